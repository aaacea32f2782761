// The search as the paper of 1997 has it: with a cap, from the line of centres.

#include <algorithm>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "engine/non_colliding.h"
#include "tests/engine/shape_pairs.h"

namespace headpin::engine {
namespace {

using test::degrees_between;
using test::depth_along;
using test::hard_cases;
using test::HardCase;
using test::kThin;
using test::Least;
using test::percentile;
using test::Pool;
using test::query;
using test::searched;
using test::Shallow;
using test::shallow;
using test::touching_distance;

// The paper's cap: how often a pair that is apart is called a contact. The rate must rise at cap 5,
// or the cap is not honoured. The table is what a user of the paper mode should know.
TEST(PaperMode, CallsMoreOfWhatIsApartAContactTheLowerItsCap) {
  constexpr int kCaps[] = {5, 10, 20};
  Pool pool(43);
  int phantom[3] = {0, 0, 0}, pairs = 0;
  for (int i = 0; i < 20000 / kThin; ++i) {
    const Shape &a = pool.pick(i % 3), &b = pool.pick(i / 3 % 3);
    const Quat q = any_rotation(pool.random);
    const Vec3 along = direction(pool.random);
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
      const Quat lean = rotation(1e-3 * direction(pool.random));
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
    const Query q{Query::paper, 5 + 5 * index_below(pool.random, 3)};
    const Closest cold = query(p.a, p.b, p.X_AB, q);
    KeptNormal n{direction(pool.random), KeptNormal::met}, same = n;
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
    const Pose X_AB{any_rotation(pool.random),
                    pool.random.uniform(0.6, 1.6) * direction(pool.random)};
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
    const int cap = 5 + 5 * index_below(pool.random, 2);
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

}  // namespace
}  // namespace headpin::engine
