// Virtual participants: that what they play is a trial like any.

#include "scene/people/participant.h"

#include <cmath>
#include <functional>
#include <memory>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "devices/base/clocks.h"
#include "devices/base/sources.h"
#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"
#include "devices/recordings/recorded_motion.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/messages.h"
#include "scene/stage/read_scenario.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kSessionOfSeven = 5063779778851053477u;

Scenario participants_room() {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  set_up_for_participants(scenario);
  return scenario;
}

/// A session as somebody saw it.
struct SessionSeen : Observer {
  void tick(const Session& session) override {
    for (devices::Sample sample : session.samples) {
      std::visit([](auto& one) { one.session_time = {}; }, sample);
      samples.push_back(sample);
    }
    events.insert(events.end(), session.events.begin(), session.events.end());
    hashes.push_back(engine::state_hash(session.world));
    if (each) each(session);
  }
  std::vector<std::string> sheets() const {
    std::vector<std::string> words;
    for (const Sheet& sheet : score(events).games) words.push_back(in_words(sheet));
    return words;
  }
  int count(std::string_view kind) const {
    return static_cast<int>(std::ranges::count(events, kind, &Event::kind));
  }
  std::function<void(const Session&)> each;
  std::vector<devices::Sample> samples;
  std::vector<Event> events;
  std::vector<std::uint64_t> hashes;
};

void let_play(const Scenario& scenario, const Person& person, int throws, SessionSeen& seen) {
  Session session = make_session(scenario);
  Participant participant({person, throws}, scenario);
  NoPace pace;
  Observer* const observers[] = {&participant, &seen};
  run(session, participant, pace, observers,
      [&](const Session& s) { return participant.finished() || s.now() > 600s; });
  EXPECT_FALSE(participant.gave_up());
}

SessionSeen replayed(const Scenario& scenario, const SessionSeen& played) {
  SessionSeen seen;
  Session session = make_session(scenario);
  devices::ReplaySource source(played.samples);
  NoPace pace;
  Observer* const observers[] = {&seen};
  run(session, source, pace, observers,
      [&](const Session& s) { return s.tick >= static_cast<std::int64_t>(played.hashes.size()); });
  return seen;
}

bool same_event(const Event& a, const Event& b) {
  return a.time == b.time && a.tick == b.tick && a.kind == b.kind && a.bodies == b.bodies &&
         a.p_W == b.p_W && a.j_W == b.j_W && a.value == b.value && a.detail == b.detail;
}

/// Somebody who does the same each time.
Person steady_person() {
  return {.speed_spread = 0.0, .aim_spread = 0.0, .timing_spread = 0.0, .tremor = 0.0, .sway = 0.0};
}

TEST(ParticipantTest, PlaysBothVersionsByTheDevicesAlone) {
  const Scenario scenario = participants_room();
  SessionSeen seen;
  let_play(scenario, draw_person(7), 2, seen);
  ASSERT_EQ(seen.count(kind::version), 2);
  EXPECT_EQ(seen.count(kind::grab), 4);
  EXPECT_EQ(seen.count(kind::release), 4);
  EXPECT_EQ(seen.count(kind::missed_grab), 0);
  EXPECT_GE(seen.count(kind::delivery), 4);
  std::vector<std::string> versions;
  for (const Event& event : seen.events) {
    if (event.kind == kind::version) versions.push_back(event.detail.text());
  }
  EXPECT_THAT(versions, testing::ElementsAre("red", "blue"));
  // It walked up by the thumbs.
  const auto forward = [](const devices::Sample& sample) {
    const auto* mouse = std::get_if<devices::MouseSample>(&sample);
    return mouse && mouse->left_thumb;
  };
  EXPECT_TRUE(std::ranges::any_of(seen.samples, forward));
}

