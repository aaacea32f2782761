#include <gtest/gtest.h>

#include "engine/seams.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using detail::Seam;

BodyId add_fixed(World& world, std::vector<Part> parts, const Pose& X_WB = {}) {
  return add_body(world,
                  {.name = "fixed", .shape = make_compound(std::move(parts)), .kind = Kind::fixed},
                  at(X_WB));
}

/// A board from `low` to `high`.
Part slab(const Vec3& low, const Vec3& high) {
  return {test::box(0.5 * (high - low)), {Quat::Identity(), 0.5 * (low + high)}};
}

/// Boards of one level behind each other, which join at y = 0, as one body or as two: parts 0 and 1.
World two_slabs(bool one_body) {
  World world = make_world({});
  const Part first = slab({-1.0, -1.0, -0.1}, {1.0, 0.0, 0.0});
  const Part second = slab({-1.0, 0.0, -0.1}, {1.0, 2.0, 0.0});
  if (one_body) {
    add_fixed(world, {first, second});
  } else {
    add_fixed(world, {first});
    add_fixed(world, {second});
  }
  return world;
}

std::size_t seams_of(World& world) {
  world.seams.made = false;
  detail::know_seams(world);
  return world.seams.all.size();
}

/// Seams of upward faces alone.
std::vector<Seam> upper_seams(World& world) {
  seams_of(world);
  std::vector<Seam> upper = world.seams.all;
  std::erase_if(upper, [](const Seam& s) { return s.up_W.z() < 0.99; });
  return upper;
}

// Above, below and on both sides: each board has the edge of each of these faces.
TEST(KnowSeams, FindsThoseOfTwoBoardsThatJoin) {
  for (const bool one_body : {false, true}) {
    World world = two_slabs(one_body);
    EXPECT_EQ(seams_of(world), 8u);
    const std::vector<Seam> upper = upper_seams(world);
    ASSERT_EQ(upper.size(), 2u);
    for (std::uint32_t k = 0; k < 2; ++k) {
      const Seam& seam = upper[k];
      EXPECT_EQ(seam.body, one_body ? 0u : k);
      EXPECT_EQ(seam.part, one_body ? k : 0u);
      EXPECT_NEAR(seam.height, 0.0, 1e-15);
      EXPECT_NEAR(seam.side, 0.0, 1e-15);
      EXPECT_LT((seam.out_W - Vec3(0.0, k == 0 ? 1.0 : -1.0, 0.0)).norm(), 1e-15);
      EXPECT_NEAR(std::abs(seam.along_W.x()), 1.0, 1e-15);
      EXPECT_NEAR(seam.from, -1.0, 1e-12);
      EXPECT_NEAR(seam.to, 1.0, 1e-12);
    }
    world.parameters.rules = 9;
    EXPECT_EQ(seams_of(world), 0u) << "the last ones are forgotten";
  }
}

TEST(KnowSeams, FindsThoseOfABoardInTheGroundAndOfNothingThatMoves) {
  World world = make_world({});
  add_fixed(world, {slab({-1.0, -1.0, -0.1}, {1.0, 0.0, 0.0})});
  EXPECT_EQ(seams_of(world), 0u);
  add_body(world, floor_body({}));
  EXPECT_EQ(seams_of(world), 4u);
  add_body(world, solid(test::box({1.0, 1.0, 0.05}), {}), at(Vec3(0.0, 1.0, -0.05)));
  EXPECT_EQ(seams_of(world), 4u);
}

/// Upper seams of two boards of which the second is moved, and turned about their edge.
std::size_t upper_seams_with(double gap, double step, double tilt) {
  World world = make_world({});
  add_fixed(world, {slab({-0.1, -0.1, -0.1}, {0.1, 0.0, 0.0})}, {Quat::Identity(), {0, 0, 0.3}});
  add_fixed(world, {slab({-0.1, 0.0, -0.1}, {0.1, 0.1, 0.0})},
            {rotation({tilt, 0.0, 0.0}), {0, gap, 0.3 + step}});
  return upper_seams(world).size();
}

// Gaps and steps of 10 um and 1 mrad still join.
TEST(KnowSeams, KnowsFacesThatJoinByTheirGapStepAndAngle) {
  EXPECT_EQ(upper_seams_with(9.9e-6, 0.0, 0.0), 2u);
  EXPECT_EQ(upper_seams_with(2e-5, 0.0, 0.0), 0u);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(upper_seams_with(0.0, sign * 9.9e-6, 0.0), 2u);
    EXPECT_EQ(upper_seams_with(0.0, sign * 1.01e-5, 0.0), 0u);
    EXPECT_EQ(upper_seams_with(0.0, 0.0, sign * 0.99e-3), 2u);
    EXPECT_EQ(upper_seams_with(0.0, 0.0, sign * 1.01e-3), 0u);
  }
}

