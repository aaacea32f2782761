#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <ccd/ccd.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fmt/format.h>
#include <ode/ode.h>

#include "engine/broad_phase.h"
#include "engine/kept_plane.h"
#include "engine/non_colliding.h"
#include "tests/bench/report.h"
#include "tests/support/fcl_shapes.h"
#include "tests/support/random_shapes.h"

// One contact query after another, ours and the peers' in turn in one process.
//
// A query gives the verdict and, when the two meet, depth, normal and point. Every contestant is
// given the pair's shapes made beforehand and two world poses; ours works out the relative pose
// within the measured time. Bullet is run twice, without margin and with one of 0.02, and the
// faster counts; its largest distance is set so that it stops at the first proof of separation. FCL
// uses its libccd solver, which is the faster and the better one of its two.
namespace {

using namespace headpin;
using namespace headpin::engine;
using test::ShapeKind;

constexpr int kFrames = 20;

struct Scene {
  Shape a, b;
  std::vector<Pose> X_WA, X_WB;  // kFrames of them, a slow drift
};

enum class Distance { separated, near, touching };

Scene scene(Random& random, ShapeKind ka, ShapeKind kb, Distance how) {
  Scene s{random_shape(random, ka), random_shape(random, kb), {}, {}};
  const Quat q = any_rotation(random);
  const Vec3 along = direction(random);
  double meets = 0.0, apart = 3.0;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (meets + apart);
    KeptNormal n;
    (closest_points(s.a, s.b, {q, middle * along}, n, {}).separated ? apart : meets) = middle;
  }
  const double off = how == Distance::separated ? random.uniform(0.3, 1.5)
                     : how == Distance::near    ? random.uniform(0.01, 0.1)
                                                : -random.uniform(0.005, 0.05);
  const Pose X_AB{q, (apart + off) * along};
  const Pose X_WA{any_rotation(random), direction(random)};
  // A turn and a shift of a few thousandths a frame: a body in a 240 Hz simulation.
  const Vec3 turn = 2e-3 * direction(random), shift = 2e-4 * direction(random);
  for (int f = 0; f < kFrames; ++f) {
    s.X_WA.push_back(X_WA);
    s.X_WB.push_back(X_WA * Pose{(rotation(f * turn) * X_AB.q).normalized(), X_AB.p + f * shift});
  }
  return s;
}

double ours(const std::vector<Scene>& scenes, bool coherent) {
  double sum = 0.0;
  for (const Scene& s : scenes) {
    KeptNormal n;
    for (int f = 0; f < kFrames; ++f) {
      if (!coherent) n = {};
      const Pose& X_WA = s.X_WA[static_cast<std::size_t>(f)];
      const Pose& X_WB = s.X_WB[static_cast<std::size_t>(f)];
      if (still_apart(s.a, X_WA, s.b, X_WB, n)) continue;  // as a world asks it
      sum += closest_points(s.a, s.b, relative(X_WA, X_WB), n, {}).distance;
    }
  }
  return sum;
}

// ---- Bullet

