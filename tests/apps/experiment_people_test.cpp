// Who of a study is a person: names that stay inside, answers, and what is not in the plan.

#include <chrono>
#include <regex>

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

  /// Takes a form of each of them.
  void answer(const std::vector<std::string>& names) const {
    std::string forms =
        "participant,presence1,presence2,presence3,presence4,presence5,presence6,"
        "sick,noticed,vrbefore,sex,occupation\n";
    for (const std::string& name : names) {
      forms += name + ",6,7,5,1,6,4,2,yes,no,female,student\n";
    }
    spit(folder_ / "forms.csv", forms);
    ASSERT_EQ(headpin("experiment ask study --from forms.csv").code, 0);
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

// Answers of everybody may be drawn to try a study out, and somebody plays then.
TEST_F(StudyPeople, DrawnAnswersOfAPersonAreSetAsideForTheRealOnes) {
  plan(3);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  const std::string drawn = slurp(folder_ / "study/answers/p001.csv");
  play("p001");
  play("p002");
  const nlohmann::json scored = json("experiment score study --json");
  EXPECT_EQ(scored["counted"], 1);
  EXPECT_EQ(scored["of_virtual"], "yes");
  EXPECT_EQ(scored["not_counted"][0]["why_not"], "a person's session with drawn answers");
  EXPECT_THAT(slurp(folder_ / "study/tables/participants.csv"), HasSubstr("\np001,no,no,"));
  const nlohmann::json status = json("experiment status study --json");
  EXPECT_EQ(status["participants"][0]["answers"], 0);
  EXPECT_EQ(status["participants"][2]["answers"], 11);
  EXPECT_EQ(status["next"], "headpin experiment ask study --participant p001");
  EXPECT_THAT(headpin("experiment status study").out,
              HasSubstr(", a person's, with drawn answers"));
  spit(folder_ / "f.csv",
       "participant,presence1,presence2,presence3,presence4,presence5,presence6,"
       "sick,noticed,vrbefore,sex,occupation\np001,6,7,5,1,6,4,2,yes,no,female,student\n");
  const Result form = headpin("experiment ask study --from f.csv --json");
  ASSERT_EQ(form.code, 0) << form.err;
  EXPECT_EQ(nlohmann::json::parse(form.out)["new_answers"], 11);
  EXPECT_THAT(
      form.err,
      HasSubstr(
          "a person answers for p001; 11 drawn answers are kept in study/answers/p001.drawn"));
  EXPECT_EQ(slurp(folder_ / "study/answers/p001.drawn"), drawn);
  EXPECT_THAT(slurp(folder_ / "study/answers/p001.csv"), testing::Not(HasSubstr("drawn")));
  const Result asked = headpin("experiment ask study --participant p002");  // goes away at once
  EXPECT_EQ(asked.code, 1);
  EXPECT_THAT(asked.err, HasSubstr("11 drawn answers are kept in study/answers/p002.drawn"));
  EXPECT_EQ(slurp(folder_ / "study/answers/p002.csv"), "participant,item,answer,source\n");
  EXPECT_EQ(json("experiment score study --only people --json")["counted"], 1);
  EXPECT_THAT(slurp(folder_ / "study/tables/participants.csv"), HasSubstr("\np001,no,yes,"));
}

TEST_F(StudyPeople, ATornLastAnswerStopsNoCommand) {
  plan(1);
  fs::create_directories(folder_ / "study/answers");
  const fs::path answers = folder_ / "study/answers/p001.csv";
  const std::string whole = "participant,item,answer,source\np001,presence1,6,asked\n";
  spit(answers, whole + "p001,sick,5,as");
  for (const char* command : {"status study", "score study"}) {
    const Result read = headpin(std::string("experiment ") + command);
    EXPECT_EQ(read.code, 0) << read.err;
    EXPECT_THAT(read.err, HasSubstr("as a crash leaves it; left out: p001,sick,5,as\n"));
  }
  EXPECT_EQ(slurp(answers), whole + "p001,sick,5,as");
  EXPECT_EQ(json("experiment status study --json")["participants"][0]["answers"], 1);
  spit(folder_ / "f.csv", "participant,item,answer\np001,presence2,3\n");
  EXPECT_EQ(headpin("experiment ask study --from f.csv").code, 0);
  EXPECT_EQ(slurp(answers), whole + "p001,presence2,3,form\n");
  // A spreadsheet's last line is whole, whatever its end.
  spit(answers, "participant;item;answer;source\np001;presence1;6;asked\np001;sick;5;asked");
  EXPECT_EQ(json("experiment status study --json")["participants"][0]["answers"], 2);
}

TEST_F(StudyPeople, TheHundredthRunComesAfterTheNinetyNinth) {
  plan(1);
  play("p001");
  const fs::path runs = folder_ / "study/sessions/p001";
  fs::copy_file(runs / "run-01.lcmlog", runs / "run-100.lcmlog");
  fs::rename(runs / "run-01.lcmlog", runs / "run-99.lcmlog");
  EXPECT_EQ(json("experiment status study --json")["participants"][0]["run"], "run-99");
}

// The plan alone says who was replaced.
TEST_F(StudyPeople, ALostPlanIsNotMadeAgainWithoutThoseWhoHaveReplacedOthers) {
  plan(2);
  play("p001");
  ASSERT_EQ(headpin("experiment plan -o study --replace p001").code, 0);
  play("p003");
  const fs::path path = folder_ / "study/plan.csv";
  const std::string whole = slurp(path);
  const std::string says = "study/plan.csv: p003 has sessions or answers but is not in the plan\n";
  for (const char* command : {"plan -o study", "status study", "score study"}) {
    const Result known = headpin(std::string("experiment ") + command);
    EXPECT_EQ(known.code, 0) << known.err;
    EXPECT_THAT(known.err, testing::Not(HasSubstr("not in the plan"))) << command;
  }
  // A row that was deleted by hand.
  spit(path, whole.substr(0, whole.find("\np003,") + 1));
  for (const char* command : {"plan -o study", "status study", "score study"}) {
    const Result known = headpin(std::string("experiment ") + command);
    EXPECT_EQ(known.code, 0) << known.err;
    EXPECT_THAT(known.err, HasSubstr(says)) << command;
  }
  // All of them.
  for (const std::string& left : {whole.substr(0, whole.find('\n') + 1), std::string()}) {
    left.empty() ? void(fs::remove(path)) : spit(path, left);
    expect_refusal("experiment plan -o study --people 2", 1,
                   "p003 has sessions or answers but would not be in a new plan of 2");
    const std::string status = headpin("experiment status study").err;
    EXPECT_THAT(status, HasSubstr(left.empty() ? "study/plan.csv: cannot open" : says));
  }
  spit(path, whole);
  EXPECT_EQ(json("experiment status study --json")["participants"][0]["replaced_by"], "p003");
}

TEST_F(StudyPeople, SessionsThatAreSimulatedOtherwiseThanRecordedAreNamed) {
  plan(2);
  play("p001");
  play("p002");
  EXPECT_THAT(headpin("experiment score study").out,
              testing::Not(HasSubstr("simulated otherwise")));
  rewrite_run("p002", [](scene::Trial& trial) {
    for (scene::Event& event : trial.events) {
      if (event.kind == scene::kind::game_hash) event.detail = std::string("0123456789abcdef");
    }
  });
  // Only of who counts: nobody has answered yet.
  EXPECT_TRUE(json("experiment score study --json")["simulated_otherwise"].empty());
  answer({"p001", "p002"});
  EXPECT_EQ(json("experiment score study --json")["simulated_otherwise"],
            nlohmann::json::array({"p002"}));
  EXPECT_THAT(headpin("experiment score study").out,
              HasSubstr("  simulated otherwise than recorded: p002 (see replays)\n"));
}

TEST_F(StudyPeople, AnAnalysisOfATableOlderThanAnswersSaysSo) {
  plan(1);
  ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  const auto says = [&] { return headpin("experiment analyse study").err; };
  EXPECT_THAT(says(), testing::Not(HasSubstr("is older than")));
  for (const char* name : {"answers/p001.csv", "sessions/p001/run-01.lcmlog", "plan.csv"}) {
    const fs::path path = folder_ / "study" / name;
    const auto before = fs::last_write_time(path);
    fs::last_write_time(path, fs::file_time_type::clock::now() + std::chrono::hours(1));
    EXPECT_THAT(says(),
                HasSubstr("study/tables/participants.csv: is older than the newest of plan"))
        << name;
    fs::last_write_time(path, before);
  }
  // The page of a trial is no data of it.
  spit(folder_ / "study/sessions/p001/run-01.html", "a page");
  fs::last_write_time(folder_ / "study/sessions/p001/run-01.html",
                      fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_THAT(says(), testing::Not(HasSubstr("is older than")));
}

// A scenario's name is anybody's text. Two files stay two.
TEST_F(StudyPeople, ADeidentifiedExportHasNoNameOfAScenarioOfOnesOwn) {
  plan(2);
  for (const char* file : {"alice/a.obj", "alice/b.obj"}) {
    spit(folder_ / file, slurp(HEADPIN_SOURCE_DIR "/assets/meshes/skittle_hull.obj"));
  }
  play("p001");  // in the bundled room
  std::string room = slurp(folder_ / "study/scenario.toml");
  const std::string name = "name = 'uno-slater-1997'", parts = "parts = [";
  ASSERT_NE(room.find(name), std::string::npos);
  room.replace(room.find(name), name.size(), "name = 'room of alice smith'");
  room.insert(room.find(parts) + parts.size(),
              "{shape = 'polyhedron', file = '../alice/a.obj'}, "
              "{shape = 'polyhedron', file = '../alice/b.obj'},");
  spit(folder_ / "study/scenario.toml", room);
  play("p002");
  ASSERT_EQ(headpin("experiment export study --motion-bids numbered --deidentify").code, 0);
  const auto scenario_of = [&](const std::string& subject) {
    const std::string events =
        fmt::format("numbered/sub-{0}/motion/sub-{0}_task-bowling_run-01_events.json", subject);
    const auto sidecar = nlohmann::json::parse(slurp(folder_ / events));
    return sidecar["HeadpinTrial"]["scenario"].get<std::string>();
  };
  EXPECT_THAT(scenario_of("001"), HasSubstr("name = 'uno-slater-1997'"));
  const std::string own = scenario_of("002");
  EXPECT_THAT(own, HasSubstr("name = 'scenario'"));
  EXPECT_THAT(own, testing::Not(HasSubstr("alice")));
  EXPECT_THAT(own, HasSubstr("'skittle-part-1-mesh.obj'"));
  EXPECT_THAT(own, HasSubstr("'skittle-part-2-mesh.obj'"));
}

// With as many people as there were, nothing shows that one of them has replaced another.
TEST_F(StudyPeople, APlanThatIsMadeAgainBesideSessionsSaysWhatItDoesNotHave) {
  plan(2);
  const std::string says = "study/plan.csv: is made again for the sessions or answers";
  EXPECT_THAT(headpin("experiment plan -o study").err, testing::Not(HasSubstr(says)));
  ASSERT_EQ(headpin("experiment plan -o study --replace p001").code, 0);
  play("p003");
  fs::remove(folder_ / "study/plan.csv");
  EXPECT_THAT(headpin("experiment plan -o study --people 2").err,
              testing::EndsWith("expected a copy of the plan that was lost\n"));
  const Result again = headpin("experiment plan -o study --people 3");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr(says));
}

TEST_F(StudyPeople, NotesAndEmptyFoldersAreNobodysSessionsOrAnswers) {
  plan(1);
  const fs::path sessions = folder_ / "study/sessions", answers = folder_ / "study/answers";
  fs::create_directories(sessions / "p009");
  fs::create_directories(answers / "p006.csv");
  spit(sessions / "notes.txt", "the second day it rained\n");
  spit(sessions / "p009/run-01.html", "a page");
  spit(answers / "p007.csv", "participant,item,answer,source\n");  // as a form that was only opened
  spit(answers / "my notes.csv", "day,weather\n2,rain\n");
  EXPECT_EQ(headpin("experiment status study").err, "");
  fs::remove(folder_ / "study/plan.csv");
  const Result again = headpin("experiment plan -o study --people 1");
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.err, "");
  spit(sessions / "p009/run-01.lcmlog", "");
  spit(answers / "p007.csv", "participant,item,answer,source\np007,sick,5,asked\n");
  EXPECT_EQ(headpin("experiment status study").err,
            "study/plan.csv: p007 has sessions or answers but is not in the plan\n"
            "study/plan.csv: p009 has sessions or answers but is not in the plan\n");
}

