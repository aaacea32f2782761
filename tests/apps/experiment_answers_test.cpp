// Answers, scores and the model of a study, as a laboratory meets them.

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

/// A table as rows of name -> cell. Cells here have no commas.
using Rows = std::vector<std::map<std::string, std::string>>;

class StudyAnswers : public CommandLine {
 protected:
  void plan(int people, const std::string& more = "") const {
    ASSERT_EQ(
        headpin("experiment plan -o study --seed 7 --people " + std::to_string(people) + more).code,
        0);
  }

  /// A study of one throw a game.
  void plan_short(int people) const {
    std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
    text.replace(text.find("throws = 10"), 11, "throws = 1");
    std::ofstream(folder_ / "short.toml") << text;
    plan(people, " --design short.toml");
  }

  Rows table(const std::string& name) const {
    const auto cells = [](const std::string& line) {
      std::vector<std::string> all;
      std::string cell;
      bool quoted = false;
      for (const char c : line) {
        if (c == '"') {
          quoted = !quoted;
        } else if (c == ',' && !quoted) {
          all.push_back(std::exchange(cell, ""));
        } else {
          cell += c;
        }
      }
      all.push_back(cell);
      return all;
    };
    std::istringstream lines(slurp(folder_ / name));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = cells(line);
    Rows rows;
    while (std::getline(lines, line)) {
      const auto values = cells(line);
      EXPECT_EQ(values.size(), names.size()) << line;
      auto& row = rows.emplace_back();
      for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = values[i];
    }
    return rows;
  }

  /// `headpin ARGUMENTS` by somebody who types these lines and then goes away.
  Result typed(const std::string& arguments, const std::string& lines) const {
    std::ofstream(folder_ / "typed.txt") << lines;
    const std::string command = "cd '" + folder_.string() + "' && '" HEADPIN_PROGRAM "' " +
                                arguments + " >out.txt 2>err.txt <typed.txt";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), slurp(folder_ / "out.txt"), slurp(folder_ / "err.txt")};
  }

  void expect_the_published_model(int degrees_of_freedom) const;

  static bool has_r() { return std::system("Rscript --version >/dev/null 2>&1") == 0; }
};

const std::string kAll = "6\n7\n5\n1\n6\nn/a\n2\nyes\nno\nfemale\nstudent\n";

TEST_F(StudyAnswers, AreAskedOneByOneAndGoneOnWith) {
  plan(2);
  const Result half = typed("experiment ask study --participant p001", "6\n8\nsix\n\n7\n5\n");
  EXPECT_EQ(half.code, 1);
  EXPECT_THAT(half.err, HasSubstr("3 of 11 questions are answered"));
  EXPECT_THAT(half.out, HasSubstr("expected a whole number from 1 to 7, or n/a, found '8'"));
  EXPECT_THAT(half.out, HasSubstr("found 'six'"));
  EXPECT_THAT(half.out, HasSubstr("your sense of being there"));
  EXPECT_THAT(half.out, HasSubstr("somewhere that I visited"));
  EXPECT_EQ(table("study/answers/p001.csv").size(), 3u);
  const Result rest = typed("experiment ask study --participant p001 --language de",
                            "1 \n6\n\tn/a\n2\n ja\nnein\r\nweiblich  \nStudium\n");  // blanks too
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("Haben Sie schon einmal"));
  ASSERT_EQ(typed("experiment ask study --participant p002", kAll).code, 0);
  std::string other = slurp(folder_ / "study/answers/p002.csv");
  for (std::size_t at = 0; (at = other.find("p002")) != std::string::npos;) other[at + 3] = '1';
  EXPECT_EQ(slurp(folder_ / "study/answers/p001.csv"), other);
  EXPECT_EQ(json("experiment status study --json")["participants"][0]["answers"], 11);
  expect_refusal("experiment ask study --participant p001 --language xx", 2,
                 "expected one of en, de");
  expect_refusal("experiment ask study --participant ../x", 2, "found '../x'");
}

