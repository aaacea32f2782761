#include "engine/contacts.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::kShapeKinds;
using test::ShapeKind;

std::vector<ContactPoint> contacts(const Shape& a, const Pose& X_WA, const Shape& b,
                                   const Pose& X_WB, double margin = 0.0) {
  KeptNormal n;
  QueryCounts counts;
  std::vector<ContactPoint> out;
  const int count = find_contacts(a, X_WA, b, X_WB, margin, n, {}, counts, out);
  EXPECT_EQ(static_cast<std::size_t>(count), out.size());
  return out;
}

// The deepest point of a body in the floor is as deep as its lowest point is low.
TEST(OnAHalfSpace, TheDeepestContactIsTheLowestPoint) {
  Random random(11);
  for (const ShapeKind k : kShapeKinds) {
    for (int i = 0; i < 200; ++i) {
      const Shape shape = random_shape(random, k);
      const Pose X_WB{any_rotation(random), {0.0, 0.0, 0.2}};
      const Pose X_WA{any_rotation(random), random.uniform(-0.3, 0.3) * direction(random)};
      const Vec3 up = X_WA.q * Vec3::UnitZ();
      const Vec3 lowest = X_WB * support(shape, X_WB.q.conjugate() * -up);
      const double depth = (X_WA.p - lowest).dot(up);
      const std::vector<ContactPoint> points = contacts(HalfSpace{}, X_WA, shape, X_WB);
      ASSERT_EQ(points.empty(), depth < 0.0) << kind(shape);
      double deepest = -1.0;
      for (const ContactPoint& c : points) {
        deepest = std::max(deepest, c.depth);
        EXPECT_LT((c.n_AB_W - up).norm(), 1e-12);
        // Half-way between plane and body point, which is in the body.
        EXPECT_NEAR((c.p_W - X_WA.p).dot(up), -0.5 * c.depth, 1e-12);
        EXPECT_TRUE(contains(shape, X_WB.inverse() * (c.p_W - 0.5 * c.depth * up), 1e-9));
      }
      if (!points.empty()) {
        EXPECT_NEAR(deepest, depth, 1e-12) << kind(shape);
      }
    }
  }
}

// A standing body's contact points lie round its centre, so that it can stand on them.
TEST(OnAHalfSpace, AFlatBaseHasPointsRoundItsCentre) {
  for (const Shape& shape :
       {Shape(Cylinder{0.1, 0.2}), Shape(Cone{0.1, 0.4}), Shape(test::box({0.1, 0.1, 0.2}))}) {
    const auto points =
        contacts(HalfSpace{}, {}, shape, {Quat::Identity(), {0.0, 0.0, 0.2 - 1e-4}});
    ASSERT_GE(points.size(), 3u) << kind(shape);
    for (int i = 0; i < 36; ++i) {  // some point on either side of every line through the centre
      const Vec3 across(std::cos(i * 0.1745), std::sin(i * 0.1745), 0.0);
      double most = -1.0;
      for (const ContactPoint& c : points) most = std::max(most, across.dot(c.p_W));
      EXPECT_GT(most, 0.04) << kind(shape);
      EXPECT_NEAR(points[0].depth, 1e-4, 1e-12);
    }
  }
}

TEST(OnAHalfSpace, ALyingCylinderHasBothEndsOfItsLowestLine) {
  const Quat lying(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);
  const auto points =
      contacts(HalfSpace{}, {}, Cylinder{0.1, 0.2}, {lying, {0.0, 0.0, 0.1 - 1e-4}});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR((points[0].p_W - points[1].p_W).norm(), 0.4, 1e-9);
}

TEST(TheOtherWayRound, NormalsTurnAndPointsStay) {
  const Pose X_WB{Quat(0.9, 0.1, 0.2, 0.3).normalized(), {0.0, 0.1, 0.15}};
  const auto ab = contacts(HalfSpace{}, {}, Cylinder{0.1, 0.2}, X_WB, 0.1);
  const auto ba = contacts(Cylinder{0.1, 0.2}, X_WB, HalfSpace{}, {}, 0.1);
  ASSERT_EQ(ab.size(), ba.size());
  for (std::size_t i = 0; i < ab.size(); ++i) {
    EXPECT_EQ(ab[i].p_W, ba[i].p_W);
    EXPECT_EQ(ab[i].n_AB_W, Vec3(-ba[i].n_AB_W));
  }
}

