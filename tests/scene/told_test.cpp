// What is told of a session, from its events and states alone.

#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "scene/play/game_hash.h"
#include "scene/play/outcome.h"
#include "scene/play/presence.h"
#include "scene/play/score.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/record/file.h"
#include "scene/record/log.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

Event told(std::string_view kind, std::vector<std::string> bodies = {}, double value = 0.0,
           const std::string& detail = "") {
  Event event;
  event.kind = kind;
  event.bodies = std::move(bodies);
  event.value = value;
  event.detail = Detail::read(kind, detail);
  return event;
}

std::string why(const std::vector<Event>& events) {
  return why_nothing_fell(events);
}

TEST(WhyNothingFell, IsNotSaidWhereABallFelledASkittle) {
  const Event grab = told(kind::grab, {"ball"}), release = told(kind::release, {"ball"}, 3.0);
  EXPECT_EQ(why({grab, release, told(kind::skittle_down, {"skittle 1"}, 1.0)}), "");
  EXPECT_EQ(why({grab, release, told(kind::skittle_down, {"skittle 1"}, 1.0, "ball")}), "");
  EXPECT_NE(why({grab, release, told(kind::skittle_down, {"skittle 1"}, 1.0, "hand")}), "");
}

TEST(WhyNothingFell, IsTheFirstThingThatWasAmiss) {
  EXPECT_EQ(
      why({}),
      "the trigger was never pressed while the hand was tracked, so the ball stayed where it was");
  Event missed = told(kind::missed_grab, {"ball 2"}, 0.421);
  missed.time = Time{1'500'000};
  EXPECT_EQ(why({missed, told(kind::missed_grab, {"ball"}, 0.9)}),
            "the trigger was pressed at 1.500 s with the hand 0.42 m from the ball 2, too far to "
            "take it");
  missed.bodies.clear();
  EXPECT_THAT(why({missed}), HasSubstr("0.42 m from the ball,"));
  const Event grab = told(kind::grab, {"ball"}), release = told(kind::release, {"ball"}, 3.0);
  EXPECT_EQ(why({missed, grab}), "the ball was taken and never let go");
  EXPECT_EQ(why({grab, release}),
            "the ball was released at 3.00 m/s and touched nothing until the end");
  EXPECT_EQ(why({grab, release, told(kind::ball_touch, {"lane", "ball"}),
                 told(kind::ball_touch, {"ball", "ball 2"}), told(kind::touch, {"x", "y"})}),
            "the ball was released at 3.00 m/s and touched lane, another ball, but no skittle");
  EXPECT_EQ(why({grab, release, told(kind::first_contact, {"ball", "skittle 3"}, 2.5)}),
            "the ball met skittle 3 at 2.50 m/s, which did not fell it");
}

