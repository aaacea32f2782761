// Sweeps as a laboratory meets them: whole, in parts, stopped, killed, damaged.

#include <chrono>
#include <csignal>
#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "tests/apps/command_line.h"
#include "tests/support/csv_rows.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class SweepCommands : public CommandLine {
 protected:
  SweepCommands() {
    // A second of the throw: the ball's way to the skittles.
    EXPECT_EQ(headpin("synthesize -o throw.lcmlog --seed 4").code, 0);
    write_design(
        "[grid]\nelasticity = [0, 0.5, 1]\nfriction = [0, 0.7]\nshape = ['ellipsoid', 'true']\n"
        "[random]\ndraws = 2\nball.mass = {from = 5, to = 7}\n");
  }

  void write_design(const std::string& text) const {
    std::ofstream(folder_ / "sweep.toml") << "trials = ['throw.lcmlog']\n" << text;
  }

  void plan(const std::string& name) const {
    const Result planned = headpin("sweep plan sweep.toml -o " + name);
    ASSERT_EQ(planned.code, 0) << planned.err;
  }

  std::string merged(const std::string& name) const {
    const Result result = headpin("sweep merge " + name + " -o " + name + ".csv --force");
    EXPECT_EQ(result.code, 0) << result.err;
    return slurp(folder_ / (name + ".csv"));
  }

  /// What one process comes to that nobody disturbs.
  std::string undisturbed() const {
    plan("whole");
    EXPECT_EQ(headpin("sweep run whole --jobs 1").code, 0);
    return merged("whole");
  }
};

TEST_F(SweepCommands, ARowIsTheReplayUnderItsCondition) {
  auto rows = csv_rows(undisturbed());
  ASSERT_EQ(rows.size(), 24u);
  for (const std::size_t i : {0u, 7u, 12u, 23u}) {
    auto& row = rows[i];
    const nlohmann::json replay =
        json("replay throw.lcmlog --json --elasticity " + row["elasticity"] + " --friction " +
             row["friction"] + " --shape " + row["shape"] + " --set ball.mass=" + row["ball.mass"]);
    EXPECT_EQ(row["state_hash"], replay["state_hash"]);
    EXPECT_EQ(std::stoi(row["skittles_down"]), replay["skittles_down"]);
    EXPECT_EQ(std::stod(row["release_speed_mps"]), replay["release_speed_mps"]);
    if (!row["impact_speed_mps"].empty()) {
      EXPECT_EQ(std::stod(row["impact_speed_mps"]), replay["impact_speed_mps"]);
    }
    EXPECT_EQ(std::stol(row["impacts"]), replay["statistics"]["impacts"]);
    EXPECT_EQ(std::stod(row["simulated_s"]), replay["simulated_s"]);
  }
  const nlohmann::json status = json("sweep status whole --json");
  EXPECT_EQ(status["done"], 24);
  EXPECT_EQ(status["failed"], 0);
}

// The motion is the same whatever the display's rate; of other ticks, only those of the same time count.
TEST_F(SweepCommands, BodiesAreComparedWithWhereTheyWereAtTheSameTime) {
  write_design("[grid]\nrates.frame_hz = [60, 30, 120]\n");
  for (auto& row : csv_rows(undisturbed())) {
    EXPECT_EQ(row["apart_arcmin"], "0") << row["rates.frame_hz"];
  }
  write_design("[grid]\nrates.physics_hz = [240, 360]\n");
  plan("ticks");
  EXPECT_EQ(headpin("sweep run ticks --jobs 1").code, 0);
  auto rows = csv_rows(merged("ticks"));
  ASSERT_EQ(rows.size(), 2u);
  // The ball goes 30 mm in a tick: half a degree from near by, before anything falls otherwise.
  EXPECT_EQ(rows[0]["apart_arcmin"], "0");
}