class BulletEllipsoid : public btConvexInternalShape {
 public:
  explicit BulletEllipsoid(const Vec3& radii)
      : radii_(btScalar(radii.x()), btScalar(radii.y()), btScalar(radii.z())) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& n) const override {
    const btVector3 scaled = radii_ * n;
    const btScalar length = scaled.length();
    if (length < btScalar(1e-9)) return {0, 0, radii_.z()};
    return radii_ * scaled / length;
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* n, btVector3* out,
                                                         int count) const override {
    for (int i = 0; i < count; ++i) out[i] = localGetSupportingVertexWithoutMargin(n[i]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  void getAabb(const btTransform&, btVector3& low, btVector3& high) const override {
    low = -radii_;
    high = radii_;
  }
  const char* getName() const override { return "ellipsoid"; }

 private:
  btVector3 radii_;
};

std::unique_ptr<btConvexShape> to_bullet(const Shape& shape, double margin) {
  std::unique_ptr<btConvexShape> out;
  if (const auto* e = std::get_if<Ellipsoid>(&shape)) {
    out = std::make_unique<BulletEllipsoid>(e->radii - Vec3::Constant(margin));
  } else if (const auto* c = std::get_if<Cylinder>(&shape)) {
    out = std::make_unique<btCylinderShapeZ>(
        btVector3(btScalar(c->radius), btScalar(c->radius), btScalar(c->half_height)));
  } else if (const auto* k = std::get_if<Cone>(&shape)) {
    out = std::make_unique<btConeShapeZ>(btScalar(k->radius), btScalar(k->height));
  } else {
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Vec3& v : std::get<Polyhedron>(shape).vertices()) {
      hull->addPoint(btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z())), false);
    }
    hull->recalcLocalAabb();
    out = std::move(hull);
  }
  out->setMargin(btScalar(margin));
  return out;
}

btTransform to_bullet(const Pose& X) {
  const btQuaternion q(btScalar(X.q.x()), btScalar(X.q.y()), btScalar(X.q.z()), btScalar(X.q.w()));
  return btTransform(q, btVector3(btScalar(X.p.x()), btScalar(X.p.y()), btScalar(X.p.z())));
}

struct BulletScene {
  std::unique_ptr<btConvexShape> a, b;
  std::vector<btTransform> X_WA, X_WB;
};

std::vector<BulletScene> to_bullet(const std::vector<Scene>& scenes, double margin) {
  std::vector<BulletScene> out;
  for (const Scene& s : scenes) {
    BulletScene t{to_bullet(s.a, margin), to_bullet(s.b, margin), {}, {}};
    for (const Pose& X : s.X_WA) t.X_WA.push_back(to_bullet(X));
    for (const Pose& X : s.X_WB) t.X_WB.push_back(to_bullet(X));
    out.push_back(std::move(t));
  }
  return out;
}

double bullet(const std::vector<BulletScene>& scenes) {
  double sum = 0.0;
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver epa;
  for (const BulletScene& s : scenes) {
    btGjkPairDetector detector(s.a.get(), s.b.get(), &simplex, &epa);
    const btScalar reach = s.a->getMargin() + s.b->getMargin() + btScalar(1e-4);
    for (std::size_t f = 0; f < kFrames; ++f) {
      btGjkPairDetector::ClosestPointInput input;
      input.m_transformA = s.X_WA[f];
      input.m_transformB = s.X_WB[f];
      input.m_maximumDistanceSquared = reach * reach;
      btPointCollector result;
      detector.getClosestPoints(input, result, nullptr);
      sum += result.m_hasResult ? double(result.m_distance) : 1.0;
    }
  }
  return sum;
}

// ---- libccd

struct CcdBody {
  const Shape* shape;
  Mat3 R;
  Vec3 p;
};

void ccd_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto* body = static_cast<const CcdBody*>(object);
  const Vec3 n(ccdVec3X(direction), ccdVec3Y(direction), ccdVec3Z(direction));
  const Vec3 n_G = body->R.transpose() * n;
  const Vec3 p = body->R * support(*body->shape, n_G) + body->p;
  ccdVec3Set(out, p.x(), p.y(), p.z());
}

void ccd_centre(const void* object, ccd_vec3_t* out) {
  const auto* body = static_cast<const CcdBody*>(object);
  ccdVec3Set(out, body->p.x(), body->p.y(), body->p.z());
}

template <typename Test>
double libccd(const std::vector<Scene>& scenes, Test&& test) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = 100;
  ccd.mpr_tolerance = ccd.epa_tolerance = 1e-4;
  double sum = 0.0;
  for (const Scene& s : scenes) {
    for (std::size_t f = 0; f < kFrames; ++f) {
      const CcdBody a{&s.a, s.X_WA[f].q.toRotationMatrix(), s.X_WA[f].p};
      const CcdBody b{&s.b, s.X_WB[f].q.toRotationMatrix(), s.X_WB[f].p};
      ccd_real_t depth = 0.0;
      ccd_vec3_t direction, position;
      sum += test(&a, &b, &ccd, &depth, &direction, &position) == 0 ? depth : 0.0;
    }
  }
  return sum;
}