/// FNV-1a, byte by byte.
std::uint64_t fnv(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t hash = 14695981039346656037u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

TEST(GameHashTest, IsThatOfTheBytesOfEveryTicksHashAndVersion) {
  GameHash hash;
  EXPECT_EQ(hash.value(), fnv({}));
  hash.add(0x8123456789abcdefu, 2);
  EXPECT_EQ(hash.value(),
            fnv({0xef, 0xcd, 0xab, 0x89, 0x67, 0x45, 0x23, 0x81, 2, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(in_hex(0x1f), "000000000000001f");
}

std::optional<std::uint64_t> hash_of(const std::vector<std::int64_t>& ticks,
                                     const std::vector<Event>& events) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "trial.lcmlog").string();
  Recorder recorder(path, {});
  for (const std::int64_t tick : ticks) {
    for (const Event& event : events) {
      if (event.tick == tick) recorder.write(event);
    }
    TickState state;
    state.time = tick_time(tick, 240);
    state.tick = tick;
    state.hash = 1000u + static_cast<std::uint64_t>(tick);
    state.bodies.resize(1);
    recorder.write(state);
  }
  recorder.close();
  return game_hash_of_states(TrialFile(path));
}

TEST(GameHashTest, OfATrialsStatesIsThatOfTheSession) {
  Event red = told(kind::version, {}, 0.0, "red"), blue = told(kind::version, {}, 1.0, "blue");
  red.tick = 2;
  blue.tick = 4;
  red.time = tick_time(2, 240);
  blue.time = tick_time(4, 240);
  GameHash hash;
  const std::array<std::uint64_t, 5> versions = {0, 1, 1, 2, 2};
  for (std::size_t i = 0; i < versions.size(); ++i) hash.add(1001 + i, versions[i]);
  EXPECT_EQ(hash_of({1, 2, 3, 4, 5}, {red, blue}), hash.value());
  EXPECT_FALSE(hash_of({1, 2, 4, 5}, {red, blue})) << "a state is missing";
  EXPECT_FALSE(hash_of({2, 3}, {})) << "the first is missing";
}

TEST(GameHashTest, OfATrialIsWhatItsEventSays) {
  TrialSummary trial;
  EXPECT_FALSE(said_game_hash(trial));
  trial.events = {told(kind::release), told(kind::game_hash, {}, 0.0, "00ff")};
  trial.events.back().tick = 77;
  ASSERT_TRUE(said_game_hash(trial));
  EXPECT_EQ(said_game_hash(trial)->hash, "00ff");
  EXPECT_EQ(said_game_hash(trial)->tick, 77);
}

TEST(Approaches, AreToldWithWhatTheirEventsSay) {
  Event passed = told(kind::passed_player, {"skittle 4"}, 0.25,
                      R"({"noticed_s":1.5,"time_to_contact_s":0.75,"foreseen_m":0.1,
                          "head_away_mps2":5.25,"hand_away_mps2":1.5,"moved":true})");
  passed.time = Time{2'500'000};
  const std::vector<Event> events = {told(kind::flies_at_player, {"ball"}), passed,
                                     told(kind::passed_player, {}, 0.5, R"({"moved":false})"),
                                     told(kind::passed_player, {"ball"}, 0.5, "cut sho"),
                                     told(kind::passed_player, {"ball"}, 0.5, R"({"moved":"no"})")};
  const nlohmann::json all = approaches_of(events);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]["body"], "skittle 4");
  EXPECT_EQ(all[0]["time_s"], 2.5);
  EXPECT_EQ(all[0]["closest_m"], 0.25);
  EXPECT_EQ(all[1]["body"], "");
  const std::vector<std::string> words = approaches_in_words(events);
  ASSERT_EQ(words.size(), 3u);
  EXPECT_EQ(words[0],
            "skittle 4 flew at the player: noticed at 1.500 s, 0.75 s ahead, 0.25 m off at the "
            "closest; evaded (head 5.2, hand 1.5 m/s2 out of its way)");
  EXPECT_THAT(words[1], HasSubstr("noticed at 0.000 s, 0.00 s ahead, 0.50 m off at the closest; "
                                  "not evaded (head 0.0,"));
  EXPECT_THAT(words[2], HasSubstr("; not evaded"));
}

TEST(Approaches, AreOfWhatComesFastSoonAndNear) {
  engine::State state;
  const auto coming = [&](double speed, double time_s, double distance) {
    state.v_WB = Vec3(0.0, -speed, -50.0);  // falling is not coming
    return is_coming(state, {time_s, distance});
  };
  const Alarm alarm;
  EXPECT_TRUE(coming(1.1 * alarm.fast, 0.9 * alarm.soon_s, 0.9 * alarm.near));
  EXPECT_FALSE(coming(0.9 * alarm.fast, 0.9 * alarm.soon_s, 0.9 * alarm.near));
  EXPECT_FALSE(coming(1.1 * alarm.fast, 1.1 * alarm.soon_s, 0.9 * alarm.near));
  EXPECT_FALSE(coming(1.1 * alarm.fast, 0.9 * alarm.soon_s, 1.1 * alarm.near));
}

