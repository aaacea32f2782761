// Studies and sweeps that are planned in the folder of what they are made from.

#include <iterator>
#include <set>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

class PlannedInPlace : public CommandLine {
 protected:
  PlannedInPlace() {
    fs::create_directories(folder_ / "mine/.git");
    spit(folder_ / "mine/README.md", "mine\n");
    spit(folder_ / "mine/LICENSE", "mine\n");
  }

  /// Copies a bundled file to the folder.
  void bring(const std::string& asset, const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    fs::copy_file(HEADPIN_SOURCE_DIR "/assets/" + asset, folder_ / name);
  }

  /// Writes the bundled design with these files to mine/NAME.
  void write_design(const std::string& name, const std::string& questionnaire,
                    const std::string& scenario) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    const auto rename = [&](const std::string& key, const std::string& file) {
      const auto at = text.find("\n" + key + " = ") + 1;
      ASSERT_NE(at, 0u) << key;
      text.replace(at, text.find('\n', at) - at, key + " = '" + file + "'");
    };
    rename("questionnaire", questionnaire);
    rename("scenario", scenario);
    spit(folder_ / "mine" / name, text);
  }

  /// Expects that planning from mine/DESIGN is refused because of mine/NAME, and writes nothing.
  void expect_refused_as_own(const std::string& design, const std::string& name) const {
    const auto entries = [&] {
      return std::distance(fs::directory_iterator(folder_ / "mine"), fs::directory_iterator());
    };
    const auto before = entries();
    expect_refusal(
        "experiment plan -o mine --design mine/" + design, 1,
        "mine/" + name + ": the study writes a file of this name: give yours another name\n");
    EXPECT_EQ(entries(), before) << design;
  }

  /// Expects a refusal that writes nothing while a file lies there that is not named.
  void expect_refused_with_others(const std::string& command, const std::string& written) const {
    spit(folder_ / "mine/main.cpp", "int main() {}\n");
    expect_refusal(command, 1,
                   "mine: holds main.cpp, which headpin did not write there; expected a new or "
                   "empty folder\n");
    EXPECT_FALSE(fs::exists(folder_ / "mine" / written));
    fs::remove(folder_ / "mine/main.cpp");
  }
};

// The researcher's own design stands in the study's folder, with the questionnaire beside it.
TEST_F(PlannedInPlace, AStudyWithItsDesignQuestionnaireAndScenario) {
  write_design("my-design.toml", "./asked.toml", "./played/lane.toml");
  bring("questionnaires/uno-slater-1997.toml", "mine/asked.toml");
  bring("scenarios/uno-slater-1997.toml", "mine/played/lane.toml");
  const std::string command = "experiment plan -o mine --design mine/my-design.toml";
  expect_refused_with_others(command, "design.toml");
  const Result planned = headpin(command);
  EXPECT_EQ(planned.code, 0) << planned.err;
  EXPECT_TRUE(fs::exists(folder_ / "mine/plan.csv"));
}

TEST_F(PlannedInPlace, ASweepWithItsTrials) {
  bring("trials/demo.lcmlog", "mine/one.lcmlog");
  fs::create_directories(folder_ / "mine/recorded");
  fs::copy_file(HEADPIN_SOURCE_DIR "/tests/scene/trials/rules-13.lcmlog",
                folder_ / "mine/recorded/two.lcmlog");
  spit(folder_ / "mine/my-sweep.toml",
       "trials = ['one.lcmlog', 'recorded/two.lcmlog']\n[grid]\nelasticity = [0.5, 0.7]\n");
  const std::string command = "sweep plan mine/my-sweep.toml -o mine";
  expect_refused_with_others(command, "sweep.toml");
  const Result planned = headpin(command);
  EXPECT_EQ(planned.code, 0) << planned.err;
  EXPECT_TRUE(fs::exists(folder_ / "mine/rows.csv"));
}