TEST_F(SweepCommands, TheTableDoesNotDependOnWhoSimulatedWhichRow) {
  const std::string whole = undisturbed();
  plan("threads");
  EXPECT_EQ(json("sweep run threads --jobs 3 --json")["simulated"], 24);
  EXPECT_TRUE(merged("threads") == whole);
  EXPECT_EQ(json("sweep run threads --json")["simulated"], 0);  // what is there is not made again
  plan("shards");
  for (const char* shard : {"3/3", "1/3", "2/3"}) {
    EXPECT_EQ(headpin(std::string("sweep run shards --jobs 1 --shard ") + shard).code, 0);
  }
  EXPECT_TRUE(merged("shards") == whole);
  plan("two");
  const pid_t one = started({"sweep", "run", "two", "--jobs", "1"});
  const pid_t other = started({"sweep", "run", "two", "--jobs", "1"});
  int status = 0;
  EXPECT_EQ(waitpid(one, &status, 0), one);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(waitpid(other, &status, 0), other);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(merged("two") == whole);
}

TEST_F(SweepCommands, StoppedOrKilledAnywhereItEndsWithTheSameBytes) {
  const std::string whole = undisturbed();
  plan("timed");
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(headpin("sweep run timed --jobs 2").code, 0);
  auto took = std::chrono::duration_cast<std::chrono::microseconds>(
                  std::chrono::steady_clock::now() - begin)
                  .count();
  std::mt19937 random(7);
  plan("killed");
  int ended = 0;
  for (int i = 0; i < 25; ++i) {
    const pid_t process = started({"sweep", "run", "killed", "--jobs", "2"});
    usleep(static_cast<useconds_t>(random() % static_cast<unsigned long>(took)));
    kill(process, i % 2 == 0 ? SIGKILL : SIGTERM);
    int status = 0;
    waitpid(process, &status, 0);
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    const bool stopped = WIFEXITED(status) && WEXITSTATUS(status) == 128 + SIGTERM;
    // A signal that comes before it is watched for ends it too.
    const bool at_once = WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM;
    const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    EXPECT_TRUE(killed || stopped || at_once || done) << status;
    ended += done ? 0 : 1;
    if (done && ended > 0) break;
    if (!done) continue;
    // The machine was slower when the time was taken: earlier, on a new sweep.
    took = std::max<decltype(took)>(took / 4, 1000);
    fs::remove_all(folder_ / "killed");
    plan("killed");
  }
  EXPECT_GT(ended, 0);
  ASSERT_EQ(headpin("sweep run killed").code, 0);
  EXPECT_TRUE(merged("killed") == whole);
  for (const auto& entry : fs::directory_iterator(folder_ / "killed/pieces")) {
    EXPECT_THAT(entry.path().string(), testing::Not(testing::EndsWith(".part")));
  }
}

TEST_F(SweepCommands, WhatIsMissingOrDamagedIsSaidAndMadeAgain) {
  const std::string whole = undisturbed();
  const fs::path piece = folder_ / "whole/pieces/000005.csv";
  const std::string good = slurp(piece);
  std::string edited = good;
  edited[edited.find('\n') + 40] ^= 1;
  for (const std::string& bad : {good.substr(0, good.size() / 2), edited, std::string()}) {
    std::ofstream(piece, std::ios::binary) << bad;
    expect_refusal("sweep merge whole -o OUT.csv", 1, "000005.csv: ");
    expect_refusal("sweep run whole", 1, "delete it to have its rows simulated again");
    EXPECT_TRUE(slurp(piece) == bad);
  }
  fs::remove(piece);
  expect_refusal("sweep merge whole -o OUT.csv", 1,
                 "whole: 1 of 24 rows is not done, the first is row 6;");
  plan("none");
  expect_refusal("sweep merge none -o OUT.csv", 1,
                 "none: 24 of 24 rows are not done, the first is row 1; `headpin sweep run none`");
  EXPECT_EQ(json("sweep merge whole -o part.csv --partial --json")["merged"], 23);
  EXPECT_THAT(headpin("sweep status whole").out, HasSubstr("23 of 24 rows are done"));
  EXPECT_EQ(json("sweep run whole --json")["simulated"], 1);
  EXPECT_TRUE(merged("whole") == whole);
  const std::string rows = slurp(folder_ / "whole/rows.csv");
  std::string moved = rows;
  moved[moved.find("ellipsoid")] = 'E';
  std::ofstream(folder_ / "whole/rows.csv", std::ios::binary) << moved;
  expect_refusal("sweep run whole", 1, "rows.csv:2: expected");
  std::ofstream(folder_ / "whole/rows.csv", std::ios::binary) << "key;" << rows;
  expect_refusal("sweep run whole", 1,
                 "rows.csv:1: expected 'key,trial,elasticity,friction,shape,ball...', as");
  std::ofstream(folder_ / "whole/rows.csv", std::ios::binary) << rows;
  std::ofstream(folder_ / "whole/trials/throw.lcmlog", std::ios::app) << "x";
  expect_refusal("sweep run whole", 1, "rows.csv:2: expected");
}