TEST(Passing, IsOfHeadOrHandWhicheverIsNearer) {
  const Vec3 p_WD(0.0, 0.0, 1.7);
  engine::State state;
  state.X_WB.p = Vec3(0.5, 4.0, 1.5);
  state.v_WB = Vec3(0.0, -2.0, 0.0);
  const auto seen = [&](const Vec3& p_WH) { return passing(state, 0.1, p_WD, p_WH, 0.0); };
  const auto at_hand = seen({0.5, 1.0, 1.3});
  ASSERT_TRUE(at_hand);
  EXPECT_TRUE(at_hand->at_hand);
  EXPECT_DOUBLE_EQ(at_hand->time_s, 1.5);
  EXPECT_NEAR(at_hand->distance, 0.2 - 0.1, 1e-12);
  const auto at_head = seen({-0.9, 1.0, 1.5});
  ASSERT_TRUE(at_head);
  EXPECT_FALSE(at_head->at_hand);
  EXPECT_DOUBLE_EQ(at_head->time_s, 2.0);
  EXPECT_NEAR(at_head->distance, 0.4, 1e-12);
  EXPECT_FALSE(seen({0.5, 5.0, 1.5})->at_hand) << "it flies away from the hand";
  EXPECT_EQ(seen({0.5, 1.0, 1.45})->distance, 0.0) << "inside it";
  state.v_WB.y() = 2.0;
  EXPECT_FALSE(seen({0.5, 1.0, 1.3})) << "it flies away from the head";
  state.v_WB = Vec3(0.0, 0.0, -3.0);
  EXPECT_FALSE(seen({0.5, 1.0, 1.3})) << "it falls";
}

// Slow obvious one: small steps of its fall. What lies on the floor stays at its height.
TEST(Passing, FallsOnTheWayAndRollsOnTheFloor) {
  const double gravity = 9.81, radius = 0.1;
  engine::State state;
  for (const double z : {2.5, 1.0, 0.1, 0.05}) {
    state.X_WB.p = Vec3(0.0, 3.0, z);
    state.v_WB = Vec3(0.0, -4.0, 2.0);
    const double time_s = 0.75, floor = std::min(z, radius);
    const double there = std::max(floor, z + 2.0 * time_s - 0.5 * gravity * time_s * time_s);
    const Vec3 p_WH(0.3, 0.0, 1.2);
    const double to_hand = (Vec3(0.0, 0.0, there) - p_WH).norm() - radius;
    const auto found = passing(state, radius, Vec3(1.0, 0.0, 1.7), p_WH, gravity);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->time_s, time_s);
    const double to_head = 1.0 - radius;
    EXPECT_NEAR(found->distance, std::min(to_hand, to_head), 1e-12) << z;
  }
}

const Event kGame = told(kind::game, {}, 10.0, "ten-pin");

// The referee takes a ball back that is in the hand again within half a second and has struck nothing.
TEST(ScoreTest, AFoulWhoseBallIsTakenBackIsNoMark) {
  const auto at = [](double s, Event event) {
    event.time = microseconds(s);
    return event;
  };
  const auto marks = [&](std::vector<Event> events) {
    events.insert(events.begin(), kGame);
    events.push_back(at(3.0, told(kind::release, {"ball"})));
    events.push_back(at(9.0, told(kind::delivery, {"a"}, 1.0)));
    return score(events).games.front().marks;
  };
  using testing::ElementsAre, testing::IsEmpty;
  const Event foul = at(1.0, told(kind::foul, {"ball"}));
  const std::string mark = "foul (frame 1 ball 1)";
  EXPECT_THAT(marks({foul}), ElementsAre(mark));
  EXPECT_THAT(marks({foul, at(1.05, told(kind::grab, {"ball"}))}), IsEmpty());
  EXPECT_THAT(marks({foul, at(1.5, told(kind::grab, {"ball"}))}), ElementsAre(mark));
  EXPECT_THAT(marks({foul, at(1.05, told(kind::grab, {"skittle 1"}))}), ElementsAre(mark));
  EXPECT_THAT(marks({foul, at(1.2, told(kind::first_contact, {"ball", "skittle 1"})),
                     at(1.3, told(kind::grab, {"ball"}))}),
              ElementsAre(mark));
  EXPECT_THAT(
      marks({foul, at(1.05, told(kind::grab, {"ball"})), at(2.0, told(kind::foul, {"ball"}))}),
      ElementsAre(mark));
}

