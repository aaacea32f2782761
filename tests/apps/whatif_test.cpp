// What-if as a laboratory meets it: its tables against replays, its refusals, its end.

#include <cmath>
#include <csignal>
#include <map>

#include "tests/apps/command_line.h"
#include "tests/support/csv_rows.h"

namespace headpin {
namespace {

using testing::HasSubstr;

const std::string kOne = " --speed 1 --direction 0 --height 0 --spin 0";

class WhatIfCommand : public CommandLine {};

TEST_F(WhatIfCommand, TheReleaseAsItWasIsTheReplay) {
  const nlohmann::json replay = json("replay '" + kDemo + "' --json");
  const nlohmann::json whatif =
      json("whatif '" + kDemo + "' -o OUT --within 10 --step 2.5" + kOne + " --json");
  EXPECT_EQ(whatif["release_speed_mps"], replay["release_speed_mps"]);
  EXPECT_EQ(whatif["skittles_down"], replay["skittles_down"]);
  EXPECT_EQ(whatif["moments"], 9);
  EXPECT_EQ(whatif["grid_releases"], 1);
  EXPECT_EQ(whatif["success_share"], 1.0);
  EXPECT_LE(whatif["window"]["from_ms"], 0.0);
  EXPECT_GE(whatif["window"]["to_ms"], 0.0);
  auto rows = csv_rows(slurp(folder_ / "OUT/moments.csv"));
  ASSERT_EQ(rows.size(), 9u);
  EXPECT_EQ(rows[0]["later_ms"], "-10");
  EXPECT_EQ(rows[4]["later_ms"], "0");
  EXPECT_EQ(std::stod(rows[4]["entry_speed_mps"]), replay["impact_speed_mps"]);
  EXPECT_EQ(std::stoi(rows[4]["skittles_down"]), replay["skittles_down"]);
  auto grid = csv_rows(slurp(folder_ / "OUT/releases.csv"));
  ASSERT_EQ(grid.size(), 1u);
  EXPECT_EQ(grid[0]["entry_speed_mps"], rows[4]["entry_speed_mps"]);
  EXPECT_EQ(grid[0]["speed_factor"], "1");
  auto own = csv_rows(slurp(folder_ / "OUT/throws.csv"));
  ASSERT_EQ(own.size(), 1u);
  EXPECT_EQ(own[0]["trial"], "demo.lcmlog");
  EXPECT_EQ(std::stoi(own[0]["skittles_down"]), replay["skittles_down"]);
  for (const char* picture : {"moments.svg", "map.svg"}) {
    const std::string svg = slurp(folder_ / "OUT" / picture);
    EXPECT_THAT(svg, testing::StartsWith("<svg xmlns="));
    EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
  }
}

// The fastest moment that `info` tells is that of the releases at each millisecond around the real one.
TEST_F(WhatIfCommand, HasTheFastestMomentThatInfoTells) {
  ASSERT_EQ(headpin("synthesize -o s.lcmlog").code, 0);
  ASSERT_EQ(headpin("replay s.lcmlog -o run.lcmlog").code, 0);
  const nlohmann::json told = json("info run.lcmlog --json")["releases"].at(0);
  ASSERT_EQ(headpin("whatif run.lcmlog -o OUT --within 100 --step 1" + kOne).code, 0);
  double fastest = 0.0, at_ms = 0.0;
  for (auto& row : csv_rows(slurp(folder_ / "OUT/moments.csv"))) {
    EXPECT_EQ(std::stod(row["later_ms"]), std::round(std::stod(row["later_ms"])));
    const double speed = std::stod(row["speed_mps"]);
    if (speed > fastest) fastest = speed, at_ms = std::stod(row["later_ms"]);
  }
  EXPECT_NEAR(told["fastest_mps"].get<double>(), fastest, 1e-9);
  EXPECT_NEAR(1e3 * (told["fastest_s"].get<double>() - told["time_s"].get<double>()), at_ms, 1e-6);
}

TEST_F(WhatIfCommand, IsAskedUnderAnyCondition) {
  const nlohmann::json replay = json("replay '" + kDemo + "' --friction 0.9 --elasticity 0 --json");
  const nlohmann::json whatif =
      json("whatif '" + kDemo + "' --friction 0.9 --elasticity 0 --within 0 --json" + kOne);
  EXPECT_EQ(whatif["skittles_down"], replay["skittles_down"]);
  EXPECT_EQ(whatif["moments"], 1);
}

// Under another condition a ball may be elsewhere, so that a throw is lost: the others keep their numbers.
TEST_F(WhatIfCommand, ThrowsKeepTheirNumbersUnderACondition) {
  ASSERT_EQ(headpin("synthesize -o s.lcmlog --participant 11 --throws 3").code, 0);
  const std::string ask = "whatif s.lcmlog --within 0" + kOne;
  const Result none = headpin(ask + " --throw 99");
  EXPECT_EQ(none.code, 2);
  int lost = 0, throws = 0;
  for (int number = 1; number <= 6; ++number) {
    const std::string its = " --throw " + std::to_string(number) + " --json";
    const nlohmann::json own = json(ask + its);
    const Result other = headpin(ask + its + " --friction 1");
    if (other.code != 0) {
      EXPECT_THAT(other.out, HasSubstr("is lost under this condition"));
      ++lost;
      continue;
    }
    const nlohmann::json same = nlohmann::json::parse(other.out);
    EXPECT_EQ(same["throw"], number);
    EXPECT_EQ(same["release_speed_mps"], own["release_speed_mps"]) << number;
    ++throws;
  }
  EXPECT_GT(lost, 0);
  EXPECT_GT(throws, 2);
}

// A hand lower than the lane lets the ball go on it.
TEST_F(WhatIfCommand, ARowHasTheHeightThatTheBallReallyHad) {
  ASSERT_EQ(headpin("whatif '" + kDemo +
                    "' -o low --within 0 --speed 1 --direction 0 --spin 0 "
                    "--height -2:0:3")
                .code,
            0);
  for (auto& row : csv_rows(slurp(folder_ / "low/releases.csv"))) {
    EXPECT_GT(std::stod(row["height_m"]), 0.108) << row["raised_m"];
  }
}

TEST_F(WhatIfCommand, TheNumberOfJobsDoesNotChangeAByte) {
  for (const char* jobs : {"1", "3"}) {
    const Result result = headpin("whatif '" + kDemo + "' -o w" + jobs + " --jobs " + jobs +
                                  " --within 8 --step 4 --speed 0.9:1.1:3 --direction -1:1:3"
                                  " --height 0 --spin 0");
    ASSERT_EQ(result.code, 0) << result.err;
  }
  for (const char* file :
       {"moments.csv", "moments.svg", "releases.csv", "map.svg", "whatif.json"}) {
    EXPECT_EQ(slurp(folder_ / "w1" / file), slurp(folder_ / "w3" / file)) << file;
    EXPECT_FALSE(slurp(folder_ / "w1" / file).empty()) << file;
  }
}

// The scenario's own change of the release is the same as that of the grid.
TEST_F(WhatIfCommand, SeveralBoardsTellTheRoomToMiss) {
  const nlohmann::json whatif = json("whatif '" + kDemo + "' -o room --within 0" + kOne +
                                     " --board -2:2:3 --revs 0:1:2 --rotation 30 --json");
  EXPECT_EQ(whatif["grid_releases"], 6);
  ASSERT_FALSE(whatif["widest_miss_room"].is_null());
  auto grid = csv_rows(slurp(folder_ / "room/releases.csv"));
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid[5]["moved_boards"], "2");
  EXPECT_EQ(grid[5]["revs_factor"], "1");
  const nlohmann::json replay = json("replay '" + kDemo +
                                     "' --json --set release.boards=2 --set "
                                     "release.rotation_deg=30");
  EXPECT_EQ(std::stod(grid[5]["entry_speed_mps"]), replay["impact_speed_mps"]);
  EXPECT_THAT(slurp(folder_ / "room/boards.svg"), testing::EndsWith("</svg>\n"));
  EXPECT_THAT(headpin("whatif '" + kDemo + "' --within 0 --board -1:1:3" + kOne).out,
              HasSubstr("\nmiss room         "));
  expect_refusal("whatif '" + kDemo + "' -o OUT --board 40", 2, "--board: expected FROM:TO:STEPS");
}

TEST_F(WhatIfCommand, AGridWithoutTheThrowItselfIsNotTakenForIt) {
  const auto of = [&](const std::string& axes) {
    fs::remove_all(folder_ / "w");
    return headpin("whatif '" + kDemo + "' -o w --within 0 --height 0 --spin 0" + axes);
  };
  const auto has_cross = [&](const std::string& name) {
    return slurp(folder_ / "w" / name).find("stroke='#d03020'") != std::string::npos;
  };
  const Result away = of(" --speed 1 --direction 0 --board 1:2:2");
  ASSERT_EQ(away.code, 0) << away.err;
  EXPECT_THAT(away.out, HasSubstr("\nmiss room         not in the grid"));
  EXPECT_FALSE(has_cross("boards.svg"));
  EXPECT_FALSE(has_cross("map.svg"));
  for (const char* axes :
       {" --speed 1 --direction 1", " --speed 0.8 --direction 0", " --speed 1 --direction 3:9:3",
        " --speed 1.5:2:3 --direction 0", " --speed 1 --direction 0 --revs 1.5"}) {
    ASSERT_EQ(of(axes).code, 0);
    EXPECT_FALSE(has_cross("map.svg")) << axes;
  }
  ASSERT_EQ(of(" --speed 0.9:1.1:2 --direction -1:1:3").code, 0);
  EXPECT_TRUE(has_cross("map.svg"));  // between two cells
  fs::remove_all(folder_ / "w");
  ASSERT_EQ(headpin("whatif '" + kDemo +
                    "' -o w --within 0 --speed 1 --direction 0 --height 0:0.1:2 --spin -5:5:3")
                .code,
            0);
  const std::string map = slurp(folder_ / "w/map.svg");
  const std::size_t cross = map.find("stroke='#d03020'");
  ASSERT_NE(cross, map.npos);
  EXPECT_EQ(map.find("stroke='#d03020'", cross + 1), map.npos);  // in one of six maps
}

// Sessions of a study all have a run-01.
TEST_F(WhatIfCommand, TrialsWithOneNameAreToldApart) {
  for (const char* folder : {"a", "b"}) {
    fs::create_directory(folder_ / folder);
    fs::copy_file(kDemo, folder_ / folder / "run-01.lcmlog");
  }
  fs::copy_file(kDemo, folder_ / "other.lcmlog");
  const Result result =
      headpin("whatif a/run-01.lcmlog b/run-01.lcmlog other.lcmlog -o w --within 0" + kOne);
  ASSERT_EQ(result.code, 0) << result.err;
  auto throws = csv_rows(slurp(folder_ / "w/throws.csv"));
  ASSERT_EQ(throws.size(), 3u);
  EXPECT_EQ(throws[0]["trial"], "a/run-01.lcmlog");
  EXPECT_EQ(throws[1]["trial"], "b/run-01.lcmlog");
  EXPECT_EQ(throws[2]["trial"], "other.lcmlog");
}

TEST_F(WhatIfCommand, RefusesWhatCannotBe) {
  const std::string demo = "whatif '" + kDemo + "' -o OUT ";
  expect_refusal(demo + "--throw 2", 2, "--throw: expected a throw of");
  expect_refusal(demo + "--costs", 2, "--costs: expected two throws");
  for (const char* axis : {"1:2", "1:2:", "a", "", "0:1:3", "1:0.5:3", "1:1:2", "1:2:0", "1:2:3x",
                           "nan", "1:inf:3", "1:2:1001", "1:2:3:4"}) {
    expect_refusal(demo + "--speed '" + axis + "'", 2, "--speed: expected FROM:TO:STEPS");
  }
  expect_refusal(demo + "--speed 0.5:2:1000 --direction -9:9:1000 --height 0:1:2", 2,
                 "expected at most 1000000 releases");
  expect_refusal(demo + "--step 0", 2, "--step");
  expect_refusal(demo + "--within 501", 2, "--within");
  expect_refusal("whatif gone.lcmlog -o OUT", 1, "gone.lcmlog: cannot open");
  expect_refusal(demo + "--set rig.hand_station=3", 1, "demo.lcmlog: has no throw; expected");
}

// The added spin is about the direction of the throw.
TEST_F(WhatIfCommand, ABallAtRestHasNoDirectionToSpinAbout) {
  const std::string at_rest = "whatif '" + kDemo +
                              "' -o OUT --within 0 --speed 1 --direction 0 --height 0 "
                              "--set release.speed=0 ";
  expect_refusal(at_rest + "--spin 0:5:2", 2,
                 "--spin: expected 0 with release.speed 0, because a ball at rest has no direction "
                 "to spin about; found 0:5:2");
  EXPECT_EQ(json(at_rest + "--spin 0 --json")["grid_releases"], 1);
  EXPECT_EQ(json(at_rest + "--force --json")["grid_releases"], 1);  // not -10, 0 and 10
}

TEST_F(WhatIfCommand, ReplacesOnlyItsOwn) {
  const std::string ask = "whatif '" + kDemo + "' --within 0 -o w" + kOne;
  ASSERT_EQ(headpin(ask).code, 0);
  EXPECT_EQ(headpin(ask).code, 1);
  spit(folder_ / "w/thesis.tex", "x");
  EXPECT_EQ(headpin(ask + " --force").code, 1);
  EXPECT_EQ(slurp(folder_ / "w/thesis.tex"), "x");
}

TEST_F(WhatIfCommand, StoppedItLeavesNothing) {
  const pid_t process = started({"whatif", kDemo, "-o", "OUT", "--speed", "0.5:2:100"});
  while (!fs::exists(folder_ / "OUT/.headpin.part")) usleep(1000);
  kill(process, SIGTERM);
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, 0), process);
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(folder_ / "OUT"));
}

// Its throws counted twice in the costs.
TEST_F(WhatIfCommand, ATrialThatIsGivenTwiceIsRefused) {
  for (const char* name : {"a.lcmlog", "b.lcmlog"}) fs::copy_file(kDemo, folder_ / name);
  expect_refusal("whatif b.lcmlog a.lcmlog ./b.lcmlog --costs -o OUT" + kOne, 2,
                 "TRIALS: expected each trial once, found ./b.lcmlog twice");
}

}  // namespace
}  // namespace headpin
