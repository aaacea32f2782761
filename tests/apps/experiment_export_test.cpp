// A study as others take it: Motion-BIDS, and one page.

#include <set>

#include <fmt/format.h>

#include "base/sha256.h"
#include "scene/record/events.h"
#include "tests/apps/command_line.h"
#include "tests/apps/rewritten.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class StudyExport : public CommandLine {
 protected:
  void play(int people) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
    ASSERT_EQ(
        headpin("experiment plan -o study --design short.toml --people " + std::to_string(people))
            .code,
        0);
    ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
    ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  }

  static std::vector<std::vector<std::string>> rows(const std::string& text, char separator) {
    std::vector<std::vector<std::string>> all;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, separator);) cells.push_back(cell);
      all.push_back(cells);
    }
    return all;
  }
};

// What the tables say is what `export` of the trial says, sample by sample, by a walk of its own.
TEST_F(StudyExport, IsReadBackToTheSameSamples) {
  play(2);
  const nlohmann::json made = json("experiment export study --motion-bids data --json");
  EXPECT_EQ(made["sessions"].size(), 2u);
  const double eyes = made["sessions"][0]["eyes_m"];
  EXPECT_GT(eyes, 1.2);  // of an adult who stands
  EXPECT_LT(eyes, 2.0);
  const std::string motion = "data/sub-p001/motion/sub-p001_task-bowling_tracksys-";
  ASSERT_EQ(headpin("import " + motion + "hand_run-01_motion.tsv -o again.lcmlog").code, 0);
  ASSERT_EQ(headpin("export study/sessions/p001/run-01.lcmlog -o was").code, 0);
  ASSERT_EQ(headpin("export again.lcmlog -o is").code, 0);
  for (const char* table : {"trackers.csv", "buttons.csv", "scenario.toml"}) {
    EXPECT_EQ(slurp(folder_ / "was" / table), slurp(folder_ / "is" / table)) << table;
  }
  const auto game_hash = [&](const std::string& trial) {
    return json("replay --json " + trial)["game_hash"];
  };
  EXPECT_EQ(game_hash("again.lcmlog"), game_hash("study/sessions/p001/run-01.lcmlog"));
  EXPECT_EQ(slurp(folder_ / "data/sourcedata/sub-p001/run-01.lcmlog"),
            slurp(folder_ / "study/sessions/p001/run-01.lcmlog"));
  expect_refusal("experiment export study --motion-bids data", 1, "a dataset exists there");
}

// Files of another task or of another tracking system in the same folder were mixed in, or refused the trial.
TEST_F(StudyExport, IsReadBackWithoutTheFilesOfOtherTasksAndTrackingSystems) {
  play(1);
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  const std::string motion = "data/sub-p001/motion/sub-p001_task-bowling_tracksys-";
  const std::string import = "import " + motion + "hand_run-01_motion.tsv --json -o ";
  const nlohmann::json alone = json(import + "alone.lcmlog");
  EXPECT_TRUE(alone["notes"].empty()) << alone;
  const std::filesystem::path folder = folder_ / "data/sub-p001/motion";
  std::filesystem::copy_file(folder / "sub-p001_task-bowling_tracksys-hand_run-01_motion.tsv",
                             folder / "sub-p001_task-second_tracksys-hand_run-01_motion.tsv");
  std::ofstream(folder / "sub-p001_task-rest_run-01_events.tsv") << "onset\tduration\n0\t1\n";
  std::ofstream(folder / "sub-p001_task-bowling_tracksys-imu_run-01_motion.tsv") << "0.1\t0.2\n";
  const nlohmann::json beside = json(import + "beside.lcmlog");
  EXPECT_EQ(beside["samples"], alone["samples"]);
  EXPECT_EQ(slurp(folder_ / "beside.lcmlog"), slurp(folder_ / "alone.lcmlog"));
  ASSERT_EQ(beside["notes"].size(), 1u) << beside;
  EXPECT_EQ(
      beside["notes"][0],
      "sub-p001_task-bowling_tracksys-imu_run-01_motion.tsv: headpin writes no tracking system "
      "'imu': left out");
}

