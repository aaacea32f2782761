// Virtual participants as a user meets them: synthesized, replayed, compared.

#include <algorithm>

#include <fmt/format.h>

#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/file.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

class ParticipantCommands : public CommandLine {};

TEST_F(ParticipantCommands, AScatterWithoutAUnitHasThatOfItsNumber) {
  const auto speed = [&](const std::string& typed) {
    const nlohmann::json made = json(
        "synthesize --json --force -o t.lcmlog --scenario house-oil --seed 2 --speed " + typed);
    return made["level_speed_mps"].get<double>();
  };
  const double found = speed("14mph+-0.5");
  EXPECT_EQ(found, speed("14mph+-0.5mph"));
  EXPECT_NE(found, speed("14mph+-0.5m/s"));
  EXPECT_EQ(speed("6.5+-0.2"), speed("6.5m/s+-0.2m/s"));
}

TEST_F(ParticipantCommands, ASessionIsSynthesizedReplayedVerifiedAndCompared) {
  const nlohmann::json made =
      json("synthesize --participant 7 --throws 2 -o samples.lcmlog --json");
  EXPECT_EQ(made["throw_count"], 4);
  EXPECT_EQ(made["gave_up"], false);
  ASSERT_EQ(made["games"].size(), 2u);
  EXPECT_TRUE(json("info samples.lcmlog --json")["events"].empty());  // samples alone
  const nlohmann::json played = json("replay samples.lcmlog -o played.lcmlog --json");
  EXPECT_EQ(played["games"], made["games"]);
  EXPECT_EQ(headpin("replay played.lcmlog --verify").code, 0);
  const nlohmann::json info = json("info played.lcmlog --json");
  EXPECT_EQ(info["result"]["games"], made["games"]);
  EXPECT_EQ(info["participant"], "virtual 7");
  EXPECT_TRUE(info["result"]["approaches"].is_array());
  // The other version's parameters, the same hand.
  const nlohmann::json other = json(
      "replay played.lcmlog --set version.red.friction=0 --set version.blue.friction=0.7 "
      "-o other.lcmlog --json");
  EXPECT_NE(other["games"], made["games"]);
  const nlohmann::json compared = json("compare played.lcmlog other.lcmlog --json");
  EXPECT_EQ(compared["a"]["games"], made["games"]);
  EXPECT_EQ(compared["b"]["games"], other["games"]);
  const std::string words = headpin("compare played.lcmlog other.lcmlog").out;
  for (const nlohmann::json& games : {made["games"], other["games"]}) {
    for (const nlohmann::json& game : games) {
      EXPECT_THAT(words, testing::HasSubstr(game["sheet"].get<std::string>()));
    }
  }
}

// Two versions of a game: options act on both, or say on which.
TEST_F(ParticipantCommands, OptionsActOnEveryVersionAndSetOnTheOneItNames) {
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 -o s.lcmlog").code, 0);
  const nlohmann::json as_it_is = json("replay s.lcmlog --json");
  const std::string smooth = json(
      "replay s.lcmlog --json --set version.red.friction=0 --set "
      "version.blue.friction=0")["game_hash"];
  EXPECT_NE(smooth, as_it_is["game_hash"]);
  const nlohmann::json all = json("replay s.lcmlog --friction 0 --json");
  EXPECT_EQ(all["game_hash"], smooth);
  EXPECT_EQ(all["versions"]["red"]["friction"]["ball"], 0.0);
  EXPECT_EQ(json("replay s.lcmlog --json --set material.skittle.friction=0 "
                 "--set material.ball.friction=0 --set material.lane.friction=0 "
                 "--set material.wall.friction=0")["game_hash"],
            smooth);
  const nlohmann::json shaped = json("replay s.lcmlog --shape ellipsoid --json");
  EXPECT_EQ(shaped["versions"]["blue"]["shape"], "ellipsoid");
  EXPECT_NE(shaped["games"], as_it_is["games"]);
  EXPECT_EQ(json("replay s.lcmlog --set collision.shape=ellipsoid --json")["game_hash"],
            shaped["game_hash"]);
  const nlohmann::json one =
      json("replay s.lcmlog --json --set version.red.friction=0.25 --friction 0.5");
  EXPECT_EQ(one["versions"]["red"]["friction"]["ball"], 0.25);
  EXPECT_EQ(one["versions"]["blue"]["friction"]["ball"], 0.5);
  EXPECT_TRUE(one["friction"].is_null());  // of no one version
  expect_refusal("replay s.lcmlog --set material.ball.friction=0", 2, "version.red.friction");
  const std::string words = headpin("replay s.lcmlog --friction 0").out;
  EXPECT_THAT(words, testing::HasSubstr("red version       elasticity 0.7 each, friction 0 each"));
  EXPECT_THAT(words, testing::HasSubstr("blue version      elasticity 0.7 each, friction 0 each"));
}

