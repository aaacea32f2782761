#include "engine/non_colliding.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <ccd/ccd.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "engine/kept_plane.h"
#include "tests/support/fcl_shapes.h"
#include "tests/support/pair_campaign.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::kShapeKinds;
using test::mirrored;
using test::Random;
using test::scaled;
using test::ShapeKind;

#ifdef HEADPIN_SANITIZED
constexpr int kThin = 50;  // long properties in a fiftieth of the pairs
#else
constexpr int kThin = 1;
#endif

Closest query(const Shape& a, const Shape& b, const Pose& X_AB, const Query& q = {}) {
  KeptNormal kept;
  return closest_points(a, b, X_AB, kept, q);
}

/// Depth of the pair along n, straight from the definition: negative is a gap.
double depth_along(const Shape& a, const Shape& b, const Pose& X_AB, const Vec3& n) {
  return n.dot(support(a, n) - X_AB * support(b, X_AB.q.conjugate() * -n));
}

/// A few of each kind: making a hull takes longer than asking a thousand questions of it.
struct Pool {
  explicit Pool(std::uint64_t seed) : random(seed) {
    for (const ShapeKind k : kShapeKinds) {
      for (int i = 0; i < 25; ++i) shapes[static_cast<int>(k)].push_back(random_shape(random, k));
    }
  }
  const Shape& pick(int kind) {
    const auto& of_kind = shapes[kind];
    return of_kind[static_cast<std::size_t>(random.index(static_cast<int>(of_kind.size())))];
  }
  Random random;
  std::vector<Shape> shapes[4];
};

/// Distance at which two shapes touch when the second moves in along a line.
double touching_distance(const Shape& a, const Shape& b, const Quat& q, const Vec3& along) {
  double meets = 0.0, apart = 4.0;
  for (int k = 0; k < 55; ++k) {
    const double middle = 0.5 * (meets + apart);
    (query(a, b, {q, middle * along}).separated ? apart : meets) = middle;
  }
  return apart;
}

/// A pair that overlaps by 0.005 to 0.05 of its size along a random line.
struct Shallow {
  Shape a, b;
  Pose X_AB;
};

Shallow shallow(Pool& pool, int ka, int kb) {
  const Shape &a = pool.pick(ka), &b = pool.pick(kb);
  const Quat q = pool.random.rotation();
  const Vec3 along = pool.random.direction();
  const double t = touching_distance(a, b, q, along);
  return {a, b, {q, (t - pool.random.uniform(0.005, 0.05)) * along}};
}

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
    const Pose X_AB{pool.random.rotation(),
                    pool.random.uniform(0.5, 1.5) * pool.random.direction()};
    const Closest c = query(a, b, X_AB);
    if (!c.separated) continue;
    ++separated;
    EXPECT_NEAR(c.n_AB.norm(), 1.0, 1e-12);
    EXPECT_NEAR(c.n_AB.dot(c.p_B - c.p_A), c.distance, 1e-12);
    const double plane_a = c.n_AB.dot(c.p_A), plane_b = c.n_AB.dot(c.p_B);
    ASSERT_LT(plane_a, plane_b);
    for (int k = 0; k < 10000; ++k) {
      const Vec3 d = pool.random.direction();
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
        pool.random.index(3) ? test::special_normal(pool.random, a) : pool.random.direction();
    const Vec3 m =
        pool.random.index(3) ? test::special_normal(pool.random, b) : pool.random.direction();
    const Quat q = facing(pool.random, n, m);
    const double gap = std::pow(10.0, pool.random.uniform(-6.0, -1.0));
    const Vec3 aside = (0.1 * pool.random.direction()).cross(n);  // off centre, along the plane
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
      KeptNormal n{pool.random.direction(), KeptNormal::met};
      const Closest c = closest_points(p.a, p.b, p.X_AB, n, {.cap = cap});
      EXPECT_EQ(c.separated, cold.separated) << kind(p.a) << " " << kind(p.b);
      if (!c.separated) {
        EXPECT_NEAR(c.distance, cold.distance, -0.01 * cold.distance);
      }
    }
  }
}

