#include "engine/broad_phase.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

Vec3 point(Random& random, double r) {
  return {random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r)};
}

std::vector<Capsule> random_capsules(Random& random, int n, double room) {
  std::vector<Capsule> capsules;
  for (int i = 0; i < n; ++i) {
    const Vec3 a = point(random, room);
    const double length = i % 50 == 0 ? room : i % 3 == 0 ? 0.0 : 0.4;  // walls, balls, skittles
    capsules.push_back({a, a + length * direction(random), random.uniform(0.02, 0.15)});
  }
  return capsules;
}

// Sampled distance between two segments, and the capsules' distance beside it.
TEST(CapsuleDistance, IsThatOfTheNearestSamples) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    Capsule a{point(random, 1.0), point(random, 1.0), 0.1},
        b{point(random, 1.0), point(random, 1.0), 0.2};
    if (i % 4 == 0) b.b = b.a + 0.7 * (a.b - a.a);  // parallel
    if (i % 7 == 0) a.b = a.a;
    if (i % 9 == 0) b.b = b.a;
    double least = 1e9;
    for (int s = 0; s <= 400; ++s) {
      for (int t = 0; t <= 400; ++t) {
        least =
            std::min(least, (a.a + s / 400.0 * (a.b - a.a) - b.a - t / 400.0 * (b.b - b.a)).norm());
      }
    }
    EXPECT_LE(distance(a, b), least - 0.3 + 1e-12);
    EXPECT_NEAR(distance(a, b), least - 0.3, 0.01);  // half a sample of length 3.5 / 400
  }
}

TEST(BroadPhase, FindsThePairsThatABruteSearchFinds) {
  Random random(9);
  BroadPhase broad_phase;
  for (const int n : {0, 1, 2, 10, 100, 600}) {
    const std::vector<Capsule> capsules = random_capsules(random, n, 0.15 * std::cbrt(n + 1));
    for (const double margin : {0.0, 0.05}) {
      std::vector<Pair> expected, expected_moving;
      std::vector<std::uint8_t> moving(capsules.size());
      for (std::uint8_t& m : moving) m = static_cast<std::uint8_t>(index_below(random, 2));
      for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        for (std::uint32_t j = i + 1; j < capsules.size(); ++j) {
          if (distance(capsules[i], capsules[j]) > margin) continue;
          expected.push_back({i, j});
          if (moving[i] || moving[j]) expected_moving.push_back({i, j});
        }
      }
      EXPECT_EQ(broad_phase.find_pairs(capsules, {}, margin), expected);
      EXPECT_EQ(broad_phase.find_pairs(capsules, moving, margin), expected_moving);
    }
  }
}

// The capsule around a plate is wide, so balls beside the plate seem to meet it. Its box leaves most of them out, but
// none that is near: a clamped point gives the distance.
TEST(BroadPhase, LeavesOutWhatIsBesideAPlateAndNothingNear) {
  Random random(10);
  BroadPhase broad_phase;
  const Vec3 half(0.5, 0.6, 0.02);
  const Compound plate = make_compound({{test::box(half), {}}});
  EXPECT_EQ(plate.box.low, -half);
  EXPECT_EQ(plate.box.high, half);
  int round = 0, limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WB{i % 2 == 0 ? Quat::Identity() : rotation(point(random, 3.0)),
                    point(random, 1.0)};
    const Capsule ball{X_WB * point(random, 1.2), Vec3::Zero(), random.uniform(0.01, 0.2)};
    const std::vector<Capsule> bounds{X_WB * plate.bounds, {ball.a, ball.a, ball.radius}};
    const std::vector<Box> limits{X_WB * plate.box, {}};
    const Vec3 p_B = X_WB.inverse() * ball.a;
    const double gap = (p_B - p_B.cwiseMax(-half).cwiseMin(half)).norm() - ball.radius;
    const std::size_t found = broad_phase.find_pairs(bounds, {}, 0.01, limits).size();
    if (gap <= 0.01) {
      ASSERT_EQ(found, 1u) << gap;
    }
    limited += static_cast<int>(found);
    round += static_cast<int>(broad_phase.find_pairs(bounds, {}, 0.01).size());
  }
  EXPECT_LT(limited, 0.75 * round);
}