// A run that a person broke off, beside one of a virtual participant that counts.
TEST_F(StudyPeople, TheRunThatCountsSaysWhetherAParticipantIsVirtual) {
  plan(1);
  play("p001");
  const fs::path runs = folder_ / "study/sessions/p001";
  const std::string persons = slurp(runs / "run-01.lcmlog");
  fs::remove(runs / "run-01.lcmlog");
  ASSERT_EQ(headpin("experiment run study --participant p001 --virtual").code, 0);
  spit(runs / "run-02.lcmlog", persons.substr(0, persons.size() * 3 / 5));
  const Result asked = headpin("experiment ask study --participant p001 --virtual");
  EXPECT_EQ(asked.code, 0) << asked.err;
  const nlohmann::json status = json("experiment status study --json")["participants"][0];
  EXPECT_EQ(status["runs"], 2);
  EXPECT_EQ(status["run"], "run-01");
  EXPECT_EQ(status["answers"], 11);
  const nlohmann::json scored = json("experiment score study --json");
  EXPECT_EQ(scored["counted"], 1);
  EXPECT_EQ(scored["of_virtual"], "yes");
}

TEST_F(StudyPeople, AFileThatCannotBeReachedDoesNotStopStatus) {
  plan(1);
  ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  for (const char* name : {"sessions/p001/loop.lcmlog", "tables/loop.csv"}) {
    const fs::path path = folder_ / "study" / name;
    fs::create_symlink(path.filename(), path);
    const Result status = headpin("experiment status study");
    EXPECT_EQ(status.code, 0) << status.err;
    EXPECT_THAT(status.out, HasSubstr("next: headpin experiment analyse study\n"));
  }
}