/// Rows of hard cases, each at a gap, in a random pose.
struct HardCase {
  const char* name;
  Shape a, b;
  Pose X_AB;  // at gap zero
  Vec3 n = Vec3::UnitZ();
  double least = 1.0;  // least way out of an overlap, over the overlap along n
};

std::vector<HardCase> hard_cases() {
  const Quat I = Quat::Identity();
  const Quat upside_down(0.0, 1.0, 0.0, 0.0);
  return {
      {"coaxial cylinders, flat on flat", Cylinder{0.5, 0.5}, Cylinder{0.3, 0.4}, {I, {0, 0, 0.9}}},
      {"cylinders flat on flat, off centre",
       Cylinder{0.5, 0.5},
       Cylinder{0.3, 0.4},
       {I, {0.3, 0.1, 0.9}}},
      {"parallel cylinders, side by side",
       Cylinder{0.5, 0.5},
       Cylinder{0.3, 0.4},
       {I, {0.8, 0, 0.1}},
       Vec3::UnitX()},
      {"cone base on cap", Cylinder{0.5, 0.5}, Cone{0.4, 0.8}, {I, {0.1, 0.2, 0.9}}},
      {"apex on cap", Cylinder{0.5, 0.5}, Cone{0.4, 0.8}, {upside_down, {0.1, 0.2, 0.9}}},
      {"disc 1:100 against ellipsoid",
       Cylinder{1.0, 0.005},
       Ellipsoid{{0.3, 0.4, 0.5}},
       {I, {0.4, -0.3, 0.505}}},
      {"slab of radius 20 and ball of 0.1",
       Cylinder{20.0, 0.5},
       Ellipsoid{{0.1, 0.1, 0.1}},
       {I, {11.0, 7.0, 0.6}}},
      {"box on box", test::box({0.5, 0.4, 0.3}), test::box({0.3, 0.3, 0.2}), {I, {0.1, 0.1, 0.5}}},
      {"apex to apex",  // the way out is across the slant
       Cone{0.4, 0.8},
       Cone{0.4, 0.8},
       {upside_down, {0, 0, 0.8}},
       Vec3::UnitZ(),
       0.4 / std::sqrt(0.4 * 0.4 + 0.8 * 0.8)},
  };
}