// What the validator does not look at: as many columns as channels, and only participants who are there.
TEST_F(StudyExport, TablesFitTheirChannelsAndPeopleTheirFolders) {
  play(2);
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  int tables = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "data")) {
    const std::string name = entry.path().string();
    if (!name.ends_with("_motion.tsv")) continue;
    ++tables;
    const std::string stem = name.substr(0, name.rfind("_motion.tsv"));
    const auto channels = rows(slurp(stem + "_channels.tsv"), '\t');
    const auto sidecar = nlohmann::json::parse(slurp(stem + "_motion.json"));
    EXPECT_EQ(sidecar["MotionChannelCount"], channels.size() - 1);
    EXPECT_EQ(sidecar["LATENCYChannelCount"], 1);
    int kinds = 0;
    for (const char* kind : {"POS", "ORNT", "LATENCY", "MISC"}) {
      kinds += sidecar[std::string(kind) + "ChannelCount"].get<int>();
    }
    EXPECT_EQ(sidecar["MotionChannelCount"], kinds);
    const auto motion = rows(slurp(name), '\t');
    ASSERT_GT(motion.size(), 100u);
    for (const auto& row : motion) ASSERT_EQ(row.size(), channels.size() - 1) << name;
    const auto latency =
        std::ranges::find(channels, "LATENCY", [](const auto& row) { return row[2]; });
    const auto column = static_cast<std::size_t>(latency - channels.begin()) - 1;
    const double lasts = std::stod(motion.back()[column]) - std::stod(motion.front()[column]);
    EXPECT_NEAR(sidecar["RecordingDuration"].get<double>(), lasts, 1e-5);
    EXPECT_NEAR(sidecar["SamplingFrequencyEffective"].get<double>(),
                static_cast<double>(motion.size() - 1) / lasts, 1e-4);
    EXPECT_TRUE(
        nlohmann::json::parse(slurp(stem + "_channels.json"))["reference_frame"].is_object());
  }
  EXPECT_EQ(tables, 6);  // head, hand and what is simulated, of two people
  std::set<std::string> subjects;
  for (const char* table : {"participants.tsv", "phenotype/questionnaire.tsv"}) {
    const auto people = rows(slurp(folder_ / "data" / table), '\t');
    ASSERT_EQ(people.size(), 3u);
    EXPECT_EQ(people[0][0], "participant_id");
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_TRUE(fs::is_directory(folder_ / "data" / people[i][0])) << people[i][0];
    }
    std::string sidecar = table;
    sidecar.replace(sidecar.size() - 3, 3, "json");
    const auto words = nlohmann::json::parse(slurp(folder_ / "data" / sidecar));
    for (std::size_t i = 1; i < people[0].size(); ++i) {
      EXPECT_TRUE(words.contains(people[0][i])) << people[0][i];
    }
  }
}

TEST_F(StudyExport, RowsOfSimulatedBodiesAreTheScenariosFrames) {
  std::ofstream(folder_ / "short.toml") << [] {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    return text.replace(text.find("throws = 10"), 11, "throws = 1");
  }();
  ASSERT_EQ(headpin("experiment plan -o study --design short.toml --people 1").code, 0);
  std::string room = slurp(folder_ / "study/scenario.toml");
  const std::string rate = "frame_hz = 60";
  room.replace(room.find(rate), rate.size(), "frame_hz = 30");
  spit(folder_ / "study/scenario.toml", room);
  ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  const auto sidecar = nlohmann::json::parse(
      slurp(folder_ /
            "data/sub-p001/motion/sub-p001_task-bowling_tracksys-simulated_run-01_motion.json"));
  EXPECT_EQ(sidecar["SamplingFrequency"], 30.0);
  EXPECT_THAT(sidecar["TaskDescription"].get<std::string>(), HasSubstr("a frame of 1/30 s a row"));
}