// As an editor saves them: the last line has no end.
TEST_F(StudyAnswers, OfTheLastLineAreKeptWhoeverWroteIt) {
  plan(2);
  const std::string path = "study/answers/p001.csv", whole = "participant,item,answer,source\n";
  std::filesystem::create_directories(folder_ / "study/answers");
  spit(folder_ / path, whole + "p001,presence1,6,asked\np001,sick,5,asked");
  typed("experiment ask study --participant p001", "");  // goes away at once
  EXPECT_EQ(slurp(folder_ / path), whole + "p001,presence1,6,asked\np001,sick,5,asked");
  spit(folder_ / "forms.csv", "participant,item,answer\np001,presence2,3\n");
  EXPECT_EQ(headpin("experiment ask study --from forms.csv").code, 0);
  EXPECT_EQ(slurp(folder_ / path),
            whole + "p001,presence1,6,asked\np001,sick,5,asked\np001,presence2,3,form\n");
  // What a crash left is no answer, and is told.
  spit(folder_ / path, whole + "p001,presence1,6,asked\np001,sick,5,as");
  const Result cut = typed("experiment ask study --participant p001", "");
  EXPECT_THAT(cut.err, testing::HasSubstr("as a crash leaves it; removed: p001,sick,5,as\n"));
  EXPECT_EQ(slurp(folder_ / path), whole + "p001,presence1,6,asked\n");
  // A table of another program stays as it is.
  const std::string foreign = "participant;item;answer;source\np001;presence1;6;asked\np001;sick";
  spit(folder_ / path, foreign);
  EXPECT_THAT(typed("experiment ask study --participant p001", "").err,
              testing::HasSubstr("expected commas"));
  EXPECT_EQ(slurp(folder_ / path), foreign);
  // A whole line that is wrong is somebody's, and stays.
  spit(folder_ / path, whole + "p001,presence1,6,asked\np001,sick,9,asked");
  EXPECT_THAT(typed("experiment ask study --participant p001", "").err,
              testing::HasSubstr("p001.csv:3:"));
  EXPECT_EQ(slurp(folder_ / path), whole + "p001,presence1,6,asked\np001,sick,9,asked");
}

TEST_F(StudyAnswers, OfPaperFormsAreCheckedBeforeAnyIsKept) {
  plan(3);
  const auto forms = [&](const std::string& text) { std::ofstream(folder_ / "f.csv") << text; };
  forms("participant;sick;noticed\np001;3;yes\np002;8;no\n");
  expect_refusal("experiment ask study --from f.csv", 1, "f.csv:3: expected for sick");
  EXPECT_FALSE(fs::exists(folder_ / "study/answers/p001.csv"));
  forms("participant;sick;noticed\np001;3;yes\np002;7;no\n");
  EXPECT_EQ(json("experiment ask study --from f.csv --json")["new_answers"], 4);
  EXPECT_EQ(json("experiment ask study --from f.csv --json")["new_answers"], 0);
  EXPECT_EQ(table("study/answers/p002.csv")[0]["source"], "form");
  forms("participant,item,answer\np003,sick,1\np001,sick,4\n");
  expect_refusal("experiment ask study --from f.csv", 1,
                 "p001 has answered 3 to sick; f.csv says 4");
  EXPECT_FALSE(fs::exists(folder_ / "study/answers/p003.csv"));

  // Nothing is added to a file of something else, or with other separators.
  forms("participant,sick\np003,1\n");
  for (const auto& [text, says] :
       {std::pair{"foo\n",
                  "study/answers/p003.csv:1: expected the columns participant, item, "
                  "answer, source, found 'foo'"},
        {"participant;item;answer;source\n", "p003.csv:1: expected commas between the columns"}}) {
    spit(folder_ / "study/answers/p003.csv", text);
    expect_refusal("experiment ask study --from f.csv", 1, says);
    EXPECT_EQ(slurp(folder_ / "study/answers/p003.csv"), text);
  }
}

