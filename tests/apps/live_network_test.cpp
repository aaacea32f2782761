// A session in real time in a network of its own: fed by LCM's own player, kept by its logger.

#include <algorithm>
#include <chrono>

#include "devices/log/event_log.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "tests/apps/live_sessions.h"

namespace headpin {
namespace {

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

/// Whether each sample around the release was used at the first tick after it was measured. Where
/// other programs keep the processor busy, some come later; the hand's velocity is then another.
bool came_in_time(const scene::Trial& trial) {
  constexpr Time kTick{4167}, kAround{300'000};
  const auto release = std::ranges::find(trial.events, scene::kind::release, &scene::Event::kind);
  return release != trial.events.end() &&
         std::ranges::all_of(trial.samples, [&](const devices::Sample& sample) {
           const Time measured = devices::device_time(sample);
           if (std::chrono::abs(measured - release->time) > kAround) return true;
           const Time used = std::visit([](const auto& s) { return s.session_time; }, sample);
           return used - measured <= kTick;
         });
}

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
  // At the same places between the ticks, whenever it was sent.
  if (live["samples"] == 843 && came_in_time(trial("live.lcmlog"))) {
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

TEST_F(Live, AnInterruptEndsItCleanlyAndAKillLosesNothingWritten) {
  const Result ended = alone(
      "$headpin live --lcm '' --record ended.lcmlog --eyes none 2>/dev/null &\nwritten "
      "ended.lcmlog 200000\n"
      "kill -INT $!\nwait $!");
  EXPECT_EQ(ended.code, 1) << ended.err;  // whole, but nobody took part
  EXPECT_TRUE(scene::read_trial((folder_ / "ended.lcmlog").string()).complete);

  alone(
      "$headpin live --lcm '' --record killed.lcmlog --eyes none 2>/dev/null &\nwritten "
      "killed.lcmlog 200000\n"
      "kill -KILL $!\nwait $!");
  const scene::Trial killed = scene::read_trial((folder_ / "killed.lcmlog").string());
  EXPECT_FALSE(killed.complete);
  EXPECT_GT(killed.states.size(), 50u);  // some 2000 bytes each
  EXPECT_EQ(killed.states.back().tick, static_cast<std::int64_t>(killed.states.size()));
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
  for (const scene::Event& event : trial("live.lcmlog").events) {
    if (event.kind == "source_amiss") said += event.detail.text();
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
    for (const scene::Event& event : trial(log).events) {
      if (event.kind == scene::kDrawnByEvent) all.push_back(event.detail.text());
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
  const double wanted =
      json("replay " + kDemo + " -o demo.lcmlog --json")["release_speed_mps"].get<double>();
  nlohmann::json live;
  std::string told_of_it;
  // A busy machine may leave the line unread for so long that it loses the throw's samples.
  for (int i = 0; i < 5 && !live["release_speed_mps"].is_number(); ++i) {
    fs::remove(folder_ / "live.lcmlog");
    const Result result = alone(
        "$headpin emulate " + kDemo +
        " --link unit --faults noise=0 --mouse '' & unit=$!\n"
        "there $unit unit\n"
        "$headpin live fastrak:unit lcm: --scenario room.toml --record live.lcmlog --eyes none & "
        "live=$!\ncounted $live live.lcmlog TRACKER 700\n"
        "interrupt $live; code=$?; interrupt $unit; exit $code");
    ASSERT_EQ(result.code, 0) << result.err;
    told_of_it = result.err;
    live = json("replay live.lcmlog --verify --json");
  }
  ASSERT_TRUE(live["release_speed_mps"].is_number()) << told_of_it << live.dump(1);
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