TEST(ScoreTest, ASheetHasItsBallsAndItsMarks) {
  const Score found = score(std::vector<Event>{
      told(kind::version, {}, 0.0, "red"), kGame, told(kind::foul, {"ball"}),
      told(kind::delivery, {"a", "b", "c"}, 3.0), told(kind::dead_wood, {"d", "e"}, 2.0),
      told(kind::delivery, {"f"}, 1.0), told(kind::frame, {}, 1.0), told(kind::delivery, {}, 0.0),
      told(kind::dead_wood, {"g"}, 1.0), told(kind::game_over), told(kind::foul, {"ball"})});
  ASSERT_EQ(found.games.size(), 1u);
  const Sheet& sheet = found.games.front();
  EXPECT_EQ(sheet.version, "red");
  EXPECT_EQ(sheet.rack, 10);
  EXPECT_EQ(sheet.frames, (std::vector<Frame>{{3, 1}, {0}}));
  EXPECT_EQ(sheet.marks,
            (std::vector<std::string>{"foul (frame 1 ball 1)", "2 by hand (frame 1 ball 2)",
                                      "1 by hand (frame 2 ball 2)"}));
  EXPECT_TRUE(sheet.over);
  EXPECT_EQ(in_words(sheet),
            "red ten-pin: 3 1 | - = 4; foul (frame 1 ball 1), 2 by hand (frame 1 "
            "ball 2), 1 by hand (frame 2 ball 2)");
  EXPECT_EQ(found.skittles_down, 4);
  EXPECT_EQ(found.felled_by_hand, 3);
}

TEST(ScoreTest, ASheetWithoutABallSaysSo) {
  EXPECT_EQ(in_words(score(std::vector<Event>{kGame}).games.front()),
            "ten-pin: no ball = 0 (not over)");
}

TEST(ScoreTest, WhatFellBeforeTheFirstGameIsInNoSheetAndAnUnknownGameIsNone) {
  const std::vector<Event> before = {
      told(kind::skittle_down, {"a"}, 1.0), told(kind::skittle_down, {"b"}, 2.0, "hand"),
      told(kind::delivery, {}, 5.0), told(kind::game, {}, 10.0, "chess")};
  EXPECT_EQ(score(before).skittles_down, 1);
  EXPECT_EQ(score(before).felled_by_hand, 1);
  EXPECT_TRUE(score(before).games.empty());
  std::vector<Event> all = before;
  all.push_back(kGame);
  all.push_back(told(kind::skittle_down, {"c"}, 3.0));
  EXPECT_EQ(score(all).skittles_down, 0);
  EXPECT_EQ(score(all).felled_by_hand, 0);
  all.push_back(told(kind::delivery, {"c"}, 1.0));
  all.push_back(kGame);  // of the other version: sums go on
  EXPECT_EQ(score(all).skittles_down, 1);
  EXPECT_EQ(score(all).games.size(), 2u);
}

TEST(ScoreTest, TouchesAreOfSkittlesAndTheFirstContactIsOne) {
  EXPECT_EQ(score(std::vector<Event>{told(kind::touch), told(kind::first_contact),
                                     told(kind::ball_touch), told(kind::touch)})
                .touches,
            3);
}

