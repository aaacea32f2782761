// A session in real time: fed by LCM's own player, stopped by signals, replayed to the bit.

#include "devices/trial/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

const std::string kDemo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

const Vec3 kBehind(-0.5, 0.3, 0.2);  // p_TS

/// Sessions run by shell scripts that wait for what they need.
class Sessions : public CommandLine {
 protected:
  Result shell(const std::string& script, const std::string& wrapper = "") const {
    std::ofstream(folder_ / "script.sh")
        << "headpin=" HEADPIN_PROGRAM "\n"
        << "size() { stat -c %s \"$1\" 2>/dev/null || echo 0; }\n"
        << "written() { for i in $(seq 3000); do test $(size $1) -ge $2 && break; sleep 0.02; "
           "done; }\n"                                          // FILE, BYTES
        << "count() { grep -ao $2 $1 2>/dev/null | wc -l; }\n"  // FILE, WORD
        // PROCESS, FILE, WORD, COUNT: until there are so many, or the process is no more
        << "counted() { while kill -0 $1 && [ $(count $2 $3) -lt $4 ]; do sleep 0.1; done; }\n"
        << "there() { while kill -0 $1 && ! [ -e $2 ]; do sleep 0.02; done; }\n"  // PROCESS, FILE
        << "interrupt() { kill -INT $1; wait $1; }\n"
        << script << "\n";
    const std::string command = "cd '" + folder_.string() + "' && " + wrapper +
                                " sh script.sh >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, slurp(folder_ / "out.txt"),
            slurp(folder_ / "err.txt")};
  }

  /// Records a session with an emulated Fastrak until it has so many samples.
  ///
  /// @param feed  of the unit
  static std::string fastrak_session(const std::string& feed, const std::string& options,
                                     int samples) {
    return "rm -f live.lcmlog\n$headpin emulate " + feed +
           " --link unit --faults noise=0 --stylus &\nunit=$!\nthere $unit unit\n"
           "publish\n"
           "$headpin live --fastrak unit --record live.lcmlog --eyes none " +
           options + " &\nlive=$!\ncounted $live live.lcmlog TRACKER " + std::to_string(samples) +
           "\ninterrupt $live; code=$?\ninterrupt $unit\nexit $code";
  }

  /// A trial of a head and a hand at rest, the hand behind the transmitter.
  void record_hand_behind() const {
    devices::TrackerSample head, hand;
    head.X_TS.p = Vec3(0.8, 0.1, -0.6);
    hand.station = devices::kHandStation;
    hand.X_TS.p = kBehind;
    devices::TrialHeader header;
    header.scenario = scene::to_toml(scene::Scenario{});
    devices::Recorder recorder(folder_ / "behind.lcmlog", header);
    recorder.write(head);
    recorder.write(hand);
    recorder.close();
  }

  void take_room_of_demo() {
    ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
    fs::copy(folder_ / "out.txt", folder_ / "room.toml");
  }

  devices::Trial trial(const std::string& name) const {
    return devices::read_trial(folder_ / name);
  }
};

class Live : public Sessions {
 protected:
  /// In a network of its own that has a multicast route.
  Result alone(const std::string& script) const {
    return shell(
        "ip link set lo up\nip link set lo multicast on\nip route add 224.0.0.0/4 dev lo\n" +
            script,
        "unshare -n");
  }

  void SetUp() override {
    if (alone("true").code != 0)
      GTEST_SKIP() << "no private network: " << slurp(folder_ / "err.txt");
    take_room_of_demo();
  }
};

using LiveFastrak = Sessions;

/// $live, fed by $unit until they are interrupted.
const std::string kEndlessSession =
    "$headpin emulate --link unit --motion circle >/dev/null &\nunit=$!\nthere $unit unit\n"
    "$headpin live --fastrak unit --look fast --record live.lcmlog --json >live.json &\nlive=$!\n";

TEST_F(Live, FedByLcmLogplayerItReplaysToTheSameHashes) {
  const Result result = alone(
      "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --eyes png --json "
      ">live.json &\nlive=$!\nwritten live.lcmlog 50000\nlcm-logplayer " +
      kDemo + " >/dev/null\ncounted $live live.lcmlog TRACKER 600\ninterrupt $live");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json live = nlohmann::json::parse(slurp(folder_ / "live.json"));
  EXPECT_EQ(live["ticks"], trial("live.lcmlog").states.size());  // none skipped
  // 843 were sent; a machine that is busy with more loses datagrams before anybody gets them.
  EXPECT_THAT(live["samples"].get<int>(), testing::AllOf(testing::Gt(600), testing::Le(843)));
  EXPECT_EQ(live["sources"][0]["dropped_samples"], 0);
  if (live["samples"] == 843) {  // at the same places between the ticks, whenever it was sent
    EXPECT_EQ(live["release_speed_mps"],
              json("replay " + kDemo + " -o demo.lcmlog --json")["release_speed_mps"]);
  }
  EXPECT_GT(live["frames"].get<int>(), 0);
  EXPECT_GT(live["skittles_down"].get<int>(), 0);

  const nlohmann::json replayed = json("replay live.lcmlog --verify --json");
  EXPECT_EQ(replayed["verified_ticks"], live["ticks"]);
  EXPECT_EQ(replayed["state_hash"], live["state_hash"]);
  EXPECT_EQ(replayed["skittles_down"], live["skittles_down"]);
}