TEST_F(SweepCommands, ARowThatFailsHasItsReasonInTheTable) {
  write_design("[grid]\nroom.width = [4, 2.2]\nlane.width = [1.05, 2.4]\n");
  plan("some");
  const nlohmann::json run = json("sweep run some --json");
  EXPECT_EQ(run["failed"], 1);
  EXPECT_EQ(run["simulated"], 4);
  std::istringstream table(merged("some"));
  std::string line;
  for (int i = 0; i < 4; ++i) {
    std::getline(table, line);  // the names, and the rows that fit
    EXPECT_THAT(line, testing::Not(HasSubstr("lane.width must"))) << i;
  }
  std::getline(table, line);
  EXPECT_THAT(line, HasSubstr(",2.2,2.4,,,"));
  EXPECT_THAT(line, HasSubstr("lane.width must be less than the room's, 2.2; found 2.4"));
}

TEST_F(SweepCommands, WhatCannotBeIsRefusedBeforeAnythingIsMade) {
  const auto refuses = [&](const std::string& text, int code, const std::string& says) {
    write_design(text);
    expect_refusal("sweep plan sweep.toml -o OUT", code, says);
  };
  const std::string plan_says = "headpin sweep plan: sweep.toml:3: ";
  refuses("[grid]\nfriction = [0, 2]\n", 1,
          plan_says + "friction must be a number from 0 to 1, found 2\n");
  refuses("[grid]\nfriction = ['none']\n", 1, "must be a number from 0 to 1, found 'none'\n");
  refuses("[random]\nrates.physics_hz = {from = 120, to = 960}\n", 1,
          plan_says + "rates.physics_hz must be a whole number");
  refuses("[grid]\nfrition = [0, 1]\n", 1,
          plan_says + "unknown key 'frition'; the nearest is friction\n");
  refuses("[grid]\nshape = ['cube']\n", 1,
          plan_says + "shape must be \"true\" or \"ellipsoid\", found 'cube'\n");
  refuses(
      "[grid]\nball.colour = [1]\n", 1,
      plan_says +
          "unknown key 'ball.colour'; known here: differential, home, intermediate, mass, mass_bias, mesh, pin, radius, rg, rings\n");
  refuses("[grid]\nball.mass = ['5\\nlane.width=3']\n", 1, plan_says + "ball.mass must be");
  refuses("[random]\nball.mass = {from = -1, to = 7}\n", 1,
          plan_says + "ball.mass must be a number from 0.01 to 100, found -1\n");
  refuses("[grid\n", 1, "sweep.toml:2: not TOML");
  std::ofstream(folder_ / "sweep.toml") << "trials = ['nothing.lcmlog']\n";
  expect_refusal("sweep plan sweep.toml -o OUT", 1, "nothing.lcmlog");
  std::ofstream(folder_ / "sweep.toml") << "trials = ['throw.lcmlog', './throw.lcmlog']\n";
  expect_refusal("sweep plan sweep.toml -o OUT", 1, "trials of different names");
  write_design("");
  plan("one");
  expect_refusal("sweep plan sweep.toml -o one", 1, "a sweep is there already");
  expect_refusal("sweep run one --shard 0/3", 2, "expected K/N");
  expect_refusal("sweep run one --shard 4/3", 2, "expected K/N");
  expect_refusal("sweep run one --shard 1", 2, "expected K/N");
  expect_refusal("sweep run .", 1, "found no rows.csv");
}

