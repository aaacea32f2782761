#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scale.h"
#include "tests/support/structures.h"

namespace headpin::engine {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Cylinders 0.1 m high and 0.2 m wide on each other; the masses from below.
struct Stack {
  World world;
  std::vector<BodyId> bodies = {};
};

Stack stack(const std::vector<double>& masses, int rate_hz, std::string_view response) {
  Stack s{make_world({.rate_hz = rate_hz, .response = response, .sleep = false})};
  const Material rough{0.7, 0.7};
  add_body(s.world, floor_body(rough));
  for (std::size_t i = 0; i < masses.size(); ++i) {
    Body body = ball_body(rough, 0.1, masses[i]);
    body.shape = make_compound({{Cylinder{0.1, 0.05}, Pose{}}});
    body.inertia = masses[i] * Vec3(0.0033, 0.0033, 0.005).asDiagonal();
    s.bodies.push_back(
        add_body(s.world, body, at(Vec3(0.0, 0.0, 0.05 + 0.1 * static_cast<double>(i)))));
  }
  return s;
}

/// After ten seconds: how far the uppermost is from where it was put.
double moved(Stack s) {
  const Vec3 start = s.world.states[s.bodies.back()].X_WB.p;
  run(s.world, 10.0);
  return (s.world.states[s.bodies.back()].X_WB.p - start).norm();
}

TEST(Stack, OfTwentyStandsUnderCoulomb) {
  for (const int rate : {60, 240}) {
    if (!kThorough && rate == 240) continue;
    EXPECT_LE(moved(stack(std::vector<double>(20, 1.0), rate, "coulomb")), 2e-3) << rate;
  }
}

TEST(Stack, OfTenStandsUnderThePapersRate) {
  EXPECT_LE(moved(stack(std::vector<double>(10, 1.0), 240, "paper")), 2e-3);
}

TEST(Stack, CarriesAHundredfoldMassUnderCoulomb) {
  for (const int rate : {60, 240}) {
    EXPECT_LE(moved(stack({1.0, 1.0, 1.0, 100.0}, rate, "coulomb")), 1e-2) << rate;
  }
}

/// The impulse that the last step gave a body by its touch with a fixed body whose normal is known.
Vec3 pushed_by(const World& world, BodyId fixed, BodyId body, const Vec3& outward) {
  Vec3 sum = Vec3::Zero();
  for (const PastTouch& touch : world.memory.touches) {
    if (!concerns(touch.key, fixed) || !concerns(touch.key, body)) continue;
    for (std::uint32_t k = 0; k < touch.loads; ++k) {
      sum += world.memory.loads[touch.first_load + k].impulse * outward;
    }
    sum += touch.friction_W;
  }
  return sum;
}

/// At rest the springings carry the weight, and their thrusts are opposite.
void expect_arch_to_stand(double seconds) {
  for (const int rate : {120, 240}) {
    Structure s = arch(9, rate);
    run(s, seconds);
    EXPECT_LE(moved(s), 5e-4) << rate;
    EXPECT_EQ(s.sum.unsolved, 0) << rate;
    double weight = 0.0;
    for (const BodyId i : s.bodies) weight += s.world.bodies[i].mass * 9.81 / rate;
    const Vec3 right = pushed_by(s.world, 0, s.bodies.front(), Vec3::UnitZ());
    const Vec3 left = pushed_by(s.world, 0, s.bodies.back(), Vec3::UnitZ());
    EXPECT_NEAR(right.z() + left.z(), weight, 1e-3 * weight) << rate;
    EXPECT_LT(right.x(), -0.05 * weight) << rate;
    EXPECT_NEAR(left.x(), -right.x(), 1e-3 * weight) << rate;
  }
}

void expect_card_house_to_stand(double seconds) {
  Structure s = card_house(240);
  run(s, seconds);
  EXPECT_LE(moved(s), 5e-4);
  EXPECT_EQ(s.sum.unsolved, 0);
}

TEST(AnArch, StandsAndCarriesItself) {
  expect_arch_to_stand(kThorough ? 30.0 : 5.0);
}

TEST(ACardHouse, OfTwoStoreysStands) {
  expect_card_house_to_stand(kThorough ? 10.0 : 2.0);
}

// These are crowds. At 120 Hz they fall within seconds where passes end at 2.5 % of what gravity adds, not at 1 %.
TEST(ACardHouse, OfThreeOrFiveStoreysStands) {
  for (const int storeys : {3, 5}) {
    Structure s = card_house_of(storeys, 120);
    run(s, 5.0);
    EXPECT_LE(moved(s), 5e-4) << storeys;
    EXPECT_EQ(s.sum.unsolved, 0) << storeys;
  }
}

// Passes go through the contacts in the order of the cards, so their error depends on it. Under rules 16 five of these
// eight houses fell at 120 Hz, counted as solved.
TEST(ACardHouse, OfFiveStoreysStandsInAnyOrderOfItsCards) {
  const Structure house = card_house_of(5, 120);
  for (std::uint32_t seed = 1; seed <= (kThorough ? 8u : 4u); ++seed) {
    Structure s = in_another_order(house, seed);
    run(s, 5.0);
    EXPECT_LE(moved(s), 1e-3) << seed;
    EXPECT_EQ(s.sum.unsolved, 0) << seed;
  }
}

TEST(ArchAndCardHouse, StandForTenMinutes) {
  expect_arch_to_stand(600.0);
  expect_card_house_to_stand(600.0);
}

// Each box is up to 5 mm beside the middle. What stands starts each step from the impulses of the last
// one, and so needs few passes.
TEST(BoxesOnEachOther, StandAndAreSolvedInFewPasses) {
  for (const std::string_view response : {"coulomb", "paper"}) {
    Structure s = boxes_on_each_other(20, 240, response);
    const bool creeps = response == "paper";  // its friction does not hold what leans
    run(s, kThorough && !creeps ? 60.0 : 5.0);
    EXPECT_LE(moved(s), creeps ? 1e-3 : 1e-4) << response;
    EXPECT_EQ(s.sum.unsolved, 0) << response;
    EXPECT_LE(s.sum.solver_iterations, 12 * s.sum.steps) << response;
    const double weight = 20.0 * 9.81 / 240;
    EXPECT_NEAR(pushed_by(s.world, 0, s.bodies[0], Vec3::UnitZ()).z(), weight, 1e-3 * weight);
  }
}

// Poured into a bin they only lose energy, come to rest and fall asleep, and floor and walls carry
// their weight.
TEST(SkittlesInABin, ComeToRest) {
  const double half = 0.3;
  Structure s = skittles_in_a_bin(kThorough ? 40 : 12, half, "coulomb");
  World& world = s.world;
  world.parameters.sleep = true;
  world.parameters.keep_ledger = true;
  Workspace workspace;
  Vec3 carried = Vec3::Zero();
  Statistics sum;
  while (world.tick < 20 * 240) {
    const double before = world.ledger.sustained.energy;
    step(world, workspace);
    ASSERT_LE(world.ledger.sustained.energy - before, 1e-9) << world.tick;
    sum += world.statistics;
    if (world.statistics.awake == 0) break;
    carried = Vec3::Zero();
    for (BodyId fixed = 0; fixed < 5; ++fixed) {
      for (const BodyId i : s.bodies) {
        carried += pushed_by(world, fixed, i, world.states[fixed].X_WB.q * Vec3::UnitZ());
      }
    }
  }
  EXPECT_EQ(world.statistics.awake, 0);
  EXPECT_LE(sum.unsolved * 20, sum.islands);
  const Vec3 weight(0.0, 0.0, static_cast<double>(s.bodies.size()) * 1.5 * 9.81 / 240);
  EXPECT_LE((carried - weight).norm(), 0.02 * weight.z()) << carried.transpose();
  for (const BodyId i : s.bodies) {
    const Vec3& p = world.states[i].X_WB.p;
    EXPECT_TRUE(std::abs(p.x()) < half && std::abs(p.y()) < half && p.z() > 0.0);
  }
}

// A leaning rod touches the floor with its lower end, where its mobility differs by direction. The
// friction at its limit is opposite to the slip that remains.
TEST(Friction, IsOppositeToTheSlip) {
  const Material slippery{0.0, 0.3};
  Random random{11};
  for (int k = 0; k < 50; ++k) {
    World world = make_world({.rate_hz = 240, .response = "coulomb", .sleep = false});
    add_body(world, floor_body(slippery));
    const Quat q = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * kPi), Vec3::UnitZ())) *
                   Quat(Eigen::AngleAxisd(random.uniform(0.4, 1.2), Vec3::UnitY()));
    const Body rod = solid(Ellipsoid{{0.03, 0.03, 0.3}}, slippery);
    const double low = support(Ellipsoid{{0.03, 0.03, 0.3}}, q.conjugate() * Vec3(-Vec3::UnitZ()))
                           .dot(q.conjugate() * Vec3::UnitZ());
    const double heading = random.uniform(0.0, 2.0 * kPi);
    const Vec3 v(2.0 * std::cos(heading), 2.0 * std::sin(heading), 0.0);
    const BodyId i = add_body(world, rod, at(Pose{q, Vec3(0.0, 0.0, -low)}, v));
    step(world);
    const Vec3 F = pushed_by(world, 0, i, Vec3::UnitZ());
    ASSERT_GT(F.z(), 0.0);
    const Vec2 friction = F.head<2>();
    EXPECT_NEAR(friction.norm(), 0.09 * F.z(), 1e-9);
    const Vec3 foot =
        q * support(Ellipsoid{{0.03, 0.03, 0.3}}, q.conjugate() * Vec3(-Vec3::UnitZ()));
    const Vec2 slip = velocity_at(world.states[i], foot).head<2>();
    EXPECT_LE(friction.normalized().dot(slip.normalized()), -1.0 + 1e-6) << k;
  }
}

// Friction 1 binds every contact that presses.
TEST(PerfectlyRoughGame, IsSolvedAtEveryRate) {
  for (const int rate : {60, 240, 1000}) {
    if (!kThorough && rate != 240) continue;
    Statistics sum;
    for (const double offset : {-0.1, -0.08, -0.03, 0.02, 0.06, 0.1}) {
      RackOptions o;
      o.parameters.rate_hz = rate;
      o.material = {0.7, 1.0};
      o.ball_offset = offset;
      Bowling b = bowling(o);
      while (b.world.tick < 5 * rate) {
        step(b.world);
        sum += b.world.statistics;
      }
    }
    EXPECT_GT(sum.islands, 4000) << rate;
    EXPECT_LE(sum.unsolved * 1000, sum.islands) << rate;
    EXPECT_LE(sum.residual, 1e-4) << rate;  // [m/s]; asked for are 1e-6
  }
}

}  // namespace
}  // namespace headpin::engine
