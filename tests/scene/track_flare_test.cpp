// Track flare: the rings of oil on a ball, held against circles and Euler's equations.

#include "scene/play/track_flare.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/looks/looks.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/play/ball_path.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"

namespace headpin::scene {
namespace {

constexpr double kInch = 0.0254;

/// A lane of an alley, with this friction on the oil and on dry boards.
Scenario alley(double oil, double dry) {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/sport-oil.toml");
  scenario.lane.oil.zones = {{1, 39, 0.0, 12.0, oil}};
  scenario.lane.oil.dry = dry;
  return scenario;
}

/// With a symmetrical core, whose pin lies at an angle above the axis of a spin.
Scenario with_core(Scenario scenario, double differential, const Vec3& w_WB,
                   double pin_deg = 45.0) {
  const double pin = pin_deg * std::numbers::pi / 180.0;
  const Vec3 axis = w_WB.normalized();
  scenario.ball.rg = 0.0635;
  scenario.ball.differential = differential;
  scenario.ball.pin = std::cos(pin) * axis + std::sin(pin) * Vec3::UnitZ();
  scenario.ball.mass_bias = axis.cross(Vec3::UnitZ());
  return scenario;
}

/// A ball that was let go, and what is known of its rings.
struct Rolled {
  OilRings rings;
  std::vector<OilRing> all;
  std::vector<double> ends;  ///< of the revolution of each ring [s]
  double most_turn = 0.0;    ///< of the spin's axis in the world, per turn of the ball
};

Rolled roll(const Scenario& scenario, const Vec3& v_WB, const Vec3& w_WB) {
  Stage stage = make_stage(scenario);
  const engine::BodyId ball = stage.balls.front();
  const double r = scenario.ball.radius, dt = engine::step_seconds(stage.world);
  engine::set_kind(stage.world, ball, engine::Kind::free);
  engine::set_state(stage.world, ball, {{Quat::Identity(), Vec3(0.0, 0.1, r)}, v_WB, w_WB});
  Rolled rolled;
  const engine::State& now = stage.world.states[ball];
  while (now.X_WB.p.y() < stage.room.deck_begin() && stage.world.tick < 2400) {
    const Vec3 before = now.w_WB;
    engine::step(stage.world);
    const bool leaves = is_on_lane(r, now) && leaves_rings(stage.room, now.X_WB.p);
    add_contact(rolled.rings, now, leaves, r, dt);
    const double turn = before.cross(now.w_WB).norm() / now.w_WB.squaredNorm();
    if (leaves) rolled.most_turn = std::max(rolled.most_turn, turn / (now.w_WB.norm() * dt));
    if (!rolled.rings.newest) continue;
    rolled.all.push_back(*rolled.rings.newest);
    rolled.ends.push_back(static_cast<double>(stage.world.tick) * dt);
  }
  return rolled;
}

const Vec3 kHooks(-20.0, -20.0, 0.0);  // 270 rpm, 45 degrees of axis rotation

// A ball of even density keeps its spin in itself as long as nothing turns it: rolling, and where there
// is no friction, whatever its tilt.
TEST(TrackFlare, IsNoneOfABallOfEvenDensityThatNothingTurns) {
  const double r = Scenario().ball.radius;
  const Rolled rolls = roll(alley(0.04, 0.2), Vec3(0, 8, 0), Vec3(-8.0 / r, 0.0, 0.0));
  const Rolled spins = roll(alley(0.0, 0.2), Vec3(0, 8, 0), Vec3(-20.0, -20.0, 12.0));
  for (const Rolled* one : {&rolls, &spins}) {
    ASSERT_GT(one->all.size(), 5u);
    EXPECT_LT(one->rings.flare.value(), 1e-9);
  }
  EXPECT_NEAR(rolls.all[3].n_B.cross(Vec3::UnitX()).norm(), 0.0, 1e-9);
  EXPECT_NEAR(rolls.all[3].height, 0.0, 1e-9);
  EXPECT_NEAR(std::abs(spins.all[3].height), 12.0 / Vec3(20, 20, 12).norm(), 1e-9)
      << "as far from the middle as the axis is tilted";
}

// A ball that hooks turns the axis of its spin by a, the share of a turn of its own. Its places bend by
// that share: no ring of it is farther from a great circle.
TEST(TrackFlare, OfABallOfEvenDensityThatHooksIsLessThanItsAxisTurns) {
  const Rolled hooks = roll(alley(0.04, 0.2), Vec3(0, 8, 0), kHooks);
  const double r = Scenario().ball.radius;
  EXPECT_LT(hooks.rings.flare.value(), 2.0 * r * hooks.most_turn);
  EXPECT_LT(hooks.rings.flare.value(), 0.001);
}

// Without friction, Euler's equations in closed form: the axis goes round the pin at a steady rate. A
// ring has the axis of the middle of its revolution.
TEST(TrackFlare, IsAsFarAsTheAxisGoesRoundThePin) {
  const double differential = 0.0013;
  const Vec3 w(-30.0, 0.0, 0.0);
  const Scenario scenario = with_core(alley(0.0, 0.2), differential, w);
  const Rolled spins = roll(scenario, Vec3(0, 8, 0), w);
  ASSERT_GT(spins.all.size(), 4u);
  const double axial = std::pow(0.0635, 2), across = std::pow(0.0635 + differential, 2);
  const double along = w.dot(scenario.ball.pin);
  const double passed = spins.ends.back() - spins.ends.front();
  const double turned = (axial - across) / across * along * passed;
  const Vec3 pin = scenario.ball.pin, aside = w - along * pin;
  const Vec3 later = along * pin + std::cos(turned) * aside + std::sin(turned) * pin.cross(aside);
  const double expected = std::atan2(w.cross(later).norm(), w.dot(later));
  EXPECT_GT(expected, 0.3);
  EXPECT_NEAR(spins.rings.flare.value(), expected * scenario.ball.radius,
              0.03 * expected * scenario.ball.radius)
      << "a revolution is as long as the others but for a tick";
}

TEST(TrackFlare, GrowsWithTheDifferentialAndIsLargestWithThePinAside) {
  std::vector<double> flares;
  for (const double inches : {0.0, 0.01, 0.03, 0.05}) {
    const Scenario scenario = with_core(alley(0.04, 0.2), inches * kInch, kHooks);
    flares.push_back(roll(scenario, Vec3(0, 8, 0), kHooks).rings.flare.value() / kInch);
  }
  for (std::size_t i = 1; i < flares.size(); ++i) EXPECT_GT(flares[i], flares[i - 1] + 0.3) << i;
  const auto of_pin = [&](double pin_deg) {
    const Vec3 w(-28.0, 0.0, 0.0);
    const Scenario scenario = with_core(alley(0.04, 0.2), 0.05 * kInch, w, pin_deg);
    return roll(scenario, Vec3(0, 8, 0), w).rings.flare.value();
  };
  EXPECT_GT(of_pin(45.0), 5.0 * of_pin(0.0)) << "pin on the axis";
  EXPECT_GT(of_pin(45.0), 5.0 * of_pin(90.0)) << "pin in the track";
}

// A ball with a "relatively high" differential has "about seven inches of potential track flare"
// (S. Bailey, The Strike Zone, 1998). Ours has 4.6 in on 12 m of oil, and 6.3 in on 18 m.
TEST(TrackFlare, OfAStrongBallIsOfTheSizeThatIsPublished) {
  const Vec3 w = kHooks.normalized() * 400.0 * 2.0 * std::numbers::pi / 60.0;
  const Scenario oiled = with_core(alley(0.04, 0.2), 0.05 * kInch, w);
  Scenario whole = oiled;
  whole.lane.oil.zones = {{1, 39, 0.0, 18.0, 0.04}};
  const double on_oil = roll(oiled, Vec3(0, 8, 0), w).rings.flare.value() / kInch;
  const double on_lane = roll(whole, Vec3(0, 8, 0), w).rings.flare.value() / kInch;
  RecordProperty("flare_in_on_oil", std::to_string(on_oil));
  RecordProperty("flare_in_on_lane", std::to_string(on_lane));
  EXPECT_NEAR(on_oil, 5.0, 2.0);
  EXPECT_NEAR(on_lane, 7.0, 2.0);
}

TEST(TrackFlare, BetweenRingsIsTheAngleOfTheirAxesAndOfTheirOpenings) {
  const double r = 0.1, a = 0.3;
  const OilRing great{Vec3::UnitZ(), 0.0}, turned{Vec3(std::sin(a), 0.0, std::cos(a)), 0.0};
  const OilRing small{Vec3::UnitZ(), std::sin(0.2)};
  EXPECT_NEAR(rings_apart(great, turned, r), r * a, 1e-12);
  EXPECT_NEAR(rings_apart(great, small, r), r * 0.2, 1e-12);
  EXPECT_NEAR(rings_apart(small, turned, r), r * (a + 0.2), 1e-12);
  EXPECT_EQ(rings_apart(small, small, r), 0.0);
}

TEST(TrackFlare, CountsWhereOilIsAndOnALaneWithoutOilTheWholeLane) {
  const RoomMeasures oiled = room_measures(alley(0.04, 0.2));
  EXPECT_TRUE(leaves_rings(oiled, Vec3(0.0, 6.0, 0.1)));
  EXPECT_FALSE(leaves_rings(oiled, Vec3(0.0, 12.5, 0.1)));
  Scenario dry = alley(0.04, 0.2);
  dry.lane.oil.zones.clear();
  EXPECT_TRUE(leaves_rings(room_measures(dry), Vec3(0.0, 12.5, 0.1)));
  EXPECT_FALSE(leaves_rings(room_measures(dry), Vec3(0.0, -0.5, 0.1)));
  EXPECT_FALSE(leaves_rings(room_measures(dry), Vec3(0.6, 6.0, 0.1)));
}

/// A session whose ball has these rings.
Session ringed(bool shown) {
  Scenario scenario;
  scenario.ball.rings = shown;
  Session session = make_session(scenario);
  session.game.ringed =
      RingedBall{session.stage->balls.front(), {{Vec3::UnitX(), 0.0}, {Vec3::UnitY(), 0.3}}};
  return session;
}

// Every place of a ring that is drawn lies on the ball, at the ring's height.
TEST(TrackFlare, IsDrawnOnTheBall) {
  const Session session = ringed(true);
  const render::Mesh ring = oil_ring_mesh();
  int meshes = 0;
  const Looks looks(MeshKeeper{[&](const render::Mesh&) { return meshes++; }}, *session.stage);
  ASSERT_TRUE(looks.oil_ring);
  const Glimpse g = glimpse(session, {});
  const render::DrawList list = draw_list(looks, g);
  const Pose X_WB = session.world.states[session.stage->balls.front()].X_WB;
  int drawn = 0;
  for (const render::DrawItem& item : list.items) {
    if (item.mesh != *looks.oil_ring) continue;
    const OilRing& of = session.game.ringed->rings[static_cast<std::size_t>(drawn++)];
    EXPECT_EQ(item.id, kFirstBallId);
    for (const render::Vertex& v : ring.vertices) {
      const Vec3 p_B = X_WB.inverse() * (item.X_WG * v.p.cast<double>().cwiseProduct(item.scale));
      EXPECT_NEAR(p_B.norm(), session.scenario().ball.radius, 0.003);
      EXPECT_NEAR(p_B.dot(of.n_B), of.height * session.scenario().ball.radius, 0.002);
    }
  }
  EXPECT_EQ(drawn, 2);
}

TEST(TrackFlare, IsNotDrawnUnlessAsked) {
  const Session session = ringed(false);
  int meshes = 0;
  const Looks looks(MeshKeeper{[&](const render::Mesh&) { return meshes++; }}, *session.stage);
  EXPECT_FALSE(looks.oil_ring);
  const std::size_t items = draw_list(looks, glimpse(session, {})).items.size();
  EXPECT_EQ(items, draw_list(looks, glimpse(make_session(Scenario()), {})).items.size());
}

// The bounds of an area of oil are those of its friction: the low ones are in it, the high ones are not.
TEST(TrackFlare, CountsWithinTheBoundsOfOilThatIsMoreSlipperyThanTheLane) {
  RoomMeasures room;
  room.dry = 0.2;
  room.oil = {{Vec2(-0.3, 1.0), Vec2(0.2, 4.0), 0.04}, {Vec2(-0.3, 4.0), Vec2(0.2, 5.0), 0.2}};
  for (const Vec2& p : {Vec2(0.0, 2.0), Vec2(-0.3, 2.0), Vec2(0.0, 1.0)}) {
    EXPECT_TRUE(leaves_rings(room, Vec3(p.x(), p.y(), 0.1))) << p.transpose();
  }
  for (const Vec2& p : {Vec2(-0.4, 2.0), Vec2(0.2, 2.0), Vec2(0.3, 2.0), Vec2(0.0, 0.5),
                        Vec2(0.0, 4.0), Vec2(0.0, 4.5), Vec2(0.0, 5.5)}) {
    EXPECT_FALSE(leaves_rings(room, Vec3(p.x(), p.y(), 0.1))) << p.transpose();
  }
  room.oil.clear();
  for (const double x : {-0.55, -0.5, 0.5, 0.55}) {
    EXPECT_EQ(leaves_rings(room, Vec3(x, 2.0, 0.1)), std::abs(x) < 0.527) << x;
  }
}

// It touches the lane with one point of it.
TEST(TrackFlare, HasNoRingOfABallThatSpinsOnThePointWhereItStands) {
  OilRings rings;
  engine::State spins;
  spins.w_WB = Vec3(0.0, 0.0, 20.0);
  for (int i = 0; i < 240; ++i) {
    add_contact(rings, spins, true, 0.1, 1.0 / 240.0);
    EXPECT_FALSE(rings.newest) << i;
  }
  EXPECT_FALSE(rings.first || rings.flare);
  EXPECT_LT(rings.turned, 2.0 * std::numbers::pi) << "each turn of it begins anew";
}

}  // namespace
}  // namespace headpin::scene