double libccd_mpr(const std::vector<Scene>& scenes) {
  return libccd(scenes, ccdMPRPenetration);
}
double libccd_gjk(const std::vector<Scene>& scenes) {
  return libccd(scenes, ccdGJKPenetration);
}

// ---- FCL

using FclObject = fcl::CollisionObjectd;

struct FclScene {
  std::vector<std::unique_ptr<FclObject>> a, b;  // one per frame
};

std::vector<FclScene> to_fcl(const std::vector<Scene>& scenes) {
  std::vector<FclScene> out;
  for (const Scene& s : scenes) {
    FclScene t;
    const auto a = test::to_fcl(s.a), b = test::to_fcl(s.b);
    for (std::size_t f = 0; f < kFrames; ++f) {
      t.a.push_back(std::make_unique<FclObject>(a, s.X_WA[f].q.toRotationMatrix(), s.X_WA[f].p));
      t.b.push_back(std::make_unique<FclObject>(b, s.X_WB[f].q.toRotationMatrix(), s.X_WB[f].p));
    }
    out.push_back(std::move(t));
  }
  return out;
}

double by_fcl(const std::vector<FclScene>& scenes) {
  fcl::CollisionRequestd request(1, true);
  request.gjk_solver_type = fcl::GJKSolverType::GST_LIBCCD;
  double sum = 0.0;
  for (const FclScene& s : scenes) {
    for (std::size_t f = 0; f < kFrames; ++f) {
      fcl::CollisionResultd result;
      fcl::collide(s.a[f].get(), s.b[f].get(), request, result);
      if (result.isCollision()) sum += result.getContact(0).penetration_depth;
    }
  }
  return sum;
}

// ---- ODE (has no ellipsoid and no cone)

struct OdeScene {
  std::vector<dGeomID> a, b;
};

dGeomID to_ode(const Shape& shape, const Pose& X) {
  const Cylinder& c = std::get<Cylinder>(shape);
  const dGeomID geom = dCreateCylinder(nullptr, c.radius, 2.0 * c.half_height);
  const dQuaternion q = {X.q.w(), X.q.x(), X.q.y(), X.q.z()};
  dGeomSetQuaternion(geom, q);
  dGeomSetPosition(geom, X.p.x(), X.p.y(), X.p.z());
  return geom;
}

std::vector<OdeScene> to_ode(const std::vector<Scene>& scenes) {
  std::vector<OdeScene> out;
  for (const Scene& s : scenes) {
    OdeScene t;
    for (std::size_t f = 0; f < kFrames; ++f) {
      t.a.push_back(to_ode(s.a, s.X_WA[f]));
      t.b.push_back(to_ode(s.b, s.X_WB[f]));
    }
    out.push_back(t);
  }
  return out;
}

double by_ode(const std::vector<OdeScene>& scenes) {
  double sum = 0.0;
  dContactGeom contacts[4];
  for (const OdeScene& s : scenes) {
    for (std::size_t f = 0; f < kFrames; ++f) {
      const int n = dCollide(s.a[f], s.b[f], 4, contacts, sizeof(dContactGeom));
      if (n > 0) sum += contacts[0].depth;
    }
  }
  return sum;
}

// ---- tables

constexpr int kRounds = 25;

