#include "scene/stage/convex_pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/stage/convex_hull.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

/// A prism over a polygon that is counterclockwise from above. Its ends are given as triangles, by the
/// numbers of the polygon's points.
Surface prism_over(const std::vector<Vec2>& outline, double height,
                   const std::vector<std::array<std::uint32_t, 3>>& ends) {
  Surface s;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, height}) {
    for (const Vec2& p : outline) s.points.emplace_back(p.x(), p.y(), z);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    s.triangles.push_back({i, j, j + n});
    s.triangles.push_back({i, j + n, i + n});
  }
  for (const auto& [a, b, c] : ends) {
    s.triangles.push_back({c, b, a});
    s.triangles.push_back({a + n, b + n, c + n});
  }
  return s;
}

/// A square of 0.1 m without its upper right quarter, 0.3 m high.
Surface ell() {
  return prism_over({{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0}, {0, 0}, {0, 0.05}, {-0.05, 0.05}},
                    0.3, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}});
}

/// A body of rings about z: height and radius of each, closed below and above.
Surface turned(const std::vector<Vec2>& rings, std::uint32_t sides) {
  Surface s;
  for (const Vec2& ring : rings) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      s.points.emplace_back(ring.y() * std::cos(angle), ring.y() * std::sin(angle), ring.x());
    }
  }
  const auto last = static_cast<std::uint32_t>((rings.size() - 1) * sides);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    for (std::uint32_t k = 0; k < last; k += sides) {
      s.triangles.push_back({k + i, k + j, k + sides + j});
      s.triangles.push_back({k + i, k + sides + j, k + sides + i});
    }
    if (i > 0 && j > 0) {
      s.triangles.push_back({0, j, i});
      s.triangles.push_back({last, last + i, last + j});
    }
  }
  return s;
}

const std::vector<Vec2> kSpool = {{0.0, 0.03},  {0.06, 0.03}, {0.1, 0.012},
                                  {0.2, 0.012}, {0.24, 0.03}, {0.3, 0.03}};

/// How far a point is outside a convex polyhedron, along its faces' normals; below 0 inside.
double outside(const engine::Polyhedron& hull, const Vec3& p) {
  double most = -1.0;
  for (const engine::Polyhedron::Face& face : hull.faces()) {
    most = std::max(most, face.normal.dot(p) - face.offset);
  }
  return most;
}

double volume_of_all(const std::vector<engine::Polyhedron>& pieces) {
  double volume = 0.0;
  for (const engine::Polyhedron& piece : pieces) volume += volume_of(piece);
  return volume;
}

std::string refusal(const Surface& surface) {
  return complaint([&] { convex_pieces(surface, 16); });
}

TEST(ConvexHull, HasAllPointsInsideAndIsMadeOfSome) {
  std::mt19937 random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) {
    Vec3 p;
    for (double& x : p) x = static_cast<double>(random()) / 4294967296.0;
    points.push_back(p);
    if (i % 3 == 0) points.push_back(p);  // twice in one place
  }
  const engine::Polyhedron hull = convex_hull(points);
  for (const Vec3& p : points) EXPECT_LT(outside(hull, p), 1e-6);
  for (const Vec3& v : hull.vertices()) {
    EXPECT_NE(std::find(points.begin(), points.end(), v), points.end());
  }
  EXPECT_GT(volume_of(hull), 0.8);  // of the unit cube
}

TEST(ConvexHull, OfACubeHasItsSixFaces) {
  std::vector<Vec3> points;
  for (int i = 0; i < 27; ++i) points.emplace_back(i % 3, i / 3 % 3, i / 9);
  const engine::Polyhedron cube = convex_hull(points);
  EXPECT_EQ(cube.vertices().size(), 8u);
  EXPECT_EQ(cube.faces().size(), 6u);
  EXPECT_NEAR(volume_of(cube), 8.0, 1e-12);
  EXPECT_THAT(complaint([] {
                convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
              }),
              HasSubstr("no volume"));
}

