#include "scene/watch/followed_log.h"

#include <algorithm>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/random.h"
#include "devices/base/sources.h"
#include "scene/looks/glimpse.h"
#include "scene/page/browser_device.h"
#include "scene/page/page_session.h"
#include "scene/play/run.h"
#include "scene/record/events.h"
#include "scene/record/trial_events.h"
#include "scene/watch/recorded.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"
#include "tests/scene/demo.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

constexpr std::int64_t kTicks = 1680, kTicksAFrame = 8;  // 240 Hz, 30 Hz

/// The demo's throw with frames, as the bytes of a log, and what is true at its end.
struct PlayedDemo {
  std::vector<std::uint8_t> log;
  Score score;
  std::vector<std::pair<std::string, Pose>> bodies;
};

PlayedDemo played_demo() {
  PlayedDemo out;
  const Recorded recorded = load_trial(kDemo);
  Session session = make_session(recorded.scenario);
  const auto keep = [&](const devices::LogEvent& event) { devices::append(event, out.log); };
  TrialHeader header;
  header.participant = "Ada";
  TrialWriter writer(
      std::make_unique<TrialEvents>(header_of(header, session), TrialEvents::Options{}, keep));
  Totals totals;
  TrialPlayer source(recorded.file);
  NoPace pace;
  Observer* const observers[] = {&writer, &totals};
  for (std::int64_t tick = 0; tick < kTicks; tick += kTicksAFrame) {
    run(session, source, pace, observers,
        [&](const Session& s) { return s.tick >= tick + kTicksAFrame; });
    FrameRecord frame;
    frame.time = session.now();
    frame.frame = tick / kTicksAFrame;
    frame.tick = session.tick;
    for (Pose& X_WE : frame.X_WE) X_WE.p = Vec3(0.0, -2.0, 1.7);
    writer.write(frame);
  }
  writer.close(session);
  out.score = totals.score();
  for (std::size_t i = 0; i < session.world.bodies.size(); ++i) {
    out.bodies.emplace_back(session.world.bodies[i].name, session.world.states[i].X_WB);
  }
  return out;
}

const PlayedDemo& throw_of_the_demo() {
  static const PlayedDemo once = played_demo();
  return once;
}

nlohmann::json followed(std::span<const std::uint8_t> log, std::size_t piece) {
  FollowedLog follow;
  for (std::size_t at = 0; at < log.size(); at += piece) {
    follow.add(log.subspan(at, std::min(piece, log.size() - at)));
  }
  return follow.state();
}

TEST(FollowedLog, TellsWhatTheSessionCameTo) {
  const PlayedDemo& played = throw_of_the_demo();
  ASSERT_GT(played.score.skittles_down, 0);
  const nlohmann::json state = followed(played.log, played.log.size());
  EXPECT_EQ(state["participant"], "Ada");
  EXPECT_EQ(state["tick"], kTicks);
  EXPECT_EQ(state["skittles_down"], played.score.skittles_down);
  EXPECT_EQ(state["throws"], 1);
  EXPECT_TRUE(state["ended"]);
  EXPECT_EQ(state["unusable"], 0);
  EXPECT_EQ(state["frames"], kTicks / kTicksAFrame);
  EXPECT_NEAR(state["frame_rate_hz"].get<double>(), 30.0, 1e-3);
  ASSERT_EQ(state["bodies"].size(), played.bodies.size());
  for (const auto& [name, X_WB] : played.bodies) {
    const nlohmann::json& pose = state["bodies"][name];
    for (int i = 0; i < 3; ++i) EXPECT_EQ(pose[static_cast<std::size_t>(4 + i)], X_WB.p[i]) << name;
    EXPECT_EQ(pose[0], X_WB.q.w()) << name;
  }
}

