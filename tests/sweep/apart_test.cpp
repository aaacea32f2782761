// What the eyes can tell apart: against angles, bounces and times that are worked out here.

#include "sweep/apart.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/watch/recorded.h"
#include "sweep/result.h"
#include "sweep/runner.h"
#include "sweep/thresholds.h"
#include "tests/support/folder.h"
#include "tests/support/hand_script.h"

namespace headpin::sweep {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kArcmin = std::numbers::pi / 180.0 / 60.0;

/// A head that looks down the lane and a little down, or back to the wall.
Pose looking(bool back) {
  const Vec3 z = (back ? Vec3(0.0, -1.0, 0.0) : Vec3(0.0, -1.0, 0.15)).normalized() *
                 (back ? -1.0 : 1.0);  // against the view
  const Vec3 x = Vec3::UnitZ().cross(z).normalized();
  Eigen::Matrix3d R_WD;
  R_WD << x, z.cross(x), z;
  return {Quat(R_WD), Vec3(0.0, -1.0, 1.7)};
}

/// The same motion with a head that stays at a pose.
std::vector<devices::Sample> with_head(const scene::Scenario& scenario,
                                       const std::vector<devices::Sample>& hand, const Pose& X_WD) {
  devices::TrackerSample head;
  head.station = devices::kHeadStation;
  head.X_TS = scenario.rig.X_WT.inverse() * X_WD * scenario.rig.X_SD.inverse();
  std::vector<devices::Sample> samples;
  for (const devices::Sample& sample : hand) {
    if (std::holds_alternative<devices::TrackerSample>(sample)) {
      head.device_time = devices::device_time(sample);
      ++head.sequence;
      samples.emplace_back(head);
    }
    samples.push_back(sample);
  }
  return samples;
}

/// A session, stepped with its own copy of the samples.
struct Played {
  scene::Session session;
  devices::ReplaySource source;