// It was taken for a study's own design, and plan.csv was left in a folder that is no study.
TEST_F(PlannedInPlace, ADesignWithTheNameOfTheStudysIsRefused) {
  write_design("design.toml", "./asked.toml", "./lane.toml");
  bring("questionnaires/uno-slater-1997.toml", "mine/asked.toml");
  bring("scenarios/uno-slater-1997.toml", "mine/lane.toml");
  expect_refused_as_own("design.toml", "design.toml");
  fs::rename(folder_ / "mine/design.toml", folder_ / "mine/my-design.toml");
  const Result planned = headpin("experiment plan -o mine --design mine/my-design.toml");
  EXPECT_EQ(planned.code, 0) << planned.err;
  const Result again = headpin("experiment plan -o mine");
  EXPECT_EQ(again.code, 0) << again.err;
  const Result named = headpin("experiment plan -o mine --design mine/design.toml");
  EXPECT_EQ(named.code, 0) << named.err;
}

// It was refused after questionnaire.toml was written.
TEST_F(PlannedInPlace, AScenarioOrDesignWithTheNameOfAnotherFileOfTheStudyIsRefused) {
  bring("questionnaires/uno-slater-1997.toml", "mine/asked.toml");
  bring("scenarios/uno-slater-1997.toml", "mine/scenario.toml");
  write_design("my-design.toml", "./asked.toml", "./scenario.toml");
  expect_refused_as_own("my-design.toml", "scenario.toml");
  fs::rename(folder_ / "mine/scenario.toml", folder_ / "mine/lane.toml");
  write_design("questionnaire.toml", "./asked.toml", "./lane.toml");
  fs::remove(folder_ / "mine/my-design.toml");
  expect_refused_as_own("questionnaire.toml", "questionnaire.toml");
}

// plan.csv was left beside a design whose questionnaire lacks, and a whole study where nobody can be replaced.
TEST_F(PlannedInPlace, AStudyThatCannotBePlannedIsNotBegun) {
  write_design("design.toml", "./asked.toml", "./lane.toml");
  headpin("--version");  // its output is in files of the folder
  const auto expect_none = [&](const std::string& options, int code, const std::string& says) {
    const auto entries = [&] {
      std::set<std::string> names;
      for (const auto& entry : fs::recursive_directory_iterator(folder_))
        names.insert(entry.path().string());
      return names;
    };
    const std::set<std::string> before = entries();
    expect_refusal("experiment plan -o " + options, code, says);
    EXPECT_EQ(entries(), before) << options;
  };
  expect_none("mine", 1, "mine/questionnaire.toml: cannot open");
  bring("questionnaires/uno-slater-1997.toml", "mine/questionnaire.toml");
  expect_none("mine --replace p001", 2, "mine/plan.csv: no participant 'p001' in the plan");
  expect_none("mine --seed 8", 2, "--seed: mine/design.toml has the seed");
  expect_none("new --replace p001", 2, "new/plan.csv: no participant 'p001' in the plan");
  bring("trials/demo.lcmlog", "lost/sessions/p030/run-01.lcmlog");
  expect_none("lost --people 2", 1,
              "p030 has sessions or answers but would not be in a new plan of 2");
}

// Any link to a given file was refused as a file of others.
TEST_F(PlannedInPlace, LinksToADesignAndItsTrials) {
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml", folder_ / "shared.toml");
  fs::create_symlink("../shared.toml", folder_ / "mine/my-design.toml");
  const Result planned = headpin("experiment plan -o mine --design shared.toml");
  EXPECT_EQ(planned.code, 0) << planned.err;
  bring("trials/demo.lcmlog", "one.lcmlog");
  spit(folder_ / "sweep.toml", "trials = ['one.lcmlog']\n[grid]\nelasticity = [0.5, 0.7]\n");
  fs::create_directory(folder_ / "swept");
  fs::create_symlink("../sweep.toml", folder_ / "swept/sweep.toml");
  fs::create_symlink("../one.lcmlog", folder_ / "swept/one.lcmlog");
  const Result swept = headpin("sweep plan sweep.toml -o swept");
  EXPECT_EQ(swept.code, 0) << swept.err;
  EXPECT_TRUE(fs::is_symlink(folder_ / "swept/sweep.toml"));
}