// What the tables say of a session is what `replay` says of its trial.
TEST_F(StudyAnswers, AreScoredBesideWhatTheSessionsCameTo) {
  plan_short(3);
  ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
  ASSERT_EQ(json("experiment ask study --all --virtual --json")["new_answers"], 33);
  const nlohmann::json scored = json("experiment score study --jobs 2 --json");
  EXPECT_EQ(scored["counted"], 3);
  EXPECT_EQ(scored["of_virtual"], "yes");
  for (auto& row : table("study/tables/participants.csv")) {
    const std::string trial = "study/sessions/" + row["participant"] + "/run-01.lcmlog";
    const nlohmann::json again = json("replay --json " + trial);
    std::string said;
    const nlohmann::json info = json("info --json " + trial);
    for (const auto& event : info["events"]) {
      if (event["kind"] == "game_hash") said = event["detail"];
    }
    EXPECT_EQ(row["game_hash"], said);
    EXPECT_EQ(row["replays"], "yes");
    EXPECT_EQ(row["virtual"], "yes");
    for (const std::string colour : {"red", "blue"}) {
      const std::string version = colour == row["base_colour"] ? "base_" : "changed_";
      int points = 0, throws = 0;
      double speed = 0.0;
      for (const auto& game : again["games"]) {
        if (game["name"] == colour) points += game["points"].get<int>();
      }
      for (const auto& one : again["throws"]) {
        if (one["name"] != colour) continue;
        speed += one["release_speed_mps"].get<double>();
        ++throws;
      }
      EXPECT_EQ(row[version + "skittles"], std::to_string(points));
      EXPECT_EQ(row[version + "throws"], std::to_string(throws));
      EXPECT_NEAR(std::stod(row[version + "release_speed_mps"]), speed / throws, 1e-9);
      EXPECT_GT(std::stod(row[version + "hand_path_m"]), 3.0);  // from stand to lane and a swing
      EXPECT_LT(std::stod(row[version + "hand_path_m"]), 200.0);
    }
    EXPECT_EQ(row["planned_first"], row["played_first"]);
  }
  for (const char* name : {"table-2", "table-3", "table-4"}) {
    const Rows rows = table(std::string("study/tables/") + name + ".csv");
    EXPECT_EQ(rows[0].at("virtual"), "yes");
  }
  const std::string words = headpin("experiment score study").out;
  EXPECT_THAT(words, HasSubstr("3 of 3 participants count, all virtual"));
  EXPECT_THAT(words, HasSubstr("add up to 102"));
  // One person among them.
  ASSERT_EQ(headpin("experiment plan -o study --people 4").code, 0);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  ASSERT_EQ(headpin("experiment run study --participant p004 --trial t.lcmlog").code, 0);
  EXPECT_EQ(json("experiment score study --json")["not_counted"][0]["why_not"],
            "questions not answered");
  std::string answers = kAll;
  answers.replace(answers.find("n/a"), 3, "4");
  ASSERT_EQ(typed("experiment ask study --participant p004", answers).code, 0);
  expect_refusal("experiment score study", 2, "3 of 4 participants who count are virtual");
  EXPECT_EQ(json("experiment score study --only people --json")["of_virtual"], "no");
  EXPECT_EQ(json("experiment score study --mix --json")["of_virtual"], "mixed");
  EXPECT_EQ(table("study/tables/participants.csv")[3]["virtual"], "no");
  EXPECT_EQ(table("study/tables/participants.csv")[3]["score"], "3");
  expect_refusal("experiment ask study --participant p004 --virtual", 2,
                 "is no virtual participant");
}

TEST_F(StudyAnswers, WhoPlayedInAnotherOrderThanPlannedIsNamed) {
  ASSERT_EQ(headpin("experiment plan -o study --people 6").code, 0);
  ASSERT_EQ(headpin("synthesize --participant 7 --throws 1 --name Ann -o t.lcmlog").code, 0);
  // The trial has red first. Those who were to begin with blue are named, and count.
  std::vector<std::string> blue_first;
  for (const auto& row : table("study/plan.csv")) {
    if (row.at("game") == "1" && row.at("colour") == "blue")
      blue_first.push_back(row.at("participant"));
  }
  ASSERT_FALSE(blue_first.empty());
  for (const char* who : {"p001", "p002", "p003", "p004", "p005", "p006"}) {
    const bool other = std::ranges::count(blue_first, who) == 1;
    const Result run =
        headpin(fmt::format("experiment run study --participant {} --trial t.lcmlog", who));
    ASSERT_EQ(run.code, 0);
    EXPECT_EQ(run.err.find("run-01.lcmlog: began with the red version, in another order") !=
                  std::string::npos,
              other)
        << run.err;
  }
  const nlohmann::json status = json("experiment status study --json");
  for (const nlohmann::json& one : status["participants"]) {
    EXPECT_EQ(one["in_other_order"],
              std::ranges::count(blue_first, one["participant"].get<std::string>()) == 1);
  }
  EXPECT_THAT(headpin("experiment status study").out, HasSubstr(", in another order than planned"));
  EXPECT_EQ(json("experiment score study --json")["other_order"], blue_first);
  EXPECT_THAT(headpin("experiment score study").out,
              HasSubstr("played in another order than planned: " + blue_first.front()));
}

