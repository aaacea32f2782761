// A session in real time: fed by LCM's own player, stopped by signals, replayed to the bit.

#include "devices/log.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

const std::string kDemo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

class Live : public CommandLine {
 protected:
  /// Runs a shell script in the folder, in a network of its own that has a multicast route.
  Result alone(const std::string& script) const {
    std::ofstream(folder_ / "script.sh")
        << "ip link set lo up\nip link set lo multicast on\nip route add 224.0.0.0/4 dev lo\n"
        << "headpin=" HEADPIN_PROGRAM "\n"
        << "size() { stat -c %s \"$1\" 2>/dev/null || echo 0; }\n"
        << "written() { while [ $(size $1) -lt $2 ]; do sleep 0.02; done; }\n"  // FILE, BYTES
        << script << "\n";
    const std::string command =
        "cd '" + folder_.string() + "' && unshare -n sh script.sh >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }

  void SetUp() override {
    if (alone("true").code != 0)
      GTEST_SKIP() << "no private network: " << slurp(folder_ / "err.txt");
    ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
    fs::copy(folder_ / "out.txt", folder_ / "room.toml");
  }
};

TEST_F(Live, FedByLcmLogplayerItReplaysToTheSameHashes) {
  const Result result = alone(
      "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --duration 10 --eyes png "
      "--json >live.json &\nwritten live.lcmlog 50000\nlcm-logplayer " +
      kDemo + " >/dev/null\nwait $!");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json live = nlohmann::json::parse(slurp(folder_ / "live.json"));
  EXPECT_EQ(live["ticks"], 10 * 240);  // none skipped, whatever else the machine does
  EXPECT_EQ(live["samples"], 843);
  EXPECT_EQ(live["dropped_samples"], 0);
  EXPECT_GT(live["frames"].get<int>(), 0);
  EXPECT_GT(live["skittles_down"].get<int>(), 0);

  const nlohmann::json replayed = json("replay live.lcmlog --verify --json");
  EXPECT_EQ(replayed["verified_ticks"], live["ticks"]);
  EXPECT_EQ(replayed["state_hash"], live["state_hash"]);
  EXPECT_EQ(replayed["skittles_down"], live["skittles_down"]);
}

TEST_F(Live, AnInterruptEndsItCleanlyAndAKillLosesNothingWritten) {
  const Result ended = alone(
      "$headpin live --lcm '' --record ended.lcmlog --eyes none 2>/dev/null &\nwritten "
      "ended.lcmlog 200000\n"
      "kill -INT $!\nwait $!");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(devices::read_trial((folder_ / "ended.lcmlog").string()).complete);

  alone(
      "$headpin live --lcm '' --record killed.lcmlog --eyes none 2>/dev/null &\nwritten "
      "killed.lcmlog 200000\n"
      "kill -KILL $!\nwait $!");
  const devices::Trial killed = devices::read_trial((folder_ / "killed.lcmlog").string());
  EXPECT_FALSE(killed.complete);
  EXPECT_GT(killed.states.size(), 50u);  // some 2000 bytes each
  EXPECT_EQ(killed.states.back().tick, static_cast<std::int64_t>(killed.states.size()));
}

/// A Fastrak of headpin's own at the end of a line.
class LiveFastrak : public CommandLine {
 protected:
  /// Records a session with a unit that measures the trial, until it has so many samples.
  devices::Trial session(const std::string& trial, const std::string& options, int samples) {
    std::ofstream(folder_ / "script.sh")
        << "headpin=" HEADPIN_PROGRAM "\n"
        << "samples() { grep -ao TRACKER live.lcmlog | wc -l; }\n"
        << "$headpin emulate " << trial << " --link unit --faults noise=0 --stylus &\nunit=$!\n"
        << "until [ -e unit ]; do sleep 0.02; done\n"
        << "$headpin live --fastrak unit --record live.lcmlog --force --eyes none " << options
        << " &\nlive=$!\n"
        << "until [ -e live.lcmlog ]; do sleep 0.02; done\n"
        << "while kill -0 $live && [ $(samples) -lt " << samples << " ]; do sleep 0.02; done\n"
        << "kill -INT $live; wait $live; code=$?; kill -INT $unit; wait $unit; exit $code\n";
    const std::string command =
        "cd '" + folder_.string() + "' && rm -f live.lcmlog && sh script.sh >out.txt 2>err.txt";
    EXPECT_EQ(std::system(command.c_str()), 0) << slurp(folder_ / "err.txt");
    return devices::read_trial(folder_ / "live.lcmlog");
  }
};

TEST_F(LiveFastrak, AHandOnTheOtherSideIsFlippedUnlessItsHemisphereIsGiven) {
  devices::TrackerSample head, hand_behind;
  head.X_TS.p = Vec3(0.8, 0.1, -0.6);
  hand_behind.station = devices::kHandStation;
  hand_behind.X_TS.p = Vec3(-0.5, 0.3, 0.2);
  devices::Recorder recorder(folder_ / "behind.lcmlog", {});
  recorder.write(head);
  recorder.write(hand_behind);
  recorder.close();
  const auto expect_at = [&](const std::string& options, const Vec3& p) {
    for (const devices::Sample& sample : session("behind.lcmlog", options, 100).samples) {
      const auto& tracker = std::get<devices::TrackerSample>(sample);
      if (tracker.station != devices::kHandStation) continue;
      EXPECT_LT((tracker.X_TS.p - p).norm(), 1e-6) << options;
    }
  };
  expect_at("", -hand_behind.X_TS.p);
  expect_at("--hemisphere 2:-1,0,0", hand_behind.X_TS.p);
  expect_at("--hemisphere 0,1,0", hand_behind.X_TS.p);  // where both are
  expect_refusal("live --fastrak unit --hemisphere up", 2, "hemisphere 'up': expected X,Y,Z");
}

// A record may begin in one tick and end in the next: the replay must not know it any earlier.
TEST_F(LiveFastrak, ASessionReplaysToTheSameHashes) {
  ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
  fs::copy(folder_ / "out.txt", folder_ / "room.toml");
  const devices::Trial live =
      session(kDemo, "--scenario room.toml --set rig.delay_s=0", 400);  // the ball is in the hand
  EXPECT_TRUE(std::ranges::any_of(live.events, [](const auto& e) { return e.kind == "grab"; }));
  const nlohmann::json replayed = json("replay live.lcmlog -o again.lcmlog --verify --json");
  EXPECT_EQ(replayed["verified_ticks"], live.states.size());
  EXPECT_EQ(json("replay again.lcmlog --verify --json")["state_hash"], replayed["state_hash"]);
}

TEST_F(Live, WithoutARouteItSaysWhatIsWrong) {
  expect_refusal("live", 2, "nothing to listen to");
  expect_refusal("live --fastrak missing-tty", 1, "missing-tty");
  std::ofstream(folder_ / "taken.lcmlog") << "mine";
  EXPECT_EQ(alone("$headpin live --lcm '' --record taken.lcmlog --duration 1").code, 1);
  EXPECT_EQ(slurp(folder_ / "taken.lcmlog"), "mine");
}

}  // namespace
}  // namespace headpin