// Simulated bodies that contradict the trial are not data. One trial has another game hash, one other states.
TEST_F(StudyExport, BodiesThatAreSimulatedOtherwiseThanTheyWereRecordedAreLeftOut) {
  play(3);
  const auto trial = [&](const std::string& id) {
    return folder_ / "study/sessions" / id / "run-01.lcmlog";
  };
  fs::rename(trial("p001"), folder_ / "p001.lcmlog");
  rewrite_trial(folder_ / "p001.lcmlog", trial("p001"), [](scene::Trial& one) {
    for (scene::Event& event : one.events) {
      if (event.kind == scene::kind::game_hash) event.detail = "0123456789abcdef";
    }
  });
  ASSERT_EQ(headpin("replay study/sessions/p002/run-01.lcmlog -o p002.lcmlog").code, 0);
  fs::remove(trial("p002"));
  rewrite_trial(folder_ / "p002.lcmlog", trial("p002"),
                [](scene::Trial& one) { change_states_from(1000, one); });
  const Result made = headpin("experiment export study --motion-bids data");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("p001/run-01.lcmlog: the replayed game differs"));
  EXPECT_THAT(made.err,
              HasSubstr("p002/run-01.lcmlog: tick 1000 (4.166666 s) of the replay differs"));
  for (const char* id : {"p001", "p002", "p003"}) {
    int simulated = 0, files = 0;
    for (const auto& entry :
         fs::directory_iterator(folder_ / "data" / ("sub-" + std::string(id)) / "motion")) {
      ++files;
      if (entry.path().string().find("tracksys-simulated") != std::string::npos) ++simulated;
    }
    EXPECT_GT(files, 4) << id;
    EXPECT_EQ(simulated, std::string(id) == "p003" ? 4 : 0) << id;
  }
  const std::string readme = slurp(folder_ / "data/README");
  EXPECT_THAT(readme, HasSubstr("tracksys-simulated is left out"));
  EXPECT_THAT(readme, testing::Not(HasSubstr("replays to the bit")));
  ASSERT_EQ(headpin("experiment plan -o whole --design short.toml --people 1").code, 0);
  ASSERT_EQ(headpin("experiment run whole --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment export whole --motion-bids data2").code, 0);
  EXPECT_THAT(slurp(folder_ / "data2/README"), HasSubstr("replays to the bit"));
}

TEST_F(StudyExport, DeidentifiedHasNumbersAndNoTrials) {
  play(1);
  const Result made = headpin("experiment export study --motion-bids data --deidentify");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("the motion data still reveal"));
  EXPECT_FALSE(fs::exists(folder_ / "data/sourcedata"));
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "data")) {
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("p001")));
    if (entry.is_regular_file()) {
      EXPECT_THAT(slurp(entry.path()), testing::Not(HasSubstr("p001"))) << entry.path();
    }
  }
}

// Names and trials of the export that was begun first would stay in a dataset without names.
TEST_F(StudyExport, AnUnfinishedExportGoesOnOnlyWithTheSameChoice) {
  play(2);
  const auto interrupted = [&](const std::string& folder) {
    fs::remove(folder_ / folder / "dataset_description.json");  // it is written last
  };
  ASSERT_EQ(headpin("experiment export study --motion-bids named").code, 0);
  ASSERT_EQ(headpin("experiment export study --motion-bids numbered --deidentify").code, 0);
  interrupted("named");
  interrupted("numbered");
  expect_refusal(
      "experiment export study --motion-bids named --deidentify", 1,
      "named: expected a new or empty folder, or an unfinished export of the same study");
  expect_refusal("experiment export study --motion-bids numbered", 1,
                 "begun with the same choice of --deidentify");
  EXPECT_FALSE(fs::exists(folder_ / "named/sub-001"));
  EXPECT_FALSE(fs::exists(folder_ / "numbered/sourcedata"));
  // Somebody, or a run, that this export does not write.
  const auto refused_with = [&](const std::string& name, const std::string& says) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << "of another";
    expect_refusal("experiment export study --motion-bids numbered --deidentify", 1, says);
    fs::remove(folder_ / name);
  };
  refused_with("numbered/sub-001/motion/sub-001_task-bowling_tracksys-head_run-02_motion.tsv",
               "run-02_motion.tsv: expected only files that this export writes");
  refused_with("numbered/sub-p001/x", "numbered/sub-p001: expected only subjects that this export");
  fs::remove(folder_ / "numbered/sub-p001");
  refused_with("numbered/sourcedata/sub-p002/run-01.lcmlog", "sourcedata/sub-p002: expected only");
  fs::remove_all(folder_ / "numbered/sourcedata");
  EXPECT_EQ(headpin("experiment export study --motion-bids named").code, 0);
  EXPECT_EQ(headpin("experiment export study --motion-bids numbered --deidentify").code, 0);
}