/// The plan with the rows of one participant changed.
std::string with_colours_exchanged(const std::string& plan, const std::string& participant) {
  std::istringstream lines(plan);
  std::string out, line;
  while (std::getline(lines, line)) {
    const auto exchange = [&](const std::string& one, const std::string& other) {
      const std::size_t at = line.find("," + one + ",");
      if (at != std::string::npos) line.replace(at + 1, one.size(), other);
      return at != std::string::npos;
    };
    if (line.starts_with(participant + ",") && !exchange("red", "blue")) exchange("blue", "red");
    out += line + "\n";
  }
  return out;
}

TEST_F(StudyAnswers, ASessionThatIsNotWhatThePlanHasDoesNotCount) {
  plan_short(2);
  ASSERT_EQ(headpin("experiment run study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(json("experiment score study --json")["counted"], 2);
  const auto expect_not = [&](const std::string& who, const std::string& why) {
    const nlohmann::json scored = json("experiment score study --json");
    EXPECT_EQ(scored["counted"], 1);
    ASSERT_EQ(scored["not_counted"].size(), 1u);
    EXPECT_EQ(scored["not_counted"][0]["participant"], who);
    EXPECT_THAT(scored["not_counted"][0]["why_not"].get<std::string>(), HasSubstr(why));
    EXPECT_THAT(headpin("experiment status study").out, HasSubstr(why));
    EXPECT_THAT(headpin("experiment status study").out, HasSubstr("--participant " + who));
  };
  const std::string as_planned = slurp(folder_ / "study/plan.csv");
  spit(folder_ / "study/plan.csv", with_colours_exchanged(as_planned, "p001"));
  expect_not("p001", "not as planned: version.red.");
  spit(folder_ / "study/plan.csv", as_planned);
  const std::filesystem::path sessions = folder_ / "study/sessions";
  std::filesystem::copy_file(sessions / "p001/run-01.lcmlog", sessions / "p002/run-01.lcmlog",
                             std::filesystem::copy_options::overwrite_existing);
  expect_not("p002", "not as planned: it is the session of p001");
  // Drawn answers need no session, but that is told.
  std::filesystem::remove_all(sessions / "p002");
  EXPECT_EQ(json("experiment score study --json")["not_played"][0], "p002");
  EXPECT_THAT(headpin("experiment score study").out,
              HasSubstr("without a session, by drawn answers alone: p002"));
}

/// What R made of the answers is what another program makes of them, and within its errors the
/// published model from which they were drawn.
void StudyAnswers::expect_the_published_model(int degrees_of_freedom) const {
  const std::string refit = "python3 " HEADPIN_SOURCE_DIR "/tests/apps/refit.py '" +
                            (folder_ / "study/tables/participants.csv").string() + "' >'" +
                            (folder_ / "refit.csv").string() + "'";
  ASSERT_EQ(std::system(refit.c_str()), 0);
  std::map<std::string, std::pair<double, double>> other;
  std::istringstream lines(slurp(folder_ / "refit.csv"));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t a = line.find(','), b = line.rfind(',');
    other[line.substr(0, a)] = {std::stod(line.substr(a + 1, b - a - 1)),
                                std::stod(line.substr(b + 1))};
  }
  const Rows fitted = table("study/analysis/table-6.csv");
  ASSERT_EQ(fitted.size(), 10u);
  for (auto row : fitted) {
    const auto [estimate, error] = other.at(row["term"]);
    EXPECT_NEAR(std::stod(row["estimate"]), estimate, 1e-6) << row["term"];
    EXPECT_NEAR(std::stod(row["se"]), error, 1e-5) << row["term"];
    // The answers were drawn from the published model: it comes back within its errors.
    EXPECT_NEAR(estimate, std::stod(row["published"]), 4.0 * error) << row["term"];
    EXPECT_EQ(row["virtual"], "yes");
  }
  std::map<std::string, std::string> fit;
  for (auto row : table("study/analysis/fit.csv")) fit[row["quantity"]] = row["value"];
  EXPECT_NEAR(std::stod(fit["deviance"]), other["deviance"].first, 1e-6);
  EXPECT_EQ(fit["degrees_of_freedom"], std::to_string(degrees_of_freedom));
  EXPECT_EQ(fit["separated"], "no");
  EXPECT_NEAR(std::stod(fit["published_p"]), 0.12, 0.005);  // "between the 20% and 10% tail"
}

// R's glm and Newton's method on the likelihood, by a program that shares nothing with it.
TEST_F(StudyAnswers, AreFittedByRAsByAnotherProgram) {
  plan(300);
  ASSERT_EQ(json("experiment ask study --all --virtual --json")["participants"], 300);
  expect_refusal("experiment analyse study", 1, "headpin experiment score study");
  ASSERT_EQ(headpin("experiment score study").code, 0);
  const std::string before = slurp(folder_ / "study/tables/participants.csv");
  expect_refusal("experiment analyse study --only people", 1,
                 "study/tables/participants.csv: nobody counts with --only people; expected at "
                 "least one person");
  const Result without = headpin("experiment analyse study");
  if (!has_r()) {
    EXPECT_EQ(without.code, 1);
    EXPECT_THAT(without.err, HasSubstr("apt install r-base-core"));
    GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
  }
  ASSERT_EQ(without.code, 0) << without.err;
  EXPECT_THAT(without.out, HasSubstr("vrbefore(2)"));
  EXPECT_THAT(without.out, HasSubstr("NO earlier experience"));
  expect_the_published_model(290);
  // It says from which table it is, so that `report` leaves it out beside another one.
  EXPECT_EQ(std::system(("cd '" + (folder_ / "study/analysis").string() +
                         "' && sha256sum --quiet -c made-from.txt")
                            .c_str()),
            0);
  EXPECT_THAT(slurp(folder_ / "study/analysis/effects.svg"), HasSubstr("<svg"));
  EXPECT_THAT(slurp(folder_ / "study/analysis/scores.png"), testing::StartsWith("\x89PNG"));
  // The script is the laboratory's: what it changes stays and is run.
  std::ofstream(folder_ / "study/model.R", std::ios::app)
      << "\nwriteLines('mine', to('own.txt'))\n";
  const nlohmann::json again = json("experiment analyse study --json");
  EXPECT_EQ(again["script_changed"], true);
  EXPECT_EQ(slurp(folder_ / "study/analysis/own.txt"), "mine\n");
  std::ofstream(folder_ / "study/model.R", std::ios::app) << "\nstop('too few')\n";
  expect_refusal("experiment analyse study", 1, "study/model.R: R stopped: ");
  EXPECT_THAT(headpin("experiment analyse study").err, HasSubstr("too few Execution halted\n"));
  EXPECT_EQ(slurp(folder_ / "study/analysis/own.txt"), "mine\n");
  EXPECT_EQ(slurp(folder_ / "study/tables/participants.csv"), before);
}

TEST_F(StudyAnswers, OfTwoThousandGiveThePublishedModelBack) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
  plan(2000);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  ASSERT_EQ(headpin("experiment analyse study").code, 0);
  expect_the_published_model(1990);
}

