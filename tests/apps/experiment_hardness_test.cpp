// A study that is killed at any moment, that two work on at once, and whose disk is full.

#include <chrono>
#include <csignal>
#include <map>
#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "tests/apps/command_line.h"
#include "tests/support/processes.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class StudyUnderStress : public CommandLine {
 protected:
  /// What a killed command leaves is in the test's own folder.
  StudyUnderStress() {
    fs::create_directory(folder_ / "tmp");
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  }

  void write_short_design() const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
  }

  void plan_short(const std::string& name, int people) const {
    write_short_design();
    ASSERT_EQ(headpin("experiment plan -o " + name + " --design short.toml --seed 7 --people " +
                      std::to_string(people))
                  .code,
              0);
  }

  /// Runs it to its end and tells how long that took [us].
  useconds_t undisturbed(const std::vector<std::string>& words) const {
    const auto begin = std::chrono::steady_clock::now();
    int status = 0;
    waitpid(started(words), &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << words[1] << status;
    const auto took = std::chrono::steady_clock::now() - begin;
    return static_cast<useconds_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(took).count());
  }

  /// Kills it so many times, each after another part of that while, and lets it come to its end then.
  /// One that was at its end before the signal came is done.
  void killed(const std::vector<std::string>& words, int times, useconds_t took) {
    int status = 0;
    for (int i = 0; i < times; ++i) {
      const pid_t process = started(words);
      usleep(static_cast<useconds_t>(random_() % took));
      kill(process, SIGKILL);
      waitpid(process, &status, 0);
      if (WIFEXITED(status)) return;
      ++kills_;
    }
    // Killed behind its last rename, its output is there and refused: that is an end too.
    const fs::path output = folder_ / words.back();
    const bool written =
        fs::is_regular_file(output) || fs::exists(output / "dataset_description.json");
    waitpid(started(words), &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 0 || written)) << words[1] << status;
  }

  /// A study that is left alone and one whose every command is killed so often.
  void kill_each_command(int times);

  /// Every file below a folder: its name and its bytes.
  std::map<std::string, std::string> files(const std::string& name) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / name)) {
      if (!entry.is_regular_file()) continue;
      all[fs::relative(entry.path(), folder_ / name).string()] = slurp(entry.path());
    }
    return all;
  }

  /// `headpin ARGUMENTS` where no file may grow beyond so much.
  Result limited(int kilobytes, const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && { (ulimit -f " + std::to_string(kilobytes) +
        "; exec '" HEADPIN_PROGRAM "' " + arguments +
        ") 2>&1 >/dev/null </dev/null; echo \\$? >code.txt; } | cat >err.txt";
    EXPECT_EQ(std::system(("bash -c \"" + command + "\"").c_str()), 0);
    return {std::stoi(slurp(folder_ / "code.txt")), "", slurp(folder_ / "err.txt")};
  }

  /// On a full disk the command says one line that names what, and no file of these is another.
  void expect_nothing_lost(int kilobytes, const std::string& arguments, const std::string& says,
                           const std::string& folder) const {
    const auto before = files(folder);
    const Result result = limited(kilobytes, arguments);
    EXPECT_EQ(result.code, 1) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(says)) << arguments;
    EXPECT_TRUE(files(folder) == before) << arguments;
  }

  static bool has_r() { return std::system("Rscript --version >/dev/null 2>&1") == 0; }

  int kills_ = 0;
  std::mt19937 random_{20};
};

