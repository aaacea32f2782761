#include "scene/page/page_session.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/page/browser_device.h"
#include "scene/page/play_page.h"
#include "scene/play/run.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "scene/watch/verifier.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kTakes = 0.5, kSwings = 1.0, kLetsGo = 1.4, kEnds = 4.0;  // [s]

PageSession::Options options_of(const std::string& device, bool left_hand = false) {
  PageSession::Options options;
  options.device = device;
  options.left_hand = left_hand;
  options.participant = "P07";
  return options;
}

/// Where the ball's centre shall be: on its stand, then on a way along the lane that speeds up.
Vec3 wanted_ball(const Scenario& scenario, double time) {
  const double s = std::max(0.0, time - kSwings);
  const Vec3& home = scenario.ball.home;
  const double to_lane = std::min(1.0, s / 0.3);
  return {(1.0 - to_lane) * home.x(), home.y() + 8.0 * s * s, home.z() - 0.6 * to_lane};
}

devices::TrackerSample sample(std::int32_t station, Time time, const Pose& X_TS) {
  devices::TrackerSample s;
  s.station = station;
  s.device_time = s.host_time = time;
  s.X_TS = X_TS;
  return s;
}

/// Throws the ball with samples of both stations at 60 Hz, which a device that predicts tells before
/// their time. The hand's axes are those of the world.
void throw_ball(PageSession& session, const Scenario& played) {
  const Rig& rig = played.rig;
  const Pose X_TW = rig.X_WT.inverse();
  bool pressed = false;
  for (std::int64_t frame = 0; frame <= static_cast<std::int64_t>(60 * kEnds); ++frame) {
    const double t = static_cast<double>(frame) / 60.0;
    const Time now = microseconds(t);
    const auto take = [&](std::int64_t station, const Pose& X_TS) {
      devices::TrackerSample s =
          sample(static_cast<std::int32_t>(station), now + microseconds(rig.predicted_s), X_TS);
      s.host_time = s.sent_time = now;
      session.take(s);
    };
    const Pose X_WD{rotation(Vec3(0.5 * M_PI, 0.0, 0.0)), rig.X_WT.p + Vec3(0.0, 0.0, 1.7)};
    take(rig.head_station, X_TW * X_WD);
    // Fingers ahead, the back of the hand up.
    Pose X_WH{rotation(Vec3(0.5 * M_PI, 0.0, 0.0)), Vec3::Zero()};
    X_WH.p = wanted_ball(played, std::min(t + rig.predicted_s, 1.9)) - X_WH.q * played.hand.grip;
    take(rig.hand_station, X_TW * X_WH * rig.X_SH.inverse());
    if (const bool press = t >= kTakes && t < kLetsGo; press != pressed) {
      session.take(devices::MouseSample{.device_time = now, .host_time = now, .trigger = press});
      pressed = press;
    }
    session.advance(now);
  }
}

Scenario played_room(const std::string& device, bool left_hand) {
  return played_with(Scenario{}, browser_device(device), left_hand);
}

/// The events of a kind in a log.
std::vector<Event> events_of(const TrialFile& file, std::string_view kind) {
  std::vector<Event> found;
  for (const Event& event : file.summary().events) {
    if (event.kind == kind) found.push_back(event);
  }
  return found;
}

class PageSessionThrow : public testing::TestWithParam<std::pair<std::string, bool>> {};

TEST_P(PageSessionThrow, ReplaysToTheBitAndFliesAsTheHandMoved) {
  const auto& [device, left_hand] = GetParam();
  const Scenario played = played_room(device, left_hand);
  PageSession session(to_toml(Scenario{}), options_of(device, left_hand));
  std::vector<std::uint8_t> log = session.take_log();
  throw_ball(session, played);
  const nlohmann::json said = session.finish(240, 3);
  const std::vector<std::uint8_t> rest = session.take_log();
  log.insert(log.end(), rest.begin(), rest.end());

  const Recorded recorded = load_trial(log, "page");
  const TrialSummary& trial = recorded.file.summary();
  EXPECT_TRUE(trial.complete);
  EXPECT_EQ(trial.header.participant, "P07");
  EXPECT_EQ(to_toml(recorded.scenario), to_toml(played));
  Session again = make_session(recorded.scenario);
  TrialPlayer source(recorded.file, {.states = true});
  Verifier verifier("page", source, again);
  NoPace pace;
  Observer* const observers[] = {&verifier};
  const std::int64_t ticks = said["ticks"];
  run(again, source, pace, observers, [&](const Session& s) { return s.tick >= ticks; });
  EXPECT_EQ(verifier.finish(trial, again), 0);
  EXPECT_EQ(in_hex(again.game_hash.value()), said["game_hash"]);

  const std::vector<Event> releases = events_of(recorded.file, "release");
  ASSERT_EQ(releases.size(), 1u);
  // 16 m/s2 along the lane, 0.4 s after it began.
  EXPECT_NEAR(releases[0].value, 16.0 * (kLetsGo - kSwings), 0.3);
  EXPECT_GT(said["skittles_down"], 0);
  const std::vector<Event> pace_kept = events_of(recorded.file, "kept_pace");
  ASSERT_EQ(pace_kept.size(), 1u);
  EXPECT_EQ(pace_kept[0].detail.value_or(KeptPace{}).late_frames, 3);
}