TEST_F(LiveFastrak, ASessionThatNobodyTakesPartInHasFailed) {
  const Result alone =
      headpin("live --lcm memq:// --eyes none --duration 0.2 --record empty.lcmlog --json");
  EXPECT_EQ(alone.code, 1);
  EXPECT_THAT(alone.err,
              testing::HasSubstr("headpin live: no sample arrived in 0.2 s from lcm:memq://"));
  EXPECT_EQ(nlohmann::json::parse(alone.out)["exit_code"], 1);
  EXPECT_TRUE(trial("empty.lcmlog").complete);
}

TEST_F(LiveFastrak, ASecondSessionOnALineAndASecondUnitAtALinkAreRefused) {
  const Result run = shell(
      "$headpin emulate --link line --motion circle --control unit >/dev/null &\n"
      "there $! line; there $! unit\n"
      "$headpin live --fastrak line --eyes none --record first.lcmlog 2>first.txt &\n"
      "first=$!\nthere $first first.lcmlog\n"
      "$headpin live --fastrak line --eyes none --record second.lcmlog; echo $?\n"
      "$headpin emulate --link line; echo $?\n"
      "counted $first first.lcmlog TRACKER 150\ninterrupt $first; echo $?; echo quit >unit; wait");
  EXPECT_EQ(run.out, "75\n75\n0\n") << run.err << slurp(folder_ / "first.txt");
  EXPECT_THAT(run.err, testing::HasSubstr("line: in use by another headpin"));
  EXPECT_THAT(run.err, testing::HasSubstr("line: another emulator uses it"));
  EXPECT_TRUE(trial("first.lcmlog").complete);
  EXPECT_GT(trial("first.lcmlog").samples.size(), 100u);
}

