#include "engine/polyhedra.h"

#include <gtest/gtest.h>

#include "engine/non_colliding.h"
#include "tests/support/paper_data.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

bool meet(const Shape& a, const Shape& b, const Pose& X_AB) {
  KeptNormal n;
  return !closest_points(a, b, X_AB, n, {}).separated;
}

// With and without early out, and by the non-colliding method: three ways to one verdict.
TEST(Polyhedra, MeetOrDoNotWhateverTheMethod) {
  Random random(21);
  int meeting = 0;
  for (int i = 0; i < 2000; ++i) {
    const Polyhedron a = i % 3 ? test::random_hull(random, 30) : test::box({0.5, 0.3, 0.4});
    const Polyhedron b = i % 5 ? test::random_hull(random, 12) : test::box({0.1, 0.6, 0.05});
    const Pose X_AB{any_rotation(random), random.uniform(0.0, 1.3) * direction(random)};
    const bool expected = meet(a, b, X_AB);
    EXPECT_EQ(intersect_by_features(a, b, X_AB, EarlyOut::no), expected);
    EXPECT_EQ(intersect_by_features(a, b, X_AB, EarlyOut::yes), expected);
    meeting += expected;
  }
  EXPECT_GT(meeting, 500);
  EXPECT_LT(meeting, 1500);
}

// No vertex of either is inside the other, yet they meet: only the edges tell.
TEST(Polyhedra, ThatOnlyCrossEdgesMeet) {
  const Polyhedron beam = test::box({1.0, 0.1, 0.1}), other = test::box({0.1, 1.0, 0.1});
  const Pose X_AB{Quat::Identity(), {0.05, 0.07, 0.15}};
  EXPECT_TRUE(intersect_by_features(beam, other, X_AB, EarlyOut::yes));
  EXPECT_TRUE(intersect_by_features(beam, other, X_AB, EarlyOut::no));
}

TEST(Polyhedra, OneInsideTheOtherMeet) {
  const Polyhedron big = test::box({1.0, 1.0, 1.0}), small = test::box({0.1, 0.1, 0.1});
  for (const EarlyOut out : {EarlyOut::no, EarlyOut::yes}) {
    EXPECT_TRUE(intersect_by_features(big, small, {}, out));
    EXPECT_TRUE(intersect_by_features(small, big, {}, out));
  }
}

TEST(PaperData, HasSevenObjectsOfTwentyTwoPrimitivesAndExactlyAsManyPolygonsAsAsked) {
  for (const int polygons : {200, 419, 970, 2000, 4000}) {
    const test::PaperData data = test::paper_data(polygons);
    std::size_t objects = 0, primitives = 0, faces = 0;
    for (const Compound& c : data.polyhedral) {
      ++objects;
      primitives += c.parts.size();
      for (const Part& p : c.parts) faces += std::get<Polyhedron>(p.shape).faces().size();
    }
    EXPECT_EQ(objects, 7u);
    EXPECT_EQ(primitives, 22u);
    EXPECT_EQ(faces, static_cast<std::size_t>(polygons));
    EXPECT_EQ(data.polygons, polygons);
    // Corners lie on the parametric surfaces they stand for.
    for (std::size_t i = 0; i < objects; ++i) {
      for (std::size_t k = 0; k < data.polyhedral[i].parts.size(); ++k) {
        for (const Vec3& v : std::get<Polyhedron>(data.polyhedral[i].parts[k].shape).vertices()) {
          EXPECT_TRUE(contains(data.parametric[i].parts[k].shape, v, 1e-12));
          EXPECT_FALSE(contains(data.parametric[i].parts[k].shape, v * (1.0 + 1e-9), 0.0));
        }
      }
    }
  }
}

Polyhedron octahedron() {
  return Polyhedron(
      {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

// A common point is enough: of two faces, two edges or two vertices. Just apart there is none.
TEST(Polyhedra, MeetWhereTheyTouch) {
  struct Case {
    const char* name;
    Polyhedron a, b;
    Vec3 p_AB;
  };
  const Polyhedron cube = test::box({0.5, 0.5, 0.5}), beam = test::box({0.25, 2.0, 0.25});
  const Case cases[] = {
      {"face on face", cube, cube, {0.0, 0.0, 1.0}},
      {"edge on edge", cube, cube, {0.0, 1.0, 1.0}},
      {"vertex on vertex", cube, cube, {1.0, 1.0, 1.0}},
      {"vertex on face", cube, octahedron(), {0.25, 0.25, 1.5}},
      {"face on face, crossed", cube, beam, {0.0, 0.0, 0.75}},
      {"edge across an edge", cube, octahedron(), {1.0, 1.0, 0.0}},
  };
  for (const Case& c : cases) {
    for (const double more : {0.0, 1e-9}) {
      const Pose X_AB{Quat::Identity(), (1.0 + more) * c.p_AB};
      for (const EarlyOut out : {EarlyOut::no, EarlyOut::yes}) {
        EXPECT_EQ(intersect_by_features(c.a, c.b, X_AB, out), more == 0.0) << c.name;
        EXPECT_EQ(intersect_by_features(c.b, c.a, X_AB.inverse(), out), more == 0.0) << c.name;
      }
    }
  }
}

// An edge that starts in the plane of a face, beside the face, and rises over it is outside.
TEST(Polyhedra, DoNotMeetByAnEdgeThatRisesFromThePlaneOfAFace) {
  const Polyhedron cube = test::box({0.5, 0.5, 0.5});
  const Polyhedron over(
      {Vec3(-1.0, 0.0, 0.5), Vec3(1.0, 0.0, 1.0), Vec3(0.0, 0.25, 2.0), Vec3(0.0, -0.25, 2.0)},
      {{0, 2, 1}, {1, 3, 0}, {0, 3, 2}, {2, 3, 1}});
  for (const EarlyOut out : {EarlyOut::no, EarlyOut::yes}) {
    EXPECT_FALSE(intersect_by_features(cube, over, {}, out));
    EXPECT_FALSE(intersect_by_features(over, cube, {}, out));
  }
}

}  // namespace
}  // namespace headpin::engine