TEST(KnowSeams, JoinsThoseWithNeighboursThatNearlyTouch) {
  for (const auto& [gap, count] : {std::pair(1.5e-5, 1), std::pair(4e-5, 2)}) {
    World world = make_world({});
    add_fixed(world, {slab({-1.0, -1.0, -0.1}, {1.0, 0.0, 0.0})});
    add_fixed(world, {slab({-1.0, 0.0, -0.1}, {0.2, 1.0, 0.0})});
    add_fixed(world, {slab({0.2 + gap, 0.0, -0.1}, {1.0, 1.0, 0.0})});
    std::vector<Seam> first = upper_seams(world);
    std::erase_if(first, [](const Seam& s) { return s.body != 0; });
    EXPECT_EQ(std::ssize(first), count) << gap;
  }
}

/// Whether a point of a board's edge is inside another board's upper side: 1, 0, or -1 where it is near
/// that one's border.
int is_over(const Part& part, const Pose& X_WB, const Vec3& half, const Vec3& p_W) {
  const Vec3 p = (X_WB * part.X_BG).inverse() * p_W;
  const double beyond = std::max(std::abs(p.x()) - half.x(), std::abs(p.y()) - half.y());
  return std::abs(beyond) < 5e-5 ? -1 : beyond < 0.0 ? 1 : 0;
}

// Boards of one level that lie at random across each other, all of them tilted, against points of their edges.
TEST(KnowSeams, FindsEachPartOfAnEdgeThatIsOverAnotherBoard) {
  Random random(83);
  const Pose X_WB{rotation({0.3, -0.4, 0.5}), {1.0, -2.0, 0.7}};
  int inside = 0, outside = 0;
  for (int n = 0; n < 20; ++n) {
    std::vector<Part> parts;
    std::vector<Vec3> halves;
    for (int k = 0; k < 6; ++k) {
      const Vec3 half(random.uniform(0.1, 0.5), random.uniform(0.1, 0.5),
                      random.uniform(0.01, 0.1));
      halves.push_back(half);
      parts.push_back({test::box(half),
                       {rotation({0.0, 0.0, random.uniform(-3.0, 3.0)}),
                        {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), -half.z()}}});
    }
    World world = make_world({});
    add_fixed(world, parts, X_WB);
    seams_of(world);
    const Vec3 up = X_WB.q * Vec3::UnitZ();
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
      for (int point = 0; point < 200; ++point) {
        const int edge = point % 4;
        const double t = random.uniform(-1.0, 1.0), side = edge < 2 ? -1.0 : 1.0;
        const Vec3 out = edge % 2 == 0 ? Vec3(side, 0, 0) : Vec3(0, side, 0);
        const Vec3 p =
            (edge % 2 == 0 ? Vec3(side, t, 1.0) : Vec3(t, side, 1.0)).cwiseProduct(halves[k]);
        const Pose X_WG = X_WB * parts[k].X_BG;
        const Vec3 p_W = X_WG * p, out_W = X_WG.q * out;
        int over = 0;
        for (std::uint32_t other = 0; other < parts.size() && over >= 0; ++other) {
          if (other == k) continue;
          const int here = is_over(parts[other], X_WB, halves[other], p_W);
          over = here != 0 ? here : over;
        }
        if (over < 0) continue;
        const auto found = std::ranges::count_if(world.seams.all, [&](const Seam& s) {
          const double along = s.along_W.dot(p_W);
          return s.part == k && (s.up_W - up).norm() < 1e-9 && (s.out_W - out_W).norm() < 1e-9 &&
                 std::abs(s.height - up.dot(p_W)) < 1e-9 &&
                 std::abs(s.side - out_W.dot(p_W)) < 1e-9 && along > s.from && along < s.to;
        });
        ASSERT_EQ(found, over) << n << " " << k << " " << t;
        ++(over == 1 ? inside : outside);
      }
    }
  }
  EXPECT_GT(inside, 3000);
  EXPECT_GT(outside, 3000);
}

// ---- points

/// A point between a body and the first of two boards, at a place of the board's surface.
struct AtSeam {
  Vec3 surface{0.3, -5e-5, -1e-4};  // of the board
  double lean = 0.1;                // of its normal over the seam: sine
  double depth = 1e-5;
  Vec3 ball{0.3, -0.02, -2e-4};  // lowest point of the ball
  std::size_t others = 0;        // points that are not asked about
};

enum class What { same, gone, mended };

