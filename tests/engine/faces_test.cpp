// Faces that carry a body as a half-space does, and parts that need no search.

#include <gtest/gtest.h>

#include "engine/contacts.h"
#include "tests/engine/shape_pairs.h"

namespace headpin::engine {
namespace {

const Pose kSlab{Quat(0.8, 0.2, -0.4, 0.4).normalized(), {1.0, -2.0, 0.5}};
const Vec3 kHalf(3.0, 2.0, 0.4);

struct Found {
  std::vector<ContactPoint> points;
  std::int64_t queries = 0;
  double deepest = -1e300;
};

Found found(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB, double margin,
            bool faces) {
  Query query;
  query.faces = faces;
  std::vector<KeptNormal> kept(kept_normals(a, b));
  QueryCounts counts;
  Found found;
  find_contacts(a, X_WA, b, X_WB, margin, kept, query, counts, found.points);
  found.queries = counts.queries;
  for (const ContactPoint& p : found.points) found.deepest = std::max(found.deepest, p.depth);
  return found;
}

/// Some parts near each other, 0.1 to 0.3 m in all.
Compound random_body(Random& random, test::Pool& pool, int most) {
  std::vector<Part> parts;
  const int count = 1 + index_below(random, most);
  for (int i = 0; i < count; ++i) {
    const bool turned = index_below(random, 2) == 0;
    parts.push_back({test::scaled(pool.pick(index_below(random, 4)), 0.1),
                     {turned ? any_rotation(random) : Quat::Identity(), 0.1 * random.normal3()}});
  }
  return make_compound(parts);
}

/// Height of the lowest point over the body's origin.
double lowest_of(const Compound& body, const Quat& turn) {
  double lowest = 1e300;
  for (const Part& part : body.parts) {
    const Vec3 down = (turn * part.X_BG.q).conjugate() * -Vec3::UnitZ();
    lowest = std::min(lowest, (turn * (part.X_BG * support(part.shape, down))).z());
  }
  return lowest;
}

void expect_equal(const Found& one, const Found& other) {
  ASSERT_EQ(one.points.size(), other.points.size());
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_LT((one.points[i].p_W - other.points[i].p_W).norm(), 1e-12);
    EXPECT_LT((one.points[i].n_AB_W - other.points[i].n_AB_W).norm(), 1e-12);
    EXPECT_NEAR(one.points[i].depth, other.points[i].depth, 1e-12);
  }
}

// Over the middle of a face a body has the very points that it has on a half-space.
TEST(AFace, CarriesAsAHalfSpaceWhatIsFarFromItsEdges) {
  Random random(31);
  test::Pool pool(32);
  const Compound slab = make_compound({{test::box(kHalf), {}}});
  const Compound plane = make_compound({{HalfSpace{}, {}}});
  const Pose X_WP = kSlab * Pose{Quat::Identity(), {0.0, 0.0, kHalf.z()}};
  int with_points = 0;
  for (int i = 0; i < 2000; ++i) {
    const Compound body = random_body(random, pool, 4);
    const Quat turn = any_rotation(random);
    const double height = random.uniform(-0.02, 0.005) - lowest_of(body, turn);
    const Pose X_WB =
        kSlab *
        Pose{turn, {random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0), kHalf.z() + height}};
    for (const bool slab_first : {true, false}) {
      const Found on_face = slab_first ? found(slab, kSlab, body, X_WB, 1e-3, true)
                                       : found(body, X_WB, slab, kSlab, 1e-3, true);
      const Found on_plane = slab_first ? found(plane, X_WP, body, X_WB, 1e-3, true)
                                        : found(body, X_WB, plane, X_WP, 1e-3, true);
      ASSERT_EQ(on_face.points.empty(), on_plane.points.empty()) << i;
      if (on_face.points.empty()) continue;
      ++with_points;
      expect_equal(on_face, on_plane);
    }
  }
  EXPECT_GT(with_points, 500);
}