TEST_F(SweepCommands, OnAFullDiskOneErrorIsSaidAndNoPieceIsHalf) {
  plan("full");
  const std::string command = "cd '" + folder_.string() +
                              "' && bash -c \"(ulimit -f 0; exec '" HEADPIN_PROGRAM
                              "' sweep run full --jobs 2) 2>&1 >/dev/null | cat >err.txt; exit "
                              "\\${PIPESTATUS[0]}\"";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  const std::string err = slurp(folder_ / "err.txt");
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  EXPECT_THAT(err, HasSubstr("pieces/"));
  for (const auto& entry : fs::directory_iterator(folder_ / "full/pieces")) {
    EXPECT_EQ(entry.path().filename(), ".claims");
  }
  EXPECT_EQ(json("sweep run full --json")["simulated"], 24);
}

TEST_F(SweepCommands, TheReportIsAPageOfMaps) {
  undisturbed();
  EXPECT_EQ(json("sweep report whole -o maps.html --json")["done"], 24);
  const std::string page = slurp(folder_ / "maps.html");
  EXPECT_THAT(page, HasSubstr("24 of 24 rows"));
  EXPECT_THAT(page, HasSubstr("headpin replay whole/trials/throw.lcmlog --elasticity 0.5"));
  EXPECT_EQ(headpin("sweep report whole -o other.html --x shape --y friction").code, 0);
  // Along the map goes another key than up.
  EXPECT_THAT(headpin("sweep report whole -o up.html --y elasticity").out,
              HasSubstr("over friction and elasticity\n"));
  expect_refusal("sweep report whole -o OUT.html --x ball.mass", 2, "expected a key of the grid");
  write_design("");
  plan("one");
  expect_refusal("sweep report one -o OUT.html", 1, "expected a [grid]");
}

// Slurm itself is in ./dev check cluster.
TEST_F(SweepCommands, TheScriptsForSlurmRunEveryPart) {
  const std::string whole = undisturbed();
  plan("cluster");
  const nlohmann::json slurm = json("sweep slurm cluster --tasks 3 --minutes 7 --json");
  EXPECT_THAT(slurp(folder_ / "cluster/sweep.sbatch"), HasSubstr("#SBATCH --array=1-3\n"));
  EXPECT_THAT(slurp(folder_ / "cluster/sweep.sbatch"), HasSubstr("#SBATCH --time=7\n"));
  for (const int task : {2, 3, 1}) {
    const std::string command =
        "SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_ID=" + std::to_string(task) + " bash '" +
        slurm["array"].get<std::string>() + "' >/dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  EXPECT_EQ(std::system(("bash '" + slurm["merge"].get<std::string>() + "' >/dev/null").c_str()),
            0);
  EXPECT_TRUE(slurp(folder_ / "cluster/results.csv") == whole);
  expect_refusal("sweep slurm cluster", 1, "sweep.sbatch");
  expect_refusal("sweep slurm cluster --tasks 500 --force", 2, "--tasks: expected at most");
}

// The line is typed into a shell as it is printed.
TEST_F(SweepCommands, TheLineThatSubmitsIsOneForAShell) {
  const std::string typed = "\"it's_(a)_\\$x\"", there = "it's_(a)_$x";
  plan(typed);
  const std::string submit = json("sweep slurm " + typed + " --minutes 7 --json")["submit"];
  spit(folder_ / "sbatch", "#!/bin/sh\nfor word; do printf '%s\\n' \"$word\" >>said.txt; done\n");
  fs::permissions(folder_ / "sbatch", fs::perms::owner_all);
  spit(folder_ / "submit.sh", "PATH=.:$PATH\n" + submit + "\n");
  ASSERT_EQ(std::system(("cd '" + folder_.string() + "' && sh submit.sh").c_str()), 0);
  const std::string said = slurp(folder_ / "said.txt");
  EXPECT_THAT(said, HasSubstr("/" + there + "/sweep.sbatch\n"));
  EXPECT_THAT(said, HasSubstr("/" + there + "/merge.sbatch\n"));
}

// `sweep plan` has no --force.
TEST_F(SweepCommands, AForeignDesignInTheFolderIsNotReplacedByAnOptionThatIsNotThere) {
  fs::create_directory(folder_ / "s");
  spit(folder_ / "s/sweep.toml", "x = 1\n");
  const Result result = headpin("sweep plan sweep.toml -o s");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, testing::EndsWith("s/sweep.toml: exists already\n"));
}