TEST_F(Live, AnInterruptEndsItCleanlyAndAKillLosesNothingWritten) {
  const Result ended = alone(
      "$headpin live --lcm '' --record ended.lcmlog --eyes none 2>/dev/null &\nwritten "
      "ended.lcmlog 200000\n"
      "kill -INT $!\nwait $!");
  EXPECT_EQ(ended.code, 1) << ended.err;  // whole, but nobody took part
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

TEST_F(LiveFastrak, AHandOnTheOtherSideIsFlippedUnlessItsHemisphereIsGiven) {
  record_hand_behind();
  const auto expect_at = [&](const std::string& options, const Vec3& p) {
    const Result result = shell(fastrak_session("behind.lcmlog --place recorded", options, 100));
    ASSERT_EQ(result.code, 0) << result.err;
    for (const devices::Sample& sample : trial("live.lcmlog").samples) {
      const auto& tracker = std::get<devices::TrackerSample>(sample);
      if (tracker.station != devices::kHandStation) continue;
      EXPECT_LT((tracker.X_TS.p - p).norm(), 1e-6) << options;
    }
  };
  expect_at("", -kBehind);
  expect_at("--hemisphere 2:-1,0,0", kBehind);
  expect_at("--hemisphere 0,1,0", kBehind);  // where both are
  expect_refusal("live --fastrak unit --hemisphere up", 2, "hemisphere 'up': expected X,Y,Z");
}

// A record may begin in one tick and end in the next: the replay must not know it any earlier.
TEST_F(LiveFastrak, ASessionReplaysToTheSameHashes) {
  take_room_of_demo();
  // The ball is in the hand by then.
  const Result result =
      shell(fastrak_session(kDemo, "--scenario room.toml --set rig.delay_s=0", 400));
  ASSERT_EQ(result.code, 0) << result.err;
  const devices::Trial live = trial("live.lcmlog");
  EXPECT_TRUE(std::ranges::any_of(live.events, [](const auto& e) { return e.kind == "grab"; }));
  const nlohmann::json replayed = json("replay live.lcmlog -o again.lcmlog --verify --json");
  EXPECT_EQ(replayed["verified_ticks"], live.states.size());
  EXPECT_EQ(json("replay again.lcmlog --verify --json")["state_hash"], replayed["state_hash"]);
}

// At a terminal or behind an Ethernet adapter, the machine idle or busy: the same throw.
TEST_F(LiveFastrak, ABusyMachineDoesNotChangeAThrow) {
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "sanitizers take the time that four busy loops leave; what makes it hold is "
                  "tested without a clock: ThroughAUnit, FastrakDriverTest";
#endif
  take_room_of_demo();
  const auto release_speed = [&](const std::string& line, int hogs) {
    const Result result = shell(
        "for i in $(seq " + std::to_string(hogs) +
        "); do while :; do :; done & hogs=\"$hogs $!\"; done\n"
        "rm -f unit out live.lcmlog\n"
        "$headpin emulate " +
        kDemo + " " + line +
        " --faults noise=0 --stylus >out & unit=$!\n"
        "while kill -0 $unit && ! grep -q Fastrak out; do sleep 0.02; done\n"
        "case '" +
        line +
        "' in *tcp*) line=tcp:$(head -1 out);; *) line=unit;; esac\n"
        "$headpin live --fastrak $line --scenario room.toml --record live.lcmlog --eyes none "
        "--json >live.json & live=$!\n"
        "counted $live live.lcmlog TRACKER 600\n"  // of 841; the ball is let go at 475
        "interrupt $live; code=$?\ntest -z \"$hogs\" || kill $hogs\ninterrupt $unit\nexit $code");
    EXPECT_EQ(result.code, 0) << result.err;
    const nlohmann::json live = nlohmann::json::parse(slurp(folder_ / "live.json"));
    EXPECT_EQ(live["sources"][0]["missed"], 0) << line << ", " << hogs << " hogs";
    EXPECT_EQ(live["sources"][0]["skipped_bytes"], 0) << line << ", " << hogs << " hogs";
    return json("info live.lcmlog --json")["result"]["release_speed_mps"].get<double>();
  };
  const double speed = release_speed("--link unit", 0);
  const double replayed = json("replay " + kDemo + " --json")["release_speed_mps"];
  EXPECT_NEAR(speed, replayed, 0.1);
  EXPECT_NEAR(release_speed("--link unit", 4), speed, 0.1);
  EXPECT_NEAR(release_speed("--tcp 0", 4), speed, 0.1);
}

/// Of each thread of $live and of what draws for it: policy (1 is SCHED_FIFO) and niceness.
const std::string kSchedules =
    "$headpin live " + kDemo +
    " --record live.lcmlog & live=$!\n"
    "counted $live live.lcmlog STATE 10\n"
    "of() { cut -d' ' -f41 $2/stat | sed \"s/^/$1 policy /\"; cut -d' ' -f19 $2/stat | sed "
    "\"s/^/$1 nice "
    "/\"; }\n"
    "{ of shell /proc/$$\n"
    "for task in /proc/$live/task/*; do\n"
    "  test ${task##*/} = $live && of ticks $task || of others $task\n"
    "done\n"
    "for task in /proc/$(cat /proc/$live/task/*/children)/task/*; do of draws $task; done; } "
    ">schedules 2>/dev/null\n"
    "interrupt $live";

// What goes before everything else is the tick, not what draws: were that real-time too, nothing else
// would run beside it. Nor does it give way then: three busy processes would starve it.
TEST_F(LiveFastrak, TicksAreScheduledInRealTimeAndDrawingIsNot) {
  if (!json("doctor --json")["real_time"]["works"]) GTEST_SKIP() << "not allowed to anybody here";
  ASSERT_EQ(shell(kSchedules).code, 0) << slurp(folder_ / "err.txt");
  const std::string schedules = slurp(folder_ / "schedules");
  const std::string shells = schedules.substr(schedules.find("shell nice ") + 6);
  EXPECT_THAT(schedules, testing::HasSubstr("ticks policy 1\n"));
  EXPECT_THAT(schedules, testing::HasSubstr("others policy 0\n"));
  EXPECT_THAT(schedules, testing::Not(testing::HasSubstr("others policy 1\n")));
  EXPECT_THAT(schedules, testing::HasSubstr("draws policy 0\n"));
  EXPECT_THAT(schedules, testing::Not(testing::HasSubstr("draws policy 1\n")));
  EXPECT_THAT(schedules, testing::HasSubstr("draws " + shells.substr(0, shells.find('\n') + 1)));
}

TEST_F(LiveFastrak, WhereTicksCannotGoFirstDrawingGivesWay) {
  std::string without;  // the right to go first
  if (json("doctor --json")["real_time"]["works"]) {
    without = "setpriv --bounding-set=-sys_nice --inh-caps=-sys_nice";
    if (shell("true", without).code != 0) GTEST_SKIP() << "setpriv cannot take the right away";
    shell("$headpin doctor --json >doctor.json", without);
    if (nlohmann::json::parse(slurp(folder_ / "doctor.json"))["real_time"]["works"]) {
      GTEST_SKIP() << "allowed to everybody here";
    }
  }
  ASSERT_EQ(shell(kSchedules, without).code, 0) << slurp(folder_ / "err.txt");
  const std::string schedules = slurp(folder_ / "schedules");
  EXPECT_THAT(schedules, testing::HasSubstr("ticks policy 0\n"));
  EXPECT_THAT(schedules, testing::Not(testing::HasSubstr("policy 1\n")));
  const auto niceness = [&](const std::string& of) {
    const std::size_t at = schedules.find(of + " nice ");
    EXPECT_NE(at, std::string::npos) << schedules;
    return std::stoi(schedules.substr(at + of.size() + 6));
  };
  EXPECT_EQ(niceness("draws"), std::max(niceness("shell"), 10));
}

// The loss is said when it happens and when the session ends; the session itself goes on.
TEST_F(LiveFastrak, ARecordingThatSomebodyTakesAwayIsSaidToBeLost) {
  for (const auto& [deed, said] : {std::pair{"rm live.lcmlog", "was deleted while"},
                                   {"mv live.lcmlog gone", "was moved while"},
                                   {"echo x >new; mv new live.lcmlog", "was replaced while"},
                                   {": >live.lcmlog", "was cut to "}}) {
    const Result result = shell(
        "rm -f live.lcmlog; $headpin emulate --link unit --motion circle & unit=$!\n"
        "there $unit unit\n"
        "$headpin live --fastrak unit --record live.lcmlog --eyes none --json >live.json & "
        "live=$!\n"
        "counted $live live.lcmlog TRACKER 60\n" +
        std::string(deed) +
        "\nwhile kill -0 $live && ! grep -q 'continues without a recording' err.txt; do sleep "
        "0.05; done\n"
        "interrupt $live; code=$?\ninterrupt $unit\nexit $code");
    EXPECT_EQ(result.code, 1) << deed << "\n" << result.err;
    EXPECT_THAT(result.err, testing::HasSubstr(std::string("headpin live: live.lcmlog: ") + said));
    EXPECT_EQ(nlohmann::json::parse(slurp(folder_ / "live.json"))["exit_code"], 1);
  }
}

// Whatever else goes away, a recording gets its end.
TEST_F(LiveFastrak, ARecordingIsWholeWhenTheTerminalOrTheReaderIsGone) {
  const auto whole = [&](const std::string& session) {
    const Result result = shell(
        "rm -f live.lcmlog; $headpin emulate --link unit --motion circle & unit=$!\n"
        "there $unit unit\n" +
        session + "\ninterrupt $unit\nexit $code");
    EXPECT_EQ(result.code, 0) << session << "\n" << result.err;
    EXPECT_TRUE(trial("live.lcmlog").complete) << session;
  };
  const std::string live = "$headpin live --fastrak unit --record live.lcmlog --eyes none";
  whole(live +
        " & live=$!\ncounted $live live.lcmlog TRACKER 60; kill -HUP $live; wait $live; "
        "code=$?");
  // Its messages go to a reader that has ended.
  whole("mkfifo pipe; (exec 3<pipe; :) & exec 4>pipe; wait $!; " + live +
        " 2>&4 & live=$!\ncounted $live live.lcmlog TRACKER 60; interrupt $live; code=$?; rm pipe");
}

TEST_F(LiveFastrak, ARecordingIntoAPipeThatClosesIsSaidToBeLost) {
  const Result result = shell(
      "$headpin emulate --link unit --motion circle & unit=$!\nthere $unit unit\n"
      "mkfifo pipe; head -c 100000 pipe >head & \n"
      "$headpin live --fastrak unit --record pipe --eyes none --duration 60; code=$?\n"
      "interrupt $unit\nexit $code");
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("headpin live: pipe: cannot write event"));
  EXPECT_EQ(fs::file_size(folder_ / "head"), 100000u);
}

