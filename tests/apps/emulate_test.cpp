// headpin emulate as its users meet it: a program of its own, a terminal, a driver at the other
// end.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/motion.h"
#include "devices/lines/lasting_line.h"
#include "devices/lines/tcp.h"
#include "devices/recordings/recorded_motion.h"
#include "scene/record/log.h"
#include "tests/support/folder.h"

namespace headpin {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Emulate : public testing::Test {
 protected:
  Emulate() { folder_ = fresh_folder("emulate"); }
  ~Emulate() override {
    if (child_ > 0) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
    fs::remove_all(folder_);
  }

  /// Until the link is there, if one is asked for.
  void start(std::vector<std::string> arguments) {
    const bool linked = std::ranges::find(arguments, "--link") != arguments.end();
    arguments.insert(arguments.begin(), {HEADPIN_PROGRAM, "emulate"});
    child_ = fork();
    if (child_ == 0) {
      std::vector<char*> argv;
      for (std::string& a : arguments) argv.push_back(a.data());
      argv.push_back(nullptr);
      if (!std::freopen((folder_ / "out").c_str(), "w", stdout)) _exit(126);
      execv(argv[0], argv.data());
      _exit(127);
    }
    for (int i = 0; i < 500 && linked && !fs::exists(link()); ++i)
      std::this_thread::sleep_for(10ms);
  }