TEST(ParticipantTest, ItsSamplesReplayToTheSameStatesEventsAndSheets) {
  const Scenario scenario = participants_room();
  for (const std::uint64_t seed : {3u, 7u}) {
    SessionSeen played;
    let_play(scenario, draw_person(seed), 3, played);
    const SessionSeen again = replayed(scenario, played);
    EXPECT_EQ(again.hashes, played.hashes);
    EXPECT_EQ(again.sheets(), played.sheets());
    EXPECT_TRUE(std::ranges::equal(again.events, played.events, same_event));
    // The same hand with the other version's parameters: another score.
    Scenario other = scenario;
    std::swap(other.version.red.friction, other.version.blue.friction);
    const SessionSeen exchanged = replayed(other, played);
    EXPECT_NE(exchanged.sheets(), played.sheets());
    EXPECT_EQ(score(exchanged.events).release_speed, score(played.events).release_speed);
  }
}

TEST(ParticipantTest, TheSameSeedGivesTheSameBytesWhateverTheCompiler) {
  // Hand and buttons until the first ball is let go: what comes then is the engine's too.
  const auto fingerprint = [](std::uint64_t seed) {
    SessionSeen seen;
    let_play(participants_room(), draw_person(seed), 1, seen);
    const auto release = std::ranges::find(seen.events, kind::release, &Event::kind);
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    devices::Buffer bytes;
    for (const devices::Sample& sample : seen.samples) {
      const bool after = devices::device_time(sample) > release->time;
      if (after || devices::device_of(sample) == devices::device_at(devices::kHeadStation))
        continue;
      std::visit([&](const auto& s) { encode(s, bytes); }, sample);
      for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
    }
    return hash;
  };
  EXPECT_EQ(fingerprint(7), kSessionOfSeven);
  EXPECT_NE(fingerprint(8), kSessionOfSeven);
}

TEST(ParticipantTest, IsMeasuredAsByAFastrakWithTwoReceivers) {
  const Scenario scenario = participants_room();
  SessionSeen seen;
  let_play(scenario, draw_person(7), 1, seen);
  std::int64_t cycle = 0;
  for (const devices::Sample& sample : seen.samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (!tracker) continue;
    ASSERT_EQ(tracker->device_time, tick_time(cycle, 120));
    EXPECT_EQ(tracker->station, cycle % 2 == 0 ? devices::kHeadStation : devices::kHandStation);
    EXPECT_EQ(tracker->sequence, cycle / 2);
    EXPECT_GT(tracker->host_time, tracker->device_time);
    EXPECT_GT(tracker->X_TS.p.x(), 0.0);  // in the hemisphere the transmitter faces
    EXPECT_LT(tracker->X_TS.p.norm(), devices::kFastrakRange);
    ++cycle;
  }
  EXPECT_GT(cycle, 120 * 20);
}

TEST(ParticipantTest, ItsGazeFollowsTheBall) {
  const Scenario scenario = participants_room();
  SessionSeen seen;
  int rolling = 0, in_sight = 0;
  seen.each = [&](const Session& session) {
    const engine::BodyId ball = session.stage->balls.front();
    const engine::State& state = session.world.states[ball];
    const auto X_WD = head_pose(session);
    const bool rolls = session.world.bodies[ball].kind == engine::Kind::free &&
                       state.v_WB.y() > 2.0 && state.X_WB.p.y() > 1.5;
    if (!rolls || !X_WD) return;
    ++rolling;
    const Vec3 p_DB = X_WD->inverse() * state.X_WB.p;
    in_sight += -p_DB.z() / p_DB.norm() > std::cos(20.0 * 3.14159 / 180.0);
  };
  let_play(scenario, draw_person(7), 3, seen);
  EXPECT_GT(rolling, 6 * 100);
  EXPECT_GT(in_sight, 0.9 * rolling);
}

// Who pulls to the right by four degrees and does nothing else wrong misses by less each time.
TEST(ParticipantTest, AMissIsMended) {
  Scenario scenario = participants_room();
  scenario.version.buttons = false;
  scenario.game.balls = 1;
  scenario.game.frames = 5;
  scenario.lane.head_pin = 6.0;
  Person person = steady_person();
  person.aim_bias = 4.0 * 3.14159 / 180.0;
  person.mending = 0.5;
  SessionSeen seen;
  std::vector<double> passed_at;
  bool before = true;
  seen.each = [&](const Session& session) {
    const double y = session.world.states[session.stage->balls.front()].X_WB.p.y();
    const bool now_before = y < 5.0;
    if (before && !now_before) {
      passed_at.push_back(session.world.states[session.stage->balls.front()].X_WB.p.x());
    }
    before = now_before;
  };
  let_play(scenario, person, 5, seen);
  ASSERT_GE(passed_at.size(), 3u);
  EXPECT_GT(passed_at[0], 0.25);  // 5.2 m times the sine of four degrees: 0.36
  EXPECT_LT(passed_at[1], 0.7 * passed_at[0]);
  EXPECT_LT(std::abs(passed_at.back()), scenario.ball.radius + 0.02);
}