INSTANTIATE_TEST_SUITE_P(Devices, PageSessionThrow,
                         testing::Values(std::pair{"mouse", false},
                                         std::pair{"generic-webxr", false},
                                         std::pair{"predicting-webxr", false},
                                         std::pair{"generic-webxr", true}));

TEST(BrowserDevice, AGripThatPointsAheadIsAHandThatDoes) {
  // A fist held ahead, its thumb up (WebXR: -z is on the thumb's side). A right hand then has its
  // back to the right, which is x; fingers that were opened would point ahead, which is -y.
  const auto axis = [](bool left_hand, const Vec3& a_H) {
    const Rig rig = played_room("generic-webxr", left_hand).rig;
    return Vec3(rig.X_SH.q * a_H);
  };
  EXPECT_TRUE(axis(false, Vec3::UnitY()).isApprox(Vec3::UnitX(), 1e-12));    // back
  EXPECT_TRUE(axis(false, -Vec3::UnitZ()).isApprox(-Vec3::UnitY(), 1e-12));  // fingers
  // The left hand's back is then to the left, and x is still to the right.
  EXPECT_TRUE(axis(true, Vec3::UnitY()).isApprox(-Vec3::UnitX(), 1e-12));
  EXPECT_TRUE(axis(true, -Vec3::UnitZ()).isApprox(-Vec3::UnitY(), 1e-12));
}

TEST(BrowserDevice, TheTrackedSpaceStandsUprightBehindTheFoulLine) {
  for (const bool left_hand : {false, true}) {
    const Scenario played = played_room("generic-webxr", left_hand);
    const Pose& X_WT = played.rig.X_WT;
    EXPECT_TRUE((X_WT.q * Vec3::UnitY()).isApprox(Vec3::UnitZ(), 1e-12));
    EXPECT_TRUE((X_WT.q * -Vec3::UnitZ()).isApprox(Vec3::UnitY(), 1e-12));
    EXPECT_LT(X_WT.p.y(), 0.0);
    EXPECT_EQ(X_WT.p.z(), 0.0);
    const double beside = played.ball.home.x() - X_WT.p.x();
    EXPECT_GT(left_hand ? -beside : beside, 0.0) << "the ball is on the side of its hand";
    EXPECT_LT(std::abs(X_WT.p.x()), 0.05) << "the player is in the middle of the lane";
  }
}

TEST(PageSession, TellsTheRingsOfOilOfTheLastThrow) {
  Scenario scenario;
  scenario.ball.rings = true;
  set_elasticity(scenario.material, 0.0);  // it stays on the lane
  scenario.hand.spin = Vec3(60.0, 0.0, 0.0);
  PageSession session(to_toml(scenario), options_of("mouse"));
  const nlohmann::json before = session.take_news();
  EXPECT_TRUE(before.is_null() || before["rings"]["each"].empty());
  throw_ball(session, played_with(scenario, browser_device("mouse"), false));
  const nlohmann::json rings = session.take_news()["rings"];
  EXPECT_EQ(rings["ball"], 0);
  EXPECT_GE(rings["each"].size(), 2u);
  for (const nlohmann::json& ring : rings["each"]) {
    ASSERT_EQ(ring.size(), 8u);
    const Vec3 centre(ring[4], ring[5], ring[6]);
    EXPECT_NEAR(std::hypot(centre.norm(), ring[7].get<double>()), scenario.ball.radius, 1e-9);
  }
  EXPECT_TRUE(session.take_news().is_null()) << "nothing is told twice";
}

TEST(PageSession, IsOverOnceBothVersionsHaveBeenPlayed) {
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
  scenario.version.buttons = true;
  // The hand waits at the red button, and throws from there.
  const Scenario played = played_with(scenario, browser_device("mouse"), false);
  scenario.version.red.button =
      played.ball.home - rotation(Vec3(0.5 * M_PI, 0.0, 0.0)) * played.hand.grip;
  PageSession session(to_toml(scenario), options_of("mouse"));
  throw_ball(session, played);
  session.advance(microseconds(kEnds + scenario.game.ball_back_s));
  const nlohmann::json red = session.take_news()["score"];
  ASSERT_EQ(red["sheets"].size(), 1u);
  EXPECT_THAT(red["sheets"][0].get<std::string>(),
              testing::AllOf(testing::StartsWith("red "), testing::Not(HasSubstr("not over"))));
  EXPECT_EQ(red["last_over"], true);
  EXPECT_EQ(red["over"], false);
  EXPECT_EQ(red["unplayed"], nlohmann::json({"blue"}));
}