TEST_F(LiveFastrak, AUnitThatIsSwitchedOffAndOnIsTakenUpAgain) {
  const Result result = shell(
      "$headpin emulate --link unit --motion circle & unit=$!\nthere $unit unit\n"
      "$headpin live --fastrak unit --record live.lcmlog --eyes none & live=$!\n"
      "counted $live live.lcmlog TRACKER 60\ninterrupt $unit\n"
      "while kill -0 $live && ! grep -q 'unit hung up; waiting' err.txt; do sleep 0.05; done\n"
      "before=$(count live.lcmlog TRACKER)\n"
      "$headpin emulate --link unit --motion circle & unit=$!\n"
      "counted $live live.lcmlog TRACKER $((before + 60))\n"
      "interrupt $live; code=$?\ninterrupt $unit\nexit $code");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("fastrak:unit is back"));
  EXPECT_TRUE(trial("live.lcmlog").complete);
}

TEST_F(Live, PosesPublishedToAnEmulatedFastrakComeOutAsItsRecords) {
  record_hand_behind();
  const Result result = alone("publish() { $headpin stream behind.lcmlog --lcm ''; }\n" +
                              fastrak_session("--lcm ''", "--hemisphere 0,1,0", 100));
  ASSERT_EQ(result.code, 0) << result.err;
  int of_hand = 0;
  for (const devices::Sample& sample : trial("live.lcmlog").samples) {
    const auto& tracker = std::get<devices::TrackerSample>(sample);
    const bool hand = tracker.station == devices::kHandStation;
    EXPECT_LT((tracker.X_TS.p - (hand ? kBehind : Vec3(0.8, 0.1, -0.6))).norm(), 1e-6);
    of_hand += hand;
  }
  EXPECT_GT(of_hand, 40);
}

TEST_F(Live, AnotherLanguageSeesWhatTheEyesAndTheViewerSee) {
  if (shell("python3 --version").code != 0) GTEST_SKIP() << "no python3";
  ASSERT_EQ(
      shell("lcm-gen -p --ppath generated " HEADPIN_SOURCE_DIR "/devices/lcm/types/*.lcm").code, 0);
  for (const std::string eyes : {"raw", "png"}) {
    const Result seen = alone(
        "rm -f seen.lcmlog live.lcmlog\n"
        "lcm-logger -q -f seen.lcmlog &\nlogger=$!\nthere $logger seen.lcmlog\n"
        "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --eyes " +
        eyes + " &\nlive=$!\nwritten live.lcmlog 50000\n$headpin stream --lcm '' " + kDemo +
        " &\nstream=$!\nfor channel in HEADPIN_EYES DRAKE_VIEWER_DRAW; "
        "do\ncounted $live seen.lcmlog $channel 5\ndone\n"
        "interrupt $live; code=$?\ninterrupt $stream\ninterrupt $logger\nexit $code");
    ASSERT_EQ(seen.code, 0) << seen.err;
    const Result read = shell("python3 -B " HEADPIN_SOURCE_DIR
                              "/tests/apps/read_eyes.py generated seen.lcmlog live.lcmlog");
    EXPECT_EQ(read.code, 0) << eyes << "\n" << read.out << read.err;
  }
}

