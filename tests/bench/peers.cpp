#include "tests/bench/peers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <mujoco/mujoco.h>
#include <ode/ode.h>

namespace headpin::bench {
namespace {

constexpr double kDt = 1.0 / 240, kTilt = 0.86602540378443864676;  // cosine of 30 degrees
constexpr double kCentre = 0.147, kBall = 0.108, kSpacing = 0.3048, kSpeed = 6.0;

struct Spot {
  double x, y;
};

/// Where the head pin of each rack stands, and the ten spots round it.
std::vector<Spot> origins(int racks) {
  std::vector<Spot> out;
  const int across = static_cast<int>(std::ceil(std::sqrt(racks)));
  for (int k = 0; k < racks; ++k) out.push_back({4.0 * (k % across), 8.0 * (k / across)});
  return out;
}

std::vector<Spot> spots(const Spot& origin) {
  std::vector<Spot> out;
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k <= row; ++k) {
      out.push_back({origin.x + kSpacing * (k - 0.5 * row),
                     origin.y + kSpacing * 0.5 * std::sqrt(3.0) * row});
    }
  }
  return out;
}

/// 42 corners on the unit sphere: an icosahedron, its edges halved; and its 80 triangles.
struct Hull {
  std::vector<std::array<double, 3>> corners;
  std::vector<std::array<unsigned, 3>> faces;
};

Hull unit_hull() {
  Hull h;
  const double g = 0.5 * (1.0 + std::sqrt(5.0)), n = std::sqrt(1.0 + g * g);
  for (const auto& c : std::vector<std::array<double, 3>>{{-1, g, 0},
                                                          {1, g, 0},
                                                          {-1, -g, 0},
                                                          {1, -g, 0},
                                                          {0, -1, g},
                                                          {0, 1, g},
                                                          {0, -1, -g},
                                                          {0, 1, -g},
                                                          {g, 0, -1},
                                                          {g, 0, 1},
                                                          {-g, 0, -1},
                                                          {-g, 0, 1}}) {
    h.corners.push_back({c[0] / n, c[1] / n, c[2] / n});
  }
  const unsigned ico[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                               {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                               {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                               {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  std::map<std::pair<unsigned, unsigned>, unsigned> halves;
  const auto half = [&](unsigned a, unsigned b) {
    const std::pair<unsigned, unsigned> key = std::minmax(a, b);
    if (const auto it = halves.find(key); it != halves.end()) return it->second;
    std::array<double, 3> m{};
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k) m[k] = h.corners[a][k] + h.corners[b][k];
    for (const double x : m) length += x * x;
    for (double& x : m) x /= std::sqrt(length);
    h.corners.push_back(m);
    return halves[key] = static_cast<unsigned>(h.corners.size()) - 1;
  };
  for (const auto& f : ico) {
    const unsigned ab = half(f[0], f[1]), bc = half(f[1], f[2]), ca = half(f[2], f[0]);
    h.faces.push_back({f[0], ab, ca});
    h.faces.push_back({f[1], bc, ab});
    h.faces.push_back({f[2], ca, bc});
    h.faces.push_back({ab, bc, ca});
  }
  return h;
}

class Bullet final : public Contender {
 public:
  explicit Bullet(const Scene& scene)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broad_phase_, &solver_, &configuration_),
        plane_(btVector3(0, 0, 1), 0),
        base_(btVector3(0.0258f, 0.0258f, 0.03f)),
        neck_(btVector3(0.0235f, 0.0235f, 0.08f)),
        head_(0.0325f),
        ball_(static_cast<btScalar>(kBall)) {
    gContactBreakingThreshold = 0.005f;
    world_.setGravity(btVector3(0, 0, -9.81f));
    for (const auto& c : unit_hull().corners) {
      belly_.addPoint(
          btVector3(static_cast<btScalar>(0.0605 * c[0]), static_cast<btScalar>(0.0605 * c[1]),
                    static_cast<btScalar>(0.110 * c[2])),
          false);
    }
    belly_.recalcLocalAabb();
    for (btConvexInternalShape* s :
         std::initializer_list<btConvexInternalShape*>{&base_, &neck_, &belly_}) {
      s->setMargin(0.001f);
    }
    const auto at = [](double z) {
      return btTransform(btQuaternion::getIdentity(),
                         btVector3(0, 0, static_cast<btScalar>(z - kCentre)));
    };
    skittle_.addChildShape(at(0.03), &base_);
    skittle_.addChildShape(at(0.116), &belly_);
    skittle_.addChildShape(at(0.26), &neck_);
    skittle_.addChildShape(at(0.3485), &head_);
    add(plane_, 0, btVector3(0, 0, 0), btVector3(0, 0, 0), 0.25f, scene.sleep);
    for (const Spot& o : origins(scene.racks)) {
      for (const Spot& s : spots(o)) {
        skittles_.push_back(add(skittle_, 1.5f, btVector3(0.0145f, 0.0145f, 0.0021f),
                                point(s.x, s.y, kCentre), 0.8f, scene.sleep));
      }
      if (!scene.ball) continue;
      const auto i = static_cast<btScalar>(0.4 * 7.0 * kBall * kBall);
      btRigidBody* ball = add(ball_, 7, btVector3(i, i, i),
                              point(o.x + scene.ball_offset, o.y - 1.5, kBall), 0.8f, scene.sleep);
      ball->setLinearVelocity(btVector3(0, static_cast<btScalar>(kSpeed), 0));
      ball->setAngularVelocity(btVector3(static_cast<btScalar>(-kSpeed / kBall), 0, 0));
    }
  }
  ~Bullet() override {
    for (const auto& b : bodies_) world_.removeRigidBody(b.get());
  }
  void step() override {
    world_.stepSimulation(static_cast<btScalar>(kDt), 0, static_cast<btScalar>(kDt));
  }
  int skittles_down() const override {
    int down = 0;
    for (const btRigidBody* b : skittles_) {
      down += b->getWorldTransform().getBasis()[2][2] < static_cast<btScalar>(kTilt);
    }
    return down;
  }

 private:
  static btVector3 point(double x, double y, double z) {
    return {static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)};
  }
  btRigidBody* add(btCollisionShape& shape, btScalar mass, const btVector3& inertia,
                   const btVector3& p, btScalar restitution, bool sleep) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), p);
    info.m_restitution = restitution;
    info.m_friction = std::sqrt(0.3f);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    if (!sleep) bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  btStaticPlaneShape plane_;
  btCylinderShapeZ base_, neck_;
  btSphereShape head_, ball_;
  btConvexHullShape belly_;
  btCompoundShape skittle_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<btRigidBody*> skittles_;
};