TEST_F(SweepCommands, AShardIsOneOfANumberThatCanBe) {
  plan("s");
  for (const char* shard : {"2/9223372036854775807", "1/1000000001", "0/1", "3/2", "1"}) {
    expect_refusal(std::string("sweep run s --shard ") + shard, 2,
                   "--shard: expected K/N with K from 1 to N, and N at most 1000000000");
  }
  EXPECT_EQ(json("sweep run s --shard 1000000000/1000000000 --json")["simulated"], 0);
}

TEST_F(SweepCommands, AMergeDoesNotReplaceThePartsOfItsSweep) {
  plan("s");
  ASSERT_EQ(headpin("sweep run s").code, 0);
  const std::string rows = slurp(folder_ / "s/rows.csv");
  fs::create_directory_symlink("s", folder_ / "link");
  for (const char* part :
       {"s/rows.csv", "s/pieces/0.csv", "s/trials/x.csv", "./s/../s/rows.csv", "link/rows.csv"}) {
    expect_refusal(std::string("sweep merge s --force -o ") + part, 2, "is part of the sweep");
  }
  EXPECT_EQ(slurp(folder_ / "s/rows.csv"), rows);
  EXPECT_EQ(headpin("sweep merge s -o s/results.csv").code, 0);
  EXPECT_EQ(headpin("sweep merge s -o -").code, 0);
}

TEST_F(SweepCommands, IterationsAreRefusedWhereNoRowHasTheDetectionThatCountsThem) {
  write_design("[grid]\niterations = [5, 7]\n");
  expect_refusal("sweep plan sweep.toml -o OUT", 1, "sweep.toml:3: iterations: expected detection");
  write_design("[grid]\niterations = [5, 7]\ndetection = ['converged']\n");
  expect_refusal("sweep plan sweep.toml -o OUT", 1, "sweep.toml:3: iterations: expected detection");
  write_design("[grid]\niterations = [5, 7]\ndetection = ['converged', 'paper']\n");
  plan("some");
}

// Such as the folder `sweep` of a program's sources.
TEST_F(SweepCommands, AFolderOfOthersIsNotPlannedIn) {
  fs::create_directories(folder_ / "sources/trials");
  spit(folder_ / "sources/main.cpp", "int main() {}\n");
  expect_refusal(
      "sweep plan sweep.toml -o sources", 1,
      "sources: holds main.cpp, which headpin did not write there; expected a new or empty folder\n");
  EXPECT_FALSE(fs::exists(folder_ / "sources/sweep.toml"));
  EXPECT_TRUE(fs::is_empty(folder_ / "sources/trials"));
  // What a killed plan leaves is no reason, and neither are hidden files.
  fs::create_directories(folder_ / "begun/trials");
  fs::create_directory(folder_ / "begun/.git");
  fs::copy_file(folder_ / "sweep.toml", folder_ / "begun/sweep.toml");
  fs::copy_file(folder_ / "throw.lcmlog", folder_ / "begun/trials/throw.lcmlog");
  spit(folder_ / "begun/rows.csv.99999999-0.part", "key,");
  plan("begun");
}

// Archives and git leave out empty folders, and one who deletes all pieces may delete the folder.
TEST_F(SweepCommands, AFolderOfPiecesThatIsGoneIsMadeAgain) {
  write_design("[grid]\nelasticity = [0.2, 0.5]\n");
  plan("some");
  fs::remove_all(folder_ / "some/pieces");
  EXPECT_EQ(json("sweep run some --json")["simulated"], 2);
}

// It counted twice in all means, and two rows had the same key.
TEST_F(SweepCommands, ACopyOfATrialIsRefused) {
  fs::copy_file(folder_ / "throw.lcmlog", folder_ / "again.lcmlog");
  spit(folder_ / "sweep.toml",
       "trials = ['throw.lcmlog', 'again.lcmlog']\n[grid]\nfriction = [0]\n");
  expect_refusal(
      "sweep plan sweep.toml -o OUT", 1,
      "sweep.toml: expected different trials, found throw.lcmlog and its copy again.lcmlog");
}

