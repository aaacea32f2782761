// The same hand under another condition: what a game hash tells apart, which throws have no
// counterpart, and every throw on its own.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/each_throw.h"
#include "scene/watch/recorded.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/folder.h"
#include "tests/support/hand_script.h"

namespace headpin::scene {
namespace {

struct Watched : Observer {
  void tick(const Session& now) override {
    events.insert(events.end(), now.events.begin(), now.events.end());
    states.push_back(engine::state_hash(now.world));
  }
  std::vector<Event> events;
  std::vector<std::uint64_t> states;
};

struct Ran {
  Watched watched;
  Session session;
};

Ran run_with(const Scenario& scenario, const std::vector<devices::Sample>& samples,
             Observer* other = nullptr) {
  Ran now{{}, make_session(scenario)};
  devices::ReplaySource source(samples);
  const Time end = source.end();
  NoPace pace;
  std::vector<Observer*> observers = {&now.watched};
  if (other) observers.push_back(other);
  run(now.session, source, pace, observers, [&](const Session& s) { return s.now() >= end; });
  return now;
}

Scenario two_versions() {
  Scenario scenario;
  scenario.game.rules = GameKind::plain;
  scenario.game.frames = 1;
  scenario.game.balls = 1;
  scenario.version.buttons = true;
  return scenario;
}

/// FNV-1a as its authors write it, over numbers of 8 bytes, the lowest first.
std::uint64_t fnv_1a(const std::vector<std::uint64_t>& numbers) {
  std::uint64_t hash = 14695981039346656037u;
  for (std::uint64_t number : numbers) {
    for (int i = 0; i < 8; ++i, number /= 256) hash = (hash ^ number % 256) * 1099511628211u;
  }
  return hash;
}

TEST(GameHash, TellsGamesApartThatEndInTheSameState) {
  Scenario rough = two_versions(), smooth = rough;
  smooth.version.red.friction = 0.0;
  HandScript hand(rough);
  hand.touch(rough.version.red.button);
  hand.throw_from(0.05);
  hand.touch(rough.version.blue.button);  // sets all up anew
  const Ran a = run_with(rough, hand.samples), b = run_with(smooth, hand.samples);
  ASSERT_EQ(a.session.state_hash, b.session.state_hash);
  EXPECT_NE(a.session.game_hash.value(), b.session.game_hash.value());
  EXPECT_EQ(a.session.game_hash.value(), run_with(rough, hand.samples).session.game_hash.value());
}

TEST(GameHash, IsOfTheStateHashAndTheVersionOfEveryTick) {
  const Scenario scenario = two_versions();
  HandScript hand(scenario);
  hand.stay(Vec3(0.0, -1.0, 1.0), 0.1);
  hand.touch(scenario.version.blue.button);
  hand.touch(scenario.version.red.button);
  const Ran now = run_with(scenario, hand.samples);
  std::vector<std::uint64_t> numbers;
  std::uint64_t version = 0;
  for (std::size_t i = 0; i < now.watched.states.size(); ++i) {
    for (const Event& event : now.watched.events) {
      if (event.kind != kind::version || event.tick != static_cast<std::int64_t>(i) + 1) continue;
      version = event.detail.text() == "red" ? 1 : 2;
    }
    numbers.push_back(now.watched.states[i]);
    numbers.push_back(version);
  }
  EXPECT_EQ(version, 1u);
  EXPECT_EQ(now.session.game_hash.value(), fnv_1a(numbers));
}

Scenario four_balls() {
  Scenario scenario;
  scenario.game.rules = GameKind::plain;
  scenario.game.frames = 2;
  scenario.game.balls = 2;
  return scenario;
}

HandScript four_throws(const Scenario& scenario) {
  HandScript hand(scenario);
  for (const double x : {0.02, 0.3, -0.1, 0.2}) hand.throw_from(x);
  return hand;
}

std::vector<int> felled(const std::vector<Event>& events) {
  std::vector<int> all;
  for (const Event& event : events) {
    if (event.kind == kind::delivery) all.push_back(static_cast<int>(event.value));
  }
  return all;
}

/// In which a ball that is thrown comes back after the hand has come for the next one.
Scenario late_ball() {
  Scenario scenario = four_balls();
  set_friction(scenario, 0.0);
  scenario.game.ball_back_s = 15.0;
  return scenario;
}

TEST(Counterparts, AThrowWhoseBallWasNotBackIsTold) {
  const Scenario scenario = four_balls();
  const HandScript hand = four_throws(scenario);
  const Ran recorded = run_with(scenario, hand.samples);
  ASSERT_EQ(thrown(recorded.watched.events).size(), 4u);
  EXPECT_TRUE(without_counterpart(recorded.watched.events, recorded.watched.events).empty());

  const Ran late = run_with(late_ball(), hand.samples);
  const std::vector<Unpaired> lost =
      without_counterpart(recorded.watched.events, late.watched.events);
  // The sum holds: what was thrown there, and what is told not to be.
  EXPECT_EQ(lost.size() + felled(late.watched.events).size(), 4u);
  ASSERT_FALSE(lost.empty());
  EXPECT_EQ(lost.front().thrown.number, 2);
  EXPECT_EQ(lost.front().why, "not thrown: the hand closed on nothing");
}

TEST(EachThrow, UnderTheSameConditionIsWhatItWas) {
  const Scenario scenario = four_balls();
  const HandScript hand = four_throws(scenario);
  EachThrow each(make_session(scenario), scenario);
  const Ran now = run_with(scenario, hand.samples, &each);
  each.finish();
  std::vector<int> was, other;
  for (const ThrowAlone& one : each.throws()) {
    was.push_back(one.as_it_was.felled.value_or(-1));
    other.push_back(one.other.felled.value_or(-1));
    EXPECT_EQ(one.thrown.felled, one.as_it_was.felled);
    EXPECT_EQ(one.as_it_was.impact_speed, one.other.impact_speed);
  }
  EXPECT_EQ(was, felled(now.watched.events));
  EXPECT_EQ(other, was);
}

// A switch that bounces: the ball is taken and let go within a tick, and taken again.
TEST(EachThrow, OfATickIsAThrowOfItsOwn) {
  const Scenario scenario;
  std::vector<devices::Sample> samples = test::straight_throw(scenario);
  std::erase_if(samples, [](const devices::Sample& sample) {
    const auto* button = std::get_if<devices::MouseSample>(&sample);
    return button && button->trigger;
  });
  // Ticks use samples of `rig.delay_s` before.
  const Time tick = tick_time(30, scenario.rates.physics_hz) - microseconds(scenario.rig.delay_s);
  for (const auto& [after_us, trigger] : {std::pair{500, true}, {2'000, false}, {20'000, true}}) {
    samples.emplace_back(
        devices::MouseSample{.device_time = tick + Time{after_us}, .trigger = trigger});
  }
  std::ranges::stable_sort(samples, {}, [](const auto& s) { return devices::available(s); });
  EachThrow each(make_session(scenario), scenario);
  const Ran now = run_with(scenario, samples, &each);
  each.finish();
  const std::vector<ThrowAlone> throws = each.throws();
  ASSERT_EQ(throws.size(), 2u);
  EXPECT_LT(*throws[0].as_it_was.release_speed, 1.0);
  EXPECT_NEAR(*throws[1].as_it_was.release_speed, 6.0, 0.2);
  EXPECT_EQ(throws[0].as_it_was.skittles_down, 0);
  EXPECT_GT(throws[1].as_it_was.skittles_down, 0);
}

TEST(EachThrow, LosesNoneUnderAConditionThatLosesSome) {
  const Scenario scenario = four_balls(), late = late_ball();
  const HandScript hand = four_throws(scenario);
  EachThrow each(make_session(scenario), late);
  const Ran now = run_with(scenario, hand.samples, &each);
  each.finish();
  const std::vector<ThrowAlone> throws = each.throws();
  ASSERT_EQ(throws.size(), 4u);
  for (const ThrowAlone& one : throws) {
    EXPECT_TRUE(one.other.felled.has_value()) << one.thrown.number;
    EXPECT_EQ(one.other.release_speed, one.as_it_was.release_speed);
  }
  // The first one is not preceded by any: it is the first of a replay of the whole session.
  const Ran replayed = run_with(late, hand.samples);
  EXPECT_EQ(throws[0].other.felled, felled(replayed.watched.events).at(0));
  // The second ball of a frame comes to the skittles that its own first ball left.
  EXPECT_LE(*throws[1].other.felled + felled(now.watched.events)[0], 10);
}

TEST(EachThrow, OfASkittleOfAnotherShapeStandsOnItsBase) {
  Scenario scenario = four_balls(), other = scenario;
  scenario.skittle.weighed = other.skittle.weighed = Weighed::parts;
  other.collision.shape = SkittleShape::ellipsoid;
  const HandScript hand = four_throws(scenario);
  EachThrow each(make_session(scenario), other);
  run_with(scenario, hand.samples, &each);
  each.finish();
  ASSERT_EQ(each.throws().size(), 4u);
  for (const ThrowAlone& one : each.throws()) EXPECT_TRUE(one.other.felled.has_value());
}

// The first throw is the first of a session under the other condition, whose skittles stand there from the start.
TEST(EachThrow, OfAnotherPlaceOfTheRackMeetsItThere) {
  const Scenario scenario = four_balls();
  const HandScript hand = four_throws(scenario);
  for (const double head_pin : {5.0, 5.9}) {
    Scenario other = scenario;
    other.lane.head_pin = head_pin;
    EachThrow each(make_session(scenario), other);
    const Ran now = run_with(scenario, hand.samples, &each);
    each.finish();
    const std::vector<ThrowAlone> throws = each.throws();
    ASSERT_EQ(throws.size(), 4u) << head_pin;
    const Ran replayed = run_with(other, hand.samples);
    EXPECT_EQ(throws[0].other.felled, felled(replayed.watched.events).at(0)) << head_pin;
    double impact = 0.0;
    for (const Event& event : replayed.watched.events) {
      if (event.kind == kind::first_contact && impact == 0.0) impact = event.value;
    }
    EXPECT_NEAR(throws[0].other.impact_speed.value_or(0.0), impact, 1e-9) << head_pin;
    EXPECT_NE(throws[0].other.impact_speed, throws[0].as_it_was.impact_speed) << head_pin;
    // The second ball of the frame comes to what its own first ball left.
    EXPECT_LE(throws[1].other.felled.value_or(99) + felled(now.watched.events)[0], 10) << head_pin;
  }
}

// What stands on its spot goes with it, by the same way; what lies stays; and the room is the other one.
TEST(ASessionUnderAnotherCondition, HasItsSkittlesOnTheOtherSpots) {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/regulation-ten-pin.toml");
  Session session = make_session(scenario);
  const engine::BodyId fallen = session.stage->skittles[4], nudged = session.stage->skittles[5];
  engine::State lies = session.world.states[fallen];
  lies.X_WB = {Quat(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0), lies.X_WB.p + Vec3(0.1, 0.0, -0.08)};
  engine::set_state(session.world, fallen, lies);
  engine::State beside = session.world.states[nudged];
  beside.X_WB.p.x() += 0.03;
  engine::set_state(session.world, nudged, beside);
  scenario.lane.head_pin -= 0.5;
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  const Session moved = on_its_own(session, stage);
  for (const engine::BodyId skittle : stage->skittles) {
    const Vec3 &p = moved.world.states[skittle].X_WB.p, &spot = stage->world.states[skittle].X_WB.p;
    if (skittle == fallen) {
      EXPECT_EQ(p, lies.X_WB.p);
    } else if (skittle == nudged) {
      EXPECT_LT((p - spot - Vec3(0.03, 0.0, 0.0)).norm(), 1e-12);
    } else {
      EXPECT_EQ(p, spot);
    }
  }
  for (engine::BodyId body = 0; body < moved.world.bodies.size(); ++body) {
    if (moved.world.bodies[body].kind != engine::Kind::fixed) continue;
    EXPECT_EQ(moved.world.states[body].X_WB.p, stage->world.states[body].X_WB.p)
        << moved.world.bodies[body].name;
  }
}

TEST(EachThrow, IsRefusedWithOtherBodiesOrTicks) {
  const Scenario scenario = four_balls();
  Scenario faster = scenario, more = scenario;
  faster.rates.physics_hz = 480;
  more.rack.spots.pop_back();
  const Session session = make_session(scenario);
  EXPECT_THROW(EachThrow(session, faster), std::invalid_argument);
  EXPECT_THROW(EachThrow(session, more), std::invalid_argument);
}

TEST(Differences, AreTheKeysThatDifferAndBothValues) {
  Scenario a, b;
  EXPECT_TRUE(differences(a, b).empty());
  b.ball.mass = 3.0;
  b.collision.gravity = 1.62;
  b.version.red.shape = SkittleShape::ellipsoid;
  std::vector<std::string> keys;
  for (const KeyDifference& one : differences(a, b)) keys.push_back(one.key);
  EXPECT_THAT(keys,
              testing::UnorderedElementsAre("ball.mass", "collision.gravity", "version.red.shape"));
  for (const KeyDifference& one : differences(a, b)) {
    set(a, one.key + "=" + one.b);  // each is an assignment
  }
  EXPECT_EQ(to_toml(a), to_toml(b));
}

/// A trial of samples alone.
TrialFile log_of(const std::vector<devices::Sample>& samples) {
  const std::filesystem::path path = fresh_folder("conditions") / "trial.lcmlog";
  Recorder recorder(path, TrialHeader{});
  for (const devices::Sample& sample : samples) recorder.write(sample);
  recorder.close();
  return TrialFile(path);
}

/// A trial of samples is simulated to find its throws: no longer than they need.
void expect_throws_found_early(const Scenario& scenario, const HandScript& hand) {
  const TrialFile file = log_of(hand.samples);
  std::int64_t ticks = 0;
  const std::vector<Event> found = events_of(file, scenario, [&] { ++ticks; });
  EXPECT_LT(ticks, tick_count(file.summary(), scenario.rates.physics_hz) - 240);
  const std::vector<Event> all = run_with(scenario, hand.samples).watched.events;
  ASSERT_FALSE(thrown(all).empty());
  ASSERT_EQ(thrown(found).size(), thrown(all).size());
  EXPECT_EQ(thrown(found).back().felled.has_value(), thrown(all).back().felled.has_value());
  EXPECT_TRUE(without_counterpart(all, found).empty());
  EXPECT_TRUE(without_counterpart(found, all).empty());
}

TEST(Counterparts, OfATrialOfSamplesAreSoughtUntilTheLastBallIsCounted) {
  Scenario scenario = four_balls();
  scenario.game.ball_back_s = 2.0;
  expect_throws_found_early(scenario, four_throws(scenario));
}

TEST(Counterparts, OfATrialWithoutAGameAreSoughtUntilTheLastRelease) {
  const Scenario scenario;
  HandScript hand(scenario);
  hand.throw_from(0.02);
  expect_throws_found_early(scenario, hand);
}

}  // namespace
}  // namespace headpin::scene
