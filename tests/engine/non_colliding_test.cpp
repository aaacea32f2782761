#include "engine/non_colliding.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "engine/kept_plane.h"
#include "tests/engine/shape_pairs.h"
#include "tests/support/pair_campaign.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::degrees_between;
using test::depth_along;
using test::hard_cases;
using test::HardCase;
using test::kShapeKinds;
using test::kThin;
using test::mirrored;
using test::percentile;
using test::Pool;
using test::query;
using test::scaled;
using test::Shallow;
using test::shallow;
using test::ShapeKind;

/// Turns B so that its normal `m` faces A's normal `n`, by any angle about it.
Quat facing(Random& random, const Vec3& n, const Vec3& m) {
  return rotation(random.uniform(0.0, 6.0) * n) * Quat::FromTwoVectors(m, -n);
}

TEST(TwoSpheres, AreAsFarApartAsTheirCentresLessTheirRadii) {
  for (const double gap : {0.5, 1e-3, 1e-9, -1e-9, -1e-3, -0.2}) {
    const Vec3 line = Vec3(1.0, 2.0, -0.5).normalized();
    const Closest c = query(Ellipsoid{{0.3, 0.3, 0.3}}, Ellipsoid{{0.2, 0.2, 0.2}},
                            {Quat::Identity(), (0.5 + gap) * line});
    EXPECT_EQ(c.separated, gap > 0.0);
    EXPECT_NEAR(c.distance, gap, 1e-12);
    EXPECT_LT((c.n_AB - line).norm(), 1e-9);
    EXPECT_LT((c.p_A - 0.3 * line).norm(), 1e-9);
    EXPECT_LT((c.p_B - (0.3 + gap) * line).norm(), 1e-9);
  }
}

// A plane that proves two shapes apart has all of A behind it and all of B before it.
TEST(Certificate, HoldsForEverySampledSurfacePoint) {
  Pool pool(40);
  int separated = 0;
  for (int i = 0; i < 600 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const Pose X_AB{any_rotation(pool.random),
                    pool.random.uniform(0.5, 1.5) * direction(pool.random)};
    const Closest c = query(a, b, X_AB);
    if (!c.separated) continue;
    ++separated;
    EXPECT_NEAR(c.n_AB.norm(), 1.0, 1e-12);
    EXPECT_NEAR(c.n_AB.dot(c.p_B - c.p_A), c.distance, 1e-12);
    const double plane_a = c.n_AB.dot(c.p_A), plane_b = c.n_AB.dot(c.p_B);
    ASSERT_LT(plane_a, plane_b);
    for (int k = 0; k < 10000; ++k) {
      const Vec3 d = direction(pool.random);
      ASSERT_LE(c.n_AB.dot(support(a, d)), plane_a + 1e-12) << kind(a) << " " << kind(b);
      ASSERT_GE(c.n_AB.dot(X_AB * support(b, d)), plane_b - 1e-12) << kind(a) << " " << kind(b);
    }
  }
  EXPECT_GT(separated, 200 / kThin);
}

