// Virtual participants as a user meets them: synthesized, replayed, compared.

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

class ParticipantCommands : public CommandLine {};

TEST_F(ParticipantCommands, ASessionIsSynthesizedReplayedVerifiedAndCompared) {
  const nlohmann::json made =
      json("synthesize --participant 7 --throws 2 -o samples.lcmlog --json");
  EXPECT_EQ(made["throws"], 4);
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

TEST_F(ParticipantCommands, ThrowsThatTheGameLeavesNoTimeForAreTold) {
  const std::string line = "synthesize --participant 3 --scenario english-skittles --throws 50 ";
  const nlohmann::json made = json(line + "-o all.lcmlog --json");
  EXPECT_EQ(made["throws_asked"], 50);
  EXPECT_LT(made["throws"], 50);
  EXPECT_THAT(headpin(line + "-o again.lcmlog").out,
              testing::HasSubstr(made["throws"].dump() + " of 50, then the game was over"));
}

TEST_F(ParticipantCommands, WhatDoesNotGoTogetherIsRefused) {
  expect_refusal("synthesize --participant 7 -o session.csv", 2, ".lcmlog");
  expect_refusal("synthesize --participant 7 --speed 6 -o session.lcmlog", 2, "--speed");
  expect_refusal("synthesize --throws 3 -o session.lcmlog", 2, "--participant");
  expect_refusal("synthesize --participant -1 -o session.lcmlog", 2, "--participant");
}

}  // namespace
}  // namespace headpin
