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

}  // namespace
}  // namespace headpin::engine
