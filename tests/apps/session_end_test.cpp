// Where a session ended, and whether it was complete, comes back from tables and XDF.

#include "tests/apps/rewritten.h"
#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class SessionEnd : public TrialCommands {
 protected:
  /// The bundled throw as a live session whose trackers stop half a second after the release, before the ball
  /// meets a skittle: only its states and its last events tell that it went on until 7 s.
  void make_live() const {
    rewrite_trial(kDemo, folder_ / "short.lcmlog", [](scene::Trial& trial) {
      std::erase_if(trial.samples, [](const devices::Sample& sample) {
        return devices::available(sample) > Time{4'500'000};
      });
      scene::Event end;
      end.time = Time{7'000'000};
      end.kind = scene::kind::session_end;
      trial.events.push_back(end);
    });
    ASSERT_EQ(headpin("replay short.lcmlog -o played.lcmlog").code, 0);
    rewrite_trial(folder_ / "played.lcmlog", folder_ / "live.lcmlog", [](scene::Trial& trial) {
      std::erase_if(trial.events, [](const scene::Event& event) {
        return event.kind == scene::kind::session_end;
      });
    });
  }

  /// Changes what trial.json says of a key.
  void say_in_header(const std::string& key, const nlohmann::json& value) const {
    const fs::path path = folder_ / "tables/trial.json";
    nlohmann::json header = nlohmann::json::parse(slurp(path));
    header[key] = value;
    std::ofstream(path) << header.dump();
  }
};

TEST_F(SessionEnd, ComesBackWithTheSkittlesThatFellAfterTheLastSample) {
  make_live();
  const nlohmann::json live = json("replay live.lcmlog --json");
  ASSERT_GT(live["skittles_down"], 0);
  ASSERT_EQ(live["simulated_s"], 7.0);
  ASSERT_EQ(headpin("export live.lcmlog -o tables").code, 0);
  ASSERT_EQ(headpin("export live.lcmlog --xdf live.xdf").code, 0);
  for (const std::string from : {"tables", "live.xdf"}) {
    ASSERT_EQ(headpin("import --force " + from + " -o back.lcmlog").code, 0);
    EXPECT_EQ(json("replay back.lcmlog --json")["game_hash"], live["game_hash"]) << from;
    // And once more, with one event that tells it.
    ASSERT_EQ(headpin("export --force back.lcmlog -o twice").code, 0);
    ASSERT_EQ(headpin("import --force twice -o back.lcmlog").code, 0);
    EXPECT_EQ(json("replay back.lcmlog --json")["game_hash"], live["game_hash"]) << from;
    const auto events = trial("back.lcmlog").events;
    EXPECT_EQ(std::ranges::count(events, scene::kind::session_end, &scene::Event::kind), 1);
  }
}

// Another rate of ticks in scenario.toml: the same time.
TEST_F(SessionEnd, IsATimeAtAnyRate) {
  make_live();
  ASSERT_EQ(headpin("export live.lcmlog -o tables").code, 0);
  std::string scenario = slurp(folder_ / "tables/scenario.toml");
  const std::size_t at = scenario.find("physics_hz = 240");
  ASSERT_NE(at, std::string::npos);
  scenario.replace(at, 16, "physics_hz = 480");
  std::ofstream(folder_ / "tables/scenario.toml") << scenario;
  ASSERT_EQ(headpin("import tables -o back.lcmlog").code, 0);
  EXPECT_EQ(json("replay back.lcmlog --json")["simulated_s"], 7.0);
}

// Time without samples is limited wherever it lies: else a number in a file would make an endless replay.
TEST_F(SessionEnd, LongAfterTheLastSampleIsALongGap) {
  ASSERT_EQ(headpin("export " + kDemo + " -o tables").code, 0);
  say_in_header("end_s", 100'000);
  ASSERT_EQ(headpin("import tables -o back.lcmlog").code, 0);
  expect_refusal("replay back.lcmlog -o OUT.lcmlog", 1, "no sample for 99992");
  say_in_header("end_s", 1e300);
  expect_refusal("import tables -o OUT.lcmlog", 1, "tables/trial.json: end_s: expected seconds");
  say_in_header("end_s", 1);  // before the last sample
  ASSERT_EQ(headpin("import --force tables -o back.lcmlog").code, 0);
  EXPECT_EQ(json("replay back.lcmlog --json")["game_hash"],
            json("replay " + kDemo + " --json")["game_hash"]);
}

TEST_F(SessionEnd, LongAfterTheLastSampleIsNotedWithTheOptionThatReplaysIt) {
  ASSERT_EQ(headpin("export " + kDemo + " -o tables").code, 0);
  say_in_header("end_s", 100);
  const Result made = headpin("import tables -o back.lcmlog");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("s after its last sample: --longest-gap "));
  expect_refusal("replay back.lcmlog -o OUT.lcmlog", 1, "s to the end of the session; expected");
  const std::string option = "--longest-gap ";
  const std::string offered = made.err.substr(made.err.find(option) + option.size(), 2);
  EXPECT_EQ(json("replay back.lcmlog --json --longest-gap " + offered)["simulated_s"], 100.0);
}

TEST_F(SessionEnd, ThatIsMissingIsNoted) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o game.lcmlog").code, 0);
  const std::string whole = slurp(folder_ / "game.lcmlog");
  std::ofstream(folder_ / "cut.lcmlog", std::ios::binary) << whole.substr(0, whole.size() * 3 / 5);
  ASSERT_EQ(headpin("export cut.lcmlog -o tables").code, 0);
  ASSERT_EQ(headpin("export cut.lcmlog --xdf cut.xdf").code, 0);
  for (const std::string from : {"tables", "cut.xdf"}) {
    const Result made = headpin("import --force " + from + " -o back.lcmlog");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.err, HasSubstr("the trial was not complete when it was exported")) << from;
    EXPECT_THAT(made.out, testing::Not(HasSubstr("a whole session"))) << from;
    const auto events = trial("back.lcmlog").events;
    const auto note = std::ranges::find(events, scene::kind::import_note, &scene::Event::kind);
    ASSERT_NE(note, events.end()) << from;
    EXPECT_THAT(note->detail.text(), HasSubstr("not complete")) << from;
  }
}

}  // namespace
}  // namespace headpin
