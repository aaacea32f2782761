#include "engine/rods.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

/// The moments of parts that are apart, in closed form.
Moments closed_form(const std::vector<Part>& parts) {
  Moments m;
  for (const Part& part : parts) {
    m.add(std::visit([](const auto& s) { return moments(s); }, part.shape), part.X_BG);
  }
  return m;
}

/// The largest relative error of the moments, for a body of this size [m].
double error_of(const Moments& found, const Moments& expected, double size) {
  const double v = expected.volume;
  return std::max({std::abs(found.volume - v) / v,
                   (found.first - expected.first).norm() / (v * size),
                   (found.second - expected.second).norm() / (v * size * size)});
}

Quat quarters(int count, const Vec3& axis) {
  return rotation(0.5 * std::numbers::pi * count * axis);
}

const Vec3 kPlace(0.3, -0.2, 0.15);

void expect_moments(const Shape& shape, const Quat& q, Rods rods, double error) {
  const std::vector<Part> parts{{shape, {q, kPlace}}};
  EXPECT_LT(error_of(bundled_rods(parts, rods), closed_form(parts), 1.0), error)
      << kind(shape) << " " << q.coeffs().transpose();
}

// Lines follow the bends of each part: small parts beside a large one, far apart along x and y.
TEST(BundledRods, OfSmallRoundPartsFarApartHaveTheirMoments) {
  std::vector<Part> parts;
  for (const Vec3& p : {Vec3(0.0, 0.0, 0.0), Vec3(3.0, 0.1, 0.2), Vec3(-0.5, 2.0, -0.3)}) {
    parts.push_back({Ellipsoid{{0.01, 0.02, 0.03}}, {Quat::Identity(), p}});
  }
  parts.push_back({Cylinder{0.01, 0.01}, {quarters(1, Vec3::UnitY()), {1.0, -1.0, 0.0}}});
  EXPECT_LT(error_of(bundled_rods(parts, Rods::between_bends), closed_form(parts), 2.0), 1e-4);
}

// Rods reach as far as the highest part; a cone ends at its apex and its base all the same.
TEST(BundledRods, OfAConeBetweenBallsEndWhereItEnds) {
  std::vector<Part> parts{{Cone{0.3, 0.8}, {}}};
  for (const double z : {-2.0, 2.0}) {
    parts.push_back({Ellipsoid{Vec3::Constant(0.1)}, {Quat::Identity(), {0.0, 0.0, z}}});
  }
  EXPECT_LT(error_of(bundled_rods(parts, Rods::between_bends), closed_form(parts), 2.0), 1e-4);
}

// Also where even lines go past the apex of a lying cone, through its mirror image.
TEST(BundledRods, OfALyingConeBesideABallEndAtItsApex) {
  const std::vector<Part> parts{
      {Cone{0.3, 0.8}, {quarters(1, Vec3::UnitY()), Vec3::Zero()}},
      {Ellipsoid{Vec3::Constant(0.1)}, {Quat::Identity(), {1.2, 0.0, 0.0}}}};
  EXPECT_LT(error_of(bundled_rods(parts, Rods::even), closed_form(parts), 1.0), 1e-4);
}

TEST(BundledRods, OfAConeWithAnUprightSideHaveItsMoments) {
  expect_moments(Cone{0.3, 0.8}, rotation({std::atan(0.375), 0.0, 0.0}), Rods::between_bends, 2e-5);
}

TEST(BundledRods, OfABoxAreExactAtEverySize) {
  for (const double size : {1e-5, 1e4}) {
    const std::vector<Part> parts{{test::box(size * Vec3(0.2, 0.3, 0.45)), {}}};
    EXPECT_LT(error_of(bundled_rods(parts, Rods::between_bends), closed_form(parts), size), 1e-10);
  }
}

// Lines between the bends: the documented error is 1e-3, that of round outlines is 2e-5.
TEST(BundledRods, OfAnUprightConeHaveItsMomentsEitherWayUp) {
  expect_moments(Cone{0.3, 0.8}, Quat::Identity(), Rods::between_bends, 2e-8);
  expect_moments(Cone{0.3, 0.8}, quarters(2, Vec3::UnitX()), Rods::between_bends, 2e-8);
}

TEST(BundledRods, OfALyingConeHaveItsMoments) {
  expect_moments(Cone{0.3, 0.8}, quarters(1, Vec3::UnitX()), Rods::between_bends, 2e-5);
  expect_moments(Cone{0.5, 0.3}, quarters(-1, Vec3::UnitY()), Rods::between_bends, 2e-5);
}