TEST(PhantomContact, NeverHappensInTheHardCases) {
  Random random(42);
  for (const HardCase& c : hard_cases()) {
    for (int i = 0; i < 300; ++i) {
      const double gap = std::pow(10.0, random.uniform(-5.9, -1.0));
      const Pose X_AB{c.X_AB.q, c.X_AB.p + gap * c.n};
      // The question is asked in a frame that is turned about, so that rounding takes part.
      const Pose X_WA{random.rotation(), random.direction()};
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

// The paper's cap: how often a pair that is apart is called a contact. The rate must rise at cap 5,
// or the cap is not honoured. The table is what a user of the paper mode should know.
TEST(PaperMode, CallsMoreOfWhatIsApartAContactTheLowerItsCap) {
  constexpr int kCaps[] = {5, 10, 20};
  Pool pool(43);
  int phantom[3] = {0, 0, 0}, pairs = 0;
  for (int i = 0; i < 20000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 3), &b = pool.pick(i / 3 % 3);
    const Quat q = pool.random.rotation();
    const Vec3 along = pool.random.direction();
    const double t = touching_distance(a, b, q, along) + pool.random.uniform(0.01, 0.1);
    ++pairs;
    for (int k = 0; k < 3; ++k) {
      const Closest c = query(a, b, {q, t * along}, {Query::paper, kCaps[k]});
      phantom[k] += !c.separated;
      ASSERT_LE(c.iterations, kCaps[k]);
      if (c.capped) {
        ASSERT_EQ(c.iterations, kCaps[k]);
      }
      if (c.separated) {
        ASSERT_LT(depth_along(a, b, {q, t * along}, c.n_AB), 0.0);  // never wrong
      }
    }
  }
  std::printf("phantom contacts [%%]                      cap 5   cap 10   cap 20\n");
  std::printf("%-38s %8.2f %8.2f %8.2f\n", "random pairs, gap 0.01 to 0.1",
              100.0 * phantom[0] / pairs, 100.0 * phantom[1] / pairs, 100.0 * phantom[2] / pairs);
  EXPECT_GT(phantom[0], phantom[1]);
  EXPECT_GE(phantom[1], phantom[2]);
  EXPECT_GT(phantom[0], pairs / 500);
  EXPECT_LT(phantom[2], pairs / 100);

  int flat[3] = {0, 0, 0};
  for (const HardCase& c : hard_cases()) {
    int count[3] = {0, 0, 0};
    constexpr int kTries = 200;
    for (int i = 0; i < kTries; ++i) {
      // Leaning a little, as nothing is quite flat in a running world.
      const Quat lean = rotation(1e-3 * pool.random.direction());
      const Pose X_AB{lean * c.X_AB.q, c.X_AB.p + 1e-3 * c.n};
      if (!query(c.a, c.b, X_AB).separated) continue;
      for (int k = 0; k < 3; ++k)
        count[k] += !query(c.a, c.b, X_AB, {Query::paper, kCaps[k]}).separated;
    }
    std::printf("%-38s %8.1f %8.1f %8.1f\n", c.name, 100.0 * count[0] / kTries,
                100.0 * count[1] / kTries, 100.0 * count[2] / kTries);
    for (int k = 0; k < 3; ++k) flat[k] += count[k];
  }
  EXPECT_GT(flat[0], flat[1]);
  EXPECT_GE(flat[1], flat[2]);
}

// 1997 began every query at the line of centres. What it then guesses of a depth is no more than
// the overlap along that line.
TEST(PaperMode, KnowsNoKeptNormalUnlessAskedTo) {
  Pool pool(63);
  int different = 0;
  for (int i = 0; i < 4000 / kThin; ++i) {
    const Shallow p = shallow(pool, i % 4, i / 4 % 4);
    const Query q{Query::paper, 5 + 5 * pool.random.index(3)};
    const Closest cold = query(p.a, p.b, p.X_AB, q);
    KeptNormal n{pool.random.direction(), KeptNormal::met}, same = n;
    const Closest kept = closest_points(p.a, p.b, p.X_AB, n, q);
    EXPECT_EQ(kept.distance, cold.distance);
    EXPECT_EQ(kept.n_AB, cold.n_AB);
    const auto centre_of = [](const Shape& s) {
      return std::visit([](const auto& shape) { return centre(shape); }, s);
    };
    const Vec3 line = p.X_AB * centre_of(p.b) - centre_of(p.a);
    EXPECT_LE(-cold.distance, depth_along(p.a, p.b, p.X_AB, line.normalized()) + 1e-12);
    different +=
        closest_points(p.a, p.b, p.X_AB, same, {.mode = q.mode, .cap = q.cap, .warm = true}).n_AB !=
        cold.n_AB;
  }
  EXPECT_GT(different, 1000 / kThin);
}

/// The least depth over the sphere, by search: many directions, then ever smaller steps from the
struct Least {
  double depth;
  Vec3 n;
};

/// best.
Least searched(Random& random, const Shallow& p, const Vec3& also) {
  double least = depth_along(p.a, p.b, p.X_AB, also);
  Vec3 best = also;
  for (int k = 0; k < 1500; ++k) {
    const Vec3 n = random.direction();
    const double d = depth_along(p.a, p.b, p.X_AB, n);
    if (d < least) {
      least = d;
      best = n;
    }
  }
  double step = 0.1;
  for (int k = 0; k < 1500; ++k) {
    const Vec3 n = (best + step * random.direction()).normalized();
    const double d = depth_along(p.a, p.b, p.X_AB, n);
    if (d < least) {
      least = d;
      best = n;
    } else {
      step = std::max(0.985 * step, 1e-10);
    }
  }
  return {least, best};
}

double percentile(std::vector<double> v, double p) {
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(p * static_cast<double>(v.size() - 1))];
}

double degrees_between(const Vec3& a, const Vec3& b) {
  return 2.0 * std::asin(std::min(1.0, 0.5 * (a - b).norm())) * 57.29577951308232;
}

/// The line of centres, from which the paper begins.
Vec3 line_of_centres(const Shape& a, const Shape& b, const Pose& X_AB) {
  const auto centre_of = [](const Shape& s) {
    return std::visit([](const auto& shape) { return centre(shape); }, s);
  };
  return (X_AB * centre_of(b) - centre_of(a)).normalized();
}

// "This iterative process is continued until the positions become the closest points": what is
// answered at the cap is near the least depth, and nearer the higher the cap. The least is found by
// a random search, which knows of no step of the method.
TEST(PaperMode, ComesNearerToTheClosestPointsTheHigherItsCap) {
  Pool pool(65);
  constexpr int kCaps[] = {5, 20};
  std::vector<double> degrees[2], over[2], degrees_of_last[2];
  for (int i = 0; i < 450; ++i) {
    const Shallow p = shallow(pool, i % 3, i / 3 % 3);
    const Least least = searched(pool.random, p, line_of_centres(p.a, p.b, p.X_AB));
    for (int k = 0; k < 2; ++k) {
      const Closest c = query(p.a, p.b, p.X_AB, {Query::paper, kCaps[k]});
      ASSERT_FALSE(c.separated);
      // Depth, normal and points are of one plane.
      ASSERT_NEAR(-c.distance, depth_along(p.a, p.b, p.X_AB, c.n_AB), 1e-12);
      ASSERT_NEAR(c.distance, c.n_AB.dot(c.p_B - c.p_A), 1e-12);
      degrees[k].push_back(degrees_between(c.n_AB, least.n));
      over[k].push_back(-c.distance / least.depth);
      const Closest last =
          query(p.a, p.b, p.X_AB, {.mode = Query::paper, .cap = kCaps[k], .last = true});
      degrees_of_last[k].push_back(degrees_between(last.n_AB, least.n));
    }
  }
  for (int k = 0; k < 2; ++k) {
    std::printf(
        "cap %2d: normal %5.1f / %5.1f deg, depth %.2f / %.2f of the least; last %5.1f deg\n",
        kCaps[k], percentile(degrees[k], 0.5), percentile(degrees[k], 0.9),
        percentile(over[k], 0.5), percentile(over[k], 0.9), percentile(degrees_of_last[k], 0.5));
  }
  EXPECT_LT(percentile(degrees[0], 0.5), 9.0);
  EXPECT_LT(percentile(degrees[1], 0.5), 2.0);
  EXPECT_LT(percentile(degrees[1], 0.9), 12.0);
  // Half of a cap of 5 seeks a proof, so that few turns are left: 1.43 and 1.64 by the pairs that two
  // compilers draw. The last plane of before was 2.0 times too deep.
  EXPECT_LT(percentile(over[0], 0.5), 1.8);
  EXPECT_LT(percentile(over[1], 0.5), 1.05);
  EXPECT_LT(percentile(over[1], 0.9), 1.7);
}

// "If at any step of iteration the scalar product has a positive value, [...] the iteration can be
// terminated immediately": at the first one too, whatever the margin.
TEST(PaperMode, EndsAtTheFirstLookThatProvesWhateverTheMargin) {
  Pool pool(66);
  int within = 0;
  for (int i = 0; i < 4000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const Pose X_AB{pool.random.rotation(),
                    pool.random.uniform(0.6, 1.6) * pool.random.direction()};
    const double gap = -depth_along(a, b, X_AB, line_of_centres(a, b, X_AB));
    if (gap <= 1e-12) continue;
    const Closest c = query(a, b, X_AB, {.mode = Query::paper, .margin = 0.1});
    EXPECT_TRUE(c.separated);
    EXPECT_EQ(c.iterations, 1) << kind(a) << " " << kind(b);
    EXPECT_NEAR(c.distance, gap, 1e-12);
    within += gap < 0.1;
  }
  EXPECT_GT(within, 200 / kThin);
}

// What trials were recorded under before: the rule restated.
TEST(PaperMode, StillAnswersFromTheLastPlaneWhereATrialDid) {
  Pool pool(67);
  for (int i = 0; i < 3000 / kThin; ++i) {
    const Shallow p = shallow(pool, i % 3, i / 3 % 3);
    const int cap = 5 + 5 * pool.random.index(2);
    Vec3 n = line_of_centres(p.a, p.b, p.X_AB);
    const auto across = [&](const Vec3& m) -> Vec3 {
      return support(p.a, m) - p.X_AB * support(p.b, p.X_AB.q.conjugate() * -m);
    };
    Vec3 S = across(n);
    double least = n.dot(S);
    int looks = 1;
    while (looks < cap && (S - n.dot(S) * n).norm() > 1e-6 * S.norm()) {
      n = (n - 1.5 * n.dot(S) / S.squaredNorm() * S).normalized();
      S = across(n);
      least = std::min(least, n.dot(S));
      ++looks;
    }
    const Closest c = query(p.a, p.b, p.X_AB, {.mode = Query::paper, .cap = cap, .last = true});
    if (!c.capped) continue;  // the points lay along the normal, to rounding
    EXPECT_LT((c.n_AB - n).norm(), 1e-6) << kind(p.a) << " " << kind(p.b);
    EXPECT_NEAR(-c.distance, least, 1e-8);
  }
}

// Depth is that of the definition along the normal given, and no direction found by search is
// shallower.
TEST(Depth, OfParametricPairsIsTheLeastOverAllDirections) {
  Pool pool(44);
  std::vector<double> excess;
  for (int i = 0; i < 1800 / kThin; ++i) {
    const Shallow p = shallow(pool, i % 3, i / 3 % 3);
    const Closest c = query(p.a, p.b, p.X_AB);
    ASSERT_FALSE(c.separated);
    ASSERT_NEAR(-c.distance, depth_along(p.a, p.b, p.X_AB, c.n_AB), 1e-12);
    // Equations (1) and (2): D is parallel to N, and both points lie on their surfaces.
    EXPECT_LT((c.p_B - c.p_A - c.distance * c.n_AB).norm(), 1e-4);
    EXPECT_TRUE(contains(p.a, c.p_A, 1e-9));
    EXPECT_TRUE(contains(p.b, p.X_AB.inverse() * c.p_B, 1e-9));
    excess.push_back(-c.distance - searched(pool.random, p, c.n_AB).depth);
  }
  EXPECT_LT(percentile(excess, 0.99), 1e-7);
}

/// Exact least depth of two polyhedra: it is along a face normal of either or across two edges.
double polyhedra_depth(const Polyhedron& a, const Polyhedron& b, const Pose& X_AB, Vec3& n_AB) {
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vec3& n) {
    const double d = n.dot(support(a, n) - X_AB * support(b, X_AB.q.conjugate() * -n));
    if (d < least) {
      least = d;
      n_AB = n;
    }
  };
  for (const Polyhedron::Face& f : a.faces()) consider(f.normal);
  for (const Polyhedron::Face& f : b.faces()) consider(X_AB.q * -f.normal);
  for (const Polyhedron::Edge& ea : a.edges()) {
    const Vec3 da = a.vertices()[ea.to] - a.vertices()[ea.from];
    for (const Polyhedron::Edge& eb : b.edges()) {
      const Vec3 n = da.cross(X_AB.q * (b.vertices()[eb.to] - b.vertices()[eb.from]));
      const double length = n.norm();
      if (length < 1e-9) continue;
      consider(n / length);
      consider(-n / length);
    }
  }
  return least;
}