// file:// needs no network: the log plays at its pace, and the session ends with it.
TEST_F(LiveFastrak, WithoutANetworkALogFeedsASessionOrAUnit) {
  take_room_of_demo();
  const std::string url = "file://" + kDemo;
  const nlohmann::json live =
      json("live --lcm '" + url + "' --scenario room.toml --record live.lcmlog --json");
  EXPECT_EQ(live["samples"], 843);
  EXPECT_GT(live["frames"].get<int>(), 0);
  EXPECT_GT(live["skittles_down"].get<int>(), 0);
  // Where the time goes is all of it.
  double stages_s = 0.0;
  for (const auto& stage : live["latency_stages"]) {
    EXPECT_GE(stage.get<double>(), 0.0);
    stages_s += stage.get<double>();
  }
  EXPECT_NEAR(stages_s, live["latency_mean_s"].get<double>(), 1e-9);
  EXPECT_GT(stages_s, 0.0);
  EXPECT_EQ(json("replay live.lcmlog --verify --json")["state_hash"], live["state_hash"]);
  // In a room that is not the log's own it says so, and goes on.
  for (const std::string own : {"", " --scenario room.toml", " --friction 0.1"}) {
    EXPECT_THAT(headpin("live --lcm '" + url + "' --eyes none --duration 0.3" + own).err,
                testing::Not(testing::HasSubstr("another scenario")))
        << own;
  }
  const Result other = headpin("live --lcm '" + url +
                               "' --eyes none --duration 0.5 --scenario paper-room --set "
                               "ball.home=[0.5,-0.3,0.9]");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_THAT(other.err,
              testing::HasSubstr("was recorded in another scenario than this session's"));
  // The unit goes on measuring where the log left its receivers.
  const Result unit = shell("$headpin emulate --lcm '" + url + "?speed=0' --duration 0.5");
  EXPECT_EQ(unit.code, 0) << unit.err;
}

// By its name alone, in its own room: the same session again, and the same as a replay's.
TEST_F(LiveFastrak, ATrialFeedsASession) {
  const nlohmann::json live = json("live " + kDemo + " --eyes none --record live.lcmlog --json");
  EXPECT_EQ(live["samples"], 843);
  EXPECT_EQ(live["sources"][0]["source"], kDemo);
  EXPECT_EQ(live["sources"][0]["activity"], "at its end");
  ASSERT_EQ(headpin("replay " + kDemo + " -o replayed.lcmlog").code, 0);
  const nlohmann::json both = json("compare replayed.lcmlog live.lcmlog --json");
  EXPECT_TRUE(both["first_difference_tick"].is_null()) << both;
  EXPECT_EQ(json("replay live.lcmlog --verify --json")["state_hash"], live["state_hash"]);
  expect_refusal("live nobody.lcmlog --record OUT", 1, "nobody.lcmlog: ");
  const Result itself = headpin("live live.lcmlog --record live.lcmlog --force");
  EXPECT_EQ(itself.code, 1);
  EXPECT_THAT(itself.err, testing::HasSubstr("live.lcmlog: is an input of this command"));
  EXPECT_TRUE(trial("live.lcmlog").complete);
}

// What the eyes saw is drawn again to the pixel: the look is in the trial.
TEST_F(LiveFastrak, RecordedFramesAreDrawnAgainToThePixel) {
  take_room_of_demo();  // else the head looks at a wall
  const std::string play =
      "live --lcm 'file://" + kDemo + "' --scenario room.toml --duration 1.5 --record ";
  for (const std::string samples : {"1", "2"}) {
    ASSERT_EQ(headpin(play + samples + ".lcmlog --samples " + samples).code, 0);
    const nlohmann::json verified = json("frames " + samples + ".lcmlog --verify --json");
    EXPECT_GT(verified["verified_frames"], 0);
    EXPECT_EQ(verified["verified_frames"], trial(samples + ".lcmlog").frames.size());
    EXPECT_THAT(headpin("info " + samples + ".lcmlog --scenario").out,
                testing::HasSubstr("[look]"));
  }
  // Another look is another picture, and said to be.
  devices::Trial other = trial("1.lcmlog");
  scene::Scenario scenario = scene::scenario_of_trial(other.header.scenario, "1.lcmlog");
  scenario.look.samples = 2;
  other.header.scenario = scene::to_toml(scenario);
  devices::Recorder recorder(folder_ / "other.lcmlog", other.header);
  devices::write(recorder, other.samples, {});
  for (const devices::FrameRecord& frame : other.frames) recorder.write(frame);
  recorder.close();
  expect_refusal("frames other.lcmlog --verify", 1,
                 "differs from the recording, first difference in the left");
  expect_refusal("frames " + kDemo + " --verify", 1, "has no recorded frames");
}