/// What becomes of the point: as it was, left out, or that of the ball's lowest point with the board's face.
What becomes(const AtSeam& at_seam, bool fixed_first, bool one_body) {
  World world = two_slabs(one_body);
  const double r = 0.1;
  const BodyId ball = add_body(world, ball_body({}, r), at(Vec3(at_seam.ball + Vec3(0.0, 0.0, r))));
  detail::know_seams(world);
  const Vec3 n_W(0.0, at_seam.lean, std::sqrt(1.0 - at_seam.lean * at_seam.lean));
  const double sign = fixed_first ? 1.0 : -1.0;
  const ContactPoint point{.p_W = at_seam.surface - 0.5 * at_seam.depth * n_W,
                           .n_AB_W = sign * n_W,
                           .depth = at_seam.depth};
  std::vector<ContactPoint> points(at_seam.others, point);
  points.push_back(point);
  const Pose none;
  const detail::Placed board{0, none}, thing{ball, world.states[ball].X_WB};
  detail::mend_at_seams(world, fixed_first ? board : thing, fixed_first ? thing : board,
                        at_seam.others, points);
  for (std::size_t k = 0; k < at_seam.others; ++k) EXPECT_EQ(points[k].depth, point.depth);
  if (points.size() == at_seam.others) return What::gone;
  EXPECT_EQ(points.size(), at_seam.others + 1);
  const ContactPoint& is = points.back();
  if (is.depth == point.depth && is.p_W == point.p_W && is.n_AB_W == point.n_AB_W) {
    return What::same;
  }
  const double depth = -at_seam.ball.z();
  EXPECT_NEAR(is.depth, depth, 1e-15);
  EXPECT_LT((is.p_W - at_seam.ball - Vec3(0.0, 0.0, 0.5 * depth)).norm(), 1e-15);
  EXPECT_LT((is.n_AB_W - sign * Vec3::UnitZ()).norm(), 1e-15);
  return What::mended;
}

void expect_each_way(const AtSeam& at_seam, What what, const char* name) {
  for (const bool fixed_first : {false, true}) {
    for (const bool one_body : {false, true}) {
      EXPECT_EQ(becomes(at_seam, fixed_first, one_body), what) << name << fixed_first << one_body;
    }
  }
}

TEST(MendAtSeams, GivesAPointToTheBoardUnderItOrToTheNextOne) {
  expect_each_way({}, What::mended, "over its board ");
  expect_each_way({.ball = {0.3, 0.02, -2e-4}}, What::gone, "over the next ");
  expect_each_way({.ball = {0.3, -0.02, 3e-4}}, What::mended, "apart ");
  expect_each_way({.others = 2}, What::mended, "behind others ");
  expect_each_way({.ball = {0.3, 0.02, -2e-4}, .others = 2}, What::gone, "behind others ");
}

// A normal that leans by 1 mrad, 0.1 mm beside the edge, 1 mm below the face, 1 mm of gap or depth.
TEST(MendAtSeams, LeavesAPointThatIsNotAtTheSeam) {
  const auto on_surface = [](double x, double y, double z) { return AtSeam{.surface = {x, y, z}}; };
  expect_each_way({.lean = 1.01e-3}, What::mended, "leans ");
  expect_each_way({.lean = 0.99e-3}, What::same, "leans ");
  expect_each_way({.lean = -0.1}, What::same, "leans back ");
  for (const double side : {-1.0, 1.0}) {
    expect_each_way(on_surface(side * (1.0 + 0.99e-4), 0.0, 0.0), What::mended, "end ");
    expect_each_way(on_surface(side * (1.0 + 1.01e-4), 0.0, 0.0), What::same, "end ");
  }
  expect_each_way(on_surface(0.3, -0.99e-4, 0.0), What::mended, "inside ");
  expect_each_way(on_surface(0.3, -1.01e-4, 0.0), What::same, "inside ");
  expect_each_way(on_surface(0.3, 0.0, -0.99e-3), What::mended, "below ");
  expect_each_way(on_surface(0.3, 0.0, -1.01e-3), What::same, "below ");
  expect_each_way({.depth = -0.99e-3}, What::mended, "gap ");
  expect_each_way({.depth = -1.01e-3}, What::same, "gap ");
  expect_each_way({.ball = {0.3, -0.02, -0.99e-3}}, What::mended, "deep ");
  expect_each_way({.ball = {0.3, -0.02, -1.01e-3}}, What::same, "deep ");
  expect_each_way({.ball = {0.3, 0.02, -1.01e-3}}, What::same, "hangs down behind ");
}

// All seams of a board in the ground are those of its upper side.
TEST(MendAtSeams, LeavesAPointWhoseNormalIsThatOfTheFace) {
  World world = make_world({});
  add_fixed(world, {slab({-1.0, -1.0, -0.1}, {1.0, 1.0, 0.0})});
  add_body(world, floor_body({}));
  const BodyId ball = add_body(world, ball_body({}), at(Vec3(0.0, 0.0, kBallRadius)));
  detail::know_seams(world);
  ASSERT_EQ(world.seams.all.size(), 4u);
  const Pose none;
  std::vector<ContactPoint> points{
      {.p_W = {0.0, 1.0, 0.0}, .n_AB_W = Vec3::UnitZ(), .depth = 1e-5}};
  detail::mend_at_seams(world, {0, none}, {ball, world.states[ball].X_WB}, 0, points);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].depth, 1e-5);
}