TEST(Depth, OfPolyhedraIsThatOfTheirFacesAndEdges) {
  Random random(45);
  std::vector<double> depth_error, normal_error;
  std::vector<Shape> hulls;
  for (int i = 0; i < 20; ++i) hulls.push_back(test::random_hull(random, 64));
  for (int i = 0; i < 200 / kThin; ++i) {
    const Shape &a = hulls[static_cast<std::size_t>(i % 20)],
                &b = hulls[static_cast<std::size_t>((7 * i + 3) % 20)];
    const Quat q = random.rotation();
    const Vec3 along = random.direction();
    const double t = touching_distance(a, b, q, along) - random.uniform(0.005, 0.05);
    const Pose X_AB{q, t * along};
    const Closest c = query(a, b, X_AB);
    Vec3 n = Vec3::Zero();
    const double truth = polyhedra_depth(std::get<Polyhedron>(a), std::get<Polyhedron>(b), X_AB, n);
    depth_error.push_back(std::abs(-c.distance - truth));
    normal_error.push_back(degrees_between(c.n_AB, n));
    EXPECT_LT(depth_error.back(), 0.01 * truth);  // what non_colliding.h promises
  }
  // One in a hundred gets another way out that is within the promise, and is some degrees off.
  std::printf("hull against hull: depth p95 %.1e, normal p95 %.2f deg\n",
              percentile(depth_error, 0.95), percentile(normal_error, 0.95));
  EXPECT_LT(percentile(depth_error, 0.95), 1e-6);
  EXPECT_LT(percentile(normal_error, 0.95), 0.1);
}