// Whether some point lies on either side of every line through the centre, at least `arm` away.
bool stands(const std::vector<ContactPoint>& points, const Vec3& centre, const Vec3& up,
            double arm) {
  for (int i = 0; i < 36; ++i) {
    const Vec3 u = up.unitOrthogonal(), v = up.cross(u);
    const Vec3 across = std::cos(i * 0.1745) * u + std::sin(i * 0.1745) * v;
    double most = -1.0;
    for (const ContactPoint& c : points) most = std::max(most, across.dot(c.p_W - centre));
    if (most < arm) return false;
  }
  return true;
}

// Flat on flat in any pose: the points lie on both surfaces, as deep as the overlap, round the
// middle.
TEST(FlatOnFlat, HasPointsToStandOn) {
  Random random(12);
  const Shape bases[] = {Cylinder{0.1, 0.2}, Cone{0.1, 0.4}, test::box({0.1, 0.1, 0.2})};
  const Shape tables[] = {Cylinder{0.3, 0.1}, test::box({0.3, 0.4, 0.1}), Cylinder{0.08, 0.1}};
  for (const Shape& base : bases) {
    for (const Shape& table : tables) {
      for (int i = 0; i < 20; ++i) {
        const Pose X_WA{any_rotation(random), 2.0 * direction(random)};
        const double depth = 1e-3 * random.uniform(0.1, 1.0);
        const Pose X_WB =
            X_WA * Pose{rotation({0, 0, random.uniform(0, 6)}), {0.0, 0.0, 0.3 - depth}};
        const auto points = contacts(table, X_WA, base, X_WB, 1e-4);
        ASSERT_GE(points.size(), 3u) << kind(base) << " on " << kind(table);
        const Vec3 up = X_WA.q * Vec3::UnitZ();
        EXPECT_TRUE(stands(points, X_WB * Vec3(0, 0, -0.2), up, 0.03));
        for (const ContactPoint& c : points) {
          EXPECT_NEAR(c.depth, depth, 1e-9);
          EXPECT_LT((c.n_AB_W - up).norm(), 1e-6);
          EXPECT_NEAR((X_WA.inverse() * c.p_W).z(), 0.1 - 0.5 * depth, 1e-9);
        }
      }
    }
  }
}

TEST(SideOnSide, HasBothEndsOfWhatTheyShare) {
  Random random(13);
  for (int i = 0; i < 50; ++i) {
    const Pose X_WA{any_rotation(random), direction(random)};
    const Pose X_WB = X_WA * Pose{rotation({0, 0, random.uniform(0, 6)}), {0.199, 0.0, 0.1}};
    const auto points = contacts(Cylinder{0.1, 0.3}, X_WA, Cylinder{0.1, 0.3}, X_WB, 1e-4);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_NEAR((points[0].p_W - points[1].p_W).norm(), 0.5, 1e-6);
    EXPECT_NEAR(points[0].depth, 1e-3, 1e-9);
    EXPECT_NEAR(points[1].depth, 1e-3, 1e-9);
  }
}

// A cone lying on its side on a cylinder's flank, along it: two points of the shared line.
TEST(SideOnSide, WorksForConesToo) {
  const Cone cone{0.1, 0.3};
  const double slant = std::sqrt(0.1), sine = 0.1 / slant, cosine = 0.3 / slant;
  // Turn the cone so that its generator in the direction -x becomes parallel to z.
  const Vec3 inwards(cosine, 0.0, -sine);  // minus the outward normal of the generator at -x
  const Quat q = Quat::FromTwoVectors(inwards, Vec3::UnitX());
  const Vec3 middle = q * Vec3(-0.05, 0.0, 0.0);  // of the generator
  const Pose X_AB{q, Vec3(0.2 - 1e-3, 0.0, 0.0) - middle};
  const auto points = contacts(Cylinder{0.2, 0.5}, {}, cone, X_AB, 1e-4);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR((points[0].p_W - points[1].p_W).norm(), slant, 1e-6);
  EXPECT_NEAR(points[0].depth, 1e-3, 1e-8);
}

// A cone as flat as a dish, met exactly along its axis, is met at its tip.
TEST(TipOfADish, IsMetAtItself) {
  const Cone dish{0.3, 0.02};
  const Shape bases[] = {Cylinder{0.1, 0.1}, test::box({0.1, 0.1, 0.1}), dish};
  for (const Shape& base : bases) {
    const bool cone = std::holds_alternative<Cone>(base);
    const Pose X_AB{cone ? Quat(0.0, 1.0, 0.0, 0.0) : Quat::Identity(),
                    {0.0, 0.0, 0.01 + (cone ? 0.01 : 0.1) - 1e-4}};
    for (const auto& points :
         {contacts(dish, {}, base, X_AB, 1e-4), contacts(base, X_AB, dish, {}, 1e-4)}) {
      ASSERT_GE(points.size(), 1u);
      for (const ContactPoint& point : points) {
        ASSERT_TRUE(point.p_W.allFinite()) << kind(base);
        EXPECT_LT((point.p_W - Vec3(0.0, 0.0, 0.01)).norm(), 1e-3) << kind(base);
        EXPECT_NEAR(point.depth, 1e-4, 1e-6);
      }
    }
  }
}