// Pairs set at a known gap along a known normal, on faces, sides, rims and anywhere: a million of
// them, with gaps from 1e-6 to 0.1, and every one is told apart, with a plane that proves it.
TEST(PhantomContact, NeverHappensInAMillionPairs) {
  Pool pool(41);
  int wrong = 0, false_proofs = 0, capped = 0;
  for (int i = 0; i < 1000000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const Vec3 n =
        index_below(pool.random, 3) ? test::special_normal(pool.random, a) : direction(pool.random);
    const Vec3 m =
        index_below(pool.random, 3) ? test::special_normal(pool.random, b) : direction(pool.random);
    const Quat q = facing(pool.random, n, m);
    const double gap = std::pow(10.0, pool.random.uniform(-6.0, -1.0));
    const Vec3 aside = (0.1 * direction(pool.random)).cross(n);  // off centre, along the plane
    const Pose X_AB{q, support(a, n) - q * support(b, m) + gap * n + aside};
    const Closest c = query(a, b, X_AB);
    wrong += !c.separated;
    false_proofs += c.separated && depth_along(a, b, X_AB, c.n_AB) > 1e-15;
    capped += c.capped;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(false_proofs, 0);
  std::printf("capped and answered by the fallback: %d\n", capped);
}

// Part of `./dev check pairs`: what the header promises, for every two kinds of shapes.
TEST(Promise, HoldsForEveryTwoKindsOfShapes) {
  for (const test::Form a : test::kForms) {
    for (const test::Form b : test::kForms) {
      if (b < a) continue;
      const test::Tally t = test::try_pairs(a, b, 600 / std::min(kThin, 10), 61);
      EXPECT_EQ(t.faults(), 0) << test::name(a) << " " << test::name(b) << ", worst " << t.worst
                               << "\n  " << t.example;
    }
  }
}

// Turned upside down about a horizontal axis, the axis of the quaternion is unit only to rounding;
// looked at along itself, nothing is left of it across.
TEST(PhantomContact, NeverHappensUpsideDown) {
  for (int degree = 0; degree < 360; ++degree) {
    const SinCos yaw = sin_cos(degree * 0.0174532925199432958);
    const Pose X_AB{Quat(0.0, yaw.cos, yaw.sin, 0.0), {0.0, 0.0, 1.51}};
    for (const Shape& a :
         {Shape(Cylinder{1.0, 0.5}), Shape(Cone{1.0, 1.0}), Shape(test::box({1, 1, 0.5}))}) {
      for (const Shape& b : {Shape(Cylinder{0.7, 1.0}), Shape(Cone{0.7, 2.0})}) {
        const Closest c = query(a, b, X_AB, {.margin = 0.1});
        EXPECT_TRUE(c.separated) << degree << " degrees: " << kind(a) << " " << kind(b);
        EXPECT_NEAR(c.distance, 0.01, 1e-9) << degree << " degrees: " << kind(a) << " " << kind(b);
      }
    }
  }
}

// A search that runs out of its evaluations leaves the next one all of its own.
TEST(WarmStart, PastItsCapIsHarmless) {
  Pool pool(62);
  for (int i = 0; i < 4000 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    if (i % 2) p.X_AB.p *= 1.0 + 0.06 / p.X_AB.p.norm();
    const Closest cold = query(p.a, p.b, p.X_AB);
    for (const int cap : {1, 2, 3, 5}) {
      KeptNormal n{direction(pool.random), KeptNormal::met};
      const Closest c = closest_points(p.a, p.b, p.X_AB, n, {.cap = cap});
      EXPECT_EQ(c.separated, cold.separated) << kind(p.a) << " " << kind(p.b);
      if (!c.separated) {
        EXPECT_NEAR(c.distance, cold.distance, -0.01 * cold.distance);
      }
    }
  }
}

TEST(PhantomContact, NeverHappensInTheHardCases) {
  Random random(42);
  for (const HardCase& c : hard_cases()) {
    for (int i = 0; i < 300; ++i) {
      const double gap = std::pow(10.0, random.uniform(-5.9, -1.0));
      const Pose X_AB{c.X_AB.q, c.X_AB.p + gap * c.n};
      // The question is asked in a frame that is turned about, so that rounding takes part.
      const Pose X_WA{any_rotation(random), direction(random)};
      const Closest answer = query(c.a, c.b, relative(X_WA, X_WA * X_AB));
      EXPECT_TRUE(answer.separated) << c.name << " at a gap of " << gap;
      const Pose X_in{c.X_AB.q, c.X_AB.p - gap * 0.1 * c.n};
      const Closest meets = query(c.a, c.b, relative(X_WA, X_WA * X_in));
      EXPECT_FALSE(meets.separated) << c.name << " at a depth of " << 0.1 * gap;
      EXPECT_NEAR(meets.distance, -0.1 * gap * c.least, 1e-9) << c.name;
      EXPECT_NEAR(meets.n_AB.dot(c.n), c.least, c.least < 1.0 ? 1e-3 : 5e-7)
          << c.name << " at a depth of " << 0.1 * gap;
    }
  }
}

struct Change {
  double depth, degrees;
};

/// Largest differences, of 99 in 100 pairs, between an answer and its image.
template <typename F>
Change changes(std::uint64_t seed, F&& image) {
  Pool pool(seed);
  std::vector<double> depth, degrees;
  for (int i = 0; i < 800 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    const Closest c = query(p.a, p.b, p.X_AB, {.margin = 0.2});
    const Closest d = image(pool.random, p);
    EXPECT_EQ(c.separated, d.separated);
    depth.push_back(std::abs(c.distance - d.distance));
    degrees.push_back(degrees_between(c.n_AB, d.n_AB));
  }
  return {percentile(depth, 0.98), percentile(degrees, 0.98)};
}

// Where two directions are equally deep, either may be the answer; hence the 98th percentile.
TEST(Symmetry, SwappingTheShapesTurnsTheNormal) {
  const Change d = changes(50, [](Random&, const Shallow& p) {
    const Pose X_BA = p.X_AB.inverse();
    Closest c = query(p.b, p.a, X_BA, {.margin = 0.2});
    c.n_AB = p.X_AB.q * -c.n_AB;
    return c;
  });
  EXPECT_LT(d.depth, 1e-6);
  EXPECT_LT(d.degrees, 0.3);
}

TEST(Symmetry, AMirroredPairHasTheMirroredAnswer) {
  const Change d = changes(51, [](Random&, const Shallow& p) {
    const Pose X{Quat(p.X_AB.q.w(), p.X_AB.q.x(), -p.X_AB.q.y(), -p.X_AB.q.z()),
                 {-p.X_AB.p.x(), p.X_AB.p.y(), p.X_AB.p.z()}};
    Closest c = query(mirrored(p.a), mirrored(p.b), X, {.margin = 0.2});
    c.n_AB.x() = -c.n_AB.x();
    return c;
  });
  EXPECT_LT(d.depth, 1e-6);
  EXPECT_LT(d.degrees, 0.3);
}

TEST(Symmetry, AScaledPairIsAsMuchDeeper) {
  for (const double k : {1e-3, 0.1, 30.0, 1e3}) {
    const Change d = changes(52, [k](Random&, const Shallow& p) {
      Closest c =
          query(scaled(p.a, k), scaled(p.b, k), {p.X_AB.q, k * p.X_AB.p}, {.margin = 0.2 * k});
      c.distance /= k;
      return c;
    });
    EXPECT_LT(d.depth, 1e-6) << k;
    EXPECT_LT(d.degrees, 0.3) << k;
  }
}

// Turning both bodies about turns the answer: the pair's own frame does not know of it.
TEST(Symmetry, MovingBothBodiesMovesTheAnswer) {
  const Change d = changes(53, [](Random& random, const Shallow& p) {
    const Pose X_WA{any_rotation(random), direction(random)};
    return query(p.a, p.b, relative(X_WA, X_WA * p.X_AB), {.margin = 0.2});
  });
  EXPECT_LT(d.depth, 1e-6);
  EXPECT_LT(d.degrees, 0.3);
}

// A body that drifts, asked with the last normal and without: one verdict, fewer evaluations.
TEST(WarmStart, GivesTheColdVerdictInFewerEvaluations) {
  Pool pool(54);
  long warm_total = 0, cold_total = 0;
  for (int i = 0; i < 400 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    KeptNormal n;
    const Vec3 turn = 3e-3 * direction(pool.random), shift = 2e-3 * direction(pool.random);
    for (int f = 0; f < 40; ++f) {
      const Pose X{(rotation(f * turn) * p.X_AB.q).normalized(), p.X_AB.p + f * shift};
      const Closest warm = closest_points(p.a, p.b, X, n, {});
      const Closest cold = query(p.a, p.b, X);
      EXPECT_EQ(warm.separated, cold.separated);
      if (f > 0) {
        warm_total += warm.iterations;
        cold_total += cold.iterations;
      }
    }
  }
  EXPECT_LT(warm_total, 0.75 * static_cast<double>(cold_total));
}

TEST(WarmStart, WithAStaleOppositeOrMeaninglessNormalIsHarmless) {
  Pool pool(55);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4000 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    if (i % 2) p.X_AB.p *= 1.0 + 0.06 / p.X_AB.p.norm();
    const Closest cold = query(p.a, p.b, p.X_AB);
    for (const Vec3& n : {Vec3(-cold.n_AB), direction(pool.random), Vec3(nan, 0, 1),
                          Vec3(inf, 0, 0), Vec3(1e-300, 0, 0), Vec3(5, 5, 5)}) {
      for (const KeptNormal::Of of : {KeptNormal::none, KeptNormal::apart, KeptNormal::met}) {
        KeptNormal kept{n, of};
        const Closest c = closest_points(p.a, p.b, p.X_AB, kept, {});
        EXPECT_EQ(c.separated, cold.separated) << kind(p.a) << " " << kind(p.b);
        EXPECT_TRUE(std::isfinite(c.distance));
        EXPECT_EQ(kept.of, c.separated ? KeptNormal::apart : KeptNormal::met);
        EXPECT_LT((kept.n_AB - c.n_AB).norm(), 1e-9);
      }
    }
  }
}