// Frictionless, elastic skittles come back from the wall.
TEST(ParticipantTest, DrawsBackFromWhatFliesAtItUnlessNothingDisturbsIt) {
  if (!kThorough) GTEST_SKIP() << "six whole sessions are for an optimised build";
  const Scenario scenario = participants_room();
  int came = 0, evaded = 0, came_still = 0, evaded_still = 0;
  for (const std::uint64_t seed : {1u, 2u, 7u}) {
    for (const bool draws_back : {true, false}) {
      Person person = draw_person(seed);
      person.draws_back = draws_back;
      SessionSeen seen;
      let_play(scenario, person, 10, seen);
      for (const nlohmann::json& approach : approaches_of(seen.events)) {
        ++(draws_back ? came : came_still);
        (draws_back ? evaded : evaded_still) += approach["moved"] == true;
      }
    }
  }
  EXPECT_GT(came, 3);
  EXPECT_GT(came_still, 3);
  EXPECT_GE(evaded, 0.8 * came);
  EXPECT_LE(evaded_still, 0.2 * came_still);
}

TEST(ParticipantTest, GivesUpWhereAButtonIsOutOfReach) {
  Scenario scenario = participants_room();
  scenario.version.red.button.z() = 2.7;
  Session session = make_session(scenario);
  Participant participant({draw_person(7), 1}, scenario);
  NoPace pace;
  Observer* const observers[] = {&participant};
  run(session, participant, pace, observers,
      [&](const Session& s) { return participant.finished() || s.now() > 120s; });
  EXPECT_TRUE(participant.finished());
  EXPECT_TRUE(participant.gave_up());
}

/// A recording measured by an emulated unit and told by the driver to a session whose clock is held
/// to it; buttons on a line of their own, by the clock of the unit's records and late each by
/// something else.
class ThroughUnit : public devices::Source {
 public:
  /// @param phase  of the unit's clock against the session's
  ThroughUnit(const std::vector<devices::Sample>& recorded, const Scenario& scenario, Time phase)
      : recorded_(recorded),
        tick_(tick_time(1, scenario.rates.physics_hz)),
        phase_(phase),
        unit_(options_for(recorded),
              [this, motion = devices::recorded_motion(recorded)](int station, Time time) {
                return motion(station, begin_ && time > *begin_ ? time - *begin_ : Time{});
              }),
        ends_(devices::memory_streams()),
        driver_(std::move(ends_.second), clocks_) {
    clocks_.follow_first(scenario.rates.physics_hz);
    for (const devices::Sample& sample : recorded) {
      if (const auto* mouse = std::get_if<devices::MouseSample>(&sample))
        buttons_.push_back(*mouse);
    }
  }

  void poll(Time now, std::vector<devices::Sample>& out) override {
    behind_us_ += clocks_.stretch_us(tick_);
    const Time machine = now + phase_ + Time{std::llround(behind_us_)};
    while (served_ < machine) serve(std::min(served_ + Time{1ms}, machine));
    driver_.poll(now, out);
    press(now, machine, out);
    std::ranges::stable_sort(out, {}, devices::device_time);
  }
  bool exhausted() const override { return false; }
  std::optional<Time> begin() const { return begin_; }