  Played(const scene::Scenario& scenario, const std::vector<devices::Sample>& samples)
      : session(scene::make_session(scenario)), source(samples) {}
  void advance() { scene::advance(session, source); }
};

/// Lets the ball fall from so high over the lane, in view of the player.
scene::HandScript dropped(const scene::Scenario& scenario, double height) {
  scene::HandScript hand(scenario);
  hand.stay(scenario.ball.home, 0.3);
  hand.trigger(true);
  hand.stay(scenario.ball.home, 0.2);
  hand.stay(Vec3(0.0, 3.5, scenario.ball.radius + height), 0.6);
  hand.trigger(false);
  hand.stay(Vec3(0.0, 3.5, scenario.ball.radius + height), 0.1);
  hand.stay(Vec3(-1.2, -1.0, 1.0), 2.0);
  return hand;
}

scene::Scenario with_elasticity(double e) {
  scene::Scenario scenario;
  scenario.material.ball.elasticity = scenario.material.lane.elasticity = e;
  return scenario;
}

/// Both sessions side by side, until a time [s].
void watch(Apart& apart, Played& a, Played& b, double until = 3.0) {
  while (seconds(a.session.now()) < until) {
    a.advance();
    b.advance();
    apart.tick(a.session, b.session);
  }
}

TEST(Apart, AnglesAreThoseOfTrigonometry) {
  const Vec3 eye(0.1, -0.4, 1.7);
  for (const double arcmin : {1e-6, 0.02, 1.0, 12.5, 900.0, 10'000.0}) {
    const double angle = arcmin * kArcmin;
    const Vec3 a = eye + Vec3(0.0, 7.0, 0.0);
    const Vec3 b = eye + 5.0 * Vec3(std::sin(angle), std::cos(angle), 0.0);
    EXPECT_NEAR(arcmin_between(eye, a, b), arcmin, 1e-9 * std::max(1.0, arcmin));
  }
  const Vec3 ahead = eye + Vec3(0.0, 3.0, 0.0), right = eye + Vec3(3.0, 3.0, 0.0);
  EXPECT_NEAR(arcmin_between(eye, Place{ahead, ahead}, Place{ahead, right}), 45.0 * 60.0, 1e-9);
}

// A ball that falls comes up again to e^2 of the height, and the restitution is what is told apart.
TEST(Apart, TheBounceOfABallIsThatOfItsElasticity) {
  const scene::Scenario high = with_elasticity(0.9), low = with_elasticity(0.8);
  const auto samples = with_head(high, dropped(high, 0.8).samples, looking(false));
  Played a(high, samples), b(low, samples);
  Apart apart(a.session, b.session);
  std::array<double, 2> largest{};
  double first = 0.0;
  while (seconds(a.session.now()) < 3.0) {
    a.advance();
    b.advance();
    apart.tick(a.session, b.session);
    // Every fourth tick is a frame of the display.
    if (a.session.tick % 4 != 0) continue;
    const Pose X_WD = looking(false);
    const engine::BodyId ball = a.session.stage->balls.front();
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Vec3 p = X_WD * Vec3(eye == 0 ? -0.032 : 0.032, 0.0, 0.0);
      const Vec3 to_a = (a.session.world.states[ball].X_WB.p - p).normalized();
      const Vec3 to_b = (b.session.world.states[ball].X_WB.p - p).normalized();
      const double arcmin = 2.0 * std::asin(0.5 * (to_a - to_b).norm()) / kArcmin;
      largest[eye] = std::max(largest[eye], arcmin);
      if (arcmin > 12.5 && first == 0.0) first = seconds(a.session.now());
    }
  }
  const BodyApart& ball = apart.bodies().front();
  ASSERT_TRUE(ball.bounce);
  const double e_a = 0.9 * 0.9, e_b = 0.8 * 0.8;  // those of a pair multiply
  EXPECT_NEAR(ball.bounce->a, e_a * e_a * 0.8, 0.001);
  EXPECT_NEAR(ball.bounce->b, e_b * e_b * 0.8, 0.001);
  EXPECT_NEAR(ball.bounce->size, (e_a - e_b) / e_a, 0.01);
  EXPECT_NEAR(ball.bounce->times, (e_a - e_b) / e_a / 0.10, 0.1);
  EXPECT_NEAR(ball.arcmin[0], largest[0], 1e-6 * largest[0]);
  EXPECT_NEAR(ball.arcmin[1], largest[1], 1e-6 * largest[1]);
  EXPECT_GT(largest[0], 100.0);
  EXPECT_EQ(apart.limit_arcmin(), 12.5);  // 75 degrees over 360 pixels
  EXPECT_NEAR(ball.place.times, std::max(largest[0], largest[1]) / 12.5, 1e-4);
  ASSERT_TRUE(ball.place.first);
  EXPECT_NEAR(seconds(*ball.place.first), first, 1e-6);
  EXPECT_LT(ball.off_view_deg, 40.0);
  ASSERT_TRUE(ball.speed);
  EXPECT_GT(ball.speed->times, 1.0);
  const std::vector<std::string> told = in_sentences(apart);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_THAT(told[0], StartsWith("First, from "));
  EXPECT_THAT(told[0], HasSubstr("the ball's"));
}

TEST(Apart, OneSessionDoesNotDifferFromItself) {
  const scene::Scenario scenario;
  const auto samples = with_head(scenario, dropped(scenario, 0.5).samples, looking(false));
  Played a(scenario, samples), b(scenario, samples);
  Apart apart(a.session, b.session);
  watch(apart, a, b);
  EXPECT_GT(apart.frames(), 150);
  EXPECT_THAT(in_sentences(apart), testing::ElementsAre("Nothing differs."));
}

// In the bundled throw, skittles that an elastic ball strikes are away when the others still turn in view:
// no threshold was measured for what is so slow.
TEST(Apart, ASpeedCountsOnlyWhereBothAreInTheRangeOfItsThreshold) {
  const scene::Recorded demo = scene::load_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  const auto samples = scene::read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog").samples;
  scene::Scenario elastic = demo.scenario;
  scene::set_elasticity(elastic, 1.0);
  Played a(demo.scenario, samples), b(elastic, samples);
  Apart apart(a.session, b.session);
  watch(apart, a, b, 7.0);
  ASSERT_TRUE(apart.bodies().front().speed);  // of the ball
  for (const BodyApart& body : apart.bodies()) {
    if (!body.speed) continue;
    EXPECT_GE(std::min(body.speed->a, body.speed->b), kSlowest) << body.body;
    EXPECT_LE(std::max(body.speed->a, body.speed->b), kFastest) << body.body;
  }
}

TEST(Apart, WhatTheHeadDoesNotSeeIsNotTold) {
  const scene::Scenario high = with_elasticity(0.9), low = with_elasticity(0.3);
  const auto samples = with_head(high, dropped(high, 0.8).samples, looking(true));
  Played a(high, samples), b(low, samples);
  Apart apart(a.session, b.session);
  watch(apart, a, b);
  EXPECT_EQ(apart.bodies().front().place.size, 0.0);
  EXPECT_FALSE(apart.bodies().front().speed);
  EXPECT_FALSE(apart.bodies().front().bounce);
  EXPECT_THAT(in_sentences(apart), testing::ElementsAre("Nothing differs."));
}

TEST(Apart, TheFirstContactIsWhenTheFirstSkittleIsStruck) {
  const scene::Scenario scenario;
  scene::HandScript fast(scenario);
  fast.throw_from(0.0, 6.0, 3.0);
  scene::Scenario slow = scenario;
  slow.material.lane.friction = 0.0;
  const auto samples = with_head(scenario, fast.samples, looking(false));
  Played a(scenario, samples), b(slow, samples);
  Apart apart(a.session, b.session);
  std::array<std::optional<Time>, 2> struck;
  while (seconds(a.session.now()) < 4.0) {
    a.advance();
    b.advance();
    apart.tick(a.session, b.session);
    for (const auto& [session, when] :
         {std::pair(&a.session, &struck[0]), {&b.session, &struck[1]}}) {
      for (const scene::Event& event : session->events) {
        if (event.kind == scene::kind::first_contact && !*when) *when = event.time;
      }
    }
  }
  ASSERT_TRUE(struck[0] && struck[1]);
  const BodyApart& ball = apart.bodies().front();
  ASSERT_TRUE(ball.contact);
  EXPECT_EQ(ball.contact->a, nearest_seconds(*struck[0]));
  EXPECT_EQ(ball.contact->b, nearest_seconds(*struck[1]));
  EXPECT_NEAR(ball.contact->size, 1e3 * std::abs(seconds(*struck[0] - *struck[1])), 1e-9);
  EXPECT_GT(ball.contact->size, 0.0);
}

TEST(Apart, RefusesOtherBodiesRatesAndHeads) {
  const scene::Scenario scenario;
  const auto hand = dropped(scenario, 0.5).samples;
  Played a(scenario, with_head(scenario, hand, looking(false)));
  scene::Scenario faster = scenario;
  faster.rates.physics_hz = 480;
  Played other(faster, hand);
  EXPECT_THAT(complaint([&] { Apart(a.session, other.session); }),
              HasSubstr("another trial: has rates.physics_hz = 480, one trial has 240; expected"));
  scene::Scenario fewer = scenario;
  fewer.rack.spots.resize(3);
  Played few(fewer, hand);
  EXPECT_EQ(complaint([&] {
              Apart(a.session, few.session, {}, {"a.lcmlog", "b.lcmlog"});
            }),
            "b.lcmlog: has 3 skittles, a.lcmlog has 10; expected the same balls and skittles");
  scene::Scenario narrow = scenario;
  narrow.hmd.optics.horizontal_fov_deg = 20.0;
  Played other_display(narrow, hand);
  EXPECT_THAT(
      complaint([&] { Apart(a.session, other_display.session); }),
      HasSubstr("another trial: has hmd.horizontal_fov_deg = 20, one trial has 75; expected "
                "the same display"));
  Played turned(scenario, with_head(scenario, hand, looking(true)));
  Apart apart(a.session, turned.session, {}, {"a.lcmlog", "b.lcmlog"});
  EXPECT_THAT(complaint([&] {
                for (int i = 0; i < 40; ++i) {
                  a.advance();
                  turned.advance();
                  apart.tick(a.session, turned.session);
                }
              }),
              StartsWith("a.lcmlog and b.lcmlog: their heads are at different places at "));
}

// The recorded condition is 0 from itself; of the other one a skittle in the middle of the view differs most.
TEST(Apart, ARowOfASweepTellsHowFarItIsFromItsTrial) {
  const std::string path = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  const std::vector<Trial> trials = {read_trial(path)};
  const Rows rows(parse_design("trials = ['" + path + "']\n[grid]\nshape = ['true', 'ellipsoid']\n",
                               "sweep.toml"),
                  {trials[0].sha256});
  Runner runner(rows, trials);
  const auto cell = [&](std::int64_t number) {
    const std::vector<std::string> names = columns_of(rows);
    const auto column =
        std::ranges::find(result_columns(), std::string_view("apart_arcmin"),
                          [](const ResultColumn& c) { return std::string_view(c.name); });
    const std::vector<std::string> cells = runner.run(rows.at(number), [] {});
    return cells[names.size() + static_cast<std::size_t>(column - result_columns().begin())];
  };
  EXPECT_EQ(cell(0), "0");
  scene::Scenario ellipsoid = trials[0].scenario;
  ellipsoid.collision.shape = scene::SkittleShape::ellipsoid;
  Played a(trials[0].scenario, trials[0].samples), b(ellipsoid, trials[0].samples);
  Apart apart(a.session, b.session);
  while (seconds(a.session.now()) < 7.0) {
    a.advance();
    b.advance();
    apart.tick(a.session, b.session);
  }
  double most = 0.0;
  for (const BodyApart& body : apart.bodies()) most = std::max(most, body.place.size);
  EXPECT_GT(most, 100.0);
  EXPECT_NEAR(std::stod(cell(1)), most, 1e-9 * most);
}

// docs/guides/apart.md has each threshold with its source.
TEST(Apart, ThresholdsAreThoseOfTheGuide) {
  const std::string page = slurp(HEADPIN_SOURCE_DIR "/docs/guides/apart.md");
  for (const Threshold& one : kThresholds) {
    const std::string unit = one.unit.empty() ? "" : fmt::format(" {}", one.unit);
    EXPECT_THAT(page, HasSubstr(fmt::format("| {} | {}{} | {} | {} | {} |", one.name, one.value,
                                            unit, one.quantity, one.source, one.read_in)));
  }
}

// Without elasticity the bundled ball does not bounce; later it rides over a fallen skittle and comes down.
TEST(Apart, TheFirstLandingDecidesWhetherABallBounces) {
  const std::string path = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  const scene::Scenario scenario = scene::load_trial(path).scenario;
  const auto samples = scene::read_trial(path).samples;
  scene::Scenario dull = scenario;
  scene::set_elasticity(dull, 0.0);
  Played a(scenario, samples), b(dull, samples);
  Apart apart(a.session, b.session);
  watch(apart, a, b, 6.0);
  const BodyApart& ball = apart.bodies().front();
  ASSERT_TRUE(ball.bounce);
  EXPECT_NEAR(ball.bounce->a, 0.2195, 0.001);
  EXPECT_EQ(ball.bounce->b, 0.0);
  EXPECT_EQ(ball.bounce->size, 1.0);
  Played c(dull, samples), d(scenario, samples);
  Apart turned(c.session, d.session);
  watch(turned, c, d, 6.0);
  EXPECT_FALSE(turned.bodies().front().bounce);  // of a bounce of 0 there is no share
  EXPECT_GT(turned.bodies().front().place.times, 1.0);
}

// The display hangs beside the eyes: it has no pixel of what the ball does.
TEST(Apart, ContactsThatNoPixelShowsAreNotTold) {
  const std::string path = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  scene::Scenario scenario = scene::load_trial(path).scenario;
  scenario.rig.X_SD = Pose{Quat(0.5, 0.5, 0.5, 0.5), Vec3(0.1, 0.0, 0.12)};
  const auto samples = scene::read_trial(path).samples;
  scene::Scenario elastic = scenario;
  scene::set_elasticity(elastic, 1.0);
  Played a(scenario, samples), b(elastic, samples);
  Apart apart(a.session, b.session);
  watch(apart, a, b, 7.0);
  for (const BodyApart& body : apart.bodies()) {
    EXPECT_FALSE(body.contact) << body.body;
    EXPECT_FALSE(body.bounce) << body.body;
  }
  EXPECT_THAT(in_sentences(apart), testing::ElementsAre("Nothing differs."));
}

// It is parked behind the wall, which is no place that anybody could see it move to.
TEST(Apart, ASkittleThatWasSweptAwayHasNoPlace) {
  const scene::Scenario scenario;
  const auto samples = with_head(scenario, dropped(scenario, 0.5).samples, looking(false));
  Played a(scenario, samples), b(scenario, samples);
  const engine::BodyId skittle = a.session.stage->skittles.front();
  a.session.game.swept[skittle] = 1;
  a.session.world.states[skittle].X_WB.p.y() = scenario.room.ahead + 1.0;
  Apart apart(a.session, b.session);
  watch(apart, a, b, 1.0);
  EXPECT_GT(apart.frames(), 30);
  EXPECT_FALSE(places_of(a.session).of[1]);
  EXPECT_TRUE(places_of(b.session).of[1]);
  EXPECT_EQ(apart.bodies()[1].place.size, 0.0);
  EXPECT_EQ(arcmin_in_view(a.session, places_of(b.session)), 0.0);
  Places others = places_of(a.session);
  others.balls = 2;
  others.of.pop_back();
  others.of.push_back(others.of.front());
  EXPECT_FALSE(arcmin_in_view(a.session, others));  // as many bodies, but not the same ones
}

// Bodies alone were compared, and skittles that are drawn 43 mm apart did not differ.
TEST(Apart, SkittlesThatAreDrawnOtherwiseAreSaid) {
  const auto told = [](const scene::Scenario& of_a, const scene::Scenario& of_b) {
    const auto samples = with_head(of_a, dropped(of_a, 0.5).samples, looking(false));
    Played a(of_a, samples), b(of_b, samples);
    Apart apart(a.session, b.session);
    watch(apart, a, b, 0.2);
    return in_sentences(apart);
  };
  scene::Scenario high;
  scene::set_shape(high, scene::SkittleShape::ellipsoid);
  high.skittle.seen = scene::SeenSkittle::collider;
  scene::Scenario low = high, profile = high;
  low.collision.rules = 12;
  profile.skittle.seen = scene::SeenSkittle::profile;
  const double centre = scene::make_session(low).stage->skittle_centre;
  const double higher_mm = 1e3 * (0.5 * low.skittle.height - centre);
  const std::string nothing = "No place, speed, contact or bounce differs.";
  EXPECT_THAT(
      told(low, high),
      testing::ElementsAre(
          nothing, fmt::format("Skittles are drawn {:.3g} mm higher in the second, which is not "
                               "compared.",
                               higher_mm)));
  EXPECT_THAT(told(high, low), testing::Contains(HasSubstr("mm lower in the second")));
  EXPECT_THAT(
      told(high, profile),
      testing::ElementsAre(nothing, "Skittles are drawn in another shape, which is not compared."));
  EXPECT_THAT(told(high, high), testing::ElementsAre("Nothing differs."));
}

// Balls that end in other places are thousands of arcmin apart: the table had 7.28e+03.
TEST(Apart, NumbersHaveNoExponents) {
  EXPECT_EQ(in_digits(7283.4, 3), "7283");
  EXPECT_EQ(in_digits(999.6, 3), "1000");
  EXPECT_EQ(in_digits(637.7, 3), "638");
  EXPECT_EQ(in_digits(69.25, 3), "69.2");
  EXPECT_EQ(in_digits(130.2, 2), "130");
  EXPECT_EQ(in_digits(0.0631, 2), "0.063");
  EXPECT_EQ(in_digits(2.0, 2), "2");
  EXPECT_EQ(in_digits(3e-7, 3), "<0.001");
  EXPECT_EQ(in_digits(0.0, 3), "0");
  EXPECT_EQ(times_in_words(99.7), "100");
  EXPECT_EQ(times_in_words(0.0052), "less than 0.01");
}

// Its pixel was that of the field of view, which the edges of the picture override.
TEST(Apart, APictureGivenByItsEdgesHasTheirPixels) {
  scene::Scenario by_edges, by_fields;
  render::Optics& edges = by_edges.hmd.optics;
  edges.outer_deg = edges.inner_deg = 10.0;
  edges.up_deg = edges.down_deg = 8.0;
  by_fields.hmd.optics.horizontal_fov_deg = 20.0;
  by_fields.hmd.optics.vertical_fov_deg = 16.0;
  const auto samples = dropped(by_edges, 0.5).samples;
  const Played a(by_edges, samples), b(by_fields, samples);
  EXPECT_DOUBLE_EQ(Apart(b.session, b.session).pixel_arcmin(), 4.0);
  EXPECT_DOUBLE_EQ(Apart(a.session, a.session).pixel_arcmin(), 4.0);
  EXPECT_DOUBLE_EQ(Apart(a.session, b.session).limit_arcmin(), 4.0) << "it is the same display";
  edges.up_deg = 9.0;
  const Played taller(by_edges, samples);
  EXPECT_THAT(complaint([&] { Apart(a.session, taller.session); }),
              HasSubstr("another trial: has hmd.up_deg = 9, one trial has 8; expected the same"));
}

}  // namespace
}  // namespace headpin::sweep