/// A body of small balls of a radius in a row along y, which begins above y = -0.5.
Body balls_in_a_row(std::uint32_t count, double r) {
  std::vector<Part> parts;
  for (std::uint32_t j = 0; j < count; ++j) {
    parts.push_back({Ellipsoid{Vec3::Constant(r)}, {Quat::Identity(), {0.0, -0.5 + 0.01 * j, r}}});
  }
  Body body = ball_body({});
  body.shape = make_compound(parts);
  return body;
}

// The number of a pair of parts is that of A's times the number of B's parts, and B's.
TEST(MendAtSeams, KnowsThePartsByTheFeatureOfTheirPair) {
  for (const bool fixed_first : {false, true}) {
    World world = two_slabs(true);
    const BodyId balls = add_body(world, balls_in_a_row(3, 0.002));
    detail::know_seams(world);
    const Pose none;
    for (std::uint32_t i = 0; i < 2; ++i) {
      for (std::uint32_t j = 0; j < 3; ++j) {
        const Vec3 n_W = Vec3(0.0, i == 0 ? 0.1 : -0.1, 1.0).normalized();
        std::vector<ContactPoint> points{
            {.n_AB_W = fixed_first ? n_W : Vec3(-n_W),
             .feature = (fixed_first ? 3 * i + j : 2 * j + i) << 16 | 5}};
        const detail::Placed board{0, none}, thing{balls, none};
        detail::mend_at_seams(world, fixed_first ? board : thing, fixed_first ? thing : board, 0,
                              points);
        if (i == 1) {  // all of them are over the first part
          EXPECT_TRUE(points.empty());
          continue;
        }
        ASSERT_EQ(points.size(), 1u);
        EXPECT_LT((points[0].p_W - Vec3(0.0, -0.5 + 0.01 * j, 0.0)).norm(), 1e-12);
      }
    }
  }
}

// A feature has 16 bits for a pair of parts.
TEST(MendAtSeams, LeavesBodiesOfMoreThan65536PairsOfPartsAndThoseThatAreFree) {
  for (const std::uint32_t count : {256u, 257u}) {
    World world = make_world({});
    std::vector<Part> slabs;
    for (int k = 0; k < 256; ++k) {
      slabs.push_back(slab({-1.0, k - 256.0, -0.1}, {1.0, k - 255.0, 0.0}));
    }
    add_fixed(world, slabs);
    const BodyId balls = add_body(world, balls_in_a_row(count, 0.002));
    detail::know_seams(world);
    const Pose none;
    std::vector<ContactPoint> points{
        {.p_W = {0.0, -255.0, 0.0}, .n_AB_W = Vec3(0.0, 0.1, 1.0).normalized()}};
    detail::mend_at_seams(world, {0, none}, {balls, none}, 0, points);
    EXPECT_EQ(points.empty(), count == 256) << "far over the next part";
  }
  World world = two_slabs(false);
  detail::know_seams(world);
  world.bodies[0].kind = Kind::free;
  world.bodies[1].kind = Kind::free;
  const Pose none;
  std::vector<ContactPoint> points{{.n_AB_W = Vec3(0.0, 0.1, 1.0).normalized()}};
  detail::mend_at_seams(world, {0, none}, {1, none}, 0, points);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NE(points[0].n_AB_W.y(), 0.0);
}

// What others than the step looked for had a point at the edge of the next board.
TEST(ContactsNow, AreThoseOfTheStep) {
  for (const bool one_body : {false, true}) {
    World world = two_slabs(one_body);
    const BodyId ball = add_body(world, ball_body({}, 0.1), at(Vec3(0.3, -0.005, 0.0998)));
    std::vector<ContactPoint> points, of_shapes;
    for (BodyId fixed = 0; fixed < ball; ++fixed) {
      contacts_now(world, fixed, ball, 0.0, points);
      const Compound &a = *world.bodies[fixed].shape, &b = *world.bodies[ball].shape;
      std::vector<KeptNormal> normals(kept_normals(a, b));
      QueryCounts counts;
      find_contacts(a, world.states[fixed].X_WB, b, world.states[ball].X_WB, 0.0, normals, {},
                    counts, of_shapes);
    }
    EXPECT_EQ(of_shapes.size(), 2u);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_LT((points[0].n_AB_W - Vec3::UnitZ()).norm(), 1e-6);
    EXPECT_NEAR(points[0].depth, 2e-4, 1e-8);
    EXPECT_THROW(contacts_now(world, 0, ball + 1, 0.0, points), std::invalid_argument);
  }
}

}  // namespace
}  // namespace headpin::engine