// A plane that still separates says what closest_points would, and one that does not says nothing.
TEST(AKeptPlane, ProvesOnlyWhatIsSo) {
  Pool pool(64);
  int proven = 0, apart = 0;
  for (int i = 0; i < 20000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const double margin = index_below(pool.random, 2) * pool.random.uniform(0.0, 0.1);
    const Pose X_AB{any_rotation(pool.random),
                    pool.random.uniform(0.5, 1.5) * direction(pool.random)};
    KeptNormal n;
    closest_points(a, b, X_AB, n, {.margin = margin});
    const Pose X_now{rotation(0.02 * direction(pool.random)) * X_AB.q,
                     X_AB.p + 0.02 * direction(pool.random)};
    const Pose X_WA{any_rotation(pool.random), direction(pool.random)}, X_WB = X_WA * X_now;
    const bool still = still_apart(a, X_WA, b, X_WB, n, margin);
    EXPECT_EQ(still_apart(a, b, X_now.q.toRotationMatrix(), X_now.p, n, margin), still);
    const Closest now = query(a, b, relative(X_WA, X_WB), {.margin = margin});
    apart += now.distance > margin;
    proven += still;
    if (still) {
      EXPECT_GT(now.distance, margin) << kind(a) << " " << kind(b);
      EXPECT_LT(depth_along(a, b, X_now, n.n_AB), -margin + 1e-12);
    }
  }
  EXPECT_GT(proven, apart / 2);
  const Pose X_WB{Quat::Identity(), {9, 0, 0}};
  const auto along_x = [](KeptNormal::Of of) { return KeptNormal{Vec3::UnitX(), of}; };
  EXPECT_TRUE(still_apart(Cylinder{}, {}, Cylinder{}, X_WB, along_x(KeptNormal::apart)));
  EXPECT_FALSE(still_apart(Cylinder{}, {}, Cylinder{}, X_WB, along_x(KeptNormal::met)));
  EXPECT_FALSE(still_apart(Cylinder{}, {}, Cylinder{}, X_WB, along_x(KeptNormal::none)));
  EXPECT_FALSE(still_apart(Cylinder{}, {}, HalfSpace{}, {}, {Vec3::UnitZ(), KeptNormal::apart}));
}