TEST(ConvexPieces, OfAnLAreItsTwoBlocks) {
  const std::vector<engine::Polyhedron> pieces = convex_pieces(ell(), 16);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NEAR(volume_of_all(pieces), 0.75 * 0.1 * 0.1 * 0.3, 1e-12);
  for (const engine::Polyhedron& piece : pieces) EXPECT_EQ(piece.faces().size(), 6u);
}

// Their volume is that of frustums: h (a + b + sqrt(a b)) / 3, with the areas of its ends.
TEST(ConvexPieces, OfASpoolAreCutAtItsBends) {
  constexpr std::uint32_t kSides = 24;
  const double area = 0.5 * kSides * std::sin(2.0 * std::numbers::pi / kSides);  // of a unit ring
  double truth = 0.0;
  for (std::size_t i = 1; i < kSpool.size(); ++i) {
    const double a = kSpool[i - 1].y(), b = kSpool[i].y();
    truth += area * (kSpool[i].x() - kSpool[i - 1].x()) * (a * a + b * b + a * b) / 3.0;
  }
  const Surface spool = turned(kSpool, kSides);
  EXPECT_NEAR(volume_of(spool), truth, 1e-12);
  const std::vector<engine::Polyhedron> pieces = convex_pieces(spool, 16);
  ASSERT_EQ(pieces.size(), 3u);
  EXPECT_NEAR(volume_of_all(pieces), truth, 1e-9 * truth);
  for (std::size_t i = 0; i < 3; ++i) {
    double low = 1.0, high = 0.0;
    for (const Vec3& v : pieces[i].vertices()) {
      low = std::min(low, v.z());
      high = std::max(high, v.z());
    }
    EXPECT_EQ(low, (std::array{0.0, 0.1, 0.2}[i]));
    EXPECT_EQ(high, (std::array{0.1, 0.2, 0.3}[i]));
  }
  const std::vector<engine::Polyhedron> hull = convex_pieces(spool, 1);
  ASSERT_EQ(hull.size(), 1u);
  EXPECT_NEAR(volume_of(hull[0]), area * 0.03 * 0.03 * 0.3, 1e-12);
}

// A tube: no plane across one axis parts it, and its pieces leave the hole open.
TEST(ConvexPieces, OfATubeCoverItOnceAndLeaveItsHole) {
  constexpr std::uint32_t kSides = 24;
  constexpr double kOuter = 0.05, kInner = 0.03, kHeight = 0.3;
  Surface tube;
  for (const Vec2& ring :
       {Vec2(0, kOuter), Vec2(0, kInner), Vec2(kHeight, kOuter), Vec2(kHeight, kInner)}) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      tube.points.emplace_back(ring.y() * std::cos(angle), ring.y() * std::sin(angle), ring.x());
    }
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    tube.triangles.push_back({a, b, c});
    tube.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t j = (i + 1) % kSides, n = kSides;
    quad(i, j, 2 * n + j, 2 * n + i);
    quad(n + j, n + i, 3 * n + i, 3 * n + j);
    quad(j, i, n + i, n + j);
    quad(2 * n + i, 2 * n + j, 3 * n + j, 3 * n + i);
  }
  const std::vector<engine::Polyhedron> pieces = convex_pieces(tube, 16);
  EXPECT_LE(pieces.size(), 16u);
  const double truth = 0.5 * kSides * std::sin(2.0 * std::numbers::pi / kSides) *
                       (kOuter * kOuter - kInner * kInner) * kHeight;
  EXPECT_NEAR(volume_of(tube), truth, 1e-12);
  EXPECT_GE(volume_of_all(pieces), truth * (1.0 - 1e-9));
  EXPECT_LE(volume_of_all(pieces), 1.02 * truth);
  std::mt19937 random(2);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  int in_wall = 0, outer = 0, open = 0, filled = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p(0.12 * (uniform() - 0.5), 0.12 * (uniform() - 0.5), kHeight * uniform());
    const auto within = std::count_if(pieces.begin(), pieces.end(),
                                      [&](const auto& piece) { return outside(piece, p) < -1e-9; });
    const double r = std::hypot(p.x(), p.y()), flat = std::cos(std::numbers::pi / kSides);
    EXPECT_LE(within, 1) << p.transpose();
    if (r > kInner && r < kOuter * flat) {
      ++in_wall;
      EXPECT_EQ(within, 1) << p.transpose();
    }
    outer += r > kOuter ? static_cast<int>(within) : 0;
    if (r < kInner * flat) ++(within == 0 ? open : filled);
  }
  EXPECT_GT(in_wall, 500);
  EXPECT_EQ(outer, 0);
  EXPECT_GT(open, 20 * filled);  // what the hulls add
}

