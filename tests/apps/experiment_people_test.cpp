// Who of a study is a person: names that stay inside, answers, and what is not in the plan.

#include <fmt/format.h>

#include "scene/record/events.h"
#include "tests/apps/command_line.h"
#include "tests/apps/rewritten.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class StudyPeople : public CommandLine {
 protected:
  /// A study of one throw a game, and a trial that a person played.
  void plan(int people) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
    ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
    ASSERT_EQ(
        headpin(fmt::format("experiment plan -o study --design short.toml --seed 7 --people {}",
                            people))
            .code,
        0);
  }

  void play(const std::string& who) const {
    ASSERT_EQ(headpin("experiment run study --trial t.lcmlog --participant " + who).code, 0);
  }

  /// Changes the run of a participant.
  void rewrite_run(const std::string& who, const std::function<void(scene::Trial&)>& change) const {
    const fs::path run = folder_ / "study/sessions" / who / "run-01.lcmlog";
    fs::rename(run, folder_ / "was.lcmlog");
    rewrite_trial(folder_ / "was.lcmlog", run, change);
  }
};

TEST_F(StudyPeople, ADeidentifiedExportHasNoNamesOfFilesAndDevices) {
  plan(1);
  fs::create_directory(folder_ / "alice");
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/meshes/hand.obj", folder_ / "alice/alice-hand.obj");
  std::string room = slurp(folder_ / "study/scenario.toml");
  room.replace(room.find("file = ''", room.find("[hand.mesh]")), 9,
               "file = '../alice/alice-hand.obj'");
  spit(folder_ / "study/scenario.toml", "# the room of alice\n" + room);
  play("p001");
  rewrite_run("p001", [](scene::Trial& trial) {
    for (const std::string_view kind : {scene::kind::imported, scene::kind::import_note,
                                        scene::kind::played_with, scene::kind::source_amiss}) {
      scene::Event event;
      event.kind = kind;
      event.value = 1234567.0;  // a day
      event.detail = std::string("alice-smith-1990.csv");
      trial.events.insert(trial.events.begin(), event);
    }
  });
  ASSERT_EQ(headpin("experiment export study --motion-bids named").code, 0);
  ASSERT_EQ(headpin("experiment export study --motion-bids numbered --deidentify").code, 0);
  const std::string motion = "named/sub-p001/motion/sub-p001_task-bowling_run-01_events.";
  EXPECT_THAT(slurp(folder_ / (motion + "tsv")), HasSubstr("alice-smith-1990.csv"));
  EXPECT_THAT(slurp(folder_ / (motion + "json")), HasSubstr("alice-hand.obj"));
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "numbered")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_THAT(slurp(entry.path()), testing::Not(HasSubstr("alice"))) << entry.path();
    EXPECT_THAT(slurp(entry.path()), testing::Not(HasSubstr("Ann"))) << entry.path();
  }
  const std::string events =
      slurp(folder_ / "numbered/sub-001/motion/sub-001_task-bowling_run-01_events.tsv");
  EXPECT_THAT(events, HasSubstr("\timported\t0\t"));
  EXPECT_THAT(events, HasSubstr("\tversion\t"));
  EXPECT_THAT(events, HasSubstr("\tred\t"));
  // The same game comes from it.
  ASSERT_EQ(headpin("import numbered/sub-001/motion/"
                    "sub-001_task-bowling_tracksys-hand_run-01_motion.tsv -o again.lcmlog")
                .code,
            0);
  EXPECT_EQ(json("replay --json again.lcmlog")["game_hash"],
            json("replay --json study/sessions/p001/run-01.lcmlog")["game_hash"]);
}

}  // namespace
}  // namespace headpin