void measure(const std::string& name, const std::vector<Scene>& scenes,
             std::vector<bench::Row>& rows) {
  const double ns = 1e9 / (static_cast<double>(scenes.size()) * kFrames);
  const std::vector<BulletScene> bare = to_bullet(scenes, 0.0), padded = to_bullet(scenes, 0.02);
  const std::vector<FclScene> fcl_scenes = to_fcl(scenes);
  const std::vector<double> s =
      bench::interleaved({{"cold", [&] { return ours(scenes, false); }},
                          {"coherent", [&] { return ours(scenes, true); }},
                          {"bullet", [&] { return bullet(bare); }},
                          {"bullet padded", [&] { return bullet(padded); }},
                          {"mpr", [&] { return libccd_mpr(scenes); }},
                          {"gjk", [&] { return libccd_gjk(scenes); }},
                          {"fcl", [&] { return by_fcl(fcl_scenes); }}},
                         kRounds);
  for (const std::size_t i : {0u, 1u}) {
    const std::string which = name + (i == 0 ? ", cold" : ", coherent");
    rows.push_back({which, "ns", ns * s[i], "Bullet", ns * std::min(s[2], s[3])});
    rows.push_back({which, "ns", ns * s[i], "libccd MPR", ns * s[4]});
    rows.push_back({which, "ns", ns * s[i], "libccd GJK+EPA", ns * s[5]});
    rows.push_back({which, "ns", ns * s[i], "FCL", ns * s[6]});
  }
}

void measure_ode(const std::string& name, const std::vector<Scene>& scenes,
                 std::vector<bench::Row>& rows) {
  const double ns = 1e9 / (static_cast<double>(scenes.size()) * kFrames);
  const std::vector<OdeScene> ode = to_ode(scenes);
  const std::vector<double> s = bench::interleaved(
      {{"cold", [&] { return ours(scenes, false); }}, {"ode", [&] { return by_ode(ode); }}},
      kRounds);
  rows.push_back({name + ", cold", "ns", ns * s[0], "ODE", ns * s[1]});
}

// Racks of standing skittles, each with a ball among them, all of them moving a little every step.
struct Hall {
  std::vector<std::vector<Capsule>> steps;
};

Hall hall(int skittles) {
  Random random(31);
  Hall h;
  const Capsule skittle{{0, 0, 0.0605}, {0, 0, 0.32}, 0.0605},
      ball{{0, 0, 0.108}, {0, 0, 0.108}, 0.108};
  std::vector<Pose> X_W;
  std::vector<bool> is_ball;
  const int racks = skittles / 10;
  const int side = static_cast<int>(std::ceil(std::sqrt(racks)));
  for (int r = 0; r < racks; ++r) {
    const Vec3 at(2.0 * (r % side), 3.0 * (r / side), 0.0);
    for (int row = 0; row < 4; ++row) {
      for (int i = 0; i <= row; ++i) {
        X_W.push_back({Quat::Identity(), at + Vec3(0.3048 * (i - 0.5 * row), 0.264 * row, 0.0)});
        is_ball.push_back(false);
      }
    }
    X_W.push_back({Quat::Identity(), at + Vec3(0.05, 0.1, 0.0)});
    is_ball.push_back(true);
  }
  for (int step = 0; step < 8; ++step) {
    std::vector<Capsule> bounds;
    for (std::size_t i = 0; i < X_W.size(); ++i) {
      const Pose tilt{rotation(0.3 * random.uniform(0.0, 1.0) * direction(random)),
                      X_W[i].p + 0.01 * direction(random)};
      bounds.push_back(tilt * (is_ball[i] ? ball : skittle));
    }
    h.steps.push_back(bounds);
  }
  return h;
}