/// A box between two corners.
Surface box(const Vec3& low, const Vec3& high) {
  Surface s = prism_over({low.head<2>(), {high.x(), low.y()}, high.head<2>(), {low.x(), high.y()}},
                         high.z() - low.z(), {{0, 1, 2}, {0, 2, 3}});
  for (Vec3& p : s.points) p.z() += low.z();
  return s;
}

Surface inside_out(Surface s) {
  for (auto& t : s.triangles) std::swap(t[0], t[1]);
  return s;
}

Surface both(Surface a, const Surface& b) {
  const auto first = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& t : b.triangles) {
    a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return a;
}

TEST(ConvexPieces, OfShellsAreThoseOfEachShell) {
  const Surface base = box({-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1});
  const std::vector<std::pair<Surface, double>> cases = {
      {both(base, box({-0.02, -0.02, 0.1}, {0.02, 0.02, 0.3})),
       0.001 + 0.00032},  // it stands on it
      {both(base, box({-0.05, -0.05, 0.36}, {0.05, 0.05, 0.38})), 0.001 + 0.0002},  // apart
      {both(base, box({-0.0495, -0.05, 0.0}, {0.0505, 0.05, 0.1})), 2 * 0.001},  // one in the other
      {both(box({-0.1, -0.01, 0.0}, {0.1, 0.01, 0.3}), box({-0.01, -0.1, 0.0}, {0.01, 0.1, 0.3})),
       2 * 0.0012},  // across each other
  };
  for (const auto& [surface, volume] : cases) {
    const std::vector<engine::Polyhedron> pieces = convex_pieces(surface, 16);
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_NEAR(volume_of_all(pieces), volume, 1e-12);
  }
  const auto mixed = convex_pieces(both(ell(), box({0.2, 0.0, 0.0}, {0.3, 0.1, 0.1})), 16);
  EXPECT_EQ(mixed.size(), 3u);
  EXPECT_NEAR(volume_of_all(mixed), 0.75 * 0.1 * 0.1 * 0.3 + 0.001, 1e-12);
}

TEST(ConvexPieces, OfAShellInsideOutAreAHoleOrRefused) {
  const Surface base = box({-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1});
  const Surface hole = inside_out(box({-0.03, -0.03, 0.02}, {0.03, 0.03, 0.08}));
  // No one or two cuts open a closed cavity, so that it is filled; it is no body beside the box.
  const double hollow = volume_of_all(convex_pieces(both(base, hole), 16));
  EXPECT_GE(hollow, 0.001 - 0.06 * 0.06 * 0.06);
  EXPECT_LE(hollow, 0.001 * (1.0 + 1e-9));
  EXPECT_THAT(refusal(both(base, inside_out(box({0.2, 0.0, 0.0}, {0.21, 0.01, 0.01})))),
              HasSubstr("a part of it is turned inside out, at 0.21, 0, 0"));
}