// A pair within the margin gets its true gap, not the first proof of one.
TEST(Margin, GivesNearPairsTheirClosestPoints) {
  Pool pool(56);
  std::vector<double> excess;
  for (int i = 0; i < 4000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const Vec3 n =
        index_below(pool.random, 2) ? test::special_normal(pool.random, a) : direction(pool.random);
    const Vec3 m =
        index_below(pool.random, 2) ? test::special_normal(pool.random, b) : direction(pool.random);
    const Quat q = facing(pool.random, n, m);
    const double gap = pool.random.uniform(1e-3, 0.09);
    const Pose X_AB{q, support(a, n) - q * support(b, m) + gap * n};
    const Closest c = query(a, b, X_AB, {.margin = 0.1});
    ASSERT_TRUE(c.separated);
    excess.push_back(std::abs(c.distance - gap));
    EXPECT_LT((c.p_B - c.p_A - c.distance * c.n_AB).norm(), 1e-2)
        << kind(a) << " " << kind(b) << " gap " << gap << " found " << c.distance << " after "
        << c.iterations;
  }
  EXPECT_LT(percentile(excess, 0.99), 1e-6);
}

// Far inside each other, centre on centre, axis on axis: they meet, and every number is finite.
// Which way is out is then a matter of taste, and how deep a local minimum.
TEST(DeepOverlap, HasTheRightVerdictAndFiniteNumbers) {
  Pool pool(57);
  for (int i = 0; i < 4000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const double off = i % 5 == 0 ? 0.0 : pool.random.uniform(0.0, 0.3);
    const Pose X_AB{i % 3 ? any_rotation(pool.random) : Quat::Identity(),
                    off * direction(pool.random)};
    const Closest c = query(a, b, X_AB);
    EXPECT_FALSE(c.separated) << kind(a) << " " << kind(b);
    EXPECT_TRUE(std::isfinite(c.distance) && c.p_A.allFinite() && c.p_B.allFinite());
    EXPECT_NEAR(c.n_AB.norm(), 1.0, 1e-9);
    EXPECT_GT(-c.distance, 0.0);
    EXPECT_LT(-c.distance, 2.0);
  }
}