TEST(Depth, OfPairsWithAPolyhedronIsTheLeastOverAllDirections) {
  Pool pool(46);
  std::vector<double> excess, normal_error;
  for (int i = 0; i < 600 / kThin; ++i) {
    const Shallow p = i % 2 ? shallow(pool, 3, i / 2 % 3) : shallow(pool, i / 2 % 3, 3);
    const Closest c = query(p.a, p.b, p.X_AB);
    ASSERT_FALSE(c.separated);
    EXPECT_LT((c.p_B - c.p_A - c.distance * c.n_AB).norm(), 1e-3);
    const Least least = searched(pool.random, p, c.n_AB);
    excess.push_back(-c.distance - least.depth);
    normal_error.push_back(degrees_between(c.n_AB, least.n));
  }
  std::printf("with a hull: depth p99 %.1e, normal p99 %.2f deg\n", percentile(excess, 0.99),
              percentile(normal_error, 0.99));
  EXPECT_LT(percentile(excess, 0.99), 1e-4);
  EXPECT_LT(percentile(normal_error, 0.99), 1.0);
}

struct CcdBody {
  const Shape* shape;
  Pose X;
};

void ccd_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto* body = static_cast<const CcdBody*>(object);
  const Vec3 n(ccdVec3X(direction), ccdVec3Y(direction), ccdVec3Z(direction));
  const Vec3 p = body->X * support(*body->shape, body->X.q.conjugate() * n);
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