TEST_F(StudyExport, WhatIsNoSessionIsRefusedWithFileAndLine) {
  play(1);
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  const fs::path motion = folder_ / "data/sub-p001/motion";
  const std::string head = "sub-p001_task-bowling_tracksys-head_run-01_motion.tsv";
  const std::string whole = slurp(motion / head);
  const std::string line = "import data/sub-p001/motion/" + head + " -o OUT.lcmlog";
  const auto with = [&](const std::string& text) { std::ofstream(motion / head) << text; };
  with("1.0\t2\n" + whole);
  expect_refusal(line, 1, head + ":1: expected 17 cells, found '2'");
  with("x" + whole);
  expect_refusal(line, 1, head + ":1: expected a number, found 'x");
}

TEST_F(StudyExport, TheReportIsOnePageThatSaysWhatIsVirtual) {
  play(2);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  const Result made = headpin("experiment report study -o study.html");
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string page = slurp(folder_ / "study.html");
  for (const char* says : {"2 of these 2 participants are virtual", "Reported sickness level",
                           "add up to 102", "p002", "presence6", "<svg", "</html>"}) {
    EXPECT_THAT(page, HasSubstr(says));
  }
  for (const char* other : {"http://", "https://", "src="}) {
    std::string without = page;  // the name of a name space is no address
    for (std::size_t at; (at = without.find("http://www.w3.org")) != std::string::npos;) {
      without.erase(at, 17);
    }
    EXPECT_THAT(without, testing::Not(HasSubstr(other)));
  }
  // Each version's one throw.
  std::size_t throws = 0;
  for (std::size_t at = 0; (at = page.find("viewBox='0 0 44 96'", at + 1)) != std::string::npos;) {
    ++throws;
  }
  EXPECT_EQ(throws, 4u);
  EXPECT_THAT(page, testing::Not(HasSubstr("<a href")));
  std::ofstream(folder_ / "study/sessions/p001/run-01.html") << "a page";
  ASSERT_EQ(headpin("experiment report study -o study.html --force").code, 0);
  EXPECT_THAT(slurp(folder_ / "study.html"),
              HasSubstr("<a href=\"study/sessions/p001/run-01.html\">"));
  // A browser takes # and ? for the end of a path.
  fs::rename(folder_ / "study", folder_ / "a#b 50% ü?");
  ASSERT_EQ(headpin("experiment report 'a#b 50% ü?' -o study.html --force").code, 0);
  EXPECT_THAT(slurp(folder_ / "study.html"),
              HasSubstr("<a href=\"a%23b%2050%25%20%C3%BC%3F/sessions/p001/run-01.html\">"));
}

TEST_F(StudyExport, AReportOfSomeLeavesOutTheAnalysisOfOthers) {
  play(2);
  fs::create_directory(folder_ / "study/analysis");
  const auto analysed = [&](int number) {
    std::ofstream(folder_ / "study/analysis/fit.csv")
        << "quantity,value,virtual\nparticipants," << number << ",yes\n";
    std::ofstream(folder_ / "study/analysis/table-6.csv") << "term,estimate,virtual\nE,4321,yes\n";
  };
  const auto page = [&](const std::string& options) {
    EXPECT_EQ(headpin("experiment report study -o study.html --force " + options).code, 0);
    return slurp(folder_ / "study.html");
  };
  const int counted = json("experiment report study -o other.html --json")["counted"].get<int>();
  analysed(counted);
  EXPECT_THAT(page("--only virtual"), HasSubstr("4321"));
  EXPECT_THAT(page("--only virtual"), HasSubstr("p001"));
  const std::string people = page("--only people");  // nobody of these two
  EXPECT_THAT(people, testing::Not(HasSubstr("4321")));
  EXPECT_THAT(people,
              HasSubstr(fmt::format("analysis is of {} participants (virtual: yes)", counted)));
  EXPECT_THAT(people, testing::Not(HasSubstr("virtual: nobody played")));
  EXPECT_THAT(people, testing::Not(HasSubstr("p001 (virtual)")));
  std::ofstream(folder_ / "study/analysis/fit.csv") << "mine,other\n1,2\n";  // by a changed script
  EXPECT_THAT(page("--only virtual"), HasSubstr("4321"));
  analysed(counted + 1);  // somebody is no longer counted
  EXPECT_THAT(page(""), testing::Not(HasSubstr("4321")));
}

