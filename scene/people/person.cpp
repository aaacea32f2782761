#include "scene/people/person.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"

namespace headpin::scene {

namespace {

constexpr std::uint64_t kPersonsTraits = 1;  ///< purpose of these random numbers

/// Interpolates from `novice` to `master` by skill.
double by_skill(const Person& person, double novice, double master) {
  return novice + (master - novice) * person.skill;
}

/// Draws the spreads of a person's throws in speed, aim and timing. They correlate only through
/// skill.
void draw_spreads(Person& person) {
  constexpr double kRadian = std::numbers::pi / 180.0;
  constexpr double kAlike = 0.3;  // correlation of any two
  Random random(person.seed, kPersonsTraits, 1);
  const double common = std::sqrt(12.0) * (0.5 - person.skill);  // mean 0, deviation 1
  const auto spread = [&](double mean, double deviation, double least, double most) {
    const double own = random.normal();
    const double by = std::sqrt(kAlike) * common + std::sqrt(1.0 - kAlike) * own;
    return std::clamp(mean + deviation * by, least, most);
  };
  person.speed_spread = spread(0.045, 0.0145, 0.01, 0.08);
  person.aim_spread = spread(1.15, 0.37, 0.3, 2.1) * kRadian;
  person.timing_spread = spread(0.0115, 0.0037, 0.003, 0.021);
}

}  // namespace

Person draw_person(std::uint64_t seed) {
  constexpr double kRadian = std::numbers::pi / 180.0;
  Random random(seed, kPersonsTraits, 0);
  const auto normal = [&](double mean, double deviation, double least, double most) {
    return std::clamp(mean + deviation * random.normal(), least, most);
  };
  Person person;
  person.seed = seed;
  person.left_handed = random.uniform() < 0.1;
  person.height = normal(1.70, 0.09, 1.45, 2.0);
  person.skill = random.uniform();
  person.speed = normal(by_skill(person, 5.8, 7.2), 0.6, 4.0, 9.0);
  person.aim_bias = by_skill(person, 2.0, 0.4) * kRadian * random.normal();
  person.release_height = normal(by_skill(person, 0.45, 0.16), 0.05, 0.13, 0.6);
  person.mending = by_skill(person, 0.3, 0.7);
  person.lean = normal(by_skill(person, 0.55, 0.95), 0.08, 0.3, 1.1);
  const double unsteadiness = random.uniform();
  person.tremor = 1e-4 + 4e-4 * unsteadiness;
  person.sway = 2e-3 + 4e-3 * unsteadiness;
  person.reaction_s = normal(0.26, 0.04, 0.18, 0.4);
  person.pace = normal(1.0, 0.12, 0.75, 1.4);
  draw_spreads(person);
  return person;
}

}  // namespace headpin::scene