void ccd_centre(const void* object, ccd_vec3_t* out) {
  const auto* body = static_cast<const CcdBody*>(object);
  ccdVec3Set(out, body->X.p.x(), body->X.p.y(), body->X.p.z());
}

// libccd's own GJK and EPA, at a tight tolerance, on the same shapes.
TEST(Peers, LibccdGivesTheSameVerdictAndDepth) {
  Pool pool(47);
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = 500;
  ccd.epa_tolerance = 1e-6;
  std::vector<double> depth_error;
  int disagree = 0;
  for (int i = 0; i < 2000 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    const bool apart = i % 2 == 1;
    if (apart) p.X_AB.p *= 1.0 + 0.08 / p.X_AB.p.norm();
    const CcdBody a{&p.a, {}}, b{&p.b, p.X_AB};
    ccd_real_t depth = 0.0;
    ccd_vec3_t direction, position;
    const bool meets = ccdGJKPenetration(&a, &b, &ccd, &depth, &direction, &position) == 0;
    const Closest c = query(p.a, p.b, p.X_AB);
    disagree += meets == c.separated;
    if (meets && !c.separated) depth_error.push_back(std::abs(-c.distance - depth));
  }
  EXPECT_EQ(disagree, 0);
  std::printf("libccd: depth differs by p50 %.1e, p90 %.1e\n", percentile(depth_error, 0.5),
              percentile(depth_error, 0.9));
  // The difference is libccd's (see Depth): its polytope stops growing at about this on round
  // shapes.
  EXPECT_LT(percentile(depth_error, 0.5), 5e-4);
  EXPECT_LT(percentile(depth_error, 0.9), 2e-3);
}