// As `analyse` says it: by the hash of the table that it read.
TEST_F(StudyExport, AReportLeavesOutTheAnalysisOfOlderAnswers) {
  play(2);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  const fs::path analysis = folder_ / "study/analysis";
  fs::create_directory(analysis);
  const int counted = json("experiment report study -o other.html --json")["counted"].get<int>();
  std::ofstream(analysis / "fit.csv")
      << "quantity,value,virtual\nparticipants," << counted << ",yes\n";
  std::ofstream(analysis / "table-6.csv") << "term,estimate,virtual\nE,4321,yes\n";
  const std::string hash =
      "cd '" + analysis.string() + "' && sha256sum ../tables/participants.csv >made-from.txt";
  ASSERT_EQ(std::system(hash.c_str()), 0);
  const auto page = [&] {
    EXPECT_EQ(headpin("experiment report study -o study.html --force").code, 0);
    return slurp(folder_ / "study.html");
  };
  EXPECT_THAT(page(), HasSubstr("4321"));
  const fs::path answers = folder_ / "study/answers/p001.csv";
  std::string text = slurp(answers);
  char& answer = text.at(text.find("presence1,") + 10);
  answer = answer == '7' ? '1' : '7';
  spit(answers, text);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  EXPECT_THAT(page(), testing::Not(HasSubstr("4321")));
  EXPECT_THAT(page(), HasSubstr("The analysis is of other data than the tables above"));
  EXPECT_THAT(headpin("experiment report study -o study.html --force").out,
              HasSubstr("experiment score` and then `headpin experiment analyse`"));
  fs::remove(analysis / "made-from.txt");  // as of an older version
  EXPECT_THAT(page(), HasSubstr("4321"));
}