TEST(PageSession, RefusesWhatIsNoSample) {
  PageSession session(to_toml(Scenario{}), options_of("mouse"));
  devices::TrackerSample bad = sample(1, Time{1000}, {});
  bad.X_TS.p.x() = std::nan("");
  EXPECT_THAT([&] { session.take(bad); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("sample at 0.001000 s")));
  EXPECT_EQ(session.advance(Time{100'000}), 24);
}

TEST(PageSession, RefusesADeviceThatIsNotKnown) {
  EXPECT_THAT(
      [] { PageSession(to_toml(Scenario{}), options_of("glove")); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("mouse, generic-webxr, predicting-webxr")));
}

TEST(PageSession, APredictedPoseIsKnownAtOnceAndThereWhenItIsFor) {
  const Scenario played = played_room("generic-webxr", false);
  PageSession session(to_toml(Scenario{}), options_of("generic-webxr"));
  const auto head_at = [&](double x, Time valid, Time got) {
    devices::TrackerSample s = sample(1, valid, {Quat::Identity(), Vec3(x, 1.7, 0.0)});
    s.host_time = s.sent_time = got;
    session.take(s);
  };
  head_at(0.0, Time{0}, Time{0});
  head_at(1.0, Time{130'000}, Time{100'000});
  const auto seen_x = [&](Time now) {
    session.advance(now);
    std::vector<float> view;
    session.see(view);
    return static_cast<double>(view[19 + 4]) - played.rig.X_WT.p.x();
  };
  const double delay = played.rig.delay_s;
  EXPECT_NEAR(seen_x(Time{100'000 - 5'000}), 0.0, 1e-6);  // not known yet
  EXPECT_NEAR(seen_x(Time{125'000}), (0.125 - delay) / 0.130, 1e-6);
  EXPECT_NEAR(seen_x(Time{150'000}), 1.0, 1e-6);
}

TEST(PageSession, OfARoomWithSoundIsHeardAsLongAsItIsPlayed) {
  Scenario loud;
  loud.sound.on = true;
  PageSession heard(to_toml(loud), options_of("mouse")),
      silent(to_toml(Scenario{}), options_of("mouse"));
  ASSERT_EQ(heard.advance(Time{100'000}), 24);
  ASSERT_EQ(silent.advance(Time{100'000}), 24);
  EXPECT_EQ(heard.take_sound().size(), std::size_t{kSoundRate / 10});
  EXPECT_TRUE(heard.take_sound().empty());
  EXPECT_TRUE(silent.take_sound().empty());
}

TEST(PageSession, SaysWhatTheScoreBoardShows) {
  Scenario alley;
  alley.game.rules = GameKind::ten_pin;
  for (const bool shown : {true, false}) {
    alley.game.show_score = shown;
    PageSession session(to_toml(alley), options_of("mouse"));
    session.advance(Time{100'000});
    const nlohmann::json news = session.take_news();
    const nlohmann::json none = nlohmann::json::array();
    EXPECT_EQ(news["board"], shown ? nlohmann::json({"_", "F1       0"}) : none);
  }
}

TEST(PlayPage, HasAllThatASessionShows) {
  for (const char* name : {"paper-room", "paper-experiment", "german-ninepins"}) {
    const Scenario scenario =
        load_scenario(fmt::format("{}/assets/scenarios/{}.toml", HEADPIN_SOURCE_DIR, name));
    const PageData data = play_page(scenario);
    const nlohmann::json& json = data.json;
    std::set<int> meshes;
    for (const nlohmann::json& mesh : json["meshes"]) meshes.insert(mesh["number"].get<int>());
    std::size_t bodies = 0;
    for (const nlohmann::json& actor : json["actors"]) {
      EXPECT_FALSE(actor["meshes"].empty());
      for (const int mesh : actor["meshes"]) EXPECT_TRUE(meshes.contains(mesh)) << actor;
      bodies += actor["role"] == "skittle" || actor["role"] == "ball";
    }
    EXPECT_EQ(json["buttons"].size(), scenario.version.buttons ? 2u : 0u);
    ASSERT_EQ(json["board"].is_null(), !scenario.game.show_score);
    if (scenario.game.show_score) {
      EXPECT_EQ(json["board"]["cells"].size(), 2u);
      for (const nlohmann::json& mesh : json["board"]["characters"]) {
        EXPECT_TRUE(meshes.contains(mesh.get<int>()));
      }
    }

    PageSession session(json["scenario"]["text"].get<std::string>(), options_of("mouse"));
    std::vector<float> view;
    session.see(view);
    ASSERT_EQ(view.size(), 26 + 7 * bodies);
    const nlohmann::json& home = json["ball"]["homes"][0];
    const std::size_t ball = 26 + 7 * scenario.rack.spots.size();
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(view[ball + 4 + i], home[i].get<float>()) << name;
    }
  }
}

}  // namespace
}  // namespace headpin::scene