// A term that all the high answers go with has no finite estimate; R alone would print 20 and 7000.
TEST_F(StudyAnswers, ThatSeparateAreSaidToAndHaveBiasReducedEstimates) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
  plan(18);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  // Friction changes: all answers are high where E is 0, none where it is 1.
  for (auto row : table("study/plan.csv")) {
    if (row["changed"] != "friction") continue;
    const fs::path path = folder_ / ("study/answers/" + row["participant"] + ".csv");
    std::string text = slurp(path);
    for (int item = 1; item <= 6; ++item) {
      const std::size_t at = text.find("presence" + std::to_string(item) + ",") + 10;
      text[at] = row["cell"][0] == '0' ? '7' : '1';
    }
    std::ofstream(path) << text;
  }
  ASSERT_EQ(headpin("experiment score study").code, 0);
  EXPECT_THAT(json("experiment analyse study --json")["endless_terms"],
              testing::Contains("change(2).E"));
  for (auto row : table("study/analysis/table-6.csv")) {
    if (row["term"] != "change(2).E") continue;
    EXPECT_EQ(row["endless"], "yes");
    if (row["bias_reduced"] == "n/a") continue;  // without r-cran-brglm2
    EXPECT_LT(std::stod(row["bias_reduced"]), -2.0);
    EXPECT_GT(std::stod(row["bias_reduced"]), -15.0);
  }
}

