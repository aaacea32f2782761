// A study that is killed at any moment, that two work on at once, and whose disk is full.

#include <csignal>
#include <map>
#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class StudyUnderStress : public CommandLine {
 protected:
  void plan_short(const std::string& name, int people) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
    ASSERT_EQ(headpin("experiment plan -o " + name + " --design short.toml --seed 7 --people " +
                      std::to_string(people))
                  .code,
              0);
  }

  /// Starts `headpin WORDS` in the folder.
  pid_t started(const std::vector<std::string>& words) const {
    const pid_t process = fork();
    if (process != 0) return process;
    const int nothing = open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) dup2(nothing, stream);
    std::vector<char*> arguments = {const_cast<char*>("headpin")};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (chdir(folder_.c_str()) == 0) execv(HEADPIN_PROGRAM, arguments.data());
    _exit(127);
  }

  /// Kills it so many times, each after another while, and lets it come to its end then. One that
  /// was at its end before the signal came is done.
  void killed(const std::vector<std::string>& words, int times) {
    int status = 0;
    for (int i = 0; i < times; ++i) {
      const pid_t process = started(words);
      usleep(static_cast<useconds_t>(random_() % 400'000));
      kill(process, SIGKILL);
      waitpid(process, &status, 0);
      if (WIFEXITED(status)) break;
    }
    if (times == 0 || !WIFEXITED(status)) waitpid(started(words), &status, 0);
    const bool exported = fs::exists(folder_ / words.back() / "dataset_description.json");
    EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 0 || exported)) << words[1] << status;
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

  std::mt19937 random_{20};
};

void StudyUnderStress::kill_each_command(int times) {
  for (const char* name : {"a", "b"}) plan_short(name, 3);
  const auto both = [&](const std::vector<std::string>& words) {
    std::vector<std::string> in_a = words, in_b = words;
    for (std::string& word : in_a) word = word == "STUDY" ? "a" : word == "DATA" ? "data-a" : word;
    for (std::string& word : in_b) word = word == "STUDY" ? "b" : word == "DATA" ? "data-b" : word;
    killed(in_a, 0);
    killed(in_b, times);
    const auto whole = files("a"), found = files("b");
    for (const auto& [file, text] : whole) {
      ASSERT_TRUE(found.contains(file)) << words[1] << ": " << file;
      EXPECT_TRUE(found.at(file) == text) << words[1] << ": " << file;
    }
    for (const auto& [file, text] : found) EXPECT_TRUE(whole.contains(file)) << file;
  };
  both({"experiment", "run", "STUDY", "--all", "--virtual", "--jobs", "2"});
  both({"experiment", "ask", "STUDY", "--all", "--virtual"});
  both({"experiment", "score", "STUDY"});
  both({"experiment", "export", "STUDY", "--motion-bids", "DATA"});
  EXPECT_TRUE(files("data-a") == files("data-b"));
  EXPECT_GT(files("data-a").size(), 30u);
}

TEST_F(StudyUnderStress, KilledAnywhereItEndsWithTheSameBytes) {
  kill_each_command(4);
}

TEST_F(StudyUnderStress, KilledFiftyTimesItEndsWithTheSameBytes) {
  kill_each_command(13);
}

TEST_F(StudyUnderStress, OnAFullDiskOneErrorIsSaidAndNothingIsHalf) {
  plan_short("a", 1);
  const auto limited = [&](int kilobytes, const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() + "' && ulimit -f " +
                                std::to_string(kilobytes) + " && '" HEADPIN_PROGRAM "' " +
                                arguments + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(("bash -c \"" + command + "\"").c_str());
    return Result{WEXITSTATUS(status), slurp(folder_ / "out.txt"), slurp(folder_ / "err.txt")};
  };
  const Result run = limited(100, "experiment run a --all --virtual");
  EXPECT_EQ(run.code, 1);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("run-01.lcmlog"));
  EXPECT_TRUE(fs::is_empty(folder_ / "a/sessions/p001"));
  ASSERT_EQ(headpin("experiment run a --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment ask a --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score a").code, 0);
  const auto before = files("a");
  const Result score = limited(2, "experiment score a");
  EXPECT_EQ(score.code, 1);
  EXPECT_EQ(std::count(score.err.begin(), score.err.end(), '\n'), 1) << score.err;
  EXPECT_TRUE(files("a") == before);
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