TEST(AHalfSpace, IsMetByWhateverReachesBelowIt) {
  Random random(58);
  for (const ShapeKind k : kShapeKinds) {
    for (int i = 0; i < 100; ++i) {
      const Shape shape = random_shape(random, k);
      const Pose X_AB{any_rotation(random), {0.3, 0.1, random.uniform(0.0, 1.0)}};
      const Vec3 p = X_AB * support(shape, X_AB.q.conjugate() * -Vec3::UnitZ());
      const Closest c = query(HalfSpace{}, shape, X_AB);
      EXPECT_EQ(c.separated, p.z() > 0.0);
      EXPECT_NEAR(c.distance, p.z(), 1e-12);
      const Closest d = query(shape, HalfSpace{}, X_AB.inverse());
      EXPECT_EQ(d.separated, c.separated);
      EXPECT_NEAR(d.distance, c.distance, 1e-12);
      EXPECT_LT((X_AB.q * d.n_AB + Vec3::UnitZ()).norm(), 1e-12);
    }
  }
  EXPECT_THROW(query(HalfSpace{}, HalfSpace{}, {}), std::invalid_argument);
}

// A floor is met in closed form, whichever of the two it is, so no cap is ever reached.
TEST(ClosestPoints, OfAFloorAreNeverCapped) {
  const Shape floor = HalfSpace{}, ball = Ellipsoid{{0.1, 0.2, 0.3}};
  KeptNormal kept;
  Query query;
  query.mode = Query::Mode::paper;
  query.cap = 5;
  const Pose up{Quat::Identity(), {0, 0, 0.25}}, down{Quat::Identity(), {0, 0, -0.25}};
  EXPECT_FALSE(closest_points(floor, ball, up, kept, query).capped);
  EXPECT_FALSE(closest_points(ball, floor, down, kept, query).capped);
  EXPECT_NEAR(closest_points(floor, ball, up, kept, query).distance, -0.05, 1e-12);
  EXPECT_NEAR(closest_points(ball, floor, down, kept, query).distance, -0.05, 1e-12);
}

}  // namespace
}  // namespace headpin::engine