// Two holes in one place are counted twice, and leave the box less than nothing; another box has enough.
TEST(ConvexPieces, OfHolesThatTakeABoxWholeAreRefused) {
  const Surface base = box({-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1});
  const Surface hole = inside_out(box({-0.045, -0.045, 0.005}, {0.045, 0.045, 0.095}));
  const Surface beside = box({0.2, 0.0, 0.0}, {0.4, 0.2, 0.2});
  EXPECT_THAT(refusal(both(both(both(base, hole), hole), beside)),
              HasSubstr("holes take all of a part of it, at -0.05, -0.05, 0 m"));
}

// Each alone is too small to be a body, together they are not.
TEST(ConvexPieces, OfTwoSpecksFarApartAreMadeOrRefused) {
  const double speck = 8.9e-4;
  const Surface two = both(box({0.0, 0.0, 0.0}, {speck, speck, speck}),
                           box({1.0, 0.0, 0.0}, {1.0 + speck, speck, speck}));
  EXPECT_EQ(convex_pieces(two, 16).size(), 1u);
}

/// Little blocks on a round way about a pole on a plate; nothing overlaps.
Surface studded_plate(int blocks, double half) {
  Surface all = both(box({-0.08, -0.08, 0.0}, {0.08, 0.08, 0.03}),
                     box({-0.015, -0.015, 0.03}, {0.015, 0.015, 0.38}));
  for (int i = 0; i < blocks; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / blocks;
    const Vec3 p(0.06 * std::cos(angle), 0.06 * std::sin(angle), 0.03);
    all = both(all, box(p - Vec3(half, half, 0.0), p + Vec3(half, half, 0.015)));
  }
  return all;
}

// Two that are near each other become one, and the others stay.
TEST(ConvexPieces, OfMoreShellsThanPiecesAreMergedWhereThatAddsLeast) {
  Surface steps = box({0.0, 0.0, 0.0}, {0.01, 0.05, 0.05});
  for (int k = 1; k < 6; ++k)
    steps = both(steps, box({0.02 * k, 0.0, 0.0}, {0.02 * k + 0.01, 0.05, 0.05}));
  const double one = 0.01 * 0.05 * 0.05;
  EXPECT_EQ(convex_pieces(steps, 6).size(), 6u);
  const auto five = convex_pieces(steps, 5);
  EXPECT_EQ(five.size(), 5u);
  EXPECT_NEAR(volume_of_all(five), 7.0 * one, 1e-9 * one);
  const auto hull = convex_pieces(steps, 1);
  ASSERT_EQ(hull.size(), 1u);
  EXPECT_NEAR(volume_of_all(hull), 11.0 * one, 1e-9 * one);

  const std::pair<Surface, double> cases[] = {{studded_plate(15, 0.006), 0.005},
                                              {studded_plate(30, 0.003), 0.02},
                                              {studded_plate(120, 0.001), 0.02}};
  for (const auto& [plate, most_added] : cases) {
    const auto pieces = convex_pieces(plate, 16);
    EXPECT_EQ(pieces.size(), 16u);
    EXPECT_GE(volume_of_all(pieces), volume_of(plate));
    EXPECT_LE(volume_of_all(pieces), (1.0 + most_added) * volume_of(plate));
    for (const Vec3& p : plate.points) {
      EXPECT_TRUE(std::ranges::any_of(pieces, [&](const auto& piece) {
        return outside(piece, p) < 1e-9;
      })) << p.transpose();
    }
  }
}

// A bent one is cut before others are merged.
TEST(ConvexPieces, OfMoreShellsThanPiecesAreThoseOfTheBentOnes) {
  Surface all = ell();
  double truth = 0.75 * 0.1 * 0.1 * 0.3;
  for (int k = 0; k < 16; ++k) {
    const Vec3 low(0.1 + 0.012 * k, 0.0, 0.0), high = low + Vec3(0.01, 0.01, 0.01);
    all = both(all, box(low, high));
    truth += 1e-6;
  }
  const auto pieces = convex_pieces(all, 16);
  EXPECT_EQ(pieces.size(), 16u);
  EXPECT_NEAR(volume_of_all(pieces), truth + 2.0 * 0.002 * 1e-4, 1e-9 * truth);
}

