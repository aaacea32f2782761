/// Structures that stand and bins of skittles: a step of today's rules, of rules 3 and 15, and of Bullet.
///
///   crowds_bench [--quick]

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>

#include <btBulletDynamicsCommon.h>

#include "tests/bench/report.h"
#include "tests/support/structures.h"

namespace headpin::bench {
namespace {

/// What a structure cost and did.
struct Outcome {
  double mean_us = 0.0;            ///< of a step
  double slowest_second_us = 0.0;  ///< mean step of the slowest second
  double moved_mm = 0.0;           ///< the body that moved most
};

/// Takes `seconds` times 240 steps, and times each second.
Outcome timed(const std::function<void()>& step, const std::function<double()>& moved,
              int seconds) {
  using Clock = std::chrono::steady_clock;
  Outcome outcome;
  for (int second = 0; second < seconds; ++second) {
    const Clock::time_point start = Clock::now();
    for (int k = 0; k < 240; ++k) step();
    const double us = std::chrono::duration<double, std::micro>(Clock::now() - start).count() / 240;
    outcome.mean_us += us / seconds;
    outcome.slowest_second_us = std::max(outcome.slowest_second_us, us);
  }
  outcome.moved_mm = 1e3 * moved();
  return outcome;
}

Outcome ours(engine::Structure s, int seconds) {
  engine::Workspace workspace;
  return timed([&] { engine::step(s.world, workspace); }, [&] { return engine::moved(s); },
               seconds);
}

/// The boxes of a structure in Bullet: 10 iterations, margins of 1 mm.
class BulletBoxes {
 public:
  explicit BulletBoxes(const engine::Structure& s) : start_(s.start) {
    world_.setGravity({0, 0, -9.81F});
    add(floor_, 0.0F, Vec3::Zero());
    box_.setMargin(0.001F);
    for (const Vec3& p : s.start) add(box_, 1.0F, p);
  }
  ~BulletBoxes() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step() { world_.stepSimulation(1.0F / 240, 1, 1.0F / 240); }
  double moved() const {
    double most = 0.0;
    for (std::size_t k = 0; k < start_.size(); ++k) {
      const btVector3& p = bodies_[k + 1]->getWorldTransform().getOrigin();
      const Vec3 now(double{p.x()}, double{p.y()}, double{p.z()});
      most = std::max(most, (now - start_[k]).norm());
    }
    return most;
  }

 private:
  void add(btCollisionShape& shape, float mass, const Vec3& p) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0.0F) shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    const auto f = [](double x) { return static_cast<btScalar>(x); };
    info.m_startWorldTransform.setOrigin({f(p.x()), f(p.y()), f(p.z())});
    info.m_friction = 0.7F;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
  }

  std::vector<Vec3> start_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  btStaticPlaneShape floor_{{0, 0, 1}, 0};
  btBoxShape box_{{0.1F, 0.1F, 0.05F}};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

void run(bool quick) {
  std::vector<Row> rows;
  const auto compare = [&](const std::string& name, const Outcome& mine, const std::string& peer,
                           const Outcome& theirs) {
    rows.push_back({name, "us", mine.mean_us, peer, theirs.mean_us});
    rows.push_back(
        {name + ", slowest second", "us", mine.slowest_second_us, peer, theirs.slowest_second_us});
    if (mine.moved_mm < 1e3)
      rows.push_back({name + ", moved", "mm", mine.moved_mm, peer, theirs.moved_mm});
  };
  const int seconds = quick ? 2 : 10;
  compare("arch of nine stones", ours(engine::arch(9, 240), seconds), "rules 3",
          ours(engine::arch(9, 240, 3), seconds));
  compare("card house", ours(engine::card_house(240), seconds), "rules 3",
          ours(engine::card_house(240, 3), seconds));
  const engine::Structure boxes = engine::boxes_on_each_other(20, 240, "coulomb");
  const Outcome stack = ours(boxes, seconds);
  compare("20 boxes", stack, "rules 3",
          ours(engine::boxes_on_each_other(20, 240, "coulomb", 3), seconds));
  BulletBoxes bullet(boxes);
  compare("20 boxes", stack, "Bullet",
          timed([&] { bullet.step(); }, [&] { return bullet.moved(); }, seconds));
  for (const std::string response : {"paper", "coulomb"}) {
    const auto pile = [&](int rules) {
      return ours(engine::skittles_in_a_bin(17, 0.3, response, rules), quick ? 1 : 3);
    };
    compare("bin of 17 skittles, " + response, pile(16), "rules 15", pile(15));
    const auto bin = [&](int rules) {
      return ours(engine::skittles_in_a_bin(quick ? 20 : 100, 0.45, response, rules),
                  quick ? 2 : 6);
    };
    const Outcome mine = bin(16);
    compare("bin of 100 skittles, " + response, mine, "rules 3", bin(3));
    compare("bin of 100 skittles, " + response, mine, "rules 15", bin(15));
  }
  publish("crowds", rows);
}

}  // namespace
}  // namespace headpin::bench

int main(int argc, char** argv) {
  try {
    headpin::bench::run(argc > 1 && std::string(argv[1]) == "--quick");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crowds_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
