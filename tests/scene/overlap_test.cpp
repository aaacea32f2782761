#include "scene/stage/overlap.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/stage/convex_hull.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/seen_mesh.h"
#include "tests/support/box_object.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

Surface box_surface(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                         (i & 4) != 0 ? high.z() : low.z());
  }
  return surface_of(convex_hull(corners));
}

Surface round_body(double radius) {
  std::vector<Vec3> points;
  constexpr int kPoints = 900;
  for (int i = 0; i < kPoints; ++i) {
    const double z = (2.0 * i + 1.0) / kPoints - 1.0, angle = 2.4 * i;
    const double r = std::sqrt(1.0 - z * z);
    points.push_back(radius * Vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
  return surface_of(convex_hull(points));
}

double overlap_within(const Surface& all) {
  return overlap_of(all, bounds_of(all), columns_for(all));
}

TEST(Overlap, OfBoxesIsWhatIsInSeveralOfThem) {
  Surface all = box_surface({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});
  append(all, box_surface({0.3, 0.2, 0.4}, {1.7, 0.9, 2.0}));
  EXPECT_NEAR(overlap_within(all), 0.7 * 0.7 * 0.6, 1e-4);
  append(all, box_surface({0.5, 0.5, 0.5}, {0.8, 0.8, 0.8}));  // in both: counted three times
  EXPECT_NEAR(overlap_within(all), 0.7 * 0.7 * 0.6 + 0.3 * 0.3 * 0.3, 2e-4);
}

// What touches, and what is hollow, is counted once.
TEST(Overlap, IsNoneWhereNothingOverlaps) {
  Surface tower = box_surface({-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1});
  append(tower, box_surface({-0.02, -0.02, 0.1}, {0.02, 0.02, 0.3}));
  append(tower, box_surface({0.05, -0.05, 0.0}, {0.06, 0.05, 0.2}));
  EXPECT_NEAR(overlap_within(tower), 0.0, 1e-15);
  Surface hollow = box_surface({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}), hole = round_body(0.3);
  for (Vec3& p : hole.points) p += Vec3(0.5, 0.5, 0.5);
  for (auto& t : hole.triangles) std::swap(t[0], t[1]);
  append(hollow, hole);
  EXPECT_NEAR(overlap_within(hollow), 0.0, 1e-15);
}

// The lens of two balls: pi h^2 (3 r - h) / 3 of each.
TEST(Overlap, OfTwoBallsIsTheirLens) {
  Surface all = round_body(1.0), other = round_body(1.0);
  for (Vec3& p : other.points) p += Vec3(0.3, 0.4, 1.2);  // 1.3 away
  append(all, other);
  const double h = 1.0 - 0.65, lens = 2.0 * std::numbers::pi * h * h * (3.0 - h) / 3.0;
  EXPECT_NEAR(overlap_within(all), lens, 0.02 * lens);  // of bodies of 900 corners
  EXPECT_NEAR(overlap_of(all, bounds_of(all), 1000), lens, 0.04 * lens);
}

TEST(Overlap, OfASurfaceWithItselfIsItsVolume) {
  const Surface once = round_body(0.1);
  Surface twice = once;
  append(twice, once);
  EXPECT_NEAR(overlap_within(twice), 0.5 * volume_of(twice), 1e-3 * volume_of(twice));
}

// The walls hold 0.008 m2 of each height: twice 0.0048, less the 0.0016 that are in both. Their hull, an
// octagon, holds 0.0112. Beside 15 other parts there is room for one piece.
TEST(PolyhedronPart, OfShellsThatOverlapTellsWhatItAddsToWhatTheyHoldTogether) {
  const TemporaryFolder folder;
  // Two walls of 0.12 x 0.04 x 0.3 m across each other.
  spit(folder / "cross.obj", box_object({-0.06, -0.02, 0.0}, {0.06, 0.02, 0.3}) +
                                 box_object({-0.02, -0.06, 0.0}, {0.02, 0.06, 0.3}, 9));
  std::string parts = "{shape = 'polyhedron', file = 'cross.obj'}";
  const auto told = [&] {
    return not_convex(parse_scenario("[skittle]\nmass = 1.0\nparts = [" + parts + "]\n",
                                     (folder / "cross.toml").string()));
  };
  EXPECT_THAT(told(), testing::ElementsAre(HasSubstr("2 convex pieces collide in its place, with "
                                                     "0.0 % more volume")));
  for (int i = 0; i < 15; ++i)
    parts += ", {shape = 'cylinder', radius = 0.01, low = 0.0, high = 0.3}";
  const std::vector<std::string> of_hull = told();
  ASSERT_EQ(of_hull.size(), 1u);
  const std::string with = "1 convex piece collides in its place, with ";
  ASSERT_THAT(of_hull[0], HasSubstr(with));
  EXPECT_NEAR(std::stod(of_hull[0].substr(of_hull[0].find(with) + with.size())), 40.0, 0.15);
}

}  // namespace
}  // namespace headpin::scene
