// A session in real time: stopped by signals, drawn by a process of its own, replayed to the bit.

#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/apps/live_sessions.h"

namespace headpin {
namespace {

using LiveFastrak = Sessions;

/// $live, fed by $unit until they are interrupted.
const std::string kEndlessSession =
    "$headpin emulate --link unit --motion circle >/dev/null &\nunit=$!\nthere $unit unit\n"
    "$headpin live --fastrak unit --look fast --record live.lcmlog --json >live.json &\nlive=$!\n";

TEST_F(LiveFastrak, ASessionThatNobodyTakesPartInHasFailed) {
  const Result alone =
      headpin("live --lcm memq:// --eyes none --duration 0.2 --record empty.lcmlog --json");
  EXPECT_EQ(alone.code, 1);
  EXPECT_THAT(alone.err,
              testing::HasSubstr("headpin live: no sample arrived in 0.2 s from lcm:memq://"));
  EXPECT_EQ(nlohmann::json::parse(alone.out)["exit_code"], 1);
  EXPECT_TRUE(trial("empty.lcmlog").complete);
}

// A message whose status was left at 0 is the commonest mistake of a publisher.
TEST_F(LiveFastrak, ASessionOfBadSamplesSaysSo) {
  ASSERT_EQ(headpin("synthesize -o good.lcmlog").code, 0);
  scene::Trial made = trial("good.lcmlog");
  for (devices::Sample& sample : made.samples) {
    if (auto* tracker = std::get_if<devices::TrackerSample>(&sample)) tracker->status = '\0';
  }
  scene::Recorder recorder((folder_ / "bad.lcmlog").string(), made.header);
  scene::write(recorder, made.samples, {});
  recorder.close();
  const std::string live = "live --eyes none --duration 0.5 --lcm file://";
  EXPECT_THAT(headpin(live + "bad.lcmlog").err,
              testing::HasSubstr(" bad samples, whose status is not a space"));
  const std::string early = headpin(live + "good.lcmlog").err;  // it ends before the throw
  EXPECT_THAT(early, testing::Not(testing::HasSubstr("bad samples")));
  EXPECT_THAT(early, testing::HasSubstr("no skittle fell: the trigger was never pressed"));
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
  const scene::Trial live = trial("live.lcmlog");
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
  scene::Trial other = trial("1.lcmlog");
  scene::Scenario scenario = scene::scenario_of_trial(other.header.scenario, "1.lcmlog");
  scenario.look.samples = 2;
  other.header.scenario = scene::to_toml(scenario);
  scene::Recorder recorder(folder_ / "other.lcmlog", other.header);
  scene::write(recorder, other.samples, {});
  for (const scene::FrameRecord& frame : other.frames) recorder.write(frame);
  recorder.close();
  expect_refusal("frames other.lcmlog --verify", 1,
                 "differs from the recording, first difference in the left");
  expect_refusal("frames " + kDemo + " --verify", 1, "demo.lcmlog: has no recorded frames");
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
  const scene::Trial recorded = trial("live.lcmlog");
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
            "while kill -0 $live && [ $(count live.lcmlog not.started.again) -lt 1 ]; do\n"
            "  child=$(cat /proc/$live/task/*/children) && kill -SEGV $child 2>/dev/null\n"
            "done\n"
            "ticks=$(count live.lcmlog STATE)\n"
            "counted $live live.lcmlog STATE $((ticks + 100))\n"
            "interrupt $live; code=$?\ninterrupt $unit\nexit $code");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("times without a picture and is not started again"));
  const scene::Trial recorded = trial("live.lcmlog");
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

TEST_F(LiveFastrak, TheSamplesOfAPixelAreTheScenariosUnlessTheyAreGiven) {
  take_room_of_demo();
  const auto samples = [&](const std::string& options) {
    EXPECT_EQ(headpin("live --duration 0.3 --force --record look.lcmlog " + options).code, 0);
    const std::string toml = trial("look.lcmlog").header.scenario;
    return scene::scenario_of_trial(toml, "look.lcmlog").look.samples;
  };
  const auto own = scene::scenario_of_trial(scene::read_trial(kDemo).header.scenario, kDemo);
  ASSERT_EQ(own.look.samples, 2);
  EXPECT_EQ(samples(kDemo), 2);
  EXPECT_EQ(samples("--scenario room.toml " + kDemo), 2);
  EXPECT_EQ(samples("--scenario room.toml --samples 1 " + kDemo), 1);
  EXPECT_EQ(samples("--samples 3 " + kDemo), 3);
  EXPECT_EQ(samples("--scenario room.toml --set look.samples=4 " + kDemo), 4);
  std::ofstream(folder_ / "short.toml") << "[ball]\nmass = 5\n";
  EXPECT_EQ(samples("--scenario short.toml " + kDemo), 1) << "it does not say it";
  EXPECT_EQ(samples("--scenario short.toml --set look.samples=4 " + kDemo), 4);
  ASSERT_EQ(shell(fastrak_session(kDemo, "", 20)).code, 0);
  const std::string bare = trial("live.lcmlog").header.scenario;
  EXPECT_EQ(scene::scenario_of_trial(bare, "live.lcmlog").look.samples, 1) << "the paper's room";
}

}  // namespace
}  // namespace headpin