 private:
  static devices::FastrakEmulatorOptions options_for(const std::vector<devices::Sample>& recorded) {
    devices::FastrakEmulatorOptions options;
    options.faults.noise = 0.0;
    options.envelope = devices::place_for(recorded).envelope;
    return options;
  }
  void serve(Time now) {
    devices::serve(unit_, *ends_.first, now);
    served_ = now;
    if (unit_.statistics().streams == streams_) return;
    streams_ = unit_.statistics().streams;
    begin_ = devices::begin_of(devices::first_measurement(recorded_), unit_, now);
  }
  void press(Time now, Time machine, std::vector<devices::Sample>& out) {
    for (; begin_ && pressed_ < buttons_.size(); ++pressed_) {
      devices::MouseSample mouse = buttons_[pressed_];
      const Time late = Time{200 + 1300 * static_cast<std::int64_t>(pressed_ % 3)};
      if (*begin_ + mouse.device_time + late > machine) return;
      const Time theirs = *begin_ + mouse.device_time - unit_.stream_zero();
      mouse.device_time = clocks_.date({.clock = mouse_clock_,
                                        .theirs = theirs,
                                        .arrived_us = static_cast<double>(now.count())});
      mouse.host_time = now;
      out.emplace_back(mouse);
    }
  }

  const std::vector<devices::Sample>& recorded_;
  devices::Clocks clocks_;
  devices::ClockId mouse_clock_ = clocks_.add(devices::Lead::never);
  Time tick_, phase_;
  std::optional<Time> begin_;
  devices::FastrakEmulator unit_;
  std::pair<std::unique_ptr<devices::ByteStream>, std::unique_ptr<devices::ByteStream>> ends_;
  devices::FastrakDriver driver_;
  std::vector<devices::MouseSample> buttons_;
  std::size_t pressed_ = 0;
  Time served_{};
  double behind_us_ = 0.0;
  std::int64_t streams_ = 0;
};

// Poses are the unit's own numbers, times whole ticks from the recorded ones, and the poses of a tick
// are of a moment whose measurements have come by then: not a bit differs, so no skittle does.
TEST(ParticipantTest, ItPlaysTheSameSheetsThroughAUnit) {
  Scenario scenario = participants_room();
  scenario.rig.delay_s = 0.05;  // also those that are late have come by then
  SessionSeen played;
  let_play(scenario, draw_person(7), 2, played);
  for (const Time phase : {0us, 5100us, 9300us}) {
    ThroughUnit source(played.samples, scenario, phase);
    SessionSeen seen;
    Session session = make_session(scenario);
    const Time lasted = tick_time(static_cast<std::int64_t>(played.hashes.size()), 240);
    while (!source.begin() || session.now() < *source.begin() + lasted) {
      advance(session, source);
      seen.tick(session);
    }
    ASSERT_EQ(seen.events.size(), played.events.size()) << phase.count();
    const std::int64_t later = seen.events.at(0).tick - played.events.at(0).tick;
    for (std::size_t i = 0; i < seen.events.size(); ++i) {
      const Event &here = played.events[i], &there = seen.events[i];
      ASSERT_EQ(there.kind, here.kind) << phase.count() << ' ' << i;
      ASSERT_EQ(there.tick, here.tick + later) << phase.count() << ' ' << i;
      ASSERT_EQ(there.value, here.value) << phase.count() << ' ' << here.kind;
      ASSERT_EQ(there.p_W, here.p_W) << phase.count() << ' ' << here.kind;
    }
  }
}

/// A participant whose hand is at a button for a moment, a second after an event.
class Brushing : public devices::Source, public Observer {
 public:
  /// @param times  after how many of the events
  Brushing(Participant& participant, const Scenario& scenario, int times, const Vec3& button_W,
           std::string_view after)
      : participant_(participant),
        scenario_(scenario),
        times_(times),
        button_W_(button_W),
        after_(after) {}

  void poll(Time now, std::vector<devices::Sample>& out) override {
    const std::size_t before = out.size();
    participant_.poll(now, out);
    for (std::size_t i = before; i < out.size(); ++i) {
      auto* hand = std::get_if<devices::TrackerSample>(&out[i]);
      if (!hand || hand->station != scenario_.rig.hand_station || !from_) continue;
      if (hand->device_time < *from_ || hand->device_time > *from_ + 150ms) continue;
      const Rig& rig = scenario_.rig;
      Pose X_PH = rig.X_WT * hand->X_TS * rig.X_SH;
      X_PH.p = button_W_ - p_WP_;
      hand->X_TS = rig.X_WT.inverse() * X_PH * rig.X_SH.inverse();
    }
  }
  bool exhausted() const override { return participant_.exhausted(); }