// Pictures are drawn in a process of its own: its end costs pictures. The trial tells of it.
TEST_F(LiveFastrak, WhatDrawsMayCrashAndTheSessionGoesOn) {
  const Result result =
      shell(kEndlessSession +
            "counted $live live.lcmlog FRAME 20\n"
            "kill -SEGV $(cat /proc/$live/task/*/children)\n"
            "counted $live live.lcmlog drawing_failed 1\n"
            "echo $(($(count live.lcmlog FRAME) + 20)) >enough\n"
            // It is started again. One word more than frames: the first message names the channel.
            "counted $live live.lcmlog FRAME $(($(cat enough) + 1))\n"
            "interrupt $live; code=$?\ninterrupt $unit\nexit $code");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json live = nlohmann::json::parse(slurp(folder_ / "live.json"));
  EXPECT_EQ(live["drawing_failures"], 1) << result.err;
#ifdef HEADPIN_SANITIZED
  const std::string how = "with exit code 1";  // AddressSanitizer handles the signal
#else
  const std::string how = "by signal 11 .*";
#endif
  EXPECT_THAT(result.err, testing::ContainsRegex("the process that draws has ended, " + how +
                                                 "; it is started again"));
  EXPECT_GT(live["late_frames"], 0);
  const devices::Trial recorded = trial("live.lcmlog");
  EXPECT_TRUE(recorded.complete);
  EXPECT_EQ(recorded.samples.size(), live["samples"]);
  ASSERT_FALSE(recorded.states.empty());
  EXPECT_EQ(recorded.states.back().tick, recorded.states.size());  // none skipped
  EXPECT_EQ(recorded.frames.size(), live["frames"]);
  EXPECT_GE(recorded.frames.size(), std::stoul(slurp(folder_ / "enough")));
  const nlohmann::json info = json("info live.lcmlog --json");
  for (const char* key : {"ticks", "overruns", "frames", "late_frames", "drawing_failures"}) {
    EXPECT_EQ(info["kept_pace"][key], live[key]) << key;
  }
  EXPECT_THAT(headpin("info live.lcmlog").out, testing::HasSubstr("; drawing failed 1 times"));
  EXPECT_EQ(json("replay live.lcmlog --verify --json")["state_hash"], live["state_hash"]);
  EXPECT_EQ(json("frames live.lcmlog --verify --json")["verified_frames"], live["frames"]);
}

TEST_F(LiveFastrak, WhatDrawsMayCrashAgainAndAgain) {
  const Result result =
      shell(kEndlessSession +
            "counted $live live.lcmlog FRAME 5\n"
            "while kill -0 $live && [ $(count live.lcmlog there.are.no.more) -lt 1 ]; do\n"
            "  child=$(cat /proc/$live/task/*/children) && kill -SEGV $child 2>/dev/null\n"
            "done\n"
            "ticks=$(count live.lcmlog STATE)\n"
            "counted $live live.lcmlog STATE $((ticks + 100))\n"
            "interrupt $live; code=$?\ninterrupt $unit\nexit $code");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("times without a picture: there are no more"));
  const devices::Trial recorded = trial("live.lcmlog");
  EXPECT_TRUE(recorded.complete);
  EXPECT_EQ(recorded.states.back().tick, recorded.states.size());
}

TEST_F(LiveFastrak, NobodyElseStartsWhatDraws) {
  expect_refusal("draw", 1, "internal command: only `headpin live` starts it");
}

TEST_F(LiveFastrak, AFloodOfWrongTypesIsSaidAtOnce) {
  std::string log = slurp(kDemo);
  for (std::size_t at = 0; (at = log.find("TRACKER", at)) != std::string::npos; at += 8) {
    log[at + 7] = static_cast<char>(log[at + 7] ^ 1);  // the first byte of the type's fingerprint
  }
  std::ofstream(folder_ / "flood.lcmlog", std::ios::binary) << log;
  const Result flood = headpin("live --lcm file://flood.lcmlog --eyes none --duration 2");
  const std::size_t said = flood.err.find("messages that cannot be used: ");
  ASSERT_NE(said, std::string::npos) << flood.err;
  const std::size_t line = flood.err.rfind('\n', said) + 1;
  EXPECT_LT(std::stod(flood.err.substr(line)), 0.5) << flood.err;
  const std::size_t again = flood.err.find("messages that cannot be used: ", said + 1);
  ASSERT_NE(again, std::string::npos) << "how many there were, at the end";
  EXPECT_EQ(flood.err.find("messages that cannot be used: ", again + 1), std::string::npos);
}