// Without a published model there is nothing to draw a virtual participant's answers from.
TEST_F(StudyPeople, TheNextCommandDrawsAnswersOnlyWhereADesignHasAModel) {
  plan(1);
  ASSERT_EQ(headpin("experiment run study --participant p001 --virtual").code, 0);
  const std::string ask = "experiment ask study --participant p001";
  const auto next = [&] { return json("experiment status study --json")["next"]; };
  EXPECT_EQ(next(), "headpin " + ask + " --virtual");
  const fs::path design = folder_ / "study/design.toml";
  static const std::regex estimates("\nestimate = [^\n]*");
  spit(design, std::regex_replace(slurp(design), estimates, ""));
  EXPECT_EQ(next(), "headpin " + ask);
  expect_refusal(ask + " --virtual", 2, "no published model");
}

// Where a form has been taken, no answers are drawn beside it: the rest is asked.
TEST_F(StudyPeople, TheNextCommandDrawsNoAnswersBesideGivenOnes) {
  plan(1);
  ASSERT_EQ(headpin("experiment run study --participant p001 --virtual").code, 0);
  spit(folder_ / "forms.csv", "participant,item,answer\np001,presence1,6\n");
  ASSERT_EQ(headpin("experiment ask study --from forms.csv").code, 0);
  const std::string ask = "experiment ask study --participant p001";
  EXPECT_EQ(json("experiment status study --json")["next"], "headpin " + ask);
  expect_refusal(ask + " --virtual", 2, "has an answer of a person: presence1, form");
}