TEST(FollowedLog, PiecesOfAnySizeAreTheSame) {
  const PlayedDemo& played = throw_of_the_demo();
  const nlohmann::json whole = followed(played.log, played.log.size());
  for (const std::size_t piece : {7u, 64u, 1000u, 4096u, 99'991u}) {
    EXPECT_EQ(followed(played.log, piece), whole) << piece;
  }
  // Byte by byte up to the first states, as a slow line brings it.
  const std::span<const std::uint8_t> first = std::span(played.log).first(40'000);
  EXPECT_EQ(followed(first, 1), followed(first, first.size()));
}

TEST(FollowedLog, TheHandIsWhereItIsBesideTheHead) {
  std::vector<std::uint8_t> log;
  TrialEvents writer(TrialHeader{}, {},
                     [&](const devices::LogEvent& event) { devices::append(event, log); });
  // In a tracked space with y up: 0.3 m to the right of the head, 0.2 m below and 0.5 m ahead of it.
  for (const auto& [station, p] : {std::pair{devices::kHeadStation, Vec3(0.0, 1.7, 0.1)},
                                   {devices::kHandStation, Vec3(0.3, 1.5, -0.4)}}) {
    devices::TrackerSample sample;
    sample.station = station;
    sample.X_TS.p = p;
    writer.write(devices::Sample(sample));
  }
  FrameRecord frame;
  for (Pose& X_WE : frame.X_WE) X_WE.p = Vec3(1.0, -2.0, 1.7);
  writer.write(frame);
  Mat3 R_WT;
  R_WT << 1.0, 0.0, 0.0,  //
      0.0, 0.0, -1.0,     //
      0.0, 1.0, 0.0;
  Scenario played;
  played.rig.X_WT.q = Quat(R_WT);
  FollowedLog follow(played);
  follow.add(log);
  const nlohmann::json hand = follow.state()["hand"];
  ASSERT_EQ(hand.size(), 7u);
  EXPECT_NEAR(hand[4].get<double>(), 1.3, 1e-12);
  EXPECT_NEAR(hand[5].get<double>(), -1.5, 1e-12);
  EXPECT_NEAR(hand[6].get<double>(), 1.5, 1e-12);
}

TEST(FollowedLog, SkittlesLookLikeThoseOfTheVersionThatIsPlayed) {
  Scenario scenario;
  scenario.skittle.seen = SeenSkittle::collider;
  scenario.collision.shape = scenario.version.red.shape = SkittleShape::parts;
  scenario.version.buttons = true;
  scenario.version.blue.shape = SkittleShape::ellipsoid;
  TrialHeader header;
  header.scenario = to_toml(scenario);
  FollowedLog follow(scenario);
  TrialEvents writer(header, {}, [&](const devices::LogEvent& event) {
    std::vector<std::uint8_t> piece;
    devices::append(event, piece);
    follow.add(piece);
  });
  EXPECT_FALSE(follow.state()["ellipsoids"]);
  for (const auto& [colour, ellipsoids] : {std::pair{"blue", true}, {"red", false}}) {
    Event begins;
    begins.kind = kind::version;
    begins.detail = colour;
    writer.write(begins);
    EXPECT_EQ(follow.state()["ellipsoids"], ellipsoids) << colour;
  }
  EXPECT_EQ(follow.state()["unusable"], 0);
}

TEST(FollowedLog, TrackingThatIsLostIsSaid) {
  std::vector<std::uint8_t> log;
  TrialEvents writer(TrialHeader{}, {},
                     [&](const devices::LogEvent& event) { devices::append(event, log); });
  const auto add = [&](std::string_view kind, const std::string& what) {
    Event event;
    event.kind = kind;
    event.detail = what;
    writer.write(event);
  };
  add(kind::tracking_lost, "head");
  add(kind::tracking_lost, "hand");
  add(kind::tracking_back, "head");
  FollowedLog follow;
  follow.add(log);
  EXPECT_EQ(follow.state()["times_lost"], 2);
  EXPECT_EQ(follow.state()["lost_now"], nlohmann::json::array({"hand"}));
  EXPECT_FALSE(follow.ended());
}

TEST(FollowedLog, AnyBytesAreTaken) {
  const PlayedDemo& played = throw_of_the_demo();
  Random random(3, 1, 4);
  for (int run = 0; run < 40; ++run) {
    std::vector<std::uint8_t> bytes(played.log.begin(), played.log.begin() + 60'000);
    const int changes = 1 << (run % 8);
    for (int i = 0; i < changes; ++i) {
      bytes[random.next() % bytes.size()] = static_cast<std::uint8_t>(random.next());
    }
    const nlohmann::json state = followed(bytes, 4096);
    EXPECT_LE(state["bodies"].size(), played.bodies.size());
  }
  // An event that claims two gigabytes is not waited for.
  std::vector<std::uint8_t> claims = {0xed, 0xa1, 0xda, 0x01};
  claims.resize(20);
  for (const int byte : {0, 0, 0, 5, 0x7f, 0xff, 0xff, 0xf0}) {
    claims.push_back(static_cast<std::uint8_t>(byte));
  }
  FollowedLog follow;
  follow.add(claims);
  for (int i = 0; i < 12; ++i) follow.add(std::vector<std::uint8_t>(1'000'000));
  follow.add(played.log);
  EXPECT_EQ(follow.state()["skittles_down"], played.score.skittles_down);
  EXPECT_GT(follow.state()["unusable"], 0);
}

devices::TrackerSample held_still(std::int64_t station, Time time, const Pose& X_TS) {
  devices::TrackerSample sample;
  sample.station = static_cast<std::int32_t>(station);
  sample.device_time = sample.host_time = time;
  sample.X_TS = X_TS;
  return sample;
}

/// A guest who holds head and hand still, and takes the ball after half a second.
/// @param ends   when that ends [s]
/// @param view   what the guest's page draws then, as PageSession::see() has it
nlohmann::json watched(const Scenario& scenario, const std::string& device, bool left_hand,
                       double ends, std::vector<float>& view) {
  const Scenario played = played_with(scenario, browser_device(device), left_hand);
  PageSession::Options options;
  options.device = device;
  options.left_hand = left_hand;
  PageSession session(to_toml(scenario), options);
  const Pose X_TW = played.rig.X_WT.inverse();
  const Pose X_WD{rotation(Vec3(0.4 * M_PI, 0.0, 0.0)), played.rig.X_WT.p + Vec3(0.1, 0.0, 1.7)};
  Pose X_WH{rotation(Vec3(0.5 * M_PI, 0.1, 0.2)), Vec3::Zero()};
  X_WH.p = played.ball.home - X_WH.q * played.hand.grip;
  bool pressed = false;
  for (int frame = 0; frame <= static_cast<int>(60.0 * ends); ++frame) {
    const Time now = microseconds(frame / 60.0);
    session.take(held_still(played.rig.head_station, now, X_TW * X_WD));
    session.take(held_still(played.rig.hand_station, now, X_TW * X_WH * played.rig.X_SH.inverse()));
    if (frame == 30) pressed = true;
    session.take(devices::MouseSample{.device_time = now, .host_time = now, .trigger = pressed});
    session.advance(now);
  }
  FrameRecord frame;
  frame.X_WE.fill(X_WD);
  session.drew(frame);
  session.see(view);
  FollowedLog follow(played_with(scenario, browser_devices().front(), false));
  follow.add(session.take_log());
  return follow.state();
}

/// @param at  of a pose in the view
void expect_drawn(const nlohmann::json& pose, const std::vector<float>& view, std::size_t at) {
  ASSERT_EQ(pose.size(), 7u);
  const double sign = pose[0].get<double>() * view[at] < 0.0 ? -1.0 : 1.0;  // q and -q are one turn
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR((i < 4 ? sign : 1.0) * pose[i].get<double>(), view[at + i], 1e-5) << i;
  }
}

TEST(FollowedLog, TheOperatorSeesHeadHandAndSkittlesAsTheGuestDoes) {
  constexpr std::size_t kClosed = 1, kX_WH = 12, kX_WD = 19, kBodies = 26;
  Scenario ellipsoids;
  ellipsoids.skittle.seen = SeenSkittle::collider;
  ellipsoids.collision.shape = SkittleShape::ellipsoid;
  for (const Scenario& scenario : {Scenario{}, ellipsoids}) {
    for (const auto& [device, left_hand] :
         {std::pair{"mouse", false}, {"generic-webxr", false}, {"generic-webxr", true}}) {
      SCOPED_TRACE(fmt::format("{} {} {}", shows_ellipsoids(scenario), device, left_hand));
      std::vector<float> view;
      const nlohmann::json state = watched(scenario, device, left_hand, 0.8, view);
      EXPECT_EQ(state["unusable"], 0);
      EXPECT_EQ(state["left_hand"], left_hand);
      EXPECT_EQ(view[kClosed], 1.0F);
      EXPECT_EQ(state["closed"], 1.0);
      expect_drawn(state["hand"], view, kX_WH);
      expect_drawn(state["head"], view, kX_WD);
      for (std::size_t i = 0; i < scenario.rack.spots.size(); ++i) {
        const std::string name = name_of_skittle(static_cast<int>(i) + 1);
        expect_drawn(state["bodies"][name], view, kBodies + 7 * i);
      }
    }
  }
  // An ellipsoid stands on the floor, though it is weighed as the true skittle.
  std::vector<float> view;
  const nlohmann::json state = watched(ellipsoids, "mouse", false, 0.1, view);
  const double z = state["bodies"]["skittle 1"][6];
  EXPECT_NEAR(z, 0.5 * ellipsoids.skittle.height, 1e-3);
  EXPECT_EQ(state["closed"], 0.0);
}

TEST(FollowedLog, TheHandClosesAsTheGuestSeesIt) {
  for (const double ends : {0.56, 0.59}) {
    std::vector<float> view;
    const nlohmann::json state = watched(Scenario{}, "generic-webxr", false, ends, view);
    EXPECT_GT(view[1], 0.0F);
    EXPECT_LT(view[1], 1.0F);
    EXPECT_NEAR(state["closed"].get<double>(), view[1], 1e-4) << ends;
  }
}

// By rules before 13 the guest sees it lower too.
TEST(FollowedLog, AnEllipsoidIsRaisedByTheRulesOfItsScenario) {
  Scenario old;
  old.skittle.seen = SeenSkittle::collider;
  old.collision.shape = SkittleShape::ellipsoid;
  old.collision.rules = 12;
  std::vector<float> view;
  const nlohmann::json state = watched(old, "mouse", false, 0.1, view);
  expect_drawn(state["bodies"]["skittle 1"], view, 26);
  EXPECT_LT(view[26 + 6], 0.5 * old.skittle.height - 0.02);
}

// A guest could make the server write down ten thousand numbers for each throw.
TEST(FollowedLog, AGameOfMoreSkittlesThanTheSessionHasIsNoneOfIt) {
  for (const int rack : {10, 11, 10'000}) {
    FollowedLog follow;
    TrialEvents writer(TrialHeader{}, {}, [&](const devices::LogEvent& event) {
      std::vector<std::uint8_t> piece;
      devices::append(event, piece);
      follow.add(piece);
    });
    Event game;
    game.kind = kind::game;
    game.detail = GameKind::plain;
    game.value = rack;
    writer.write(game);
    EXPECT_EQ(follow.state()["sheets"].size(), rack == 10 ? 1u : 0u) << rack;
    EXPECT_EQ(follow.state()["unusable"], rack == 10 ? 0 : 1) << rack;
  }
}

// The hand has a skittle as the next frame begins, which sets it up.
TEST(FollowedLog, TheHandOpensWhenWhatItHoldsIsSetUp) {
  Scenario scenario = with_rules(GameKind::plain, 2, 1);
  scenario.rack.spots.resize(1);
  Session session = make_session(scenario);
  const Stage& stage = *session.stage;
  const engine::BodyId skittle = stage.skittles.front(), ball = stage.balls.front();
  std::vector<devices::Sample> samples;
  for (int i = 0; i <= 90; ++i) {
    const Vec3 p_WH = stage.world.states[skittle].X_WB.p - scenario.hand.grip;
    devices::TrackerSample hand =
        held_still(devices::kHandStation, tick_time(i, 60), {Quat::Identity(), p_WH});
    hand.sequence = i;
    samples.emplace_back(hand);
  }
  samples.emplace_back(devices::MouseSample{.device_time = Time{100'000}, .trigger = true});
  devices::ReplaySource source(samples);
  FollowedLog follow(scenario);
  TrialWriter writer(std::make_unique<TrialEvents>(header_of({}, session), TrialEvents::Options{},
                                                   [&](const devices::LogEvent& event) {
                                                     std::vector<std::uint8_t> piece;
                                                     devices::append(event, piece);
                                                     follow.add(piece);
                                                   }));
  std::set<double> seen;
  while (session.now() < Time{1'400'000}) {
    advance(session, source);
    writer.tick(session);
    const double closed = glimpse(session, {}).closed;
    seen.insert(closed);
    ASSERT_NEAR(follow.state()["closed"].get<double>(), closed, 1e-4) << session.tick;
    if (session.tick != 60) continue;
    ASSERT_TRUE(session.player.held);
    engine::set_kind(session.world, ball, engine::Kind::free);
    engine::set_state(
        session.world, ball,
        {{Quat::Identity(), Vec3(0.3, 1.0, scenario.ball.radius)}, Vec3::Zero(), Vec3::Zero()});
  }
  EXPECT_EQ(session.game.frames.size(), 2u);
  EXPECT_FALSE(session.player.held);
  EXPECT_TRUE(seen.contains(0.0) && seen.contains(1.0));
  EXPECT_EQ(glimpse(session, {}).closed, 0.0);
}

// Its skittles could take a second to weigh each time.
TEST(FollowedLog, AHeaderOfAnotherScenarioGivesTheRigAlone) {
  Scenario others;
  others.rig = played_with(others, browser_device("mouse"), true).rig;
  others.skittle.seen = SeenSkittle::collider;
  others.collision.shape = SkittleShape::ellipsoid;
  others.rack.spots.emplace_back(0.4, 19.5);
  TrialHeader header;
  header.scenario = to_toml(others);
  FollowedLog follow;
  TrialEvents writer(header, {}, [&](const devices::LogEvent& event) {
    std::vector<std::uint8_t> piece;
    devices::append(event, piece);
    follow.add(piece);
  });
  EXPECT_TRUE(follow.state()["left_hand"]);
  EXPECT_FALSE(follow.state()["ellipsoids"]);
  Event game;
  game.kind = kind::game;
  game.detail = GameKind::plain;
  game.value = static_cast<double>(others.rack.spots.size());
  writer.write(game);
  EXPECT_EQ(follow.state()["unusable"], 1);
}

/// Takes what is written to it as a log.
struct Written {
  FollowedLog follow;
  TrialEvents writer;

  explicit Written(const TrialHeader& header)
      : writer(header, {.states = States::changes}, [this](const devices::LogEvent& event) {
          std::vector<std::uint8_t> piece;
          devices::append(event, piece);
          follow.add(piece);
        }) {}
};

// The hand was nowhere, as numbers without an end, or far outside of every room.
TEST(FollowedLog, ARigThatNoDeviceCanHaveIsNotFollowed) {
  for (const double far : {0.5, 1e4, 1e308}) {
    Scenario its;
    its.rig.X_SH.p = Vec3(far, far, 0.0);
    its.rig.X_SD.p = Vec3(0.0, far, far);
    TrialHeader header;
    header.scenario = to_toml(its);
    Written log(header);
    for (const std::int32_t station : {devices::kHeadStation, devices::kHandStation}) {
      devices::TrackerSample sample;
      sample.station = station;
      log.writer.write(devices::Sample(sample));
    }
    log.writer.write(FrameRecord{});
    const nlohmann::json hand = log.follow.state()["hand"];
    EXPECT_EQ(hand[4].get<double>(), far < 1.0 ? far : 0.0) << far;
    EXPECT_EQ(hand[6].get<double>(), far < 1.0 ? -far : 0.0) << far;
  }
}

// The operator's page was sent what is no number.
TEST(FollowedLog, AChangeToWhatIsNoPoseIsNotFollowed) {
  TrialHeader header;
  header.body_names = {"ball"};
  Written log(header);
  TickState state;
  state.bodies.resize(1);
  state.bodies[0].X_WB.p = Vec3(1.0, 2.0, 3.0);
  for (int tick = 0; tick < 3; ++tick) {
    state.tick = tick;
    log.writer.write(state);
  }
  EXPECT_EQ(log.follow.state()["unusable"], 0);
  state.tick = 3;
  state.bodies[0].X_WB.p.x() = std::numeric_limits<double>::quiet_NaN();
  log.writer.write(state);
  EXPECT_EQ(log.follow.state()["unusable"], 1);
  EXPECT_EQ(log.follow.state()["tick"], 2);
  EXPECT_EQ(log.follow.state()["bodies"]["ball"][4], 1.0);
}

}  // namespace
}  // namespace headpin::scene