// It was taken for a study that has lost its questionnaire, or refused for its name.
TEST_F(PlannedInPlace, ADesignThatIsALinkIsTheStudysAndStaysOne) {
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml", folder_ / "shared.toml");
  const std::string shared = slurp(folder_ / "shared.toml");
  for (const std::string named : {"", " --design mine/design.toml", " --design shared.toml"}) {
    fs::create_symlink("../shared.toml", folder_ / "mine/design.toml");
    expect_refusal("experiment plan -o mine --seed 7" + named, 2,
                   "mine/design.toml is a link, and no seed is written into the file that it leads "
                   "to; write it there");
    expect_refusal("experiment plan -o mine --design elasticity-friction-shape", 1,
                   "mine/design.toml: exists already, as a link to another design");
    EXPECT_FALSE(fs::exists(folder_ / "mine/questionnaire.toml"));
    const Result planned = headpin("experiment plan -o mine --seed 1" + named);
    EXPECT_EQ(planned.code, 0) << named << planned.err;
    EXPECT_TRUE(fs::exists(folder_ / "mine/questionnaire.toml"));
    fs::remove(folder_ / "mine/plan.csv");  // as if it had been killed before
    const Result again = headpin("experiment plan -o mine" + named);
    EXPECT_EQ(again.code, 0) << named << again.err;
    EXPECT_TRUE(fs::is_symlink(folder_ / "mine/design.toml"));
    EXPECT_EQ(slurp(folder_ / "shared.toml"), shared);
    for (const char* name : {"design", "questionnaire", "scenario"}) {
      fs::remove(folder_ / "mine" / (std::string(name) + ".toml"));
    }
    fs::remove(folder_ / "mine/plan.csv");
  }
}

// plan.csv was written, and the first session told that there is no scenario.
TEST_F(PlannedInPlace, AStudyThatCannotBePlayedGetsNoPlan) {
  write_design("design.toml", "./asked.toml", "./lane.toml");
  bring("questionnaires/uno-slater-1997.toml", "mine/questionnaire.toml");
  const std::string command = "experiment plan -o mine";
  const auto expect_no_plan = [&](const std::string& says) {
    expect_refusal(command, 1, says);
    EXPECT_FALSE(fs::exists(folder_ / "mine/plan.csv")) << says;
  };
  expect_no_plan("mine/scenario.toml: cannot be read");
  spit(folder_ / "mine/scenario.toml", "x = [");
  expect_no_plan("mine/scenario.toml:1: not TOML");
  fs::remove(folder_ / "mine/scenario.toml");
  bring("scenarios/paper-room.toml", "mine/scenario.toml");
  expect_no_plan("scenario 'mine/scenario.toml' has no two versions");
  fs::remove(folder_ / "mine/scenario.toml");
  bring("scenarios/uno-slater-1997.toml", "mine/scenario.toml");
  const Result planned = headpin(command);
  EXPECT_EQ(planned.code, 0) << planned.err;
  const std::string plan = slurp(folder_ / "mine/plan.csv");
  fs::remove(folder_ / "mine/scenario.toml");
  EXPECT_EQ(headpin(command).code, 0);  // adds nobody
  expect_refusal(command + " --people 36", 1, "mine/scenario.toml: cannot be read");
  EXPECT_EQ(slurp(folder_ / "mine/plan.csv"), plan);
}