// The ball is still among the skittles when the default duration ends.
TEST_F(ParticipantCommands, ATrialThatEndsBeforeItsBallsWayTellsTheWaySoFar) {
  ASSERT_EQ(headpin("synthesize --seed 1 --speed 4 -o short.lcmlog").code, 0);
  ASSERT_EQ(headpin("synthesize --seed 1 --speed 4 --duration 9 -o long.lcmlog").code, 0);
  const nlohmann::json part = json("replay short.lcmlog -o short-run.lcmlog --json")["throws"][0];
  const nlohmann::json whole = json("replay long.lcmlog -o long-run.lcmlog --json")["throws"][0];
  for (const char* key : {"board", "launch_angle_deg", "level_speed_mps", "revs_per_min",
                          "loft_end_m", "entry_board", "entry_revs_per_min"}) {
    EXPECT_TRUE(part[key].is_number()) << key;
    EXPECT_EQ(part[key], whole[key]) << key;
  }
  EXPECT_EQ(json("info short-run.lcmlog --json")["result"]["throws"][0], part);
  EXPECT_EQ(headpin("replay short-run.lcmlog --verify").code, 0);
  for (const char* trial : {"short-run.lcmlog", "long-run.lcmlog"}) {
    const auto events = scene::TrialFile(folder_ / trial).summary().events;
    EXPECT_EQ(std::ranges::count(events, scene::kind::ball_path, &scene::Event::kind), 1) << trial;
  }
}

// A spare's ball may pass the head pin's spot before it meets one.
TEST_F(ParticipantCommands, ABallsEntryIsAtItsFirstSkittleWhereverThatStands) {
  ASSERT_EQ(headpin("synthesize --scenario regulation-ten-pin --participant 7 --throws 6 "
                    "-o s.lcmlog")
                .code,
            0);
  ASSERT_EQ(headpin("replay s.lcmlog -o run.lcmlog").code, 0);
  const scene::TrialFile run(folder_ / "run.lcmlog");
  int met = 0;
  for (const scene::ThrowRow& row : scene::score(run.summary().events).throws) {
    if (!row.path || !row.entry) continue;
    ++met;
    ASSERT_TRUE(row.path->entry);
    EXPECT_EQ(row.path->entry->angle_deg, *row.entry_angle_deg) << row.frame << " " << row.ball;
  }
  EXPECT_EQ(met, 6);
}

TEST_F(ParticipantCommands, ALeftHandedOnesHandIsTheLeftHand) {
  for (const char* seed : {"7", "11"}) {
    const bool left = json(fmt::format(
        "synthesize --participant {0} --throws 1 -o {0}.lcmlog --json", seed))["left_handed"];
    EXPECT_EQ(left, seed == std::string("11"));
    const std::string scenario = headpin(fmt::format("info {}.lcmlog --scenario", seed)).out;
    EXPECT_THAT(scenario, testing::HasSubstr(left ? "hand_station = 3" : "hand_station = 2"));
    const std::string words = headpin(fmt::format("info {}.lcmlog", seed)).out;
    EXPECT_THAT(words, testing::HasSubstr(left ? "left hand" : "right hand"));
    EXPECT_THAT(words, testing::Not(testing::HasSubstr(left ? "right hand" : "left hand")));
  }
}

