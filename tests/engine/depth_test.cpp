// Depths of overlaps, beside other ways to find them: the definition, a search, libccd, FCL.

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <ccd/ccd.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include "engine/non_colliding.h"
#include "tests/engine/shape_pairs.h"
#include "tests/support/fcl_shapes.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::degrees_between;
using test::depth_along;
using test::kThin;
using test::Least;
using test::percentile;
using test::Pool;
using test::query;
using test::searched;
using test::Shallow;
using test::shallow;
using test::touching_distance;

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
    const Quat q = any_rotation(random);
    const Vec3 along = direction(random);
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

}  // namespace
}  // namespace headpin::engine
