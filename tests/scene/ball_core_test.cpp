// The core of a ball: its inertia, and how it turns by it.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/stage/bodies.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"
#include "tests/scene/refusal.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

Scenario with_core(double rg, double differential, double intermediate) {
  Scenario scenario;
  scenario.ball.rg = rg;
  scenario.ball.differential = differential;
  scenario.ball.intermediate = intermediate;
  return scenario;
}

TEST(BallCore, HasItsRadiiOfGyrationAboutPinAndMassBias) {
  Scenario scenario = with_core(0.0635, 0.0012, 0.0004);
  scenario.ball.pin = Vec3(0.6, 0.0, 0.3);
  scenario.ball.mass_bias = Vec3(0.2, 1.0, 0.1);
  const engine::Body body = ball_body(scenario);
  const Vec3 pin = scenario.ball.pin.normalized();
  const Vec3 across = pin.cross(scenario.ball.mass_bias).normalized(), bias = across.cross(pin);
  const auto radius = [&](const Vec3& axis) {
    return std::sqrt(axis.dot(body.inertia * axis) / scenario.ball.mass);
  };
  EXPECT_NEAR(radius(pin), 0.0635, 1e-12);
  EXPECT_NEAR(radius(across), 0.0647, 1e-12);
  EXPECT_NEAR(radius(bias), 0.0643, 1e-12);
  EXPECT_NEAR((body.inertia - body.inertia.transpose()).norm(), 0.0, 1e-15);
}

TEST(BallCore, IsOfEvenDensityUnlessSaid) {
  const Scenario scenario;
  const double inertia = 0.4 * scenario.ball.mass * scenario.ball.radius * scenario.ball.radius;
  EXPECT_EQ(ball_body(scenario).inertia, Mat3(Vec3::Constant(inertia).asDiagonal()));
}

// Euler's equations in closed form: in a symmetric ball that flies, the axis of its spin goes round
// the pin at (I_pin - I) / I times the spin about the pin. It is what makes the track flare.
TEST(BallCore, LetsTheSpinGoRoundThePinAsEulersEquations) {
  Scenario scenario = with_core(0.0635, 0.0013, 0.0);
  scenario.collision.gravity = 0.0;
  scenario.collision.sleep = false;
  Stage stage = make_stage(scenario);
  const engine::BodyId ball = stage.balls.front();
  engine::State state;
  state.X_WB.p = Vec3(0.0, 2.0, 1.5);
  state.w_WB = Vec3(30.0, 0.0, 25.0);  // the pin is along z
  engine::set_kind(stage.world, ball, engine::Kind::free);
  engine::set_state(stage.world, ball, state);
  const double axial = 0.0635 * 0.0635, across = 0.0648 * 0.0648;
  const double rate = (axial - across) / across * 25.0;
  const int ticks = 2 * stage.world.parameters.rate_hz;
  for (int k = 0; k < ticks; ++k) engine::step(stage.world);
  const engine::State& end = stage.world.states[ball];
  const Vec3 w_B = end.X_WB.q.conjugate() * end.w_WB;
  EXPECT_NEAR(w_B.x(), 30.0 * std::cos(2.0 * rate), 1e-3);
  EXPECT_NEAR(w_B.y(), 30.0 * std::sin(2.0 * rate), 1e-3);
  EXPECT_NEAR(w_B.z(), 25.0, 1e-3);
}

TEST(BallCore, IsOneThatABallCanHave) {
  EXPECT_EQ(refusal("[ball]\nrg = 0.0635\ndifferential = 0.0012\nintermediate = 0.0004"), "");
  EXPECT_EQ(refusal("[ball]\n\ndifferential = 0.001"),
            "lane.toml:3: ball.rg must be above 0 where the ball has a differential, found 0");
  EXPECT_THAT(refusal("[ball]\nrg = 0.2"), HasSubstr("lane.toml:2: ball.rg must be less than"));
  EXPECT_THAT(refusal("[ball]\nrg = 0.108"), HasSubstr("at most 0.08859 about all axes"));
  EXPECT_THAT(refusal("[ball]\nrg = 0.06\ndifferential = 0.1"),
              HasSubstr("must be of matter inside the ball"));
  EXPECT_THAT(refusal("[ball]\nrg = 0.05\ndifferential = 0.05\nintermediate = 0.05"),
              HasSubstr("no moment of inertia above the sum of the two others; found radii of "
                        "gyration of 0.05, 0.05 and 0.1"));
  EXPECT_EQ(refusal("[ball]\nrg = 0.06\nintermediate = 0.001"),
            "lane.toml:3: ball.intermediate must be at most ball.differential, 0; found 0.001");
  EXPECT_THAT(refusal("[ball]\nrg = 0.06\npin = [0, 0, 0]"),
              HasSubstr("lane.toml:3: ball.pin must"));
  EXPECT_EQ(refusal("[ball]\nrg = 0.06\nmass_bias = [0, 0, -1]"),
            "lane.toml:3: ball.mass_bias must be another direction than ball.pin, found the same");
}

}  // namespace
}  // namespace headpin::scene
