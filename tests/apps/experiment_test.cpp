// A study as a laboratory meets it: a folder that commands fill.

#include <chrono>
#include <csignal>
#include <map>
#include <set>

#include <unistd.h>

#include "scene/watch/recorded.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class Experiment : public CommandLine {
 protected:
  /// A study of one throw a game, so that sessions are short.
  void plan_short(const std::string& folder, int people) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
    ASSERT_EQ(headpin("experiment plan -o " + folder + " --design short.toml --seed 7 --people " +
                      std::to_string(people))
                  .code,
              0);
  }

  int lines(const std::string& name) const {
    const std::string text = slurp(folder_ / name);
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(Experiment, IsPlannedGrownAndTold) {
  const nlohmann::json made = json("experiment plan -o study --seed 7 --json");
  EXPECT_EQ(made["participants"], 18);
  EXPECT_EQ(lines("study/plan.csv"), 37);  // a line of names, two games each
  const std::string first = slurp(folder_ / "study/plan.csv");
  EXPECT_EQ(json("experiment plan -o study --people 20 --json")["new_participants"], 2);
  EXPECT_THAT(slurp(folder_ / "study/plan.csv"), testing::StartsWith(first));
  EXPECT_EQ(json("experiment plan -o study --replace p003 --json")["new_participants"], 1);
  EXPECT_EQ(json("experiment plan -o study --json")["new_participants"], 0);
  expect_refusal("experiment plan -o study --people 3", 2, "none can be removed");
  expect_refusal("experiment plan -o study --seed 8", 2, "has the seed 7");
  expect_refusal("experiment plan -o study --design elasticity-friction-shape", 2,
                 "which cannot be changed");
  expect_refusal("experiment plan -o OUT --design nothing", 2, "or one of: ");
  EXPECT_THAT(headpin("experiment plan -o study").out,
              HasSubstr("21 participants, 0 of them new, 1 replaced"));
  const nlohmann::json status = json("experiment status study --json");
  ASSERT_EQ(status["participants"].size(), 21u);
  EXPECT_EQ(status["participants"][2]["replaced_by"], "p021");
  EXPECT_THAT(status["next"], HasSubstr("experiment run study --participant p001"));
  EXPECT_THAT(headpin("experiment status study").out, HasSubstr("p003"));
  expect_refusal("experiment status nowhere", 1, "headpin experiment plan -o nowhere");
  // By hand, and wrong.
  std::ofstream(folder_ / "study/plan.csv", std::ios::app)
      << "=cmd,1,000,shape,1,base,red,1,0,x,\n";
  expect_refusal("experiment status study", 1,
                 "study/plan.csv:44: column participant: expected the name");
}

TEST_F(Experiment, APlanThatGrowsKeepsTheColumnsOfOthers) {
  ASSERT_EQ(headpin("experiment plan -o a --seed 7 --people 2").code, 0);
  const std::string before = slurp(folder_ / "a/plan.csv");
  std::string with_notes;
  std::istringstream lines_before(before);
  for (std::string line; std::getline(lines_before, line);) {
    with_notes += line + (with_notes.empty() ? ",note" : ",left-handed") + "\n";
  }
  spit(folder_ / "a/plan.csv", with_notes);
  ASSERT_EQ(headpin("experiment plan -o a --people 3").code, 0);
  EXPECT_THAT(slurp(folder_ / "a/plan.csv"), testing::StartsWith(with_notes));
  ASSERT_EQ(headpin("experiment plan -o a --replace p001").code, 0);
  EXPECT_THAT(slurp(folder_ / "a/plan.csv"), testing::StartsWith(with_notes));
}

// Sessions and answers of somebody whose rows were deleted are no newcomer's.
TEST_F(Experiment, ANewParticipantHasTheDataOfNobodyElse) {
  ASSERT_EQ(headpin("experiment plan -o a --seed 7 --people 2").code, 0);
  fs::create_directories(folder_ / "a/sessions/p003");
  fs::create_directories(folder_ / "a/answers");
  spit(folder_ / "a/sessions/p003/run-01.lcmlog", "");
  spit(folder_ / "a/answers/p004.csv", "participant,item,answer,source\np004,sick,5,asked\n");
  ASSERT_EQ(headpin("experiment plan -o a --people 3").code, 0);
  ASSERT_EQ(headpin("experiment plan -o a --replace p001").code, 0);
  const std::string plan = slurp(folder_ / "a/plan.csv");
  EXPECT_THAT(plan, testing::AllOf(HasSubstr("\np005,"), HasSubstr("\np006,")));
  EXPECT_THAT(plan, testing::Not(testing::AnyOf(HasSubstr("\np003,"), HasSubstr("\np004,"))));
}

// What is no folder of sessions is not one without sessions: the next run would be another's.
TEST_F(Experiment, ASessionsFolderThatCannotBeReadIsAnError) {
  ASSERT_EQ(headpin("experiment plan -o a --seed 7 --people 1").code, 0);
  fs::create_directories(folder_ / "a/sessions");
  std::ofstream(folder_ / "a/sessions/p001") << "a file";
  expect_refusal("experiment status a", 1, "a/sessions/p001");
}

TEST_F(Experiment, APlanThatWasLostIsMadeAgainForTheSessionsThatAreThere) {
  ASSERT_EQ(headpin("experiment plan -o study").code, 0);
  const std::string plan = slurp(folder_ / "study/plan.csv");
  fs::create_directories(folder_ / "study/sessions/p001");
  fs::remove(folder_ / "study/plan.csv");
  ASSERT_EQ(headpin("experiment plan -o study").code, 0);
  EXPECT_EQ(slurp(folder_ / "study/plan.csv"), plan);
}

TEST_F(Experiment, TheSameSeedPlansTheSameBytes) {
  ASSERT_EQ(headpin("experiment plan -o a --seed 7 --people 40").code, 0);
  ASSERT_EQ(headpin("experiment plan -o b --seed 7").code, 0);
  ASSERT_EQ(headpin("experiment plan -o b --people 40").code, 0);
  ASSERT_EQ(headpin("experiment plan -o c --seed 8 --people 40").code, 0);
  EXPECT_EQ(slurp(folder_ / "a/plan.csv"), slurp(folder_ / "b/plan.csv"));
  EXPECT_NE(slurp(folder_ / "a/plan.csv"), slurp(folder_ / "c/plan.csv"));
}

TEST_F(Experiment, ADesignOfOnesOwnIsHeldAgainstScenarioAndQuestionnaire) {
  const std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string own = text;
    own.replace(own.find(from), from.size(), to);
    std::ofstream(folder_ / "own.toml") << own;
  };
  with("levels = [1.0, 0.7]", "levels = [1.5, 0.7]");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "own.toml:13: factor.levels: elasticity must be a number from 0 to 1, found 1.5");
  with("item = 'sick'", "item = 'ill'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1, "published.item must be an item (");
  with("of = 'sick'", "of = 'sick2'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "term.of must be a factor (E, F, S) or an item (presence1, ");
  expect_refusal("experiment plan -o OUT --design own.toml", 1, "found 'sick2'");
  with("is = 'no'", "is = 'perhaps'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "term.is must be an answer of item 'vrbefore' (yes, no or n/a), found 'perhaps'");
  with("counts = {yes = 7,", "counts = {maybe = 7,");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "own.toml:161: a name in published.counts must be an answer of item 'vrbefore'");
  with("questionnaire = 'uno-slater-1997'", "questionnaire = 'nothing'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "own.toml:6: questionnaire: none of the questionnaires is called 'nothing'");
  expect_refusal("experiment power --design own.toml", 1, "own.toml:6: questionnaire: none of");
  with("scenario = 'uno-slater-1997'", "scenario = 'nothing'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "own.toml:5: scenario: no scenario is called 'nothing'");
  with("scenario = 'uno-slater-1997'", "scenario = 'paper-room'");
  expect_refusal("experiment plan -o OUT --design own.toml", 1,
                 "own.toml:5: scenario 'paper-room' has no two versions");
  with("throws = 10", "throws = 3");
  EXPECT_EQ(json("experiment plan -o study --design own.toml --json")["participants"], 18);
}

// What the plan says of order, colour and values is what the trial was played under.
TEST_F(Experiment, VirtualSessionsArePlayedAsPlannedByAnyNumberOfThreads) {
  plan_short("a", 4);
  fs::copy(folder_ / "a", folder_ / "b", fs::copy_options::recursive);
  const nlohmann::json one = json("experiment run a --all --virtual --json");
  ASSERT_EQ(one["sessions"].size(), 4u);
  EXPECT_EQ(one["sessions"][0]["virtual"], true);
  ASSERT_EQ(headpin("experiment run b --all --virtual --jobs 3").code, 0);
  std::map<std::string, std::vector<std::vector<std::string>>> planned;
  std::istringstream plan(slurp(folder_ / "a/plan.csv"));
  for (std::string line; std::getline(plan, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    planned[cells[0]].push_back(cells);
  }
  std::set<std::string> first_colours;
  for (const char* id : {"p001", "p002", "p003", "p004"}) {
    const std::string trial = std::string("/sessions/") + id + "/run-01.lcmlog";
    EXPECT_EQ(slurp(folder_ / ("a" + trial)), slurp(folder_ / ("b" + trial)));
    const nlohmann::json info = json("info --json a" + trial);
    EXPECT_EQ(info["participant"], std::string("virtual ") + id);
    const nlohmann::json again = json("replay --json a" + trial);
    std::vector<std::string> begun;
    for (const auto& event : info["events"]) {
      // Who leaves may brush a button again.
      if (event["kind"] == "version" &&
          std::ranges::find(begun, event["detail"].get<std::string>()) == begun.end()) {
        begun.push_back(event["detail"]);
      }
    }
    ASSERT_EQ(begun.size(), 2u);
    first_colours.insert(begun[0]);
    for (std::size_t game = 0; game < 2; ++game) {
      const auto& row = planned[id][game];
      EXPECT_EQ(begun[game], row[6]);
      const nlohmann::json version = again["versions"][row[6]];
      EXPECT_EQ(version["elasticity"]["ball"].get<double>(), std::stod(row[7]));
      EXPECT_EQ(version["friction"]["lane"].get<double>(), std::stod(row[8]));
      EXPECT_EQ(version["shape"], row[9]);
    }
  }
  EXPECT_EQ(first_colours.size(), 2u) << "no order was another than the rest";
  EXPECT_THAT(json("experiment status a --json")["next"].get<std::string>(),
              testing::Not(HasSubstr("run")));
  expect_refusal("experiment run a --participant p001 --virtual", 1, "has played already");
}

TEST_F(Experiment, StatusNamesTheNextStep) {
  plan_short("'my study'", 1);
  const auto next = [&] {
    const auto name = json("experiment status 'my study' --json")["next"].get<std::string>();
    EXPECT_THAT(headpin("experiment status 'my study'").out, HasSubstr("next: " + name + "\n"));
    return name;
  };
  EXPECT_EQ(next(), "headpin experiment run 'my study' --participant p001 SOURCE");
  ASSERT_EQ(headpin("experiment run 'my study' --all --virtual").code, 0);
  EXPECT_EQ(next(), "headpin experiment ask 'my study' --participant p001 --virtual");
  ASSERT_EQ(headpin("experiment ask 'my study' --all --virtual").code, 0);
  EXPECT_EQ(next(), "headpin experiment score 'my study'");
  ASSERT_EQ(headpin("experiment score 'my study'").code, 0);
  EXPECT_EQ(next(), "headpin experiment analyse 'my study'");
  fs::create_directories(folder_ / "my study/analysis");
  spit(folder_ / "my study/analysis/fit.csv", "as analyse writes it\n");
  EXPECT_EQ(json("experiment status 'my study' --json")["next"], "");
  EXPECT_THAT(headpin("experiment status 'my study'").out, testing::Not(HasSubstr("next:")));
}

// Each plays whom the other one does not. Who waits for one that the other plays says so (75).
TEST_F(Experiment, TwoThatPlayAllShareTheParticipants) {
  plan_short("a", 4);
  const std::string play = "'" HEADPIN_PROGRAM "' experiment run a --all --virtual >/dev/null 2>";
  const std::string command = "cd '" + folder_.string() + "' && { (" + play +
                              "1.txt; echo $? >1) & (" + play + "2.txt; echo $? >2) & wait; }";
  ASSERT_EQ(std::system(command.c_str()), 0);
  for (const std::string one : {"1", "2"}) {
    EXPECT_THAT(slurp(folder_ / one), testing::AnyOf("0\n", "75\n"))
        << slurp(folder_ / (one + ".txt"));
  }
  const nlohmann::json status = json("experiment status a --json");
  for (const nlohmann::json& one : status["participants"]) {
    EXPECT_EQ(one["run"], "run-01");
  }
}

TEST_F(Experiment, ASessionThatWasCutOffStaysAndTheNextIsAnotherRun) {
  plan_short("a", 1);
  ASSERT_EQ(headpin("experiment run a --participant p001 --virtual").code, 0);
  const fs::path run = folder_ / "a/sessions/p001/run-01.lcmlog";
  const std::string whole = slurp(run);
  fs::resize_file(run, fs::file_size(run) / 2);
  const std::string half = slurp(run);
  EXPECT_EQ(json("experiment status a --json")["participants"][0]["run"], nullptr);
  EXPECT_THAT(headpin("experiment status a").out, HasSubstr("cut off"));
  EXPECT_THAT(headpin("experiment run a --all --virtual").err, HasSubstr("is kept: cut off"));
  EXPECT_EQ(slurp(run), half);
  EXPECT_EQ(slurp(folder_ / "a/sessions/p001/run-02.lcmlog"), whole);
  EXPECT_EQ(json("experiment status a --json")["participants"][0]["run"], "run-02");
}

// As a laboratory leaves it that moved the first run away.
TEST_F(Experiment, TheNextRunHasTheNumberBehindTheLast) {
  plan_short("a", 1);
  ASSERT_EQ(headpin("experiment run a --participant p001 --virtual").code, 0);
  const fs::path sessions = folder_ / "a/sessions/p001";
  fs::rename(sessions / "run-01.lcmlog", sessions / "run-02.lcmlog");
  fs::resize_file(sessions / "run-02.lcmlog", fs::file_size(sessions / "run-02.lcmlog") / 2);
  ASSERT_EQ(headpin("experiment run a --participant p001 --virtual").code, 0);
  EXPECT_TRUE(fs::exists(sessions / "run-03.lcmlog"));
  EXPECT_FALSE(fs::exists(sessions / "run-01.lcmlog"));
}

TEST_F(Experiment, ASessionOfAPersonThatWasCutOffIsLeftToThePerson) {
  plan_short("a", 2);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  ASSERT_EQ(headpin("experiment run a --participant p001 --trial t.lcmlog").code, 0);
  const fs::path run = folder_ / "a/sessions/p001/run-01.lcmlog";
  fs::resize_file(run, fs::file_size(run) / 2);
  const nlohmann::json played = json("experiment run a --all --virtual --json");
  ASSERT_EQ(played["sessions"].size(), 1u);
  EXPECT_EQ(played["sessions"][0]["participant"], "p002");
  EXPECT_FALSE(fs::exists(folder_ / "a/sessions/p001/run-02.lcmlog"));
  EXPECT_EQ(json("experiment ask a --all --virtual --json")["participants"], 1);
}

// A form on paper may be typed in before the session is played.
TEST_F(Experiment, AnswersOfAPersonAreNotMixedWithDrawnOnes) {
  plan_short("a", 3);
  std::ofstream(folder_ / "f.csv") << "participant,sick\np002,3\n";
  ASSERT_EQ(headpin("experiment ask a --from f.csv").code, 0);
  const std::string form = slurp(folder_ / "a/answers/p002.csv");
  const Result all = headpin("experiment ask a --all --virtual --json");
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(nlohmann::json::parse(all.out)["participants"], 2);
  EXPECT_THAT(all.err, HasSubstr("1 participant is left out: a person has played or answered\n"));
  EXPECT_EQ(slurp(folder_ / "a/answers/p002.csv"), form);
  expect_refusal("experiment ask a --participant p002 --virtual", 2,
                 "p002 is no virtual participant: a/answers/p002.csv has an answer of a person: "
                 "sick, form");
  // Who has drawn answers alone is virtual, and gets the missing ones.
  EXPECT_EQ(json("experiment ask a --participant p001 --virtual --json")["new_answers"], 0);
}

TEST_F(Experiment, TablesAreOldWhenPlanOrQuestionnaireHaveChanged) {
  plan_short("a", 1);
  ASSERT_EQ(headpin("experiment run a --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment ask a --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score a").code, 0);
  const auto next = [&] { return json("experiment status a --json")["next"]; };
  EXPECT_EQ(next(), "headpin experiment analyse a");
  for (const char* name : {"plan.csv", "questionnaire.toml"}) {
    const fs::path path = folder_ / "a" / name;
    const auto before = fs::last_write_time(path);
    fs::last_write_time(path, fs::file_time_type::clock::now() + std::chrono::hours(1));
    EXPECT_EQ(next(), "headpin experiment score a") << name;
    fs::last_write_time(path, before);
  }
  const std::string says =
      "a/tables/participants.csv: expected the participants of a/plan.csv, "
      "found others (p002 is only in the plan)";
  EXPECT_THAT(headpin("experiment analyse a").err,
              testing::Not(HasSubstr("expected the participants")));
  ASSERT_EQ(headpin("experiment plan -o a --people 2").code, 0);
  EXPECT_THAT(headpin("experiment analyse a").err, HasSubstr(says));
}

TEST_F(Experiment, ARecordingThatHasNotBegunBlocksNothing) {
  ASSERT_EQ(headpin("experiment plan -o a --people 1").code, 0);
  fs::create_directories(folder_ / "a/sessions/p001");
  std::ofstream(folder_ / "a/sessions/p001/run-01.lcmlog") << "";
  std::ofstream(folder_ / "a/sessions/p001/run-02.lcmlog") << slurp(kDemo).substr(0, 1000);
  EXPECT_THAT(headpin("experiment status a").out, HasSubstr("run-02, 0.0 s, cut off"));
  const Result ran = headpin("experiment run a --participant p001 --virtual");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, testing::AllOf(HasSubstr("run-01.lcmlog is kept: cut off"),
                                      HasSubstr("run-02.lcmlog is kept: cut off")));
  EXPECT_TRUE(fs::exists(folder_ / "a/sessions/p001/run-03.lcmlog"));
  EXPECT_EQ(headpin("experiment ask a --participant p001 --virtual").code, 0);
  EXPECT_EQ(headpin("experiment score a").code, 0);
  // What is no recording is an error: something else is amiss.
  std::ofstream(folder_ / "a/sessions/p001/run-02.lcmlog") << std::string(1000, 'x');
  EXPECT_THAT(headpin("experiment status a").err, HasSubstr("run-02.lcmlog: not an LCM event log"));
}

TEST_F(Experiment, ATrialIsPlayedUnderTheParticipantsConditions) {
  plan_short("a", 2);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 -o s.lcmlog").code, 0);
  const nlohmann::json played = json("experiment run a --participant p001 --trial s.lcmlog --json");
  EXPECT_EQ(played["virtual"], true);
  EXPECT_EQ(played["games"].size(), 2u);
  // The same hand under the same conditions, by the command that replays.
  std::string set;
  const nlohmann::json versions = json("replay --json a/sessions/p001/run-01.lcmlog")["versions"];
  for (const auto& [colour, version] : versions.items()) {
    set += " --set version." + colour + ".elasticity=" + version["elasticity"]["ball"].dump();
    set += " --set version." + colour + ".friction=" + version["friction"]["ball"].dump();
    set += " --set version." + colour + ".shape=" + version["shape"].dump();
  }
  EXPECT_EQ(json("replay s.lcmlog --json --set collision.detection=paper" + set)["games"],
            played["games"]);
  // A person's: nobody says that it is virtual.
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  EXPECT_EQ(json("experiment run a --participant p002 --trial t.lcmlog --json")["virtual"], false);
}

// As of a left hand, whose grip is the mirror image of the scenario's.
TEST_F(Experiment, ATrialIsPlayedWithTheGripOfItsOwnHand) {
  plan_short("a", 1);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  const std::string hand = "--set 'hand.grip=[-0.02,-0.03,-0.115]' --set 'hand.spin=[1,2,3]'";
  ASSERT_EQ(headpin("replay t.lcmlog -o left.lcmlog " + hand).code, 0);
  ASSERT_EQ(headpin("experiment run a --participant p001 --trial left.lcmlog").code, 0);
  const std::string run = (folder_ / "a/sessions/p001/run-01.lcmlog").string();
  const scene::Hand played = scene::load_trial(run).scenario.hand;
  EXPECT_EQ(played.grip, Vec3(-0.02, -0.03, -0.115));
  EXPECT_EQ(played.spin, Vec3(1.0, 2.0, 3.0));
}

TEST_F(Experiment, ALiveSessionIsRecordedUnderTheParticipantsName) {
  plan_short("a", 2);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  const Result live = headpin("experiment run a --participant p001 t.lcmlog --duration 0.5 --json");
  EXPECT_EQ(live.code, 0) << live.err;
  EXPECT_THAT(live.err, HasSubstr("button first"));
  const nlohmann::json info = json("info --json a/sessions/p001/run-01.lcmlog");
  EXPECT_EQ(info["participant"], "p001");
  EXPECT_EQ(info["complete"], true);
  EXPECT_THAT(headpin("experiment status a").out, HasSubstr("without both versions"));
  const Result over = headpin("experiment run a --participant p001 --virtual");
  EXPECT_EQ(over.code, 1);
  EXPECT_THAT(over.err, HasSubstr("p001 is left out: a/sessions/p001/run-01.lcmlog is a person's"));
  // Two at once: the second is told so, and another participant's session is free.
  const std::string command =
      "(cd '" + folder_.string() +
      "' && exec '" HEADPIN_PROGRAM "' experiment run a --participant p001 t.lcmlog) 2>'" +
      (folder_ / "live.txt").string() + "' & echo $! >'" + (folder_ / "pid").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const fs::path second = folder_ / "a/sessions/p001/run-02.lcmlog";
  for (int i = 0; i < 600 && !fs::exists(second); ++i) usleep(100'000);
  ASSERT_TRUE(fs::exists(second)) << slurp(folder_ / "live.txt");
  EXPECT_EQ(headpin("experiment run a --participant p001 --virtual").code, 75);
  // Who has begun to play is a person, and is not played by a virtual one.
  const Result rest = headpin("experiment run a --all --virtual");
  EXPECT_EQ(rest.code, 0);
  EXPECT_THAT(rest.out, HasSubstr("p002"));
  EXPECT_THAT(rest.err, HasSubstr("p001 is left out: a/sessions/p001/run-01.lcmlog is a person's"));
  kill(std::stoi(slurp(folder_ / "pid")), SIGINT);
  const auto ended = [&] {
    return json("info --json a/sessions/p001/run-02.lcmlog")["complete"] == true;
  };
  for (int i = 0; i < 600 && !ended(); ++i) usleep(100'000);
  EXPECT_TRUE(ended());
}

TEST_F(Experiment, WhatARunNeedsIsSaid) {
  plan_short("a", 2);
  expect_refusal("experiment run a --participant p001", 2, "expected one of: SOURCE");
  expect_refusal("experiment run a --virtual", 2, "expected --participant NAME, or --all");
  expect_refusal("experiment run nofolder", 1, "nofolder: expected a study, found no design.toml");
  expect_refusal("experiment run a --participant p001 --virtual --trial x.lcmlog", 2,
                 "--trial excludes --virtual; expected one of: SOURCE (as in `headpin live`), "
                 "--trial FILE, --virtual, found two");
  expect_refusal("experiment run a --participant p001 --all --virtual", 2,
                 "--participant excludes --all; expected --participant NAME, or --all with "
                 "--virtual, found two");
  expect_refusal("experiment run a --all --trial x.lcmlog", 2, "--virtual");
  expect_refusal("experiment run a --participant ../x --virtual", 2, "found '../x'");
  expect_refusal("experiment run a --participant 山田 --virtual", 2, "found '山田'");
  ASSERT_EQ(headpin("experiment plan -o a --replace p001").code, 0);
  expect_refusal("experiment run a --participant p001 --virtual", 2,
                 "--participant: p001 was replaced by p003; expected p003 or another name of "
                 "a/plan.csv");
}

// What stands behind its number was taken for a part of a date, and another session counted.
TEST_F(Experiment, ARunThatIsGivenADateOrAPartKeepsItsNumber) {
  plan_short("a", 1);
  ASSERT_EQ(headpin("experiment run a --virtual --participant p001").code, 0);
  const fs::path runs = folder_ / "a/sessions/p001";
  fs::copy_file(runs / "run-01.lcmlog", runs / "run-02.lcmlog");
  fs::rename(runs / "run-01.lcmlog", folder_ / "played.lcmlog");
  const auto counts_beside_second = [&](const std::string& name) {
    fs::copy_file(folder_ / "played.lcmlog", runs / (name + ".lcmlog"));
    const nlohmann::json told = json("experiment status a --json");
    fs::remove(runs / (name + ".lcmlog"));
    return told["participants"][0]["run"];
  };
  for (const std::string name : {"run-01_2026-11-30", "run-01-2", "run-01.1", "run-1-30-11-2026"}) {
    EXPECT_EQ(counts_beside_second(name), name);
  }
  for (const std::string name : {"run-2026-11-30", "run-1999.12", "run-2026_01_02 again"}) {
    EXPECT_EQ(counts_beside_second(name), "run-02") << name;
  }
  fs::remove(runs / "run-02.lcmlog");
  spit(runs / "run-07_2026-11-30.lcmlog", "");
  ASSERT_EQ(headpin("experiment run a --virtual --participant p001").code, 0);
  EXPECT_TRUE(fs::exists(runs / "run-08.lcmlog"));
}

}  // namespace
}  // namespace headpin