// Round things touch in one point.
TEST(RoundOnAnything, HasOnePoint) {
  const auto points = contacts(Ellipsoid{{0.1, 0.1, 0.1}}, {}, Cylinder{0.1, 0.3},
                               {Quat::Identity(), {0.199, 0.0, 0.0}});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].depth, 1e-3, 1e-9);
  EXPECT_LT((points[0].p_W - Vec3(0.0995, 0.0, 0.0)).norm(), 1e-9);
}

// A round body that stands upright is the same body at every yaw.
TEST(ARoundBody, StandsOnTheSamePointsAtEveryYaw) {
  for (const Shape& shape : {Shape(Cylinder{0.03, 0.1}), Shape(Cone{0.03, 0.2})}) {
    for (const double lean : {0.0, 1e-5, 0.02}) {
      std::vector<ContactPoint> first;
      for (int k = 0; k < 12; ++k) {
        std::vector<ContactPoint> points;
        QueryCounts counts;
        KeptNormal n;
        const Pose X_WB{rotation(Vec3(lean, 0.0, 0.0)) * rotation(Vec3(0.0, 0.0, 0.5 * k)),
                        {0.2, 0.3, 0.1}};
        find_contacts(HalfSpace{}, {}, shape, X_WB, 1e-3, n, {}, counts, points);
        if (k == 0) first = points;
        ASSERT_EQ(points.size(), first.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
          EXPECT_LT((points[i].p_W - first[i].p_W).norm(), 1e-9) << kind(shape) << " " << 0.5 * k;
        }
      }
    }
  }
}

// A search adds to what others found, and counts its own points alone.
TEST(FindContacts, CountsThePointsThatItAdds) {
  const Shape ball = Ellipsoid{Vec3::Constant(0.1)};
  const Pose low{Quat::Identity(), {0, 0, 0.09}};
  KeptNormal n;
  QueryCounts counts;
  std::vector<ContactPoint> out(3);
  EXPECT_EQ(find_contacts(HalfSpace{}, {}, ball, low, 0.0, n, {}, counts, out), 1);
  EXPECT_EQ(find_contacts(ball, low, HalfSpace{}, {}, 0.0, n, {}, counts, out), 1);
  const Compound floor = make_compound({{HalfSpace{}, {}}}), body = make_compound({{ball, {}}});
  EXPECT_EQ(find_contacts(floor, {}, body, low, 0.0, {}, {}, counts, out), 1);
  EXPECT_EQ(find_contacts(body, low, floor, {}, 0.0, {}, {}, counts, out), 1);
  EXPECT_EQ(out.size(), 7u);
}

// A search that knows the last normals finds what one without them finds, also of parts that are
// turned in their body.
TEST(FindContacts, OfTurnedPartsFindTheSameFromTheLastNormals) {
  Random random(21);
  const Compound ball = make_compound({{Ellipsoid{Vec3::Constant(0.1)}, {}}});
  const Quat lying(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);
  const Compound log = make_compound({{Cylinder{0.05, 0.5}, {lying, {0.0, 0.0, 0.0}}}});
  for (const bool turned_first : {true, false}) {
    const Compound &a = turned_first ? log : ball, &b = turned_first ? ball : log;
    std::vector<KeptNormal> kept(kept_normals(a, b));
    int met = 0;
    for (int i = 0; i <= 200; ++i) {  // over the log, from end to end, and into it
      const Pose X_WB{Quat::Identity(), {0.0, 0.009 * (i - 100), 0.145 + 0.02 * std::sin(0.2 * i)}};
      std::vector<KeptNormal> none(kept_normals(a, b));
      std::vector<ContactPoint> warm, cold;
      QueryCounts counts;
      const int found = find_contacts(a, {}, b, X_WB, 0.0, kept, {}, counts, warm);
      ASSERT_EQ(found, find_contacts(a, {}, b, X_WB, 0.0, none, {}, counts, cold)) << i;
      if (found == 0) continue;
      ++met;
      EXPECT_NEAR(warm[0].depth, cold[0].depth, 1e-9) << i;
    }
    EXPECT_GT(met, 30);
    EXPECT_LT(met, 170);
  }
}

}  // namespace
}  // namespace headpin::engine
