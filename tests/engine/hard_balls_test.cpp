// The impacts of a step against a plain simulation of hard balls, from event to event: smooth elastic balls in a
// box, some at rest or asleep, one fixed, one of two parts, one driven.

#include <algorithm>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"

namespace headpin::engine {
namespace {

constexpr double kHalfBox = 0.35, kRadiusOfHard = 0.07;
constexpr Material kHard{1.0, 0.0};

/// A ball; with an inverse mass of 0 its velocity lasts. Of a fixed body of two balls each is one.
struct HardBall {
  BodyId id = 0;
  Vec3 p = Vec3::Zero(), v = Vec3::Zero();
  double inv_mass = 0.0;
};

struct HardWall {
  BodyId id = 0;
  Vec3 inward;
};

struct HardEvent {
  double time = std::numeric_limits<double>::infinity();
  std::size_t a = 0, b = 0;  ///< balls; from their number on, walls
};

/// The events in [0, T] of balls in a box, by steps that are never longer than the way to the next contact.
class HardBalls {
 public:
  std::vector<HardBall> balls;
  std::vector<HardWall> walls;
  Vec3 g = Vec3::Zero();
  double slowest = 1e9;  ///< of the approaches of all events [m/s]
  std::vector<std::pair<BodyId, BodyId>> events;

  void run_for(double seconds) {
    double now = 0.0;
    for (;;) {
      HardEvent next;
      for (std::size_t a = 0; a < balls.size(); ++a) {
        for (std::size_t b = a + 1; b < balls.size() + walls.size(); ++b) {
          const std::optional<double> t = meeting(a, b, std::min(seconds - now, next.time));
          if (t) next = {*t, a, b};
        }
      }
      const double passed = std::min(next.time, seconds - now);
      for (HardBall& ball : balls) {
        ball.p = place(ball, passed);
        ball.v = velocity(ball, passed);
      }
      now += passed;
      if (next.time > passed || now >= seconds) return;
      strike(next);
    }
  }

 private:
  Vec3 place(const HardBall& ball, double t) const {
    return ball.p + t * ball.v + (ball.inv_mass > 0.0 ? 0.5 * t * t : 0.0) * g;
  }
  Vec3 velocity(const HardBall& ball, double t) const {
    return ball.v + (ball.inv_mass > 0.0 ? t : 0.0) * g;
  }
  double inverse(std::size_t k) const { return k < balls.size() ? balls[k].inv_mass : 0.0; }
  Vec3 towards(std::size_t a, std::size_t b, double t) const {
    if (b >= balls.size()) return -walls[b - balls.size()].inward;
    return (place(balls[b], t) - place(balls[a], t)).normalized();
  }
  double gap(std::size_t a, std::size_t b, double t) const {
    if (b >= balls.size()) {
      return kHalfBox + walls[b - balls.size()].inward.dot(place(balls[a], t)) - kRadiusOfHard;
    }
    return (place(balls[b], t) - place(balls[a], t)).norm() - 2.0 * kRadiusOfHard;
  }
  double approach(std::size_t a, std::size_t b, double t) const {
    Vec3 u = velocity(balls[a], t);
    if (b < balls.size()) u -= velocity(balls[b], t);
    return u.dot(towards(a, b, t));
  }
  /// The time before `limit` at which two meet.
  std::optional<double> meeting(std::size_t a, std::size_t b, double limit) const {
    if (inverse(a) == 0.0 && inverse(b) == 0.0) return {};
    double fastest = balls[a].v.norm() + limit * g.norm() + 1e-9;
    if (b < balls.size()) fastest += balls[b].v.norm() + limit * g.norm();
    for (double t = 0.0; t < limit;) {
      const double left = gap(a, b, t);
      if (left < 1e-10 && approach(a, b, t) > 0.0) return t;
      t += std::max(left, 1e-11) / fastest;
    }
    return {};
  }
  void strike(const HardEvent& e) {
    HardBall& a = balls[e.a];
    const Vec3 n = towards(e.a, e.b, 0.0);
    const double speed = approach(e.a, e.b, 0.0);
    slowest = std::min(slowest, speed);
    const double j = 2.0 * speed / (inverse(e.a) + inverse(e.b));
    a.v -= j * inverse(e.a) * n;
    if (e.b < balls.size()) balls[e.b].v += j * inverse(e.b) * n;
    const BodyId other = e.b < balls.size() ? balls[e.b].id : walls[e.b - balls.size()].id;
    events.push_back(std::minmax(a.id, other));
  }
};

/// A box with balls, and the same for the engine.
struct BoxOfBalls {
  struct Options {
    bool gravity = false, spins = false, others = false, paper = false;
    int rate_hz = 20;
  };

