#include "scene/sound/modal.h"

#include <cmath>
#include <numbers>

#include "base/math.h"

namespace headpin::scene {

namespace {

constexpr double kInaudible = 1e-6;  // Pa at 1 m: a twentieth of the threshold of hearing

template <typename Next>
void add_samples(std::span<Resonator* const> resonators, std::span<double> sum, Next next) {
  // A sample waits for the one before it: four resonators at once take as long as one.
  for (; resonators.size() >= 4; resonators = resonators.subspan(4)) {
    Resonator a = *resonators[0], b = *resonators[1], c = *resonators[2], d = *resonators[3];
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += (next(a, i) + next(b, i)) + (next(c, i) + next(d, i));
    }
    *resonators[0] = a, *resonators[1] = b, *resonators[2] = c, *resonators[3] = d;
  }
  for (Resonator* const resonator : resonators) {
    Resonator one = *resonator;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += next(one, i);
    *resonator = one;
  }
}

}  // namespace

Resonator::Resonator(const Mode& mode) {
  constexpr double kStep = 1.0 / static_cast<double>(kSoundRate);
  const double angle = 2.0 * std::numbers::pi * mode.frequency * kStep;
  const double damping = exponential(-mode.decay * kStep);
  const SinCos once = sin_cos(angle), twice = sin_cos(2.0 * angle);
  by_last_ = 2.0 * damping * once.cos;
  by_before_ = -damping * damping;
  by_impulse_ = mode.pressure * damping * once.sin;
  last_of_one_ = -once.sin / damping;
  before_of_one_ = -twice.sin / (damping * damping);
}

bool Resonator::fade() {
  if (std::abs(last_) + std::abs(before_) > kInaudible) return false;
  last_ = before_ = 0.0;
  return true;
}

void ring(std::span<Resonator* const> resonators, std::span<double> sum) {
  add_samples(resonators, sum, [](Resonator& one, std::size_t) { return one.next(); });
}

void ring(std::span<Resonator* const> resonators, std::span<const double> impulses,
          std::span<double> sum) {
  add_samples(resonators, sum,
              [&](Resonator& one, std::size_t i) { return one.next(impulses[i]); });
}

}  // namespace headpin::scene