// Ctrl-D at a question of the form on a terminal.
TEST_F(StudyPeople, WhoEndsTheInputOfATerminalKeepsTheAnswersAndGoesOnLater) {
  plan(1);
  const int near = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(near, 0);
  ASSERT_EQ(grantpt(near), 0);
  ASSERT_EQ(unlockpt(near), 0);
  const int far = open(ptsname(near), O_RDWR | O_NOCTTY);
  ASSERT_GE(far, 0);
  const std::string typed = "6\n7\n\x04";
  ASSERT_EQ(write(near, typed.data(), typed.size()), static_cast<ssize_t>(typed.size()));
  const std::vector<std::string> ask = {"experiment", "ask", "study", "--participant", "p001"};
  int status = 0;
  waitpid(started(ask, far), &status, 0);
  close(far);
  close(near);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(slurp(folder_ / "study/answers/p001.csv"),
            "participant,item,answer,source\np001,presence1,6,asked\np001,presence2,7,asked\n");
  expect_refusal("experiment ask study --participant p001", 1,
                 "p001: 2 of 11 questions are answered; the same command continues with the next");
}

// A button that is brushed begins a game, and cuts the one before.
TEST_F(StudyPeople, WhoPlayedAVersionTwiceOrNotToItsEndIsNamed) {
  plan(2);
  const fs::path room = folder_ / "study/scenario.toml";
  std::string text = slurp(room);
  for (const auto& [from, to] :
       {std::pair("\nframes = 5", "\nframes = 1"), {"\nballs = 2", "\nballs = 1"}}) {
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), std::string_view(from).size(), to);
  }
  spit(room, text);
  ASSERT_EQ(headpin("experiment run study --participant p001 --virtual").code, 0);
  rewrite_trial(folder_ / "t.lcmlog", folder_ / "no_ball.lcmlog", [](scene::Trial& trial) {
    for (devices::Sample& sample : trial.samples) {
      if (auto* mouse = std::get_if<devices::MouseSample>(&sample)) mouse->trigger = false;
    }
  });
  ASSERT_EQ(headpin("experiment run study --trial no_ball.lcmlog --participant p002").code, 0);
  const nlohmann::json status = json("experiment status study --json")["participants"];
  EXPECT_EQ(status[0]["one_game_each"], true);
  EXPECT_EQ(status[1]["one_game_each"], false);
  const std::string words = headpin("experiment status study").out;
  const std::string says = "a version played more than once, or not to its end";
  EXPECT_THAT(words, HasSubstr(" s, " + says + "\n"));
  EXPECT_EQ(words.find(says), words.rfind(says));
  EXPECT_EQ(json("experiment score study --json")["other_games"], nlohmann::json::array({"p002"}));
  EXPECT_THAT(headpin("experiment score study").out,
              HasSubstr("  " + says + ": p002 (see base_games and changed_games)\n"));
}