// Shells that overlap hold less than their sum, of which 1 % would be reached sooner.
TEST(ConvexPieces, OfShellsThatOverlapAddLittleToWhatTheyHoldTogether) {
  const double tooth = 0.0018;  // of a ridge along the block: its hull adds 0.9 % of it
  const Surface ridged =
      prism_over({{0.0, 0.0}, {0.1, 0.0}, {0.1, 0.1}, {0.05, 0.1 - tooth}, {0.0, 0.1}}, 0.3,
                 {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}});
  EXPECT_EQ(convex_pieces(ridged, 16).size(), 1u);
  const Surface twice = both(ridged, box({0.0, 0.0, 0.0}, {0.1, 0.09, 0.3}));
  EXPECT_EQ(convex_pieces(twice, 16).size(), 2u);
  Surface dented = ridged;
  dented.points[3].y() = dented.points[8].y() = 0.1 - 1.4 * tooth;  // 1.3 % of it, 0.7 % of the sum
  EXPECT_EQ(convex_pieces(both(dented, box({0.0, 0.0, 0.0}, {0.1, 0.09, 0.3})), 16).size(), 3u);
}

TEST(ConvexPieces, AreTheSameEachTime) {
  const Surface spool = turned(kSpool, 24);
  const auto once = convex_pieces(spool, 16), again = convex_pieces(spool, 16);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_TRUE(std::ranges::equal(once[i].vertices(), again[i].vertices()));
  }
}

TEST(ConvexPieces, OfWhatIsNoBodyAreRefused) {
  EXPECT_THAT(refusal({}), HasSubstr("no triangles"));
  Surface open = ell();
  open.triangles.pop_back();
  EXPECT_THAT(refusal(open), HasSubstr("not closed"));
  Surface out = ell();
  for (auto& t : out.triangles) std::swap(t[0], t[1]);
  EXPECT_THAT(refusal(out), HasSubstr("turned inside out"));
  Surface one = ell();
  std::swap(one.triangles[3][0], one.triangles[3][1]);
  EXPECT_THAT(refusal(one), HasSubstr("both on its left side"));
  // A box that stands on another one shares its edges: the message says where.
  Surface tower =
      both(box({0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}), box({0.0, 0.0, 0.1}, {0.1, 0.1, 0.3}));
  std::vector<Vec3> points;
  const std::vector<std::uint32_t> index = weld(tower.points, 1e-6, points);
  tower.points = points;
  for (auto& t : tower.triangles) t = {index[t[0]], index[t[1]], index[t[2]]};
  const std::string said = refusal(tower);
  EXPECT_THAT(said, HasSubstr("0.1 m belongs to two triangles"));
  EXPECT_THAT(said, HasSubstr("two parts of the mesh share this edge"));
  Surface flat = ell();
  for (Vec3& p : flat.points) p.z() *= 1e-12;
  EXPECT_THAT(refusal(flat), HasSubstr("no volume"));
}

// Surfaces of random corners cross themselves: there is no right answer, but always one or a refusal.
TEST(ConvexPieces, OfHostileSurfacesEndSomehow) {
  std::mt19937 random(3);
  int refused = 0, made = 0;
  for (int i = 0; i < 60; ++i) {
    Surface s = turned(kSpool, static_cast<std::uint32_t>(3 + random() % 5));
    for (int k = 0; k < 4; ++k) {
      Vec3& p = s.points[random() % s.points.size()];
      p = Vec3(static_cast<double>(random() % 7) - 3.0, static_cast<double>(random() % 7) - 3.0,
               static_cast<double>(random() % 7) - 3.0) *
          0.05;
    }
    try {
      const std::vector<engine::Polyhedron> pieces = convex_pieces(s, 8);
      EXPECT_LE(pieces.size(), 8u);
      EXPECT_GE(pieces.size(), 1u);
      ++made;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(made, 5);
  EXPECT_GT(refused, 2);
}

}  // namespace
}  // namespace headpin::scene