  /// Exit code after `signal`.
  int end(int signal) {
    kill(child_, signal);
    int status = 0;
    waitpid(std::exchange(child_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path link() const { return folder_ / "fastrak"; }

  /// The line of a unit that serves TCP, as it says itself and `live --fastrak` takes it; empty when it says
  /// nothing.
  std::string tcp_line() const {
    for (int i = 0; i < 500; ++i) {
      std::ifstream file(folder_ / "out");
      std::string name;
      if (std::getline(file, name) && !file.eof()) return name;
      std::this_thread::sleep_for(10ms);
    }
    return "";
  }

  fs::path folder_;
  pid_t child_ = -1;
};

/// Polls in real time until there is enough to look at.
std::vector<devices::Sample> listen(devices::FastrakDriver& driver, Time span) {
  std::vector<devices::Sample> samples;
  const auto start = std::chrono::steady_clock::now();
  for (Time now{}; now < span && samples.size() < 100;) {
    std::this_thread::sleep_for(1ms);
    now = std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start);
    driver.poll(now, samples);
  }
  return samples;
}

TEST_F(Emulate, ADriverFindsTheUnitAtTheLinkAndTheLinkGoesWithIt) {
  for (const int signal : {SIGINT, SIGTERM}) {
    start({"--link", link(), "--motion", "still", "--faults", "noise=0"});
    ASSERT_TRUE(fs::exists(link()));
    devices::Clocks clocks;
    devices::FastrakDriver driver(devices::open_serial(link(), 115200), clocks);
    const auto samples = listen(driver, 60s);
    EXPECT_GT(samples.size(), 60u);
    for (const devices::Sample& sample : samples) {
      const auto& s = std::get<devices::TrackerSample>(sample);
      EXPECT_NEAR(s.X_TS.p.x(), 0.4, 1e-6);
      EXPECT_TRUE(s.good());
    }
    EXPECT_EQ(driver.statistics().skipped_bytes, 0);
    EXPECT_EQ(end(signal), 0);
    EXPECT_FALSE(fs::exists(fs::symlink_status(link())));
  }
}

// The receivers repeat the trial's poses, from its first one on, when the driver starts to listen.
TEST_F(Emulate, ATrialBeginsWhenTheDriverStartsToListen) {
  const fs::path trial = fs::path(HEADPIN_SOURCE_DIR) / "assets" / "trials" / "demo.lcmlog";
  start({"--link", link(), "--faults", "noise=0", trial});
  ASSERT_TRUE(fs::exists(link()));
  devices::FastrakOptions options;
  options.zenith.fill(Vec3::Zero());
  devices::Clocks clocks;
  devices::FastrakDriver driver(devices::open_serial(link(), 115200), clocks, options);
  const auto samples = listen(driver, 60s);
  ASSERT_GT(samples.size(), 60u);
  const devices::FastrakMotion recorded =
      devices::recorded_motion(scene::read_trial(trial).samples);
  const auto& first = std::get<devices::TrackerSample>(samples.front());
  const Pose truth = recorded(first.station, Time{}).X_TS;
  // Reported with r and -r alike; within the first tenth of a second it has not moved 5 cm.
  EXPECT_LT(std::min((first.X_TS.p - truth.p).norm(), (first.X_TS.p + truth.p).norm()), 0.05);
  EXPECT_EQ(end(SIGINT), 0);
}

// A client at another rate gets garbage, and one that searches finds the unit.
TEST_F(Emulate, ADriverAtTheWrongRateFindsTheRightOneAndSetsItsOwn) {
  start({"--link", link(), "--motion", "still", "--strict-baud", "--baud", "57600"});
  ASSERT_TRUE(fs::exists(link()));
  devices::FastrakOptions options;
  options.start_up = 100ms;  // the unit cannot hear the ^Y
  options.answer = 150ms;
  options.quiet = 50ms;
  devices::Clocks clocks;
  devices::FastrakDriver driver(devices::open_serial(link(), 115200), clocks, options);
  const auto samples = listen(driver, 60s);
  EXPECT_GT(samples.size(), 60u);
  EXPECT_EQ(end(SIGTERM), 0);
}

/// Exit code and output of `headpin ARGUMENTS`.
std::pair<int, std::string> headpin(const fs::path& folder, const std::string& arguments) {
  const std::string out = (folder / "told").string();
  const int status =
      std::system(("'" HEADPIN_PROGRAM "' " + arguments + " >'" + out + "' 2>&1").c_str());
  std::ifstream file(out);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          std::string(std::istreambuf_iterator<char>(file), {})};
}

TEST_F(Emulate, ConformanceTellsWhichClientsTheUnitServes) {
  start({"--link", link(), "--motion", "still"});
  ASSERT_TRUE(fs::exists(link()));
  const auto [served, table] =
      headpin(folder_, "conformance '" + link().string() + "' --client VESS --seconds 0.5");
  EXPECT_EQ(served, 0) << table;
  EXPECT_NE(table.find("VESS                    passes"), std::string::npos) << table;
  EXPECT_EQ(end(SIGTERM), 0);
  // Its status record has a tag where a client of 2007 insists on blanks.
  start({"--link", link(), "--motion", "still", "--tag-2012"});
  ASSERT_TRUE(fs::exists(link()));
  const auto [failed, why] = headpin(
      folder_, "conformance '" + link().string() + "' --client 'VR Juggler 2007' --seconds 0.5");
  EXPECT_EQ(failed, 1);
  EXPECT_NE(
      why.find(
          "FAILS: sent 1 bytes 'S', expected blanks in its columns 10 to 15, found 55 bytes '21S"),
      std::string::npos)
      << why;
  // The table and the failure are one object; the words are those of standard error.
  const auto [again, told] =
      headpin(folder_, "conformance '" + link().string() +
                           "' --client 'VR Juggler 2007' --seconds 0.5 --json");
  EXPECT_EQ(again, 1);
  const std::size_t begin = told.find('{');
  ASSERT_NE(begin, std::string::npos) << told;
  const nlohmann::json object =
      nlohmann::json::parse(told.substr(begin, told.rfind('}') + 1 - begin));
  EXPECT_EQ(object["exit_code"], 1);
  EXPECT_EQ(object["clients"].size(), 2u);
  EXPECT_EQ(end(SIGTERM), 0);
}

// Two clients one after the other, the first gone without a word: each gets it from the start.
TEST_F(Emulate, OverTcpEachClientGetsARunningTrial) {
  const fs::path trial = fs::path(HEADPIN_SOURCE_DIR) / "assets" / "trials" / "demo.lcmlog";
  start({"--tcp", "0", "--faults", "noise=0", trial});
  const std::string line = tcp_line();
  ASSERT_TRUE(line.starts_with("tcp:127.0.0.1:")) << line;
  const scene::Trial recorded = scene::read_trial(trial);
  const devices::FastrakMotion motion = devices::seen_from(
      devices::place_for(recorded.samples), devices::recorded_motion(recorded.samples));
  for (int client = 0; client < 2; ++client) {
    devices::FastrakOptions options;
    options.zenith.fill(Vec3::Zero());
    devices::Clocks clocks;
    devices::FastrakDriver driver(devices::open_line(line, 115200), clocks, options);
    const auto samples = listen(driver, 60s);
    ASSERT_GT(samples.size(), 60u);
    const auto& first = std::get<devices::TrackerSample>(samples.front());
    EXPECT_LT((first.X_TS.p - motion(first.station, Time{}).X_TS.p).norm(), 0.05) << client;
  }
  EXPECT_EQ(end(SIGTERM), 0);
}

// It heard the client until there was nothing more to hear, and neither ended nor sent records.
TEST_F(Emulate, AClientThatSendsWithoutPauseDoesNotHoldIt) {
  start({"--tcp", "0", "--motion", "still", "--duration", "1"});
  const std::string line = tcp_line();
  ASSERT_TRUE(line.starts_with("tcp:127.0.0.1:")) << line;
  const auto client = devices::connect_tcp("127.0.0.1", std::stoi(line.substr(14)));
  const std::vector<std::uint8_t> flood(65536, 0xff);
  int status = 0;
  while (waitpid(child_, &status, WNOHANG) == 0) client->write(flood);
  child_ = -1;
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace headpin