// A forgotten publisher of the same trial, a second later, is neither blended in nor passed over in
// silence: the throw is that of the first.
TEST_F(Live, OfTwoPublishersOfTheSameStationsOneIsKeptAndSaid) {
  const Result result = alone(
      "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --eyes none --json "
      ">live.json & live=$!\nwritten live.lcmlog 50000\n"
      "$headpin stream --lcm '' " +
      kDemo +
      " >/dev/null & first=$!\ncounted $live live.lcmlog TRACKER 240\n$headpin stream --lcm '' " +
      kDemo +
      " >/dev/null & second=$!\nwait $first\n"
      "interrupt $second; interrupt $live");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json live = nlohmann::json::parse(slurp(folder_ / "live.json"));
  const nlohmann::json source = live["sources"][0];
  EXPECT_GT(source["other_publishers_samples"].get<int>(), 100);
  EXPECT_THAT(result.err, testing::ContainsRegex(
                              "right hand has more than one publisher: [0-9]+ samples left "
                              "out, the last from [0-9.]+:[0-9]+ while [0-9.]+:[0-9]+ sent it"));
  std::string said;
  for (const devices::Event& event : trial("live.lcmlog").events) {
    if (event.kind == "source_amiss") said += event.detail;
  }
  EXPECT_THAT(said, testing::HasSubstr("more than one publisher"));
  // A machine that is busy with more loses datagrams; then it is not the same throw.
  if (source["lost_samples"] != 0 || live["samples"] < 843) return;
  EXPECT_EQ(live["release_speed_mps"],
            json("replay " + kDemo + " -o demo.lcmlog --json")["release_speed_mps"]);
}

// A fragment that claims to stand near 2^32 ends a process in which liblcm 1.3.1 reads it.
TEST_F(Live, DatagramsThatNoPublisherSendsDoNotEndASession) {
  if (shell("python3 --version").code != 0) GTEST_SKIP() << "no python3";
  std::ofstream(folder_ / "send.py") << R"(import socket, struct
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
def fragment(number, offset, data):
    return b"LC03" + struct.pack(">IIIHH", 9, 3000, offset, number, 2) + data
for channel in (b"TRACKER", b"MOUSE3D", b"OTHER"):
    for offset in (0xFFFFFF00, 0xFFFFFC18, 0x80000000):
        for datagram in (fragment(0, 0, channel + b"\0" + b"x" * 1000),
                         fragment(1, offset, b"y" * 1000)):
            s.sendto(datagram, ("239.255.76.67", 7667))
)";
  const Result result = alone(
      "$headpin emulate --lcm '' --link unit --receivers 2 >unit.txt & unit=$!\nthere $unit unit\n"
      "$headpin live --lcm '' --record live.lcmlog --eyes none --json >live.json & live=$!\n"
      "written live.lcmlog 50000\npython3 send.py\n"
      "$headpin stream --lcm '' " +
      kDemo +
      " >/dev/null & stream=$!\ncounted $live live.lcmlog TRACKER 60\n"
      "interrupt $stream; interrupt $live; code=$?; interrupt $unit; echo $? >unit.code; exit "
      "$code");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(slurp(folder_ / "unit.code"), "0\n") << slurp(folder_ / "unit.txt");
  EXPECT_THAT(result.err, testing::HasSubstr("messages that cannot be used"));
  EXPECT_TRUE(trial("live.lcmlog").complete);
}

// lcm-logger's file of a session is its trial, also of one it comes late to.
TEST_F(Live, WhatALoggerKeepsOfASessionIsATrial) {
  const std::string session =
      "rm -f *.lcmlog; lcm-logger -q -f whole.lcmlog & whole=$!\nthere $whole whole.lcmlog\n"
      "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --eyes none --json "
      ">live.json & "
      "live=$!\nwritten live.lcmlog 50000\n"
      "lcm-logger -q -f late.lcmlog & late=$!\nthere $late late.lcmlog\n"
      "counted $live late.lcmlog SESSION_HEADPIN_TRIAL 1\n"
      "$headpin stream --lcm '' " +
      kDemo +
      " >/dev/null\ncounted $live live.lcmlog TRACKER 841\ninterrupt $live; code=$?\n"
      "for i in $(seq 100); do grep -q ledger late.lcmlog && break; sleep 0.05; done; sleep 0.3\n"
      "interrupt $whole; interrupt $late; exit $code";
  // On a machine that is busy with other things a message may be lost on its way, so more than once.
  const auto came = [&](const std::string& log, const std::string& prefix) {
    const nlohmann::json info = json("info " + log + " --json");
    std::vector<nlohmann::json> seen = {
        info.value(nlohmann::json::json_pointer("/result/skittles_down"), -1)};
    for (const char* channel : {"TRACKER", "MOUSE3D"}) {
      seen.push_back(info["channels"].value(prefix + channel, nlohmann::json())["messages"]);
    }
    return seen;
  };
  const auto who_drew = [&](const std::string& log) {
    std::vector<std::string> all;
    for (const devices::Event& event : trial(log).events) {
      if (event.kind == devices::kDrawnByEvent) all.push_back(event.detail);
    }
    EXPECT_EQ(all.size(), 1u) << log;
    return all;
  };
  bool arrived = false;
  for (int attempt = 0; attempt < 4 && !arrived; ++attempt) {
    const Result result = alone(session);
    ASSERT_EQ(result.code, 0) << result.err;
    arrived = json("info whole.lcmlog --json")["complete"] &&
              came("late.lcmlog", "SESSION_") == came("live.lcmlog", "");
  }
  ASSERT_TRUE(arrived);
  const std::string hash = nlohmann::json::parse(slurp(folder_ / "live.json"))["state_hash"];
  for (const std::string log : {"whole.lcmlog", "late.lcmlog"}) {
    const nlohmann::json info = json("info " + log + " --json");
    EXPECT_EQ(info["complete"], log == "whole.lcmlog") << log;
    EXPECT_EQ(info["result"]["skittles_down"],
              json("info live.lcmlog --json")["result"]["skittles_down"]);
    const Result verified = headpin("replay " + log + " --verify");
    if (log == "whole.lcmlog") {
      EXPECT_EQ(verified.code, 0) << verified.err;
    } else {  // the states before it came are not in it; those that are there are equal
      EXPECT_EQ(verified.code, 1) << verified.out;
      EXPECT_THAT(verified.err,
                  testing::ContainsRegex("[0-9]+ of the [0-9]+ recorded ticks have no "
                                         "state .* the other [1-9][0-9]{3} are equal"));
    }
    EXPECT_EQ(json("replay " + log + " --json")["state_hash"], hash) << log;
    EXPECT_EQ(headpin("frames " + log + " --verify --force -o frames --frames 3").code, 0) << log;
    EXPECT_EQ(who_drew(log), who_drew("live.lcmlog")) << log;
  }
  const Result quiet = alone(
      "lcm-logger -q -f none.lcmlog & logger=$!\nthere $logger none.lcmlog\n"
      "$headpin live --lcm '' --no-trial --duration 1 --eyes none\ninterrupt $logger");
  EXPECT_EQ(slurp(folder_ / "none.lcmlog").find("SESSION_"), std::string::npos) << quiet.err;
}