// The report of rows that all failed gave no reason.
TEST_F(SweepCommands, AReportOfFailedRowsSaysWhyTheyFailed) {
  write_design("[grid]\nroom.width = [2.2]\nlane.width = [2.4]\nfriction = [0, 1]\n");
  plan("none");
  EXPECT_EQ(json("sweep run none --json")["failed"], 2);
  const std::string reason =
      "lane.width=2.4: lane.width must be less than the room's, 2.2; found 2.4";
  EXPECT_EQ(
      headpin("sweep report none -o none.html").out,
      "none.html: 2 of 2 rows, over friction\n2 failed, the first is row 1: " + reason + "\n");
  EXPECT_THAT(slurp(folder_ / "none.html"), HasSubstr("<td>2</td><td>1</td><td>lane.width=2.4: "));
  const nlohmann::json told = json("sweep report none -o none.html --force --json");
  EXPECT_EQ(told["failed"], 2);
  ASSERT_EQ(told["failures"].size(), 1u);
  EXPECT_EQ(told["failures"][0]["error"], reason);
  EXPECT_EQ(told["failures"][0]["failed"], 2);
  EXPECT_EQ(told["failures"][0]["first_row"], 1);
}

// A page of a million points took 3 GB, and had 1.2 GB.
TEST_F(SweepCommands, AReportOfTooManyPointsIsRefusedAndFewerAreChosen) {
  write_design(
      "[grid]\nelasticity = {from = 0, to = 1, steps = 401}\n"
      "friction = {from = 0, to = 1, steps = 251}\n");
  plan("large");
  expect_refusal("sweep report large -o OUT.html", 1,
                 "at most 100000 points on a page, found 100651");
  EXPECT_THAT(headpin("sweep report large -o half.html --at elasticity=0.50").out,
              HasSubstr("over friction\n"));
  const std::string half = slurp(folder_ / "half.html"), point = "not simulated yet";
  std::size_t points = 0;
  for (std::size_t at = 0; (at = half.find(point, at)) != std::string::npos; ++at) ++points;
  EXPECT_EQ(points, 251u);
  expect_refusal("sweep report large -o OUT.html --at friction", 2, "expected KEY=VALUE");
  expect_refusal("sweep report large -o OUT.html --at ball.mass=5", 2,
                 "expected a key of the grid");
  expect_refusal("sweep report large -o OUT.html --at friction=2", 2,
                 "expected a value of the grid");
  expect_refusal("sweep report large -o OUT.html --at friction=0 --at friction=1", 2,
                 "expected one value of friction");
}

// It said how many rows the whole sweep has, beside how many of those with the value failed.
TEST_F(SweepCommands, AReportOfAChosenValueCountsItsRowsAlone) {
  write_design("[grid]\nroom.width = [2.2]\nlane.width = [1, 2.4]\nfriction = [0, 1]\n");
  plan("some");
  EXPECT_THAT(headpin("sweep report some -o none.html --at friction=0").out,
              HasSubstr("0 of 2 rows with friction = 0, over lane.width\n"));
  EXPECT_EQ(json("sweep run some --json")["simulated"], 4);
  EXPECT_THAT(headpin("sweep report some -o all.html").out, HasSubstr("4 of 4 rows, over "));
  EXPECT_THAT(headpin("sweep report some -o narrow.html --at friction=1 --x friction").out,
              HasSubstr("2 of 2 rows with friction = 1, over friction and lane.width\n"));
  const std::string wide = "sweep report some --at lane.width=2.40 ";
  EXPECT_THAT(headpin(wide + "-o wide.html").out,
              HasSubstr("2 of 2 rows with lane.width = 2.4, over friction\n2 failed, "));
  EXPECT_THAT(slurp(folder_ / "wide.html"), HasSubstr("<p>2 of 2 rows with lane.width = 2.4."));
  const nlohmann::json told = json(wide + "-o wide.html --force --json");
  EXPECT_EQ(told["planned"], 2);
  EXPECT_EQ(told["done"], 2);
  EXPECT_EQ(told["failed"], 2);
}

}  // namespace
}  // namespace headpin