  BoxOfBalls(std::uint64_t seed, const Options& options) : random(seed) {
    Parameters p{.rate_hz = options.rate_hz, .gravity_W = Vec3::Zero()};
    if (options.gravity) p.gravity_W = hard.g = Vec3(0.0, 0.3, -0.4);
    p.impact_speed = 0.0;
    if (options.paper) p.query.mode = Query::paper;
    p.keep_ledger = true;
    world = make_world(p);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) add_wall(side * Vec3::Unit(axis));
    }
    if (options.others) add_others();
    for (int k = 0; k < 7; ++k) add_mover(options, k);
  }

  void add_wall(const Vec3& inward) {
    const Pose X_WB{Quat::FromTwoVectors(Vec3::UnitZ(), inward), -kHalfBox * inward};
    hard.walls.push_back({add_body(world, floor_body(kHard), at(X_WB)), inward});
  }

  void add_others() {
    Body two = ball_body(kHard, kRadiusOfHard);
    const Vec3 places[] = {free_place(), free_place()};
    std::vector<Part> parts;
    for (const Vec3& p : places) {
      parts.push_back({Ellipsoid{Vec3::Constant(kRadiusOfHard)}, {Quat::Identity(), p}});
    }
    two.shape = make_compound(parts);
    two.kind = Kind::fixed;
    const BodyId id = add_body(world, two);
    for (const Vec3& p : places) hard.balls.push_back({.id = id, .p = p});
    Body driven = ball_body(kHard, kRadiusOfHard);
    driven.kind = Kind::driven;
    const HardBall d{.p = free_place(), .v = any() * Vec3(1.0, -1.0, 0.5)};
    hard.balls.push_back(d);
    hard.balls.back().id = pusher = add_body(world, driven, at(d.p, d.v));
  }

  void add_mover(const Options& options, int k) {
    HardBall ball{.p = free_place(), .inv_mass = 1.0 / (4.0 + 3.0 * any())};
    if (k % 3 > 0) ball.v = 5.0 * any_vector();
    const Vec3 w = (options.spins ? 20.0 : 0.0) * any_vector();
    ball.id = add_body(world, ball_body(kHard, kRadiusOfHard, 1.0 / ball.inv_mass),
                       at(ball.p, ball.v, ball.v.isZero() ? Vec3::Zero().eval() : w));
    if (k == 3 && !options.gravity) put_to_sleep(world, ball.id);
    hard.balls.push_back(ball);
  }

  double any() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); }
  Vec3 any_vector() {
    const double z = any(), y = any(), x = any();  // in this order with every compiler
    return {x, y, z};
  }
  Vec3 free_place() {
    for (;;) {
      const Vec3 p = (kHalfBox - kRadiusOfHard - 2e-3) * any_vector();
      const bool apart = std::ranges::all_of(hard.balls, [&](const HardBall& b) {
        return (b.p - p).norm() > 2.0 * kRadiusOfHard + 2e-3;
      });
      if (apart) return p;
    }
  }

  /// Whether the driven ball meets one twice: the second time is another law.
  bool squeezes() const {
    std::vector<std::pair<BodyId, BodyId>> all = hard.events;
    std::ranges::sort(all);
    const auto twice = [&](const auto& e) {
      return (e.first == pusher || e.second == pusher) && std::ranges::count(all, e) > 1;
    };
    return std::ranges::any_of(all, twice);
  }

  std::mt19937_64 random;
  World world;
  HardBalls hard;
  BodyId pusher = ~0u;
};