TEST_F(ParticipantCommands, WhatDiffersBetweenTwoTrialsIsNamed) {
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 -o s.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay s.lcmlog -o a.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay s.lcmlog -o b.lcmlog --set ball.mass=3 --set "
                    "collision.gravity=1.62 --set lane.masking_panel=true")
                .code,
            0);
  const nlohmann::json compared = json("compare a.lcmlog b.lcmlog --json");
  std::vector<std::string> keys;
  for (const auto& one : compared["scenario_differences"]) keys.push_back(one["key"]);
  EXPECT_THAT(
      keys, testing::UnorderedElementsAre("ball.mass", "collision.gravity", "lane.masking_panel"));
  EXPECT_TRUE(compared["bodies_only_in_a"].empty());
  EXPECT_EQ(compared["bodies_only_in_b"].size(), 1u);
  EXPECT_NE(compared["first_difference_tick"], 1);  // a body that both have
  EXPECT_NE(compared["a"]["game_hash"], compared["b"]["game_hash"]);
  EXPECT_EQ(compared["a"]["game_hash"], json("replay s.lcmlog --json")["game_hash"]);
  const std::string words = headpin("compare a.lcmlog b.lcmlog").out;
  for (const char* part : {"other bodies      only b has: ", "ball.mass ", "collision.gravity ",
                           "1.62", "red friction ", "blue friction ", "game hash "}) {
    EXPECT_THAT(words, testing::HasSubstr(part));
  }
}

TEST_F(ParticipantCommands, ThrowsThatAnotherConditionLosesAreToldAndMadeOnTheirOwn) {
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 2 -o s.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay s.lcmlog -o played.lcmlog").code, 0);
  const std::string late = " --friction 0 --set game.ball_back_s=100";
  const nlohmann::json same = json("replay played.lcmlog --json");
  EXPECT_EQ(same["throws"].size(), 4u);
  EXPECT_TRUE(same["throws_without_counterpart"].empty() && same["new_throws"].empty());
  const nlohmann::json lost = json("replay played.lcmlog -o late.lcmlog --json" + late);
  const auto& unpaired = lost["throws_without_counterpart"];
  ASSERT_FALSE(unpaired.empty());
  // A trial of samples alone is as it was recorded, too.
  EXPECT_EQ(json("replay s.lcmlog --json" + late)["throws_without_counterpart"], unpaired);
  EXPECT_TRUE(json("replay s.lcmlog --json")["throws_without_counterpart"].empty());
  EXPECT_EQ(json("compare played.lcmlog late.lcmlog --json")["a"]["throws_without_counterpart"],
            unpaired);
  EXPECT_THAT(headpin("replay played.lcmlog" + late).out,
              testing::HasSubstr("has no counterpart here: throw "));
  EXPECT_THAT(headpin("compare played.lcmlog late.lcmlog").out,
              testing::HasSubstr("of 4 throws of a have no counterpart in the other"));

  const nlohmann::json each = json("replay played.lcmlog --each-throw --friction 0 --json");
  ASSERT_EQ(each["each_throw"].size(), 4u);
  for (const auto& one : each["each_throw"]) {
    EXPECT_EQ(one["felled"], one["as_it_was"]["felled"]);
    EXPECT_TRUE(one["other_condition"]["felled"].is_number()) << one;
  }
  EXPECT_THAT(headpin("replay played.lcmlog --each-throw").out,
              testing::HasSubstr("other condition"));
  expect_refusal("replay played.lcmlog --each-throw -o x.lcmlog", 2, "--each-throw");
  expect_refusal("replay played.lcmlog --each-throw --set rates.physics_hz=480", 2, "physics_hz");
}

TEST_F(ParticipantCommands, ThrowsThatTheGameLeavesNoTimeForAreTold) {
  const std::string line = "synthesize --participant 3 --scenario english-skittles --throws 50 ";
  const nlohmann::json made = json(line + "-o all.lcmlog --json");
  EXPECT_EQ(made["throws_asked"], 50);
  EXPECT_LT(made["throw_count"], 50);
  EXPECT_THAT(headpin(line + "-o again.lcmlog").out,
              testing::HasSubstr(made["throw_count"].dump() + " of 50, then the game was over"));
  // A room without a game has no end of one.
  const std::string out =
      headpin("synthesize --participant 3 --scenario paper-room --throws 2 -o room.lcmlog").out;
  EXPECT_THAT(out,
              testing::HasSubstr("1 of 2, as no ball comes back with game.rules \"one-throw\"\n"));
}

TEST_F(ParticipantCommands, WhatDoesNotGoTogetherIsRefused) {
  expect_refusal("synthesize --participant 7 -o session.csv", 2, ".lcmlog");
  expect_refusal("synthesize --participant 7 --speed 6 -o session.lcmlog", 2, "--speed");
  expect_refusal("synthesize --throws 3 -o session.lcmlog", 2, "--participant");
  expect_refusal("synthesize --participant -1 -o session.lcmlog", 2, "--participant");
}

}  // namespace
}  // namespace headpin