void StudyUnderStress::kill_each_command(int times) {
  write_short_design();
  const auto both = [&](const std::string& command) {
    const auto of = [&](const std::string& study) {
      std::vector<std::string> words;
      std::istringstream text(command);
      for (std::string word; text >> word;) {
        if (word.starts_with("STUDY")) word.replace(0, 5, study);
        words.push_back(word);
      }
      return words;
    };
    const useconds_t took = undisturbed(of("a"));
    killed(of("b"), times, took);
    const auto whole = files("a"), found = files("b");
    for (const auto& [file, text] : whole) {
      ASSERT_TRUE(found.contains(file)) << command << ": " << file;
      EXPECT_TRUE(found.at(file) == text) << command << ": " << file;
    }
    for (const auto& [file, text] : found) EXPECT_TRUE(whole.contains(file)) << command << file;
  };
  both("experiment plan --design short.toml --seed 7 --people 2 -o STUDY");
  both("experiment plan --people 3 -o STUDY");
  both("experiment run STUDY --all --virtual --jobs 2");
  both("experiment ask STUDY --all --virtual");
  both("experiment score STUDY");
  if (has_r()) both("experiment analyse STUDY");
  both("experiment report STUDY -o STUDY/study.html");
  both("experiment export STUDY --motion-bids STUDY/data");
  EXPECT_GT(files("a/data").size(), 30u);
}

TEST_F(StudyUnderStress, KilledAnywhereItEndsWithTheSameBytes) {
  kill_each_command(2);
  EXPECT_GT(kills_, 4);
}

TEST_F(StudyUnderStress, KilledFiftyTimesItEndsWithTheSameBytes) {
  kill_each_command(13);
  EXPECT_GT(kills_, 26);
}

// R that goes on would write over what the next command has it write.
TEST_F(StudyUnderStress, RDoesNotOutliveTheCommand) {
  if (!has_r()) GTEST_SKIP() << "R is not installed";
  plan_short("a", 1);
  for (const char* step : {"run a --all --virtual", "ask a --all --virtual", "score a"}) {
    ASSERT_EQ(headpin(std::string("experiment ") + step).code, 0) << step;
  }
  ASSERT_EQ(headpin("experiment analyse a").code, 0);
  const auto before = files("a/analysis");
  const std::string script = slurp(folder_ / "a/model.R");
  // One that has written into the folder it was given, and never ends.
  std::ofstream(folder_ / "a/model.R")
      << "to <- file.path(commandArgs(trailingOnly = TRUE)[2], 'fit.csv')\n"
      << "writeLines('another', to)\n"
      << "writeLines(as.character(Sys.getpid()), 'r.beside')\n"
      << "file.rename('r.beside', 'r.pid')\n"
      << "repeat Sys.sleep(0.01)\n";
  const pid_t process = started({"experiment", "analyse", "a"});
  while (!fs::exists(folder_ / "r.pid")) usleep(1000);
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
  for (const auto& [file, text] : files("a/analysis")) EXPECT_NE(text, "another\n") << file;
  wait_for_end(std::stoi(slurp(folder_ / "r.pid")));
  std::ofstream(folder_ / "a/model.R") << script;
  ASSERT_EQ(headpin("experiment analyse a").code, 0);
  const auto after = files("a/analysis");
  EXPECT_EQ(after.size(), before.size());
  for (const auto& [file, text] : before) EXPECT_TRUE(after.at(file) == text) << file;
}

// Whoever answers types the next answer when the one before is on the disk.
TEST_F(StudyUnderStress, AnAnswerIsKeptThoughTheQuestionsAreKilled) {
  plan_short("a", 1);
  const fs::path answers = folder_ / "a/answers/p001.csv";
  const std::vector<std::string> given = {"6", "7",  "5",   "1",      "6",      "n/a",
                                          "2", "no", "yes", "female", "student"};
  for (std::size_t i = 0; i < given.size(); ++i) {
    int pipe_to_it[2];
    ASSERT_EQ(pipe(pipe_to_it), 0);
    const pid_t process =
        started({"experiment", "ask", "a", "--participant", "p001"}, pipe_to_it[0]);
    close(pipe_to_it[0]);
    const std::string line = given[i] + "\n";
    ASSERT_EQ(write(pipe_to_it[1], line.data(), line.size()), std::ssize(line));
    const auto lines = [&] {
      const std::string text = fs::exists(answers) ? slurp(answers) : "";
      return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    };
    while (lines() < i + 2) usleep(1000);  // the heading is one
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
    close(pipe_to_it[1]);
    EXPECT_EQ(lines(), i + 2);
  }
  std::istringstream kept(slurp(answers));
  std::string line;
  std::getline(kept, line);
  for (const std::string& answer : given) {
    std::getline(kept, line);
    EXPECT_THAT(line, HasSubstr("," + answer + ","));
  }
  EXPECT_EQ(json("experiment status a --json")["participants"][0]["answers"], 11);
}