class BulletBroadPhase {
 public:
  explicit BulletBroadPhase(const Hall& h) {
    for (const Capsule& c : h.steps[0]) {
      const auto [low, high] = box(c);
      proxies_.push_back(broad_phase_.createProxy(low, high, 0, nullptr, 1, 1, nullptr));
    }
  }
  ~BulletBroadPhase() {
    for (btBroadphaseProxy* p : proxies_) broad_phase_.destroyProxy(p, nullptr);
  }
  double run(const Hall& h) {
    double pairs = 0.0;
    for (const std::vector<Capsule>& bounds : h.steps) {
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        const auto [low, high] = box(bounds[i]);
        broad_phase_.setAabb(proxies_[i], low, high, nullptr);
      }
      broad_phase_.calculateOverlappingPairs(nullptr);
      pairs += broad_phase_.getOverlappingPairCache()->getNumOverlappingPairs();
    }
    return pairs;
  }

 private:
  static std::pair<btVector3, btVector3> box(const Capsule& c) {
    const Vec3 r = Vec3::Constant(c.radius);
    const Vec3 low = c.a.cwiseMin(c.b) - r, high = c.a.cwiseMax(c.b) + r;
    return {btVector3(btScalar(low.x()), btScalar(low.y()), btScalar(low.z())),
            btVector3(btScalar(high.x()), btScalar(high.y()), btScalar(high.z()))};
  }
  btDbvtBroadphase broad_phase_;
  std::vector<btBroadphaseProxy*> proxies_;
};

void measure_broad_phase(std::vector<bench::Row>& rows) {
  std::vector<double> sizes, mine, theirs;
  for (const int skittles : {10, 100, 1000, 10000}) {
    const Hall h = hall(skittles);
    BroadPhase broad_phase;
    BulletBroadPhase bullet_broad_phase(h);
    const int repeats = std::max(1, 2000 / skittles);
    const std::vector<double> s =
        bench::interleaved({{"ours",
                             [&] {
                               std::size_t pairs = 0;
                               for (int k = 0; k < repeats; ++k) {
                                 for (const auto& bounds : h.steps)
                                   pairs += broad_phase.find_pairs(bounds).size();
                               }
                               return static_cast<double>(pairs);
                             }},
                            {"bullet",
                             [&] {
                               double pairs = 0.0;
                               for (int k = 0; k < repeats; ++k) pairs += bullet_broad_phase.run(h);
                               return pairs;
                             }}},
                           kRounds);
    const double us = 1e6 / (repeats * static_cast<double>(h.steps.size()));
    rows.push_back({fmt::format("broad phase, {} skittles", skittles), "us", us * s[0],
                    "Bullet dynamic tree", us * s[1]});
    sizes.push_back(skittles);
    mine.push_back(s[0] / repeats);
    theirs.push_back(s[1] / repeats);
  }
  rows.push_back({"broad phase growth exponent, 10 to 10000", "1",
                  bench::growth_exponent(sizes, mine), "Bullet dynamic tree",
                  bench::growth_exponent(sizes, theirs)});
}

}  // namespace

int main() {
  dInitODE2(0);
  std::vector<bench::Row> rows;
  const ShapeKind parametric[] = {ShapeKind::ellipsoid, ShapeKind::cylinder, ShapeKind::cone};
  const std::pair<Distance, const char*> distances[] = {{Distance::separated, "separated"},
                                                        {Distance::near, "near"},
                                                        {Distance::touching, "touching"}};
  Random random(30);
  for (const auto& [how, name] : distances) {
    std::vector<Scene> scenes, with_hull, cylinders;
    for (int i = 0; i < 30; ++i) {
      for (const ShapeKind a : parametric) {
        for (const ShapeKind b : parametric) scenes.push_back(scene(random, a, b, how));
        with_hull.push_back(scene(random, a, ShapeKind::hull, how));
      }
      with_hull.push_back(scene(random, ShapeKind::hull, ShapeKind::hull, how));
      for (int k = 0; k < 4; ++k) {
        cylinders.push_back(scene(random, ShapeKind::cylinder, ShapeKind::cylinder, how));
      }
    }
    measure(std::string(name) + " parametric pair", scenes, rows);
    measure(std::string(name) + " pair with a 64-vertex hull", with_hull, rows);
    measure_ode(std::string(name) + " pair of cylinders", cylinders, rows);
  }
  measure_broad_phase(rows);
  bench::publish("detection", rows);
  dCloseODE();
}