// A page that is there already is somebody's.
TEST_F(StudyExport, TheReportWritesThePagesOfTrialsThatAreMissing) {
  play(2);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  std::ofstream(folder_ / "study/sessions/p001/run-01.html") << "a page";
  std::ofstream(folder_ / "page.html") << "<html><!--headpin:data--></html>";
  const Result made = headpin("experiment report study -o study.html --pages --page page.html");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(slurp(folder_ / "study/sessions/p001/run-01.html"), "a page");
  const std::string page = slurp(folder_ / "study/sessions/p002/run-01.html");
  EXPECT_THAT(page, testing::StartsWith("<html>"));
  EXPECT_GT(page.size(), 10'000u);  // the trial is in it
  for (const char* name : {"p001", "p002"}) {
    EXPECT_THAT(slurp(folder_ / "study.html"),
                HasSubstr(std::string("<a href=\"study/sessions/") + name + "/run-01.html\">"));
  }
}

// What an older version wrote and nobody edited is not the laboratory's. Without R, the script is written too.
TEST_F(StudyExport, AScriptOfAnotherVersionIsWrittenAgainUnlessItWasEdited) {
  play(1);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  const fs::path script = folder_ / "study/model.R";
  headpin("experiment analyse study");
  const std::string todays = slurp(script);
  EXPECT_THAT(todays, testing::StartsWith("# The analysis of a study by the design"));
  const std::string lines = "stop('of an older version')\n";
  const std::string unedited = fmt::format(
      "{}# SHA-256 of the lines above, as headpin wrote them: {}\n", lines, base::sha256(lines));
  spit(script, unedited);
  EXPECT_THAT(headpin("experiment analyse study").err, HasSubstr("it is written again"));
  EXPECT_EQ(slurp(script), todays);
  for (const std::string& kept : {lines, unedited + "x <- 1\n", todays + "x <- 1\n"}) {
    spit(script, kept);
    EXPECT_THAT(headpin("experiment analyse study").err,
                testing::Not(HasSubstr("it is written again")));
    EXPECT_EQ(slurp(script), kept);
  }
}

// A counted skittle stands behind the wall, where it would be taken for one that was not knocked down.
TEST_F(StudyExport, HasPosesOfBodiesInPlayOnly) {
  play(1);
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  ASSERT_EQ(headpin("export study/sessions/p001/run-01.lcmlog -o was").code, 0);
  EXPECT_THAT(slurp(folder_ / "was/columns.csv"),
              HasSubstr("a skittle that was counted stands upright behind the wall ahead"));
  EXPECT_THAT(slurp(folder_ / "data/README"), HasSubstr("n/a is the pose of a body that is not"));
  EXPECT_THAT(slurp(folder_ / "data/README"), HasSubstr("on the one clock of the trial"));
  const std::string motion =
      "data/sub-p001/motion/sub-p001_task-bowling_tracksys-simulated_run-01_";
  const auto channels = rows(slurp(folder_ / (motion + "channels.tsv")), '\t');
  int unknown = 0;
  for (const auto& row : rows(slurp(folder_ / (motion + "motion.tsv")), '\t')) {
    ASSERT_EQ(row.size(), channels.size() - 1);  // a line of names
    for (std::size_t i = 0; i < row.size(); ++i) {
      unknown += row[i] == "n/a";
      if (channels[i + 1][0] == "hand_z") {
        ASSERT_NE(row[i], "-10");
      }
      const bool along = channels[i + 1][0].starts_with("skittle") && channels[i + 1][1] == "y";
      if (along && row[i] != "n/a") {
        ASSERT_LT(std::stod(row[i]), 8.0);  // the wall is at 7.6
      }
    }
  }
  EXPECT_GT(unknown, 0);
  EXPECT_EQ(unknown % 7, 0);
}

// The index of a run is a number in BIDS. What a file browser or a person adds to it is no part of it.
TEST_F(StudyExport, ARunThatIsACopyHasTheNumberOfItsRun) {
  play(2);
  const fs::path sessions = folder_ / "study/sessions";
  fs::rename(sessions / "p001/run-01.lcmlog", sessions / "p001/run-01 copy.lcmlog");
  fs::rename(sessions / "p002/run-01.lcmlog", sessions / "p002/run-x.lcmlog");
  expect_refusal("experiment export study --motion-bids data", 1,
                 "sessions/p002/run-x.lcmlog: expected a number behind run-");
  EXPECT_FALSE(fs::exists(folder_ / "data"));
  fs::rename(sessions / "p002/run-x.lcmlog", sessions / "p002/run-12_anna.lcmlog");
  ASSERT_EQ(headpin("experiment export study --motion-bids data").code, 0);
  const auto index_is = [&](const std::string& subject, const std::string& index) {
    for (const auto& entry : fs::directory_iterator(folder_ / "data" / subject / "motion")) {
      EXPECT_THAT(entry.path().filename().string(), HasSubstr("_run-" + index + "_"));
    }
  };
  index_is("sub-p001", "01");
  index_is("sub-p002", "12");
  EXPECT_EQ(slurp(folder_ / "data/sourcedata/sub-p001/run-01 copy.lcmlog"),
            slurp(sessions / "p001/run-01 copy.lcmlog"));
  const std::string head = "data/sub-p001/motion/sub-p001_task-bowling_tracksys-head_run-01_motion";
  EXPECT_EQ(headpin("import " + head + ".tsv -o again.lcmlog").code, 0);
  ASSERT_EQ(headpin("experiment export study --motion-bids numbers --deidentify").code, 0);
  const std::string people = slurp(folder_ / "numbers/participants.tsv");
  EXPECT_THAT(people, HasSubstr("\trun-12\t"));
  EXPECT_THAT(people, testing::Not(HasSubstr("anna")));
}

// Publishers of others count stations from 0. A station below 1 has no tracking system, which is said.
TEST_F(StudyExport, TellsHowManySamplesOfStationsBelowOneAreLeftOut) {
  play(1);
  const fs::path run = folder_ / "study/sessions/p001/run-01.lcmlog";
  fs::rename(run, folder_ / "whole.lcmlog");
  rewrite_trial(folder_ / "whole.lcmlog", run, [](scene::Trial& one) {
    devices::TrackerSample sample;
    for (const std::int32_t station : {0, -2, 0}) {
      sample.station = station;
      ++sample.sequence;
      one.samples.insert(one.samples.begin(), sample);
    }
  });
  const Result made = headpin("experiment export study --motion-bids data");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err,
              HasSubstr("p001/run-01.lcmlog: 3 samples of stations below 1 are left out\n"));
  const std::string motion = "data/sub-p001/motion/sub-p001_task-bowling_tracksys-";
  EXPECT_EQ(headpin("import " + motion + "hand_run-01_motion.tsv -o again.lcmlog").code, 0);
  EXPECT_EQ(scene::read_trial(folder_ / "again.lcmlog").samples.size() + 3,
            scene::read_trial(run).samples.size());
}

}  // namespace
}  // namespace headpin