TEST_F(StudyUnderStress, OnAFullDiskOneErrorIsSaidAndNothingIsHalf) {
  write_short_design();
  const Result plan = limited(0, "experiment plan -o a --design short.toml --people 1");
  EXPECT_EQ(plan.code, 1);
  EXPECT_EQ(std::count(plan.err.begin(), plan.err.end(), '\n'), 1) << plan.err;
  EXPECT_TRUE(files("a").empty());
  plan_short("a", 1);
  expect_nothing_lost(0, "experiment plan -o a --people 30", "plan.csv", "a");
  expect_nothing_lost(100, "experiment run a --all --virtual", "run-01.lcmlog", "a");
  ASSERT_EQ(headpin("experiment run a --all --virtual").code, 0);
  const Result ask = limited(0, "experiment ask a --all --virtual");
  EXPECT_EQ(ask.code, 1);
  EXPECT_THAT(ask.err, HasSubstr("p001.csv"));
  EXPECT_EQ(slurp(folder_ / "a/answers/p001.csv"), "");
  ASSERT_EQ(headpin("experiment ask a --all --virtual").code, 0);
  expect_nothing_lost(0, "experiment ask a --all --virtual --json >/dev/full", "output", "a");
  expect_nothing_lost(2, "experiment score a", "tables", "a");
  ASSERT_EQ(headpin("experiment score a").code, 0);
  expect_nothing_lost(2, "experiment score a", "tables", "a");
  if (has_r()) {
    expect_nothing_lost(0, "experiment analyse a", "model.R", "a");
    ASSERT_EQ(headpin("experiment analyse a").code, 0);
    for (const int kilobytes : {1, 8}) {  // of tables, and of pictures
      expect_nothing_lost(kilobytes, "experiment analyse a", "cannot be written whole", "a");
    }
  }
  expect_nothing_lost(2, "experiment report a -o a/study.html", "study.html", "a");
  ASSERT_EQ(headpin("experiment report a -o a/study.html").code, 0);
  expect_nothing_lost(2, "experiment report a -o a/study.html --force", "study.html", "a");
  // An export goes on where it ended; what is half has no description, so nobody takes it for one.
  const Result half = limited(30, "experiment export a --motion-bids data");
  EXPECT_EQ(half.code, 1);
  EXPECT_EQ(std::count(half.err.begin(), half.err.end(), '\n'), 1) << half.err;
  EXPECT_FALSE(fs::exists(folder_ / "data/dataset_description.json"));
  ASSERT_EQ(headpin("experiment export a --motion-bids data").code, 0);
  ASSERT_EQ(headpin("experiment export a --motion-bids whole").code, 0);
  EXPECT_TRUE(files("data") == files("whole"));
}

TEST_F(StudyUnderStress, WhatAnotherIsAtIsLeftAlone) {
  plan_short("a", 1);
  // As a process would hold it that writes this participant's answers.
  fs::create_directories(folder_ / "a/answers");
  std::ofstream(folder_ / "a/answers/p001.csv") << "";
  ASSERT_EQ(std::system(("flock -n '" + (folder_ / "a/answers/p001.csv").string() +
                         "' sh -c \"cd '" + folder_.string() +
                         "' && '" HEADPIN_PROGRAM
                         "' experiment ask a --all --virtual 2>err.txt; echo \\$? >code.txt\"")
                            .c_str()),
            0);
  EXPECT_EQ(slurp(folder_ / "code.txt"), "75\n") << slurp(folder_ / "err.txt");
  EXPECT_EQ(headpin("experiment ask a --all --virtual").code, 0);
}

}  // namespace
}  // namespace headpin