// Everybody has exactly one of the three changes, so beside a constant one of them says nothing new. The
// estimates of the others are finite all the same.
TEST_F(StudyAnswers, WithATermThatSaysNothingNewHaveFiniteEstimates) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
  std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
  text.insert(text.find("[[term]]"), "[[term]]\nname = 'const'\nestimate = 0.0\n\n");
  spit(folder_ / "const.toml", text);
  plan(100, " --design const.toml");
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  EXPECT_EQ(json("experiment analyse study --json")["endless_terms"], nlohmann::json::array());
  const Rows rows = table("study/analysis/table-6.csv");
  ASSERT_EQ(rows.size(), 11u);
  for (const auto& row : rows) {
    EXPECT_EQ(row.at("endless"), "no") << row.at("term");
    EXPECT_EQ(row.at("estimate") == "n/a", row.at("term") == "change(3)") << row.at("term");
  }
  EXPECT_EQ(table("study/analysis/fit.csv").at(1).at("value"), "10");  // coefficients
}

// One participant, and more terms: the fit is exact, and there is no p that could speak against it.
TEST_F(StudyAnswers, ThatAreFittedExactlyHaveNoPValue) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
  plan(1);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  ASSERT_EQ(headpin("experiment analyse study").code, 0);
  std::map<std::string, std::string> fit;
  for (auto& row : table("study/analysis/fit.csv")) fit[row["quantity"]] = row["value"];
  EXPECT_EQ(fit["degrees_of_freedom"], "0");
  EXPECT_EQ(fit["p"], "n/a");
  EXPECT_EQ(fit["pearson_over_df"], "n/a");
  EXPECT_NE(fit["published_p"], "n/a");
}

TEST_F(StudyAnswers, PowerIsATableOfSharesAndTheSameForTheSameSeed) {
  const std::string line = "experiment power --people 18,36 --studies 20 --seed 3 ";
  const nlohmann::json power = json(line + "--json -o power.csv");
  EXPECT_EQ(json(line + "--json --jobs 2"), power);
  ASSERT_EQ(power["power"].size(), 2u);
  for (const auto& row : power["power"]) {
    EXPECT_EQ(row["terms"].size(), 10u);
    for (const auto& term : row["terms"]) {
      EXPECT_GE(term["found"], 0.0);
      EXPECT_LE(term["found"], 1.0 + 1e-9);
    }
  }
  EXPECT_EQ(table("power.csv").size(), 20u);
  EXPECT_THAT(headpin(line + "-o power.svg").out, HasSubstr("vrbefore(2)"));
  EXPECT_THAT(slurp(folder_ / "power.svg"), HasSubstr(">change(2).E<"));
  expect_refusal("experiment power --design elasticity-friction-shape", 2, "no published model");
}

// Where many are asked, power has a closed form (tests/apps/power.py); where a term has no effect, it
// is found by chance, 5 %.
TEST_F(StudyAnswers, PowerIsThatOfTheLikelihoodRatiosOwnDistribution) {
  constexpr int kStudies = 300;
  constexpr double kOfManyPeople = 0.02;  // the distribution is that of infinitely many
  plan(2016);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  ASSERT_EQ(headpin("experiment score study").code, 0);
  ASSERT_EQ(std::system(("cd '" + folder_.string() +
                         "' && python3 -B '" HEADPIN_SOURCE_DIR
                         "/tests/apps/power.py' study/tables/participants.csv 144 >law.csv")
                            .c_str()),
            0);
  std::map<std::string, double> law;
  std::ifstream lines(folder_ / "law.csv");
  for (std::string term, power; std::getline(lines, term, ',') && std::getline(lines, power);) {
    law[term] = std::stod(power);
  }
  ASSERT_EQ(law.size(), 10u);
  const auto within = [](double share) {
    return kOfManyPeople + 3.5 * std::sqrt(share * (1.0 - share) / kStudies);
  };
  const nlohmann::json power =
      json("experiment power --people 144 --seed 5 --json --studies " + std::to_string(kStudies));
  for (const auto& term : power["power"][0]["terms"]) {
    const double share = law.at(term["term"]);
    EXPECT_NEAR(term["found"], share, within(share)) << term["term"];
    EXPECT_NEAR(term["found_without"], 0.05, within(0.05)) << term["term"];
  }
}

}  // namespace
}  // namespace headpin
