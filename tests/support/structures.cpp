#include "tests/support/structures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

constexpr double kPi = 3.14159265358979323846;

Structure on_floor(const Material& material, const Parameters& parameters) {
  Structure s{make_world(parameters)};
  add_body(s.world, floor_body(material));
  return s;
}

Parameters without_sleep(int rate_hz, std::string_view response, int rules) {
  return {.rate_hz = rate_hz, .response = response, .sleep = false, .rules = rules};
}

void put(Structure& s, const Body& body, const Pose& X_WB) {
  s.bodies.push_back(add_body(s.world, body, at(X_WB)));
  s.start.push_back(X_WB.p);
}

}  // namespace

void run(Structure& s, double seconds) {
  Workspace workspace;
  const std::int64_t end = s.world.tick + std::llround(seconds * s.world.parameters.rate_hz);
  while (s.world.tick < end) {
    step(s.world, workspace);
    s.sum += s.world.statistics;
  }
}

double moved(const Structure& s) {
  double most = 0.0;
  for (std::size_t k = 0; k < s.bodies.size(); ++k) {
    most = std::max(most, (s.world.states[s.bodies[k]].X_WB.p - s.start[k]).norm());
  }
  return most;
}

Structure arch(int stones, int rate_hz, int rules) {
  const Material rough{0.0, 0.9};
  Structure s = on_floor(rough, without_sleep(rate_hz, "coulomb", rules));
  for (int k = 0; k < stones; ++k) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
      const double angle = kPi * (k + (i & 4 ? 1 : 0)) / stones, radius = i & 1 ? 0.565 : 0.435;
      corners.emplace_back(radius * std::cos(angle), i & 2 ? 0.1 : -0.1, radius * std::sin(angle));
    }
    const std::vector<std::vector<std::uint32_t>> faces = {
        {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const Vec3 centre =
        mass_properties(*solid(Polyhedron(corners, faces), rough).shape, 1.0).centre;
    for (Vec3& corner : corners) corner -= centre;
    put(s, solid(Polyhedron(corners, faces), rough), Pose{Quat::Identity(), centre});
  }
  return s;
}

namespace {

/// Cards that lean and cards across.
class Cards {
 public:
  Cards(int rate_hz, int rules) : s_(on_floor(kCard, without_sleep(rate_hz, "coulomb", rules))) {}

  void put_card(double x, double z, double angle) {
    put(s_, body_, Pose{Quat(Eigen::AngleAxisd(angle, Vec3::UnitY())), Vec3(x, 0.0, z)});
  }
  void put_pair(double x, double z) {
    put_card(x - kAside, z + kUp, kLean);
    put_card(x + kAside, z + kUp, -kLean);
  }
  void put_across(double x, double z) { put_card(x, z + 0.5 * kThickness, 0.5 * kPi); }
  Structure house() { return std::move(s_); }

  static constexpr double kLength = 0.09, kThickness = 0.0006, kLean = 0.35;
  static inline const double kUp = 0.5 * (kLength * std::cos(kLean) + kThickness * std::sin(kLean));
  static inline const double kAside =
      0.5 * (kLength * std::sin(kLean) + kThickness * std::cos(kLean));

 private:
  static constexpr Material kCard{0.0, 0.7};
  Structure s_;
  Body body_ = solid(test::box({0.5 * kThickness, 0.03, 0.5 * kLength}), kCard, 0.002);
};

}  // namespace

Structure card_house(int rate_hz, int rules) {
  Cards cards(rate_hz, rules);
  const double span = 4.0 * Cards::kAside + 0.002, up = 2.0 * Cards::kUp;
  cards.put_pair(-0.5 * span, 0.0);
  cards.put_pair(0.5 * span, 0.0);
  cards.put_across(0.0, up);
  cards.put_pair(0.0, up + Cards::kThickness);
  return cards.house();
}

Structure card_house_of(int storeys, int rate_hz, int rules) {
  Cards cards(rate_hz, rules);
  const double span = Cards::kLength + 0.0005;
  double z = 0.0;
  for (int pairs = storeys; pairs > 0; --pairs) {
    for (int i = 0; i < pairs; ++i) cards.put_pair((i - 0.5 * (pairs - 1)) * span, z);
    z += 2.0 * Cards::kUp;
    for (int i = 0; i + 1 < pairs; ++i) cards.put_across((i - 0.5 * (pairs - 2)) * span, z);
    z += Cards::kThickness;
  }
  return cards.house();
}

Structure in_another_order(const Structure& s, std::uint32_t seed) {
  Structure other{make_world(s.world.parameters)};
  for (BodyId fixed = 0; fixed < s.bodies.front(); ++fixed) {
    add_body(other.world, s.world.bodies[fixed], s.world.states[fixed]);
  }
  std::vector<std::size_t> order(s.bodies.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random{seed};
  for (std::size_t k = order.size() - 1; k > 0; --k) {
    std::swap(
        order[k],
        order[static_cast<std::size_t>(random.uniform(0.0, 1.0) * static_cast<double>(k + 1))]);
  }
  for (const std::size_t k : order) {
    const BodyId i = s.bodies[k];
    put(other, s.world.bodies[i], s.world.states[i].X_WB);
  }
  return other;
}

Structure boxes_on_each_other(int count, int rate_hz, std::string_view response, int rules) {
  const Material rough{0.5, 0.7};
  Structure s = on_floor(rough, without_sleep(rate_hz, response, rules));
  const Body box = solid(test::box({0.1, 0.1, 0.05}), rough, 1.0);
  Random random{7};
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform(-0.005, 0.005), y = random.uniform(-0.005, 0.005);
    put(s, box, Pose{Quat::Identity(), Vec3(x, y, 0.05 + 0.1 * k)});
  }
  return s;
}

Structure skittles_in_a_bin(int count, double half, std::string_view response, int rules) {
  Material rough{0.7, 0.7};
  Structure s = on_floor(rough, without_sleep(240, response, rules));
  for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    const Quat q = Quat::FromTwoVectors(Vec3::UnitZ(), inward);
    add_body(s.world, floor_body(rough), at(Pose{q, -half * inward}));
  }
  rough.rolling_arm = 0.008;
  const Body skittle = skittle_body(rough);
  Random random{3};
  for (int k = 0; k < count; ++k) {
    const double aside = 0.4 * half;
    const Vec3 p(k % 2 ? aside : -aside, k / 2 % 2 ? aside : -aside, 0.4 + 0.42 * (k / 4));
    put(s, skittle, Pose{any_rotation(random), p});
  }
  return s;
}

}  // namespace headpin::engine