// Studies whose designs are links to one file locked each other out.
TEST_F(PlannedInPlace, StudiesThatShareADesignAreLockedApart) {
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml", folder_ / "shared.toml");
  for (const char* name : {"mine", "yours"}) {
    fs::create_directory(folder_ / name);
    fs::create_symlink("../shared.toml", folder_ / name / "design.toml");
    ASSERT_EQ(headpin(std::string("experiment plan --people 1 -o ") + name).code, 0);
  }
  // As a process would hold them that plans the other study.
  spit(folder_ / "plan.sh",
       "for name in mine yours; do\n"
       "  '" HEADPIN_PROGRAM
       "' experiment plan -o $name --people 2 2>>err.txt; echo $? >>code.txt\n"
       "done\n");
  ASSERT_EQ(std::system(("cd '" + folder_.string() +
                         "' && flock -n mine flock -n shared.toml sh plan.sh >out.txt")
                            .c_str()),
            0);
  EXPECT_EQ(slurp(folder_ / "code.txt"), "75\n0\n") << slurp(folder_ / "err.txt");
  EXPECT_THAT(slurp(folder_ / "err.txt"),
              testing::StartsWith("headpin experiment plan: mine: another headpin is planning this "
                                  "study\n"));
  EXPECT_EQ(headpin("experiment plan -o mine --people 2").code, 0);
}

// It was begun again without a word, with the scenario of today.
TEST_F(PlannedInPlace, AStudyWithALinkToItsDesignIsNotBegunAgainBesideSessionsOrAnswers) {
  bring("designs/uno-slater-1997.toml", "shared.toml");
  fs::create_symlink("../shared.toml", folder_ / "mine/design.toml");
  const std::string command = "experiment plan -o mine";
  ASSERT_EQ(headpin(command).code, 0);
  const auto expect_not_begun = [&](const std::string& data) {
    fs::remove(folder_ / "mine/plan.csv");
    for (const std::string lost : {"scenario", "questionnaire"}) {
      const fs::path file = folder_ / "mine" / (lost + ".toml");
      fs::rename(file, folder_ / "kept.toml");
      expect_refusal(command, 1, "mine/" + lost + ".toml: cannot ");
      EXPECT_FALSE(fs::exists(file)) << data;
      EXPECT_FALSE(fs::exists(folder_ / "mine/plan.csv")) << data;
      fs::rename(folder_ / "kept.toml", file);
    }
    const Result again = headpin(command);
    EXPECT_EQ(again.code, 0) << data << again.err;
    fs::remove_all(folder_ / "mine" / data);
  };
  bring("trials/demo.lcmlog", "mine/sessions/p001/run-01.lcmlog");
  expect_not_begun("sessions");
  fs::create_directories(folder_ / "mine/answers");
  spit(folder_ / "mine/answers/p001.csv", "item,answer\npresence1,6\n");
  expect_not_begun("answers");
}

// Studies whose questionnaires are links to one file locked each other out.
TEST_F(PlannedInPlace, StudiesThatShareAQuestionnaireAreAnalysedApart) {
  ASSERT_EQ(headpin("experiment plan --people 1 -o study").code, 0);
  fs::rename(folder_ / "study/questionnaire.toml", folder_ / "shared.toml");
  fs::create_symlink("../shared.toml", folder_ / "study/questionnaire.toml");
  fs::create_directory(folder_ / "study/tables");
  spit(folder_ / "study/tables/participants.csv", "participant,counts,virtual\np001,yes,yes\n");
  // As a process would hold it that analyses this study, or another one.
  const auto analysed_beside = [&](const std::string& locked) {
    const std::string command = "cd '" + folder_.string() + "' && flock -n " + locked +
                                " '" HEADPIN_PROGRAM
                                "' experiment analyse study >out.txt 2>err.txt";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  EXPECT_EQ(analysed_beside("study/tables"), 75);
  EXPECT_THAT(slurp(folder_ / "err.txt"),
              testing::HasSubstr("study/tables: another headpin is analysing this study\n"));
  EXPECT_EQ(analysed_beside("shared.toml"), 1);  // no R, or a table that its script refuses
  EXPECT_THAT(slurp(folder_ / "err.txt"), testing::Not(testing::HasSubstr("another headpin")));
}

}  // namespace
}  // namespace headpin