class Ode final : public Contender {
 public:
  explicit Ode(const Scene& scene) : hull_(unit_hull()) {
    static const bool initialised = dInitODE2(0) != 0;
    if (!initialised) throw std::runtime_error("ODE does not start");
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetQuickStepNumIterations(world_, 20);
    dWorldSetAutoDisableFlag(world_, scene.sleep ? 1 : 0);
    plane_ = dCreatePlane(space_, 0, 0, 1, 0);
    for (auto& c : hull_.corners) {
      points_.insert(points_.end(), {0.0605 * c[0], 0.0605 * c[1], 0.110 * c[2]});
    }
    for (const auto& f : hull_.faces) {
      const auto corner = [&](unsigned i, unsigned k) { return points_[3 * i + k]; };
      std::array<double, 3> u{}, v{}, n{};
      for (unsigned k = 0; k < 3; ++k) {
        u[k] = corner(f[1], k) - corner(f[0], k);
        v[k] = corner(f[2], k) - corner(f[0], k);
      }
      for (unsigned k = 0; k < 3; ++k) {
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
      }
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      double d = 0.0;
      for (unsigned k = 0; k < 3; ++k) {
        planes_.push_back(n[k] / length);
        d += n[k] / length * corner(f[0], k);
      }
      planes_.push_back(d);
      polygons_.insert(polygons_.end(), {3, f[0], f[1], f[2]});
    }
    for (const Spot& o : origins(scene.racks)) {
      for (const Spot& s : spots(o)) skittles_.push_back(add_skittle(s));
      if (!scene.ball) continue;
      dBodyID ball = dBodyCreate(world_);
      dMass mass;
      dMassSetSphereTotal(&mass, 7.0, kBall);
      dBodySetMass(ball, &mass);
      dGeomSetBody(dCreateSphere(space_, kBall), ball);
      dBodySetPosition(ball, o.x + scene.ball_offset, o.y - 1.5, kBall);
      dBodySetLinearVel(ball, 0, kSpeed, 0);
      dBodySetAngularVel(ball, -kSpeed / kBall, 0, 0);
    }
  }
  ~Ode() override {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  void step() override {
    dSpaceCollide(space_, this, &Ode::near);
    dWorldQuickStep(world_, kDt);
    dJointGroupEmpty(contacts_);
  }
  int skittles_down() const override {
    int down = 0;
    for (const dBodyID b : skittles_) down += dBodyGetRotation(b)[10] < kTilt;
    return down;
  }

 private:
  dBodyID add_skittle(const Spot& s) {
    dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, 1.5, 0, 0, 0, 0.0145, 0.0145, 0.0021, 0, 0, 0);
    dBodySetMass(body, &mass);
    const auto attach = [&](dGeomID geom, double z) {
      dGeomSetBody(geom, body);
      dGeomSetOffsetPosition(geom, 0, 0, z - kCentre);
    };
    attach(dCreateCylinder(space_, 0.0258, 0.06), 0.03);
    attach(dCreateConvex(space_, planes_.data(), static_cast<unsigned>(hull_.faces.size()),
                         points_.data(), static_cast<unsigned>(hull_.corners.size()),
                         polygons_.data()),
           0.116);
    attach(dCreateCylinder(space_, 0.0235, 0.16), 0.26);
    attach(dCreateSphere(space_, 0.0325), 0.3485);
    dBodySetPosition(body, s.x, s.y, kCentre);
    return body;
  }
  static void near(void* self, dGeomID a, dGeomID b) {
    Ode& ode = *static_cast<Ode*>(self);
    const dBodyID ba = dGeomGetBody(a), bb = dGeomGetBody(b);
    if (ba == bb) return;
    if ((!ba || !dBodyIsEnabled(ba)) && (!bb || !dBodyIsEnabled(bb))) return;
    dContact contacts[4] = {};
    const int count = dCollide(a, b, 4, &contacts[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      contacts[k].surface.mode = dContactBounce | dContactApprox1;
      contacts[k].surface.mu = 0.3;
      contacts[k].surface.bounce = ba && bb ? 0.64 : 0.2;
      contacts[k].surface.bounce_vel = 0.2;
      dJointAttach(dJointCreateContact(ode.world_, ode.contacts_, &contacts[k]), ba, bb);
    }
  }

  Hull hull_;
  std::vector<dReal> points_, planes_;
  std::vector<unsigned> polygons_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  dGeomID plane_;
  std::vector<dBodyID> skittles_;
};

class Mujoco final : public Contender {
 public:
  explicit Mujoco(const Scene& scene) {
    std::string xml = "<mujoco><option timestep='" + std::to_string(kDt) +
                      "' solver='Newton' cone='pyramidal'/><size njmax='2000' nconmax='500'/>"
                      "<default><geom friction='0.3 0.005 0.0001'/></default><worldbody>"
                      "<geom type='plane' size='0 0 1'/>";
    int bodies = 0;
    const auto body = [&](double x, double y, double z) {
      return "<body name='b" + std::to_string(bodies++) + "' pos='" + std::to_string(x) + " " +
             std::to_string(y) + " " + std::to_string(z) + "'><freejoint/>";
    };
    for (const Spot& o : origins(scene.racks)) {
      for (const Spot& s : spots(o)) {
        skittles_.push_back(bodies + 1);
        xml += body(s.x, s.y, kCentre) +
               "<inertial pos='0 0 0' mass='1.5' diaginertia='0.0145 0.0145 0.0021'/>"
               "<geom type='cylinder' size='0.0258 0.03' pos='0 0 -0.117'/>"
               "<geom type='ellipsoid' size='0.0605 0.0605 0.110' pos='0 0 -0.031'/>"
               "<geom type='cylinder' size='0.0235 0.08' pos='0 0 0.113'/>"
               "<geom type='sphere' size='0.0325' pos='0 0 0.2015'/></body>";
      }
      if (!scene.ball) continue;
      balls_.push_back(bodies);
      xml += body(o.x + scene.ball_offset, o.y - 1.5, kBall) +
             "<geom type='sphere' size='0.108' mass='7'/></body>";
    }
    xml += "</worldbody></mujoco>";
    // It counts its warnings in `data_`; the text would go to a file in the current folder.
    mju_user_warning = [](const char*) {};
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(files.filedata[0]));
    char error[512] = "";
    model_ = mj_loadXML("scene.xml", &files, error, sizeof error);
    mj_deleteVFS(&files);
    if (!model_) throw std::runtime_error(std::string("MuJoCo: ") + error);
    data_ = mj_makeData(model_);
    for (const int ball : balls_) {
      data_->qvel[6 * ball + 1] = kSpeed;
      data_->qvel[6 * ball + 3] = -kSpeed / kBall;
    }
  }
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  void step() override { mj_step(model_, data_); }
  int skittles_down() const override {
    int down = 0;
    for (const int b : skittles_) down += data_->xmat[9 * b + 8] < kTilt;
    return down;
  }

 private:
  std::vector<int> skittles_, balls_;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

}  // namespace

std::unique_ptr<Contender> make_bullet(const Scene& scene) {
  return std::make_unique<Bullet>(scene);
}
std::unique_ptr<Contender> make_ode(const Scene& scene) {
  return std::make_unique<Ode>(scene);
}
std::unique_ptr<Contender> make_mujoco(const Scene& scene) {
  return std::make_unique<Mujoco>(scene);
}

}  // namespace headpin::bench