TEST(BundledRods, OfACylinderHaveItsMomentsUprightAndLying) {
  expect_moments(Cylinder{0.2, 0.35}, Quat::Identity(), Rods::between_bends, 1e-5);
  expect_moments(Cylinder{0.2, 0.35}, quarters(1, Vec3::UnitX()), Rods::between_bends, 1e-5);
  expect_moments(Cylinder{0.2, 0.35}, quarters(1, Vec3::UnitY()), Rods::between_bends, 2e-5);
}

TEST(BundledRods, OfTurnedRoundPartsHaveTheirMoments) {
  const Quat q(0.6, 0.2, -0.3, 0.7);
  expect_moments(Cone{0.3, 0.8}, q.normalized(), Rods::between_bends, 2e-5);
  expect_moments(Cylinder{0.2, 0.35}, q.normalized(), Rods::between_bends, 2e-5);
  expect_moments(Ellipsoid{{0.2, 0.3, 0.5}}, q.normalized(), Rods::between_bends, 2e-5);
}

TEST(BundledRods, OfSteepAndFlatTurnedConesHaveTheirMoments) {
  expect_moments(Cone{0.1, 0.8}, rotation({0.02, 0.01, 0.0}), Rods::between_bends, 2e-5);
  expect_moments(Cone{0.5, 0.3}, rotation({3.0, 0.1, 0.0}), Rods::between_bends, 2e-5);
}

TEST(BundledRods, OfABoxAreExactHoweverItIsTurned) {
  expect_moments(test::box({0.2, 0.3, 0.45}), Quat::Identity(), Rods::between_bends, 2e-11);
  expect_moments(test::box({0.2, 0.3, 0.45}), Quat(0.6, 0.2, -0.3, 0.7).normalized(),
                 Rods::between_bends, 2e-11);
}

// 600 lines each way, each of which stands for its width.
TEST(BundledRods, ThatAreEvenAreThoseOfABoxAndOfATurnedCone) {
  expect_moments(test::box({0.2, 0.3, 0.45}), quarters(1, Vec3::UnitX()), Rods::even, 1e-11);
  expect_moments(Cone{0.3, 0.8}, Quat(0.6, 0.2, -0.3, 0.7).normalized(), Rods::even, 2e-6);
  expect_moments(Ellipsoid{{0.2, 0.3, 0.5}}, Quat::Identity(), Rods::even, 1e-5);
}

Part brick(const Vec3& low, const Vec3& high) {
  return {test::box(0.5 * (high - low)), {Quat::Identity(), 0.5 * (low + high)}};
}

// Bricks along the axes, as many cells of a coarse lattice: a cell counts once, whatever number of bricks has it.
TEST(BundledRods, OfBricksThatOverlapCountEachCellOnce) {
  Random random(82);
  for (int n = 0; n < 4; ++n) {
    std::vector<Part> bricks, cells;
    std::vector<bool> filled(216);
    for (int k = 0; k < 5; ++k) {
      std::array<int, 3> low{}, high{};
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = index_below(random, 5);
        high[i] = low[i] + 1 + index_below(random, 5 - low[i]);
      }
      bricks.push_back(
          brick(0.1 * Vec3(low[0], low[1], low[2]), 0.1 * Vec3(high[0], high[1], high[2])));
      for (int x = low[0]; x < high[0]; ++x) {
        for (int y = low[1]; y < high[1]; ++y) {
          for (int z = low[2]; z < high[2]; ++z) {
            if (filled[static_cast<std::size_t>(36 * x + 6 * y + z)]) continue;
            filled[static_cast<std::size_t>(36 * x + 6 * y + z)] = true;
            cells.push_back(brick(0.1 * Vec3(x, y, z), 0.1 * Vec3(x + 1, y + 1, z + 1)));
          }
        }
      }
    }
    EXPECT_LT(error_of(bundled_rods(bricks, Rods::between_bends), closed_form(cells), 1.0), 1e-10)
        << n;
  }
}

// A cylinder that a box goes through, and the box without the cylinder's disc: a hand calculation.
TEST(BundledRods, OfACylinderThroughAPlateCountTheirCommonDiscOnce) {
  const Cylinder rod{0.1, 0.4};
  const std::vector<Part> parts{{rod, {}}, {test::box({0.3, 0.25, 0.05}), {}}};
  Moments expected = closed_form(parts);
  const Moments common = moments(Cylinder{0.1, 0.05});
  expected.volume -= common.volume;
  expected.second -= common.second;
  EXPECT_LT(error_of(bundled_rods(parts, Rods::between_bends), expected, 0.5), 2e-5);
}

}  // namespace
}  // namespace headpin::engine