/// The ledger of the step's impacts holds what walls and fixed balls gave, and no energy; that of the hand what
/// was there at the start, and what the driven ball gave.
void expect_booked(const BoxOfBalls& box, const Balance& start) {
  const World& world = box.world;
  Vec3 by_fixed = Vec3::Zero(), turn = Vec3::Zero(), by_driven = Vec3::Zero();
  double work = 0.0;
  for (const ContactEvent& e : world.events) {
    if (world.bodies[e.b].kind == Kind::free) continue;
    if (e.b == box.pusher) {
      by_driven += e.impulse_W;
      work += e.impulse_W.dot(world.states[e.b].v_WB);
    } else {
      by_fixed += e.impulse_W;
      turn += e.p_W.cross(e.impulse_W);
    }
  }
  const Ledger& ledger = world.ledger;
  EXPECT_NEAR((ledger.impact.momentum - by_fixed).norm(), 0.0, 1e-9);
  EXPECT_NEAR((ledger.impact.angular_momentum - turn).norm(), 0.0, 1e-9);
  EXPECT_NEAR(ledger.impact.energy, 0.0, 1e-9);
  EXPECT_NEAR((ledger.hand.momentum - start.momentum - by_driven).norm(), 0.0, 1e-9);
  EXPECT_NEAR(ledger.hand.energy, start.energy + work, 1e-9);
}

/// Steps boxes of these options and compares; gives the number of impacts.
std::size_t compare_boxes(const BoxOfBalls::Options& options, int boxes, double accuracy) {
  std::size_t impacts = 0;
  Workspace w;
  for (int k = 0; k < boxes; ++k) {
    SCOPED_TRACE(k);
    BoxOfBalls box(static_cast<std::uint64_t>(k), options);
    box.hard.run_for(step_seconds(box.world));
    const double slow = options.gravity ? 0.15 : 0.1;
    if (box.hard.slowest < slow || box.squeezes()) continue;
    World& world = box.world;
    const Balance start = balance(world);
    step(world, w);
    std::vector<std::pair<BodyId, BodyId>> events;
    for (const ContactEvent& e : world.events) events.push_back(std::minmax(e.a, e.b));
    EXPECT_EQ(events, box.hard.events);
    EXPECT_EQ(world.statistics.impacts, static_cast<std::int64_t>(events.size()));
    EXPECT_EQ(world.statistics.pulls, 0);
    for (const HardBall& ball : box.hard.balls) {
      if (world.bodies[ball.id].kind == Kind::fixed) continue;
      EXPECT_LT((world.states[ball.id].X_WB.p - ball.p).norm(), 0.1 * accuracy) << ball.id;
      EXPECT_LT((world.states[ball.id].v_WB - ball.v).norm(), accuracy) << ball.id;
    }
    if (!options.gravity) expect_booked(box, start);
    impacts += events.size();
  }
  return impacts;
}

TEST(HardBalls, MeetInTheOrderAndWithTheImpulsesOfAPlainSimulation) {
  EXPECT_GT(compare_boxes({}, 300, 2e-3), 1200u);
}

TEST(HardBalls, MeetLikewiseFixedAndDrivenOnesAndSleepers) {
  EXPECT_GT(compare_boxes({.others = true}, 1000, 3e-3), 5000u);
}

TEST(HardBalls, MeetLikewiseUnderThePapersDetection) {
  EXPECT_GT(compare_boxes({.paper = true}, 50, 1e-2), 200u);
}

TEST(HardBalls, MeetLikewiseThoughTheyTurnFast) {
  EXPECT_GT(compare_boxes({.spins = true, .others = true}, 8, 3e-2), 30u);
}

TEST(HardBalls, MeetLikewiseWhileTheyFall) {
  EXPECT_GT(compare_boxes({.gravity = true}, 40, 1e-3), 150u);
}

}  // namespace
}  // namespace headpin::engine
