// Contacts of bodies of several parts, against those of each pair of parts alone; limits that are met exactly.

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "engine/contacts.h"
#include "tests/engine/shape_pairs.h"

namespace headpin::engine {
namespace {

struct PartContacts {
  std::vector<ContactPoint> points;
  std::vector<KeptNormal> kept;
  QueryCounts counts;
};

PartContacts part_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                           double margin, bool faces = true) {
  Query query;
  query.faces = faces;
  PartContacts found;
  found.kept.resize(kept_normals(a, b));
  find_contacts(a, X_WA, b, X_WB, margin, found.kept, query, found.counts, found.points);
  return found;
}

/// The deepest point of each pair of parts, by the number that its features have.
std::map<std::uint32_t, double> deepest_by_pair(const std::vector<ContactPoint>& points) {
  std::map<std::uint32_t, double> deepest;
  for (const ContactPoint& p : points) {
    double& most = deepest.emplace(p.feature >> 16, p.depth).first->second;
    most = std::max(most, p.depth);
  }
  return deepest;
}

/// Parts all over a cube of 2 m, some of them turned.
Compound scattered(Random& random, test::Pool& pool, int count, bool hulls) {
  std::vector<Part> parts;
  for (int i = 0; i < count; ++i) {
    const bool turned = index_below(random, 2) == 0;
    const Vec3 place(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                     random.uniform(-1.0, 1.0));
    const int kind = hulls ? static_cast<int>(test::ShapeKind::hull) : index_below(random, 4);
    const Shape shape = hulls && index_below(random, 2) == 0
                            ? Shape(test::box({0.8, 0.6, 0.3}))
                            : test::scaled(pool.pick(kind), random.uniform(0.4, 1.0));
    parts.push_back({shape, {turned ? any_rotation(random) : Quat::Identity(), place}});
  }
  return make_compound(parts);
}

/// Each pair of parts has the contacts that it has alone, under its number: that of b's part changes fastest.
void expect_pairs(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  const PartContacts& found, int& pairs) {
  constexpr double kMargin = 1e-3;
  std::map<std::uint32_t, double> deepest = deepest_by_pair(found.points);
  std::set<std::uint32_t> features;
  for (const ContactPoint& p : found.points) features.insert(p.feature);
  EXPECT_EQ(features.size(), found.points.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    for (std::size_t j = 0; j < b.parts.size(); ++j) {
      const Pose X_AB = (X_WA * a.parts[i].X_BG).inverse() * (X_WB * b.parts[j].X_BG);
      Query query;
      query.margin = kMargin;
      const double depth = -test::query(a.parts[i].shape, b.parts[j].shape, X_AB, query).distance;
      const auto pair = static_cast<std::uint32_t>(i * b.parts.size() + j);
      const auto mine = deepest.find(pair);
      if (mine != deepest.end() && depth < 0.03) {
        ++pairs;
        EXPECT_NEAR(mine->second, depth, 2e-6 + 0.011 * std::max(0.0, depth)) << pair;
      } else if (depth < 0.03) {
        EXPECT_LT(depth, 1e-6 - kMargin) << pair;
      }
      if (mine != deepest.end()) deepest.erase(mine);
    }
  }
  EXPECT_TRUE(deepest.empty());  // no other numbers
}

TEST(PairsOfParts, HaveTheirContactsUnderTheirNumbers) {
  Random random(51);
  test::Pool pool(52);
  int pairs = 0;
  for (int round = 0; round < 150 / test::kThin; ++round) {
    const bool a_hulls = round % 3 == 0, b_hulls = round % 3 == 1;
    const Compound a = scattered(random, pool, 2 + index_below(random, 4), a_hulls);
    const Compound b = scattered(random, pool, 2 + index_below(random, 4), b_hulls);
    const Pose X_WA{any_rotation(random), random.normal3()};
    const Quat turn = any_rotation(random);
    const Vec3 way = direction(random);
    double in = 0.0, out = 8.0;
    for (int k = 0; k < 10; ++k) {
      const double middle = 0.5 * (in + out);
      const Pose X_WB{turn, X_WA.p + middle * way};
      (part_contacts(a, X_WA, b, X_WB, 0.0, false).points.empty() ? out : in) = middle;
    }
    const Pose X_WB{turn, X_WA.p + (in - random.uniform(0.0, 0.03)) * way};
    for (const bool faces : {true, false}) {
      expect_pairs(a, X_WA, b, X_WB, part_contacts(a, X_WA, b, X_WB, 1e-3, faces), pairs);
      if (HasFailure()) FAIL() << round << " " << faces;
    }
  }
  EXPECT_GT(pairs, 200 / test::kThin);
}

// Over the middle of one of three blocks, a body stands on its face alone; the numbers are those of the search.
TEST(PairsOfParts, HaveTheSameNumbersOnOneFace) {
  std::vector<Part> blocks, feet;
  for (const double x : {-10.0, 0.0, 10.0}) {
    blocks.push_back({test::box({4.0, 4.0, 2.5}), {Quat::Identity(), {x, 0.0, -2.0}}});
    feet.push_back({Ellipsoid{Vec3::Constant(0.5)}, {Quat::Identity(), {0.1 * x, 0.0, 0.0}}});
  }
  feet.push_back({Ellipsoid{Vec3::Constant(0.5)}, {Quat::Identity(), {0.0, 1.0, 0.0}}});
  const Compound ground = make_compound(blocks), body = make_compound(feet);
  for (std::uint32_t block = 0; block < 3; ++block) {
    const Pose over{Quat::Identity(), {10.0 * block - 10.0, 0.0, 0.99}};
    for (const bool faces : {true, false}) {
      const PartContacts under = part_contacts(ground, {}, body, over, 0.0, faces);
      const PartContacts on = part_contacts(body, over, ground, {}, 0.0, faces);
      EXPECT_EQ(under.kept[4 * block].of, faces ? KeptNormal::none : KeptNormal::met);
      const auto below = deepest_by_pair(under.points), above = deepest_by_pair(on.points);
      ASSERT_EQ(below.size(), 4u);
      ASSERT_EQ(above.size(), 4u);
      for (std::uint32_t foot = 0; foot < 4; ++foot) {
        EXPECT_NEAR(below.at(4 * block + foot), 0.01, 1e-9);
        EXPECT_NEAR(above.at(3 * foot + block), 0.01, 1e-9);
      }
    }
  }
}

// A row of seventy balls over another row, and one ball at each place along it.
TEST(PairsOfParts, AreFoundInBodiesOfMoreThanSixtyFourParts) {
  std::vector<Part> balls;
  for (int i = 0; i < 70; ++i) {
    balls.push_back({Ellipsoid{Vec3::Constant(0.5)}, {Quat::Identity(), {1.0 * i, 0.0, 0.0}}});
  }
  const Compound row = make_compound(balls), two = make_compound({balls[0], balls[1]});
  for (std::uint32_t i = 0; i < 69; ++i) {
    const Pose over{Quat::Identity(), {1.0 * i, 0.0, 0.99}};
    const auto on_row = deepest_by_pair(part_contacts(row, {}, two, over, 0.0).points);
    const auto under = deepest_by_pair(part_contacts(two, over, row, {}, 0.0).points);
    ASSERT_EQ(on_row.size(), 2u) << i;
    ASSERT_EQ(under.size(), 2u) << i;
    for (const std::uint32_t k : {0u, 1u}) {
      EXPECT_NEAR(on_row.at(2 * (i + k) + k), 0.01, 1e-9);
      EXPECT_NEAR(under.at(70 * k + i + k), 0.01, 1e-9);
    }
  }
}

// A plane that is one part of several carries as it does alone.
TEST(PairsOfParts, OfAPlaneAndABoxAreFoundHoweverFarFromTheOrigin) {
  const Compound ground = make_compound({{HalfSpace{}, {}}, {test::box(Vec3::Constant(0.2)), {}}});
  const Shape ball = Ellipsoid{Vec3::Constant(0.5)};
  const Compound two = make_compound(
      {{ball, {Quat::Identity(), {-1.0, 0.0, 0.0}}}, {ball, {Quat::Identity(), {1.0, 0.0, 0.0}}}});
  for (const double far : {0.0, 30.0, 3000.0}) {
    const Pose low{Quat::Identity(), {far, -far, 0.49}};
    const auto under = deepest_by_pair(part_contacts(ground, {}, two, low, 0.0).points);
    ASSERT_EQ(under.size(), 2u) << far;
    EXPECT_NEAR(under.at(0), 0.01, 1e-9);
    EXPECT_NEAR(under.at(1), 0.01, 1e-9);
    const auto over = deepest_by_pair(part_contacts(two, low, ground, {}, 0.0).points);
    ASSERT_EQ(over.size(), 2u) << far;
    EXPECT_NEAR(over.at(0), 0.01, 1e-9);
    EXPECT_NEAR(over.at(2), 0.01, 1e-9);
  }
}

TEST(KeptNormals, AreOneForEachPairOfPartsAndNoneOfAPlane) {
  const Part ball{Ellipsoid{Vec3::Constant(0.5)}, {}}, plane{HalfSpace{}, {}};
  const Compound floor = make_compound({plane}), two = make_compound({ball, ball});
  const Compound three = make_compound({plane, ball, ball});
  EXPECT_EQ(kept_normals(two, three), 6u);
  EXPECT_EQ(kept_normals(three, two), 6u);
  EXPECT_EQ(kept_normals(floor, two), 0u);
  EXPECT_EQ(kept_normals(two, floor), 0u);
}

// Of two boxes the larger one carries the other by its face, without a search, which would keep a normal.
TEST(AFaceOfTheLargerBody, CarriesTheOtherOneWithoutASearch) {
  const Compound large = make_compound({{test::box({2.0, 2.0, 0.5}), {}}});
  const Compound small = make_compound({{test::box({0.1, 0.1, 0.1}), {}}});
  const Pose on{Quat::Identity(), {0.3, 0.2, 0.599}};
  for (const PartContacts& found :
       {part_contacts(large, {}, small, on, 0.0), part_contacts(small, on, large, {}, 0.0)}) {
    EXPECT_EQ(found.points.size(), 4u);
    EXPECT_EQ(found.kept[0].of, KeptNormal::none);
    EXPECT_EQ(found.counts.queries, 1);
    EXPECT_EQ(found.counts.iterations, 1);
  }
  for (const PartContacts& found : {part_contacts(large, {}, small, on, 0.0, false),
                                    part_contacts(small, on, large, {}, 0.0, false)}) {
    EXPECT_EQ(found.kept[0].of, KeptNormal::met);
  }
}

// Numbers that are exact in binary: a gap as large as the margin counts, a larger one does not.
TEST(TheMargin, IncludesTheGapThatIsAsLarge) {
  const Part ball{Ellipsoid{Vec3::Constant(0.5)}, {}};
  const Part other{ball.shape, {Quat::Identity(), {4.0, 0.0, 0.0}}};
  const Compound one = make_compound({ball}), two = make_compound({ball, other});
  const Compound plane = make_compound({{HalfSpace{}, {}}});
  const Compound box = make_compound({{test::box(Vec3::Constant(0.5)), {}}});
  for (const double margin : {0.25, std::nextafter(0.25, 0.0)}) {
    const bool is_in = margin == 0.25;
    const Pose high{Quat::Identity(), {0.0, 0.0, 0.75}}, higher{Quat::Identity(), {0.0, 0.0, 1.25}};
    EXPECT_EQ(part_contacts(plane, {}, one, high, margin).points.size(), is_in ? 1u : 0u);
    EXPECT_EQ(part_contacts(plane, {}, two, high, margin).points.size(), is_in ? 2u : 0u);
    EXPECT_EQ(part_contacts(plane, {}, box, high, margin).points.size(), is_in ? 4u : 0u);
    EXPECT_EQ(part_contacts(one, {}, one, higher, margin).points.size(), is_in ? 1u : 0u);
    EXPECT_EQ(part_contacts(two, {}, two, higher, margin).points.size(), is_in ? 2u : 0u);
    EXPECT_EQ(part_contacts(box, {}, box, higher, margin).points.size(), is_in ? 4u : 0u);
  }
}

std::vector<ContactPoint> of_shapes(const Shape& a, const Shape& b, const Pose& X_AB,
                                    bool steady = true) {
  KeptNormal kept;
  Query query;
  query.steady = steady;
  QueryCounts counts;
  std::vector<ContactPoint> out;
  find_contacts(a, {}, b, X_AB, 1e-3, kept, query, counts, out);
  return out;
}

/// A prism_of with so many sides, corners on a circle.
Polyhedron prism_of(std::uint32_t sides, double radius, double half_height) {
  std::vector<Vec3> corners;
  std::vector<std::vector<std::uint32_t>> faces(2);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / sides;
    for (const double z : {-half_height, half_height}) {
      corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    faces[0].push_back(2 * (sides - 1 - i));
    faces[1].push_back(2 * i + 1);
    const std::uint32_t k = (i + 1) % sides;
    faces.push_back({2 * i, 2 * k, 2 * k + 1, 2 * i + 1});
  }
  return Polyhedron(corners, faces);
}

/// A body over a table of height 0.2, that leans a little to one side.
Pose leaning(double lean, double to) {
  return {rotation(lean * Vec3(-std::sin(to), std::cos(to), 0.0)), {0.0, 0.0, 0.2 - 1e-4}};
}

// Which points of a face are chosen does not change with a lean of less than 1e-4, if they are steady; else,
// and on a rim, the deepest is the first.
TEST(TheFirstPoint, IsTheDeepestOfARimAndSteadyOfAFace) {
  const Shape table = test::box({1.0, 1.0, 0.1});
  std::set<std::set<std::uint32_t>> chosen;
  for (int k = 0; k < 8; ++k) {
    const Pose X_AB = leaning(5e-6, 0.1 + 0.785 * k);
    std::set<std::uint32_t> features;
    for (const ContactPoint& p : of_shapes(table, prism_of(8, 0.1, 0.1), X_AB)) {
      features.insert(p.feature);
    }
    chosen.insert(features);
    const Vec3 down = X_AB.q.conjugate() * -Vec3::UnitZ();
    const auto expect_first = [&](const Shape& s, bool steady) {
      const auto points = of_shapes(table, s, X_AB, steady);
      ASSERT_GE(points.size(), 3u);
      const Vec3 lowest = X_AB * support(s, down);
      EXPECT_LT((points[0].p_W - lowest).head<2>().norm(), 1e-4) << kind(s) << " " << steady;
    };
    expect_first(Cylinder{0.1, 0.1}, true);
    expect_first(prism_of(8, 0.1, 0.1), false);
    expect_first(prism_of(4, 0.1, 0.1), true);
  }
  EXPECT_EQ(chosen.size(), 1u);
}

// Two logs that cross at a small angle are deepest where they cross, between the ends of what they share.
TEST(CrossedLogs, HaveTheDeepestPointToo) {
  const Cylinder log{0.1, 0.3};
  const Pose X_AB{rotation({0.05, 0.0, 0.0}), {0.199, 0.0, 0.0}};
  const auto points = of_shapes(log, log, X_AB);
  ASSERT_GE(points.size(), 1u);
  EXPECT_NEAR(points[0].depth, 1e-3, 1e-9);
  EXPECT_LT((points[0].p_W - Vec3(0.0995, 0.0, 0.0)).norm(), 1e-4);
  // Nearly a margin of 1 mm apart, with ends that are further apart than that.
  const auto apart = of_shapes(log, log, {rotation({0.026, 0.0, 0.0}), {0.20095, 0.0, 0.0}});
  ASSERT_EQ(apart.size(), 1u);
  EXPECT_NEAR(apart[0].depth, -0.95e-3, 1e-9);
}

// As many corners as are kept of a face, and twice as many where two such faces overlap.
TEST(AFaceOfSixtyFourCorners, StandsOnFourPointsFarApart) {
  const Polyhedron coin = prism_of(64, 0.1, 0.1);
  for (const Shape& table :
       {Shape(test::box({1.0, 1.0, 0.1})), Shape(coin), Shape(prism_of(64, 0.2, 0.1))}) {
    const Pose X_AB{rotation({0.0, 0.0, 3.14159265358979 / 64.0}), {0.0, 0.0, 0.2 - 1e-4}};
    const auto points = of_shapes(table, coin, X_AB);
    ASSERT_EQ(points.size(), 4u);
    for (const ContactPoint& p : points) {
      EXPECT_NEAR(p.depth, 1e-4, 1e-9);
      EXPECT_NEAR(p.p_W.head<2>().norm(), 0.1, 2e-4);
    }
    EXPECT_NEAR((points[0].p_W - points[1].p_W).norm(), 0.2, 2e-3);
    EXPECT_NEAR((points[2].p_W - points[3].p_W).norm(), 0.2, 2e-2);
  }
}

}  // namespace
}  // namespace headpin::engine
