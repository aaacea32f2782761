// A folder of pictures that several processes draw, each of them a part.

#include <csignal>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/apps/command_line.h"
#include "tests/support/processes.h"

namespace headpin {
namespace {

using FramesInParts = CommandLine;

/// Every file of a folder with its bytes, but for our own list of them.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename()] = slurp(entry.path());
  }
  return files;
}

// 130 frames are three parts.
TEST_F(FramesInParts, DrawnBySeveralProcessesAreTheSameFiles) {
  const std::string draw = "frames " + kDemo + " --look 1997 --ids --flow --frames 170-299 -o ";
  ASSERT_EQ(headpin(draw + "one --cameras one.json --colmap model").code, 0);
  EXPECT_EQ(json(draw + "three --cameras three.json --colmap models --jobs 3 --json")["frames"],
            130);
  EXPECT_EQ(contents(folder_ / "three"), contents(folder_ / "one"));
  EXPECT_TRUE(fs::exists(folder_ / "one/right_000298.flo"));
  EXPECT_EQ(slurp(folder_ / "three.json"), slurp(folder_ / "one.json"));
  EXPECT_EQ(contents(folder_ / "models"), contents(folder_ / "model"));
  EXPECT_FALSE(fs::exists(folder_ / "three.parts"));
  expect_refusal(draw + "one --jobs 2", 1, "one: exists already");
  expect_refusal("frames " + kDemo + " --jobs 2 --video OUT.mkv", 2, "need -o DIR");
  fs::create_directory(folder_ / "mine.parts");
  std::ofstream(folder_ / "mine.parts/precious") << "x";
  expect_refusal(draw + "mine --jobs 2", 1, "mine.parts: exists already, and headpin did not make");
  EXPECT_EQ(slurp(folder_ / "mine.parts/precious"), "x");
}

/// The words of the first process that a running `headpin frames` has started to draw a part.
std::set<std::string> words_of_a_drawer(pid_t command) {
  while (waitpid(command, nullptr, WNOHANG) == 0) {
    for (const pid_t drawer : children_of(command)) {
      std::istringstream line(slurp("/proc/" + std::to_string(drawer) + "/cmdline"));
      std::set<std::string> words;
      for (std::string word; std::getline(line, word, '\0');) words.insert(word);
      if (!words.contains("--jobs=2") && words.contains("--frames")) return words;
    }
    usleep(1000);
  }
  return {};
}

// An option that is new is in none of the two lists: is it of the pictures, or of the whole task?
TEST_F(FramesInParts, ProcessesThatDrawGetEveryOptionOfThePictures) {
  const std::set<std::string> of_task = {"help",    "output", "video", "no-mp4", "y4m",
                                         "cameras", "colmap", "sound", "frames", "jobs",
                                         "resume",  "verify", "force", "json"};
  const std::map<std::string, std::string> of_pictures = {
      {"layout", "side-by-side"}, {"depth", "true"},    {"ids", "true"},
      {"flow", "true"},           {"view", "top"},      {"fps", "100"},
      {"gl", "osmesa"},           {"look", "fast"},     {"samples", "2"},
      {"as-shown", "true"},       {"longest-gap", "59"}};
  std::istringstream help(headpin("frames --help").out);
  const std::regex option(R"(^  (?:-\w,)?--([a-z0-9-]+).*)");
  int options = 0;
  for (std::string line; std::getline(help, line);) {
    std::smatch name;
    if (!std::regex_match(line, name, option)) continue;
    EXPECT_NE(of_task.contains(name[1]), of_pictures.contains(name[1])) << line;
    ++options;
  }
  EXPECT_EQ(options, of_task.size() + of_pictures.size());

  ASSERT_EQ(headpin("live " + kDemo + " --samples 1 --duration 1.2 --record shown.lcmlog").code, 0);
  for (const bool as_shown : {false, true}) {
    std::vector<std::string> words = {"frames", "shown.lcmlog", "-o", "drawn", "--jobs=2"};
    std::set<std::string> wanted;
    for (const auto& [name, value] : of_pictures) {
      if (name == (as_shown ? "fps" : "as-shown")) continue;  // they exclude each other
      wanted.insert("--" + name + "=" + value);
    }
    words.insert(words.end(), wanted.begin(), wanted.end());
    const pid_t command = started(words);
    const std::set<std::string> heard = words_of_a_drawer(command);
    for (const std::string& word : wanted) EXPECT_TRUE(heard.contains(word)) << word;
    kill(command, SIGTERM);
    waitpid(command, nullptr, 0);
  }
}

TEST_F(FramesInParts, ProcessesThatDrawDoNotOutliveTheCommand) {
  const pid_t process = started({"frames", kDemo, "--samples", "4", "-o", "drawn", "--jobs", "2"});
  std::vector<pid_t> drawers;
  while (drawers.size() < 2) {
    usleep(1000);
    drawers = children_of(process);
  }
  kill(process, SIGKILL);
  waitpid(process, nullptr, 0);
  for (const pid_t drawer : drawers) wait_for_end(drawer);
  EXPECT_FALSE(fs::exists(folder_ / "drawn/frames.csv"));
}

TEST_F(FramesInParts, GoOnWhereTheyWereStopped) {
  const std::string options = " --look 1997 --frames 100-299 -o drawn --resume";
  std::ofstream(folder_ / "stop.sh")
      << "'" HEADPIN_PROGRAM "' frames " << kDemo << options << " & p=$!\n"
      << "while kill -0 $p && ! [ -e drawn.parts/00000/frames.csv ]; do sleep 0.02; done\n"
      << "kill -TERM $p; wait $p\n";
  const int status = std::system(
      ("cd '" + folder_.string() + "' && sh stop.sh >out.txt 2>err.txt </dev/null").c_str());
  ASSERT_EQ(WEXITSTATUS(status), 128 + 15) << slurp(folder_ / "err.txt");
  EXPECT_FALSE(fs::exists(folder_ / "drawn/frames.csv"));
  expect_refusal("frames " + kDemo + options + " --samples 2", 1, "with other drawing options");
  const nlohmann::json resumed = json("frames " + kDemo + options + " --jobs 2 --json");
  EXPECT_EQ(resumed["frames"], 200);
  EXPECT_GE(resumed["frames_there_already"], 60);
  ASSERT_EQ(headpin("frames " + kDemo + " --look 1997 --frames 100-299 -o whole").code, 0);
  EXPECT_EQ(contents(folder_ / "drawn"), contents(folder_ / "whole"));
  EXPECT_FALSE(fs::exists(folder_ / "drawn.parts"));
}

}  // namespace
}  // namespace headpin