TEST(Throws, AreOfBallsAndTakeTheirFirstContactAndDelivery) {
  const std::string detail =
      R"({"trigger_s":0.5,"position_m":[0.1,0.2,0.3],"velocity_mps":[0,5,0],
          "spin_radps":[1,2,3],"known":"tracked"})";
  Event first = told(kind::first_contact, {"ball", "a"}, 4.5, R"({"velocity_mps":[0,4.5,0]})");
  first.time = Time{2'000'000};
  Event second = first;
  second.value = 3.0;
  second.time = Time{3'000'000};
  const std::vector<Event> events = {kGame,
                                     told(kind::release, {"skittle 1"}, 1.0, detail),
                                     told(kind::release, {}, 1.0, detail),
                                     told(kind::release, {"ball"}, 5.0, detail),
                                     first,
                                     second,
                                     told(kind::dead_wood, {"x"}, 1.0),
                                     told(kind::delivery, {"a", "b"}, 2.0),
                                     told(kind::delivery, {"c"}, 1.0)};
  const Score found = score(events);
  ASSERT_EQ(found.throws.size(), 1u);
  const ThrowRow& row = found.throws.front();
  EXPECT_EQ(row.body, "ball");
  EXPECT_EQ(row.trigger_s, 0.5);
  EXPECT_EQ(row.known, "tracked");
  EXPECT_EQ(row.p_WB, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(row.w_WB, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(row.foul, true);
  EXPECT_EQ(row.entry, Time{2'000'000});
  EXPECT_EQ(row.entry_speed, 4.5);
  EXPECT_EQ(row.entry_angle_deg, 0.0);
  EXPECT_EQ(row.frame, 1);
  EXPECT_EQ(row.ball, 1);
  EXPECT_EQ(row.counted, 2);
  EXPECT_EQ(row.felled_by_ball, 2);
  EXPECT_EQ(row.felled_by_hand, 1);
  EXPECT_EQ(found.release_speed, 5.0);
  EXPECT_EQ(found.impact_speed, 4.5);
}

TEST(Throws, ThatNobodySawLeaveStillStruck) {
  const std::vector<Event> events = {told(kind::first_contact, {"ball", "a"}, 3.0),
                                     told(kind::first_contact, {"ball", "b"}, 2.0)};
  EXPECT_EQ(score(events).impact_speed, 3.0);
  EXPECT_FALSE(score(events).release_speed);
  EXPECT_TRUE(score(events).throws.empty());
}

TEST(Throws, HaveNoPlaceWhereThreeNumbersAreNoList) {
  const Score found = score(std::vector<Event>{told(
      kind::release, {"ball"}, 5.0, R"({"position_m":{"x":1,"y":2,"z":3},"velocity_mps":7})")});
  ASSERT_EQ(found.throws.size(), 1u);
  EXPECT_FALSE(found.throws.front().p_WB);
  EXPECT_FALSE(found.throws.front().v_WB);
}

TEST(Throws, WithoutAGameHaveWhatFellSinceAndNoFoulOnTheLine) {
  const std::vector<Event> events = {
      told(kind::skittle_down, {"z"}, 1.0, "hand"),
      told(kind::release, {"ball"}, 5.0, R"({"position_m":[0,0,0.3],"velocity_mps":[0,5]})"),
      told(kind::skittle_down, {"a"}, 2.0),
      told(kind::skittle_down, {"b"}, 3.0, "hand"),
      told(kind::release, {"ball 2"}, 6.0, R"({"position_m":["x",0,0],"trigger_s":"x","known":1})"),
      told(kind::skittle_down, {"c"}, 4.0),
      told(kind::skittle_down, {"d"}, 5.0)};
  const Score found = score(events);
  ASSERT_EQ(found.throws.size(), 2u);
  EXPECT_EQ(found.throws[0].felled_by_ball, 1);
  EXPECT_EQ(found.throws[0].felled_by_hand, 1);
  EXPECT_EQ(found.throws[0].foul, false);
  EXPECT_FALSE(found.throws[0].v_WB) << "of two numbers";
  EXPECT_EQ(found.throws[1].felled_by_ball, 2);
  EXPECT_EQ(found.throws[1].felled_by_hand, 0);
  EXPECT_FALSE(found.throws[1].p_WB) << "no number";
  EXPECT_FALSE(found.throws[1].trigger_s);
  EXPECT_FALSE(found.throws[1].foul);
  EXPECT_EQ(found.skittles_down, 3);
  EXPECT_EQ(found.felled_by_hand, 2);
  EXPECT_EQ(found.release_speed, 5.0);
}

TEST(WhyNothingFell, IsAboutTheBallNotAboutASkittleInTheHand) {
  const Event taken = told(kind::grab, {"skittle 1"}),
              let_go = told(kind::release, {"skittle 1"}, 6.0);
  EXPECT_EQ(why({taken}), "the hand took skittle 1, not the ball");
  EXPECT_EQ(why({told(kind::missed_grab, {"ball"}, 0.9), taken, let_go}),
            "the hand took skittle 1, not the ball");
  const Event grab = told(kind::grab, {"ball"}), release = told(kind::release, {"ball"}, 3.0);
  EXPECT_EQ(why({taken, let_go, grab}), "the ball was taken and never let go");
  EXPECT_EQ(why({taken, let_go, grab, release}),
            "the ball was released at 3.00 m/s and touched nothing until the end");
}

TEST(WhyNothingFell, IsNotSaidOfABallThatWasCountedForMovedSkittles) {
  const Event grab = told(kind::grab, {"ball"}), release = told(kind::release, {"ball"}, 3.0),
              contact = told(kind::first_contact, {"ball", "skittle 1"}, 2.0);
  EXPECT_EQ(why({grab, release, contact, told(kind::delivery, {"skittle 1"}, 1.0)}), "");
  EXPECT_EQ(why({grab, release, contact, told(kind::delivery, {"skittle 1"}, 0.0)}), "")
      << "a foul";
  EXPECT_EQ(why({grab, release, contact, told(kind::delivery)}),
            "the ball met skittle 1 at 2.00 m/s, which did not fell it");
}

}  // namespace
}  // namespace headpin::scene