// Ten skittles on their spots do not touch each other's bounds, though their spheres overlap.
TEST(TenStandingSkittles, MakeNoPair) {
  const Compound skittle =
      make_compound({{Cylinder{0.0258, 0.03}, {Quat::Identity(), {0, 0, 0.03}}},
                     {Ellipsoid{{0.0605, 0.0605, 0.11}}, {Quat::Identity(), {0, 0, 0.116}}},
                     {Cylinder{0.0235, 0.08}, {Quat::Identity(), {0, 0, 0.26}}},
                     {Ellipsoid{{0.0325, 0.0325, 0.0325}}, {Quat::Identity(), {0, 0, 0.3485}}}});
  std::vector<Capsule> bounds;
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i <= row; ++i) {
      const Vec3 spot(0.3048 * (i - 0.5 * row), 0.3048 * 0.8660254 * row, 0.0);
      bounds.push_back(Pose{Quat::Identity(), spot} * skittle.bounds);
    }
  }
  BroadPhase broad_phase;
  EXPECT_TRUE(broad_phase.find_pairs(bounds).empty());
  EXPECT_LT(skittle.bounds.radius, 0.061);
  // A ball beside the head pin is one pair.
  bounds.push_back({Vec3(0.1, -0.1, 0.108), Vec3(0.1, -0.1, 0.108), 0.108});
  EXPECT_EQ(broad_phase.find_pairs(bounds), (std::vector<Pair>{{0, 10}}));
}

// All lengths times a power of two: each product and quotient is that of the other scale, exactly.
TEST(CapsuleDistance, IsInProportionToTheCapsules) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Capsule a{point(random, 1.0), point(random, 1.0), 0.1},
        b{point(random, 1.0), point(random, 1.0), 0.2};
    for (const double scale : {0x1p-10, 0x1p10}) {
      const auto scaled = [&](const Capsule& c) {
        return Capsule{scale * c.a, scale * c.b, scale * c.radius};
      };
      EXPECT_EQ(distance(scaled(a), scaled(b)), scale * distance(a, b));
    }
  }
}

/// Balls in a room of 0.8 m, and from its corner to the opposite one a bar wherever `bars` says.
std::vector<Capsule> balls_and_bars(Random& random, std::size_t n,
                                    const std::vector<std::size_t>& bars) {
  std::vector<Capsule> capsules;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 p = point(random, 0.4);
    capsules.push_back({p, p, random.uniform(0.02, 0.05)});
  }
  for (const std::size_t i : bars) {
    const Vec3 corner(2.0, random.uniform(-2.0, 2.0), random.uniform(1.5, 2.0));
    capsules[i] = {-corner, corner, 0.05};
  }
  return capsules;
}

std::vector<Pair> compared_each_with_each(std::span<const Capsule> capsules,
                                          std::span<const std::uint8_t> moving, double margin) {
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < capsules.size(); ++i) {
    for (std::uint32_t j = i + 1; j < capsules.size(); ++j) {
      const bool any_moves = moving.empty() || moving[i] != 0 || moving[j] != 0;
      if (any_moves && distance(capsules[i], capsules[j]) <= margin) pairs.push_back({i, j});
    }
  }
  return pairs;
}

/// Looks for what is near many capsules in a room, and compares with their boxes, one by one.
void expect_finds_near(const BroadPhase& broad_phase, std::span<const Capsule> capsules,
                       double margin, Random& random) {
  std::vector<std::uint32_t> near;
  for (int k = 0; k < 100; ++k) {
    const Vec3 p = point(random, 0.6);
    const Capsule place{p, p + point(random, 0.1), random.uniform(0.01, 0.1)};
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
      const Box box = box_around(capsules[i], 0.5 * margin);
      if (box.meets(box_around(place, 0.0))) expected.push_back(i);
    }
    broad_phase.find_near(place, near);
    ASSERT_EQ(near, expected);
  }
}

TEST(BroadPhase, FindsWhatMeetsBarsThatAreFarLargerThanTheOtherBodies) {
  Random random(12);
  BroadPhase broad_phase;
  const std::vector<Capsule> capsules = balls_and_bars(random, 600, {7, 100, 101, 598, 599});
  std::vector<std::uint8_t> moving(capsules.size());
  for (std::uint8_t& m : moving) m = static_cast<std::uint8_t>(index_below(random, 2));
  for (const std::size_t bar : {7u, 100u, 598u}) moving[bar] = bar == 100;
  for (const double margin : {0.0, 0.01}) {
    for (const std::vector<std::uint8_t>& who : {std::vector<std::uint8_t>{}, moving}) {
      EXPECT_EQ(broad_phase.find_pairs(capsules, who, margin),
                compared_each_with_each(capsules, who, margin));
      expect_finds_near(broad_phase, capsules, margin, random);
    }
  }
}

