// What a trial tells besides its samples, and what it lacks: kept and said by the commands that make a trial of it.

#include <algorithm>
#include <functional>
#include <string_view>
#include <vector>

#include "devices/log/event_log.h"
#include "tests/apps/rewritten.h"
#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A game in a headset: what it was played with, a pause after a second, and what add_told_live() adds.
void add_told_by_a_browser(scene::Trial& trial) {
  add_told_live(trial);
  scene::Event paused, played;
  paused.time = Time{1'000'000};
  paused.tick = 240;
  paused.kind = scene::kind::paused;
  paused.value = 3.5;
  played.tick = 0;
  played.kind = scene::kind::played_with;
  played.detail = std::string(
      R"({"device":"generic-webxr","views":[
      {"eye":"left","offset":[-0.031,0,0],"left":-52,"right":42,"down":-50,"up":44,"width":1680,"height":1760},
      {"eye":"right","offset":[0.033,0,0],"left":-44,"right":54,"down":-50,"up":44,"width":1680,"height":1760}]})");
  for (const scene::Event& event : {paused, played}) {
    const auto later = std::ranges::upper_bound(trial.events, event.time, {}, &scene::Event::time);
    trial.events.insert(later, event);
  }
}

/// The kinds and ticks of the events that no simulation makes.
std::vector<std::string> told_in(const scene::Trial& trial) {
  std::vector<std::string> told;
  for (const scene::Event& event : trial.events) {
    for (const std::string_view kind :
         {scene::kind::drawn_by, scene::kind::played_with, scene::kind::paused,
          scene::kind::source_amiss, scene::kind::imported}) {
      if (event.kind == kind) told.push_back(event.kind + " " + std::to_string(event.tick));
    }
  }
  return told;
}

TEST_F(TrialCommands, WhatASessionToldIsInItsReplay) {
  rewrite_trial(kDemo, folder_ / "live.lcmlog", add_told_by_a_browser);
  ASSERT_EQ(headpin("replay live.lcmlog -o again.lcmlog").code, 0);
  // What drew it is about pictures, which a replay does not have.
  EXPECT_THAT(told_in(trial("again.lcmlog")),
              ElementsAre("played_with 0", "paused 240", "source_amiss 600"));
  const Result worn = headpin("replay again.lcmlog --set hmd.profile=recorded");
  EXPECT_EQ(worn.code, 0) << worn.err;
  EXPECT_EQ(headpin("replay again.lcmlog --verify").code, 0);
  ASSERT_EQ(headpin("replay live.lcmlog -o slow.lcmlog --set rates.physics_hz=120").code, 0);
  EXPECT_THAT(told_in(trial("slow.lcmlog")),
              ElementsAre("played_with 0", "paused 120", "source_amiss 300"));
}

TEST_F(TrialCommands, WhatASessionToldIsInTheExperimentThatPlaysIt) {
  ASSERT_EQ(headpin("experiment plan -o study --people 2 --seed 1").code, 0);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o s.lcmlog").code, 0);
  rewrite_trial(folder_ / "s.lcmlog", folder_ / "live.lcmlog", [](scene::Trial& trial) {
    add_told_by_a_browser(trial);
    scene::Event imported;
    imported.kind = scene::kind::imported;
    trial.events.insert(trial.events.begin(), imported);
  });
  const Result run = headpin("experiment run study --participant p001 --trial live.lcmlog");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(told_in(trial("study/sessions/p001/run-01.lcmlog")),
              ElementsAre("imported -1", "played_with 0", "paused 240", "source_amiss 600"));
}

TEST_F(TrialCommands, AnIncompleteTrialIsNotMadeComplete) {
  const std::string demo = slurp(kDemo);
  spit(folder_ / "cut.lcmlog", demo.substr(0, demo.size() / 2));
  const auto sent = [&](const std::string& name) {
    EXPECT_EQ(
        headpin("stream '" + name + "' --lcm 'file://out.lcmlog?mode=w' --speed 0 --force").code,
        0);
    return json("info out.lcmlog --json")["complete"];
  };
  EXPECT_EQ(sent(kDemo), true);
  EXPECT_EQ(sent("cut.lcmlog"), false);

  const auto incomplete = [&](const std::string& from, const std::string& to) {
    EXPECT_EQ(headpin("replay '" + from + "' -o " + to).code, 0);
    const scene::Trial made = trial(to);
    EXPECT_TRUE(made.complete);
    return std::ranges::count(made.events, scene::kind::incomplete, &scene::Event::kind);
  };
  EXPECT_EQ(incomplete(kDemo, "whole.lcmlog"), 0);
  EXPECT_EQ(incomplete("cut.lcmlog", "made.lcmlog"), 1);
  EXPECT_EQ(incomplete("made.lcmlog", "again.lcmlog"), 1);
  EXPECT_THAT(headpin("info again.lcmlog").out, HasSubstr("is incomplete: it ends at 3."));
}

TEST_F(TrialCommands, ASecondTrialInAFileIsNotIgnoredWithoutAWord) {
  ASSERT_EQ(headpin("synthesize -o other.lcmlog --seed 7").code, 0);
  spit(folder_ / "both.lcmlog", slurp(kDemo) + slurp(folder_ / "other.lcmlog"));
  const Result both = headpin("replay both.lcmlog");
  EXPECT_EQ(both.code, 0);
  EXPECT_EQ(both.err,
            "headpin replay: both.lcmlog: the file has another trial after it, which is not read; "
            "see `headpin info`\n");
  EXPECT_THAT(headpin("info both.lcmlog").out, HasSubstr("1 more trial in the same file"));
  EXPECT_EQ(headpin("replay other.lcmlog").err, "");
}

TEST_F(TrialCommands, AMessageOfACompleteTrialIsNotPassedOverWithoutAWord) {
  devices::FileWindow file(kDemo);
  devices::LogReader reader(file);
  std::vector<std::uint8_t> wrong;
  for (int samples = 0; const auto event = reader.next();) {
    std::vector<std::uint8_t> data(event->data.begin(), event->data.end());
    if (event->channel == devices::kTrackerChannel && ++samples == 100) data[8 + 4] ^= 0x10;
    devices::append({event->number, event->time, event->channel, data}, wrong);
  }
  spit(folder_ / "wrong.lcmlog", {wrong.begin(), wrong.end()});
  EXPECT_EQ(json("info wrong.lcmlog --json")["complete"], true);
  const Result replayed = headpin("replay wrong.lcmlog");
  EXPECT_EQ(replayed.code, 0);
  EXPECT_EQ(replayed.err,
            "headpin replay: wrong.lcmlog: is complete, but 1 message in it is wrong and not used; "
            "see `headpin info`\n");
}

}  // namespace
}  // namespace headpin