// Anywhere round a box, near its edges and corners too, the search of each part finds the same depth.
TEST(AFace, IsNoOtherContactThanTheSearchFinds) {
  Random random(33);
  test::Pool pool(34);
  const Compound slab = make_compound({{test::box(0.3 * kHalf), {}}});
  int with_points = 0, quicker = 0;
  for (int i = 0; i < 20'000 / test::kThin; ++i) {
    const Compound body = random_body(random, pool, 4);
    // On the surface of a box that is a little larger, somewhere.
    Vec3 p(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    p /= p.cwiseAbs().maxCoeff();
    const Vec3 half = 0.3 * kHalf + Vec3::Constant(random.uniform(0.0, 0.2));
    const Pose X_WB = kSlab * Pose{any_rotation(random), half.cwiseProduct(p)};
    const double margin = random.uniform(0.0, 0.01);
    const bool first = index_below(random, 2) == 0;
    const auto both = [&](bool faces) {
      return first ? found(slab, kSlab, body, X_WB, margin, faces)
                   : found(body, X_WB, slab, kSlab, margin, faces);
    };
    const Found by_faces = both(true), by_search = both(false);
    quicker += by_faces.queries < by_search.queries ? 1 : 0;
    if (std::max(by_faces.deepest, by_search.deepest) < 1e-6 - margin) continue;
    // A small part deep inside has a shorter way out at a side, but then its body does not follow.
    if (by_search.deepest > 0.03) continue;
    ++with_points;
    ASSERT_FALSE(by_faces.points.empty() || by_search.points.empty()) << i;
    const double tolerance = 2e-6 + 0.011 * std::max(0.0, by_search.deepest);  // as it is promised
    EXPECT_NEAR(by_faces.deepest, by_search.deepest, tolerance) << i;
  }
  EXPECT_GT(with_points, 2000 / test::kThin);
  EXPECT_GT(quicker, 10'000 / test::kThin);
}

// What is left out has no points: parts that the other body's bounds do not reach.
TEST(PartsOutOfReach, AreNotSearchedAndHaveNoPoints) {
  Random random(35);
  test::Pool pool(36);
  std::int64_t with = 0, without = 0;
  int with_points = 0;
  for (int i = 0; i < 5000 / test::kThin; ++i) {
    Compound a = random_body(random, pool, 6), b = random_body(random, pool, 6);
    if (a.faceted || b.faceted) continue;
    const double apart = random.uniform(0.0, 1.2) * (a.bounding_radius + b.bounding_radius);
    const Pose X_WA{any_rotation(random), random.normal3()};
    const Pose X_WB{any_rotation(random), X_WA.p + apart * direction(random)};
    const Found some = found(a, X_WA, b, X_WB, 1e-3, true);
    const Found all = found(a, X_WA, b, X_WB, 1e-3, false);
    with += some.queries;
    without += all.queries;
    with_points += some.points.empty() ? 0 : 1;
    ASSERT_EQ(some.points.size(), all.points.size()) << i;
    for (std::size_t k = 0; k < some.points.size(); ++k) {
      EXPECT_EQ(some.points[k].p_W, all.points[k].p_W) << i;
      EXPECT_EQ(some.points[k].depth, all.points[k].depth) << i;
      EXPECT_EQ(some.points[k].feature, all.points[k].feature) << i;
    }
  }
  EXPECT_GT(with_points, 500 / test::kThin);
  EXPECT_LE(with, without);
}

// Paper detection searches every pair of parts, as the paper does.
TEST(PaperDetection, HasNoShortCuts) {
  Random random(37);
  test::Pool pool(38);
  const Compound slab = make_compound({{test::box(kHalf), {}}});
  for (int i = 0; i < 200; ++i) {
    const Compound body = random_body(random, pool, 4);
    const Pose X_WB = kSlab * Pose{any_rotation(random), {0.0, 0.0, kHalf.z() + 0.1}};
    std::array<std::vector<ContactPoint>, 2> points;
    std::array<QueryCounts, 2> counts;
    for (const bool faces : {false, true}) {
      Query query;
      query.mode = Query::paper;
      query.faces = faces;
      std::vector<KeptNormal> kept(kept_normals(slab, body));
      find_contacts(slab, kSlab, body, X_WB, 1e-3, kept, query, counts[faces], points[faces]);
    }
    EXPECT_EQ(counts[0].queries, counts[1].queries);
    EXPECT_EQ(points[0].size(), points[1].size());
  }
}

}  // namespace
}  // namespace headpin::engine