// Bodies go, and with them two of three bars that cross.
TEST(BroadPhase, ForgetsTheBodiesOfTheCallBefore) {
  Random random(13);
  BroadPhase broad_phase;
  const std::vector<Capsule> all = balls_and_bars(random, 600, {0, 200, 201, 590});
  const std::vector<std::uint8_t> at_rest(all.size(), 0);
  for (const std::size_t n : {600u, 200u, 600u, 25u, 600u, 24u, 600u, 10u, 2u}) {
    const std::span<const Capsule> some(all.data(), n);
    EXPECT_EQ(broad_phase.find_pairs(some), compared_each_with_each(some, {}, 0.0)) << n;
    expect_finds_near(broad_phase, some, 0.0, random);
  }
  const Capsule room{Vec3::Zero(), Vec3::Zero(), 10.0};
  std::vector<std::uint32_t> near;
  for (const std::size_t n : {0u, 1u}) {  // too few for a pair: none is near
    broad_phase.find_pairs(all);
    broad_phase.find_near(room, near);
    EXPECT_EQ(near.size(), all.size());
    EXPECT_TRUE(broad_phase.find_pairs(std::span(all.data(), n)).empty());
    broad_phase.find_near(room, near);
    EXPECT_TRUE(near.empty());
  }
  EXPECT_TRUE(broad_phase.find_pairs(all, at_rest).empty());
  broad_phase.find_near(room, near);
  EXPECT_TRUE(near.empty());
}

// A bar through the diagonal of a lattice of tiny balls. If it were sorted into cells of the size that suits the
// others, it would be in 1e9 of them.
TEST(BroadPhase, NeedsNoMoreMemoryForABarAmongManyTinyBodies) {
  constexpr std::uint32_t kSide = 16, kBalls = kSide * kSide * kSide;
  std::vector<Capsule> capsules;
  for (std::uint32_t i = 0; i < kBalls; ++i) {
    const Vec3 p(0.5 * (i % kSide), 0.5 * (i / kSide % kSide), 0.5 * (i / (kSide * kSide)));
    capsules.push_back({p, p, 1e-5});
  }
  capsules.push_back({capsules.front().a, capsules.back().a, 0.1});
  std::vector<Pair> expected;
  for (std::uint32_t k = 0; k < kSide; ++k) {
    expected.push_back({k * (1 + kSide + kSide * kSide), kBalls});
  }
  BroadPhase broad_phase;
  EXPECT_EQ(broad_phase.find_pairs(capsules), expected);
}

// Cells have the size of the bodies: cells of a metre would be too many for bodies of a kilometre.
TEST(BroadPhase, FindsTheSamePairsOfBodiesOfEverySize) {
  Random random(16);
  BroadPhase broad_phase;
  const std::vector<Capsule> capsules = balls_and_bars(random, 200, {3, 150});
  const std::vector<Pair> expected = compared_each_with_each(capsules, {}, 0.0);
  for (const double scale : {0x1p-10, 1.0, 0x1p10}) {
    std::vector<Capsule> scaled;
    for (const Capsule& c : capsules)
      scaled.push_back({scale * c.a, scale * c.b, scale * c.radius});
    EXPECT_EQ(broad_phase.find_pairs(scaled), expected) << scale;
  }
}

TEST(BroadPhase, FindsTheSamePairsWhenThreadsShareTheWork) {
  Random random(14);
  const std::vector<Capsule> capsules = balls_and_bars(random, 2500, {40, 41});
  BroadPhase alone, shared;
  const std::vector<Pair> expected = alone.find_pairs(capsules);
  EXPECT_GT(expected.size(), 2500u);
  for (const int threads : {2, 3}) {
    Crew crew;
    crew.use(threads);
    EXPECT_EQ(shared.find_pairs(capsules, {}, 0.0, {}, &crew), expected);
  }
}

}  // namespace
}  // namespace headpin::engine