TEST(Peers, FclGivesTheSameVerdictAndDepth) {
  Pool pool(48);
  fcl::CollisionRequestd request(1, true);
  request.gjk_solver_type = fcl::GJKSolverType::GST_LIBCCD;
  std::vector<double> depth_error;
  int disagree = 0;
  for (int i = 0; i < 1000 / kThin; ++i) {
    Shallow p = shallow(pool, i % 4, i / 4 % 4);
    if (i % 2 == 1) p.X_AB.p *= 1.0 + 0.08 / p.X_AB.p.norm();
    const fcl::CollisionObjectd a(test::to_fcl(p.a)),
        b(test::to_fcl(p.b), p.X_AB.q.toRotationMatrix(), p.X_AB.p);
    fcl::CollisionResultd result;
    fcl::collide(&a, &b, request, result);
    const Closest c = query(p.a, p.b, p.X_AB);
    disagree += result.isCollision() == c.separated;
    if (result.isCollision() && !c.separated) {
      depth_error.push_back(std::abs(-c.distance - result.getContact(0).penetration_depth));
    }
  }
  EXPECT_LE(disagree, 1);
  std::printf("FCL: depth differs by p50 %.1e, p90 %.1e\n", percentile(depth_error, 0.5),
              percentile(depth_error, 0.9));
  EXPECT_LT(percentile(depth_error, 0.5), 1e-4);
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
    const Pose X_WA{random.rotation(), random.direction()};
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
    const Vec3 turn = 3e-3 * pool.random.direction(), shift = 2e-3 * pool.random.direction();
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
    for (const Vec3& n : {Vec3(-cold.n_AB), pool.random.direction(), Vec3(nan, 0, 1),
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
    const double margin = pool.random.index(2) * pool.random.uniform(0.0, 0.1);
    const Pose X_AB{pool.random.rotation(),
                    pool.random.uniform(0.5, 1.5) * pool.random.direction()};
    KeptNormal n;
    closest_points(a, b, X_AB, n, {.margin = margin});
    const Pose X_now{rotation(0.02 * pool.random.direction()) * X_AB.q,
                     X_AB.p + 0.02 * pool.random.direction()};
    const Pose X_WA{pool.random.rotation(), pool.random.direction()}, X_WB = X_WA * X_now;
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
        pool.random.index(2) ? test::special_normal(pool.random, a) : pool.random.direction();
    const Vec3 m =
        pool.random.index(2) ? test::special_normal(pool.random, b) : pool.random.direction();
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
    const Pose X_AB{i % 3 ? pool.random.rotation() : Quat::Identity(),
                    off * pool.random.direction()};
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
      const Pose X_AB{random.rotation(), {0.3, 0.1, random.uniform(0.0, 1.0)}};
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

}  // namespace
}  // namespace headpin::engine