  void tick(const Session& session) override {
    p_WP_ = session.player.walk.p_WP;
    for (const Event& event : session.events) {
      if (event.kind == after_ && times_-- > 0) from_ = event.time + 1s;
    }
  }

 private:
  Participant& participant_;
  const Scenario& scenario_;
  int times_;
  Vec3 button_W_;
  std::string_view after_;
  std::optional<Time> from_;
  Vec3 p_WP_ = Vec3::Zero();
};

/// The versions in order, with the balls of each: "red 1".
std::vector<std::string> versions_brushed(int times, int throws, bool& gave_up,
                                          Colour brushed = Colour::blue,
                                          std::string_view after = kind::release) {
  const Scenario scenario = participants_room();
  const Versions& versions = scenario.version;
  const Vec3 button = brushed == Colour::blue ? versions.blue.button : versions.red.button;
  Session session = make_session(scenario);
  Participant participant({steady_person(), throws}, scenario);
  Brushing brushing(participant, scenario, times, button, after);
  SessionSeen seen;
  NoPace pace;
  Observer* const observers[] = {&participant, &brushing, &seen};
  run(session, brushing, pace, observers,
      [&](const Session& s) { return participant.finished() || s.now() > 600s; });
  EXPECT_TRUE(participant.finished());
  gave_up = participant.gave_up();
  std::vector<std::pair<std::string, int>> begun;
  for (const Event& event : seen.events) {
    if (event.kind == kind::version) begun.emplace_back(event.detail.text(), 0);
    if (event.kind == kind::release && !begun.empty()) ++begun.back().second;
  }
  std::vector<std::string> words;
  for (const auto& [colour, balls] : begun) words.push_back(fmt::format("{} {}", colour, balls));
  return words;
}

TEST(ParticipantTest, WhoBrushesTheOtherButtonBeginsItsVersionAgain) {
  bool gave_up = false;
  EXPECT_THAT(versions_brushed(1, 2, gave_up),
              testing::ElementsAre("red 1", "blue 0", "red 2", "blue 2"));
  EXPECT_FALSE(gave_up);
}

// With its last ball the version is over.
TEST(ParticipantTest, WhoBrushesTheOtherButtonAfterTheLastBallGoesOnToThatVersion) {
  bool gave_up = false;
  EXPECT_THAT(versions_brushed(1, 1, gave_up), testing::ElementsAre("red 1", "blue 0", "blue 1"));
  EXPECT_FALSE(gave_up);
}

// Its own version begins again with a new rack, so that all its balls are thrown again.
TEST(ParticipantTest, WhoBrushesTheButtonOfItsVersionThrowsAllItsBallsAgain) {
  bool gave_up = false;
  EXPECT_THAT(versions_brushed(1, 2, gave_up, Colour::red),
              testing::ElementsAre("red 1", "red 2", "blue 2"));
  EXPECT_FALSE(gave_up);
}

// Nothing was thrown yet that would have to be thrown again.
TEST(ParticipantTest, WhoTouchesItsButtonAgainOnTheWayToTheFirstBallGoesOn) {
  bool gave_up = false;
  EXPECT_THAT(versions_brushed(5, 1, gave_up, Colour::red, kind::version),
              testing::ElementsAre("red 0", "red 0", "red 0", "red 0", "red 0", "red 1", "blue 1"));
  EXPECT_FALSE(gave_up);
}

TEST(ParticipantTest, GivesUpWhereTheOtherVersionBeginsTooOften) {
  bool gave_up = false;
  EXPECT_THAT(versions_brushed(100, 2, gave_up),
              testing::ElementsAre("red 1", "blue 0", "red 1", "blue 0", "red 1", "blue 0", "red 1",
                                   "blue 0", "red 1", "blue 0"));
  EXPECT_TRUE(gave_up);
}

}  // namespace
}  // namespace headpin::scene