// A Fastrak's line carries one switch; the mouse's three come beside it.
TEST_F(Live, ThumbsThatAreTypedAtAnEmulatorReachTheSession) {
  const Result result = alone(
      "$headpin emulate --link unit --motion circle --stylus --control ctl --mouse '' & unit=$!\n"
      "there $unit unit; there $unit ctl\n"
      "$headpin live --fastrak unit --lcm '' --record live.lcmlog --eyes none & live=$!\n"
      "counted $live live.lcmlog TRACKER 60\n"
      "n=0; for line in 'left-thumb down' press 'right-thumb down' release 'left-thumb up' "
      "'right-thumb up'; do\n"
      "n=$((n+1)); echo $line >ctl; counted $live live.lcmlog MOUSE3D $n; done\n"
      "interrupt $live; code=$?; echo quit >ctl; wait $unit; exit $code");
  ASSERT_EQ(result.code, 0) << result.err;
  std::string buttons;
  for (const devices::Sample& sample : trial("live.lcmlog").samples) {
    const auto* mouse = std::get_if<devices::MouseSample>(&sample);
    if (!mouse) continue;
    buttons += mouse->left_thumb ? 'L' : '-';
    buttons += mouse->right_thumb ? 'R' : '-';
    buttons += mouse->trigger ? 'T' : '-';
    buttons += ' ';
  }
  EXPECT_THAT(buttons, testing::EndsWith("L-- L-T LRT LR- -R- --- "));
  EXPECT_EQ(json("replay live.lcmlog --verify --json")["verified_ticks"],
            trial("live.lcmlog").states.size());
}

// Its line has float32 numbers, hence not to the last digit; a millisecond of the trigger is 8e-3.
TEST_F(Live, AThrowThroughAnEmulatedUnitWithItsMouseIsThatOfItsReplay) {
  const Result result = alone(
      "$headpin emulate " + kDemo +
      " --link unit --faults noise=0 --mouse '' & unit=$!\n"
      "there $unit unit\n"
      "$headpin live fastrak:unit lcm: --scenario room.toml --record live.lcmlog --eyes none & "
      "live=$!\ncounted $live live.lcmlog TRACKER 700\n"
      "interrupt $live; code=$?; interrupt $unit; exit $code");
  ASSERT_EQ(result.code, 0) << result.err;
  const double wanted =
      json("replay " + kDemo + " -o demo.lcmlog --json")["release_speed_mps"].get<double>();
  const nlohmann::json live = json("replay live.lcmlog --verify --json");
  EXPECT_NEAR(live["release_speed_mps"].get<double>(), wanted, 1e-3);
  std::ptrdiff_t told = 0;
  for (const devices::Sample& sample : trial("live.lcmlog").samples) {
    told += std::holds_alternative<devices::MouseSample>(sample) ? 1 : 0;
  }
  EXPECT_GT(told, 30);  // two changes, and ten times a second
}

TEST_F(Live, WithoutARouteItSaysWhatIsWrong) {
  expect_refusal("live", 2, "no source of samples");
  expect_refusal("live --fastrak missing-tty", 1, "missing-tty");
  std::ofstream(folder_ / "taken.lcmlog") << "mine";
  EXPECT_EQ(alone("$headpin live --lcm '' --record taken.lcmlog --duration 1").code, 1);
  EXPECT_EQ(slurp(folder_ / "taken.lcmlog"), "mine");
}

}  // namespace
}  // namespace headpin