TEST_F(StudyPeople, TablesOfNobodyAreNoPeoples) {
  plan(1);
  const nlohmann::json scored = json("experiment score study --json");
  EXPECT_EQ(scored["counted"], 0);
  EXPECT_EQ(scored["of_virtual"], "n/a");
  EXPECT_THAT(slurp(folder_ / "study/tables/table-2.csv"), HasSubstr("\ntotal,,0,18,n/a\n"));
  EXPECT_THAT(headpin("experiment score study").out,
              testing::StartsWith("0 of 1 participants count\n"));
}

// Such as the folder `study` of a program's sources.
TEST_F(StudyPeople, AreNotPlannedInAFolderOfOthers) {
  fs::create_directories(folder_ / "sources/tables");
  spit(folder_ / "sources/main.cpp", "int main() {}\n");
  expect_refusal(
      "experiment plan -o sources", 1,
      "sources: holds main.cpp, which headpin did not write there; expected a new or empty folder\n");
  EXPECT_FALSE(fs::exists(folder_ / "sources/questionnaire.toml"));
  // What a killed plan leaves is no reason, and neither are hidden files.
  fs::create_directories(folder_ / "study/.git");
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/questionnaires/uno-slater-1997.toml",
                folder_ / "study/questionnaire.toml");
  spit(folder_ / "study/design.toml.99999999-0.part", "seed");
  ASSERT_EQ(headpin("experiment plan -o study").code, 0);
  // A study may hold anything when more participants are planned.
  spit(folder_ / "study/notes.txt", "p003 comes on Monday\n");
  EXPECT_EQ(headpin("experiment plan -o study --people 20").code, 0);
}

// A copy that a file manager made was taken for the last run, and the next run got its number again.
TEST_F(StudyPeople, ACopyOfARunComesBetweenItAndTheNextRun) {
  plan(1);
  play("p001");
  const fs::path runs = folder_ / "study/sessions/p001";
  const auto counts = [&] {
    return json("experiment status study --json")["participants"][0]["run"];
  };
  fs::copy_file(runs / "run-01.lcmlog", runs / "run-01 copy.lcmlog");
  EXPECT_EQ(counts(), "run-01");
  fs::copy_file(runs / "run-01.lcmlog", runs / "run-02.lcmlog");
  spit(runs / "run-01.lcmlog", "");
  EXPECT_EQ(counts(), "run-01 copy");
  fs::remove(runs / "run-02.lcmlog");
  fs::rename(runs / "run-01 copy.lcmlog", folder_ / "kept.lcmlog");
  spit(runs / "run-03 copy.lcmlog", "");
  play("p001");
  EXPECT_EQ(counts(), "run-04");
}

// They come behind all runs with numbers, and were taken for the session that had just been played.
TEST_F(StudyPeople, RunsWithNamesOfOnesOwnAreNoneOfANumberNorTheLastOne) {
  plan(4);
  int others = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string who = fmt::format("p00{}", i + 1);
    const fs::path runs = folder_ / "study/sessions" / who;
    fs::create_directories(runs);
    for (const char* name : {"copy", "2026-11-30", "20261130", "2147483647", "99999999999"}) {
      spit(runs / fmt::format("run-{}.lcmlog", name), "");
    }
    const Result run = headpin("experiment run study --trial t.lcmlog --participant " + who);
    const auto told = json("experiment status study --json")["participants"][i];
    EXPECT_EQ(told["run"], "run-01");
    const bool other = told["in_other_order"];
    EXPECT_EQ(run.err.find("run-01.lcmlog: began with the red") != run.err.npos, other) << run.err;
    others += other ? 1 : 0;
    fs::remove(runs / "run-01.lcmlog");
    EXPECT_EQ(json("experiment run study --virtual --json --participant " + who)["virtual"], true);
  }
  EXPECT_GT(others, 0);
}

}  // namespace
}  // namespace headpin
