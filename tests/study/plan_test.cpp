// Plans as they are written, and as people and spreadsheets change them.

#include "study/plan.h"

#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "study/design_checks.h"
#include "study/model.h"
#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

using testing::HasSubstr;

class PlanTable : public testing::Test {
 protected:
  PlanTable() { extend(plan_, design_, 7, 18); }

  static std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  static std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
  }
  std::string says(const std::string& text) const {
    return complaint([&] { parse_plan(text, "plan.csv", design_); });
  }
  /// What is said when in the row of that line one cell is another.
  std::string says_with(std::size_t line, std::size_t column, const std::string& cell) const {
    std::vector<std::string> all = lines(to_csv(plan_, design_));
    const CsvTable table = parse_csv(joined(all), "plan.csv");
    std::vector<std::string> cells = table.rows[line - 2].cells;
    cells[column] = cell;
    all[line - 1] = csv_line(cells);
    all[line - 1].pop_back();
    return says(joined(all));
  }

  const Design design_ = bundled_design();
  Plan plan_;
};

// Table 1: elasticity 1.0 or 0.7, friction 0.0 or 0.7, ellipsoid or true shape; what changes is the
// other of the two.
TEST_F(PlanTable, EveryValueIsSpelledOut) {
  const CsvTable table = parse_csv(to_csv(plan_, design_), "plan.csv");
  ASSERT_EQ(table.rows.size(), 36u);
  for (const CsvRow& row : table.rows) {
    const std::string& cell = table.cell(row, "cell");
    const auto expected = [&](const char* key, std::size_t at, const char* zero, const char* one) {
      bool is_one = cell[at] == '1';
      if (table.cell(row, "version") == "changed" && table.cell(row, "changed") == key) {
        is_one = !is_one;
      }
      EXPECT_EQ(table.cell(row, key), is_one ? one : zero) << row.line;
    };
    expected("elasticity", 0, "1", "0.7");
    expected("friction", 1, "0", "0.7");
    expected("shape", 2, "ellipsoid", "true");
  }
}

TEST_F(PlanTable, RowsInAnotherOrderAreTheSamePlan) {
  std::vector<std::string> all = lines(to_csv(plan_, design_));
  std::mt19937 random(5);
  std::shuffle(all.begin() + 1, all.end(), random);
  Plan read = parse_plan(joined(all), "plan.csv", design_);
  std::ranges::sort(read, {}, &PlannedParticipant::id);
  EXPECT_EQ(read, plan_);
}

TEST_F(PlanTable, WhatASpreadsheetMakesOfItIsTheSamePlan) {
  std::string text = "\xef\xbb\xbf";
  for (std::string line : lines(to_csv(plan_, design_))) {
    std::ranges::replace(line, ',', ';');
    std::ranges::replace(line, '.', ',');
    for (const char* cell : {";000;", ";010;", ";001;", ";011;"}) {  // numbers to a spreadsheet
      const std::size_t at = line.find(cell);
      if (at == std::string::npos) continue;
      const std::string digits = std::to_string(std::stoi(std::string(cell).substr(1, 3)));
      line.replace(at, 5, ";" + digits + ";");
    }
    text += line + "\r\n";
  }
  EXPECT_EQ(parse_plan(text, "plan.csv", design_), plan_);
}

TEST_F(PlanTable, TruthInCapitalsIsTruth) {
  std::string text;
  int values = 0;
  for (std::string line : lines(to_csv(plan_, design_))) {
    const std::size_t at = line.find(",true,");
    if (at != std::string::npos) line.replace(at, 6, ++values % 2 == 0 ? ",TRUE," : ",True,");
    text += line + "\n";
  }
  EXPECT_GT(values, 2);
  EXPECT_EQ(parse_plan(text, "plan.csv", design_), plan_);
}

// A laboratory adds columns, anywhere: what it wrote there stays with participant and game.
TEST_F(PlanTable, ColumnsThatAreNotThePlansAreKept) {
  std::vector<std::string> all = lines(to_csv(plan_, design_));
  all[0] = "room," + all[0] + ",note";
  for (std::size_t i = 1; i < all.size(); ++i) {
    all[i] = fmt::format("r{},{},\"n, {}\"", i, all[i], i);
  }
  std::mt19937 random(5);
  std::shuffle(all.begin() + 1, all.end(), random);
  const CsvTable before = parse_csv(joined(all), "plan.csv");
  Plan plan = parse_plan(joined(all), "plan.csv", design_);
  std::ranges::sort(plan, {}, &PlannedParticipant::id);
  replace(plan, "p003");
  const std::vector<std::string> now = lines(to_csv(plan, design_, before));
  const std::vector<std::string> plain = lines(to_csv(plan, design_));
  ASSERT_EQ(now.size(), 39u);
  EXPECT_EQ(now[0], plain[0] + ",room,note");
  for (std::size_t i = 1; i < 37; ++i) {
    EXPECT_EQ(now[i], fmt::format("{},r{},\"n, {}\"", plain[i], i, i));
  }
  for (const std::size_t i : {37u, 38u}) EXPECT_EQ(now[i], plain[i] + ",,");
  EXPECT_EQ(to_csv(plan, design_, parse_csv(to_csv(plan_, design_), "plan.csv")),
            to_csv(plan, design_));
}

// They are those of somebody who is no longer in the plan, with sessions and answers.
TEST_F(PlanTable, NamesThatAreTakenAreNotGivenAgain) {
  Plan plan = plan_;
  extend(plan, design_, 7, 20, {"P019", "p021", "x"});
  EXPECT_EQ(plan[18].id, "p020");
  EXPECT_EQ(plan[19].id, "p022");
  replace(plan, "p001", {"p021", "p023"});
  EXPECT_EQ(plan[20].id, "p024");
}

TEST_F(PlanTable, WhatIsWrongIsSaidWithFileLineAndWhatWasExpected) {
  const std::string text = to_csv(plan_, design_);
  const std::vector<std::string> all = lines(text);
  EXPECT_THAT(says(text + all[3] + "\n"),
              HasSubstr("plan.csv:38: column game: expected the other game of p002: this one is in "
                        "line 4, found '1'"));
  EXPECT_EQ(says(joined({all[0], all[1]})),
            "plan.csv:2: column game: expected two rows of p001, game 1 and game 2, found game 1 "
            "alone");
  EXPECT_THAT(says_with(5, 2, "020"),
              HasSubstr("plan.csv:5: column cell: expected a cell of the design (000, "));
  EXPECT_THAT(says_with(5, 3, "gravity"),
              HasSubstr("plan.csv:5: column changed: expected a parameter that changes"));
  EXPECT_EQ(says_with(5, 4, "3"), "plan.csv:5: column game: expected 1 or 2, found '3'");
  EXPECT_THAT(says_with(5, 6, "green"),
              HasSubstr("plan.csv:5: column colour: expected red or blue"));
  EXPECT_THAT(says_with(5, 7, "0.8"), HasSubstr("plan.csv:5: column elasticity: expected "));
  EXPECT_THAT(says_with(5, 1, "0"), HasSubstr("plan.csv:5: column place: expected a whole number"));
  // One of the two rows alone.
  EXPECT_NE(says_with(5, 6, "red") + says_with(5, 6, "blue"), "");
  for (const char* name : {"../x", "=cmd", "", "山田", "a b", "p001,x"}) {
    EXPECT_THAT(says_with(4, 0, name),
                HasSubstr("plan.csv:4: column participant: expected the name of a participant"))
        << name;
  }
  EXPECT_THAT(says_with(4, 0, std::string(300, 'a')), HasSubstr("plan.csv:4:"));
  EXPECT_LT(says_with(4, 0, std::string(300, 'a')).size(), 200u);
  EXPECT_THAT(says_with(4, 0, "P001"), HasSubstr("in more than capitals"));
}

TEST_F(PlanTable, WhatTheTwoGamesOfAParticipantDisagreeAboutIsNamedByItsColumn) {
  EXPECT_EQ(says_with(2, 1, "99"),
            "plan.csv:3: column place: expected 99 as in line 2 (the other game of p001), found 1");
  EXPECT_EQ(says_with(5, 10, "p001"),
            "plan.csv:5: column replaces: expected nothing as in line 4 (the other game of p002), "
            "found p001");
  const std::vector<std::string> all = lines(to_csv(plan_, design_));
  const bool red = all[3].find(",red,") != std::string::npos;
  EXPECT_EQ(says_with(5, 6, red ? "red" : "blue"),
            fmt::format("plan.csv:5: column colour: expected another one than in line 4 (the other "
                        "game of p002), found '{}'",
                        red ? "red" : "blue"));
}

TEST_F(PlanTable, NobodyReplacesHimselfOrWhoIsNotInThePlan) {
  for (const char* name : {"p001", "p999"}) {
    std::vector<std::string> all = lines(to_csv(plan_, design_));
    all[1] += name;
    all[2] += name;
    EXPECT_EQ(says(joined(all)),
              fmt::format("plan.csv:2: column replaces: expected another participant of the plan, "
                          "found '{}'",
                          name));
  }
}

// p001 replaced by another, who is replaced by p001: somebody must have been there first.
TEST_F(PlanTable, NobodyIsReplacedByWhoCameBefore) {
  Plan plan = plan_;
  replace(plan, "p001");
  replace(plan, plan.back().id);
  EXPECT_EQ(says(to_csv(plan, design_)), "");
  plan[0].replaces = plan.back().id;
  EXPECT_EQ(says(to_csv(plan, design_)),
            fmt::format("plan.csv:2: column replaces: expected a participant who was there before "
                        "p001, found '{}'",
                        plan.back().id));
}

TEST(Designs, WhatIsWrongIsSaidWithFileAndLine) {
  const std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/designs/uno-slater-1997.toml");
  const auto says = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    changed.replace(at, from.size(), to);
    return complaint([&] { parse_design(changed, "d.toml"); });
  };
  EXPECT_EQ(says("people = 2", "people = 3"), "");
  EXPECT_THAT(says("people = 2", "people = 0"),
              HasSubstr("row.people must be a whole number from 1"));
  EXPECT_THAT(says("cell = '000'", "cell = '0000'"), HasSubstr("row.cell must be 3 digits"));
  EXPECT_THAT(says("changed = 'shape'", "changed = 'gravity'"),
              HasSubstr("row.changed must be the key of a factor: elasticity, friction, shape"));
  EXPECT_THAT(says("letter = 'F'", "letter = 'E'"), HasSubstr("factor.letter must be another one"));
  EXPECT_THAT(says("levels = [0.0, 0.7]", "levels = [0.7, 0.7]"),
              HasSubstr("factor.levels must be two different values, found [0.7, 0.7]"));
  EXPECT_THAT(says("key = 'shape'", "key = 'colour'"), HasSubstr("factor.key must be"));
  EXPECT_THAT(says("throws = 10", "thorws = 10"),
              HasSubstr("d.toml:7: unknown key 'thorws'; the nearest is throws"));
  EXPECT_THAT(says("name = 'F'", "name = 'sick'"), HasSubstr("term.name must be another name"));
  EXPECT_THAT(says("[[row]]", "[[row"), HasSubstr("not TOML"));
  EXPECT_THAT(says("cell = '000'", "cell = '000'\nsex = 1"),
              HasSubstr("unknown key 'row.sex'; known here: cell, changed, people"));
  const std::size_t published = text.find("[[published]]");
  const std::string block = text.substr(published, text.find("[[", published + 2) - published);
  EXPECT_THAT(says(block, block + block), HasSubstr("published.item must be another one"));
  EXPECT_EQ(says("counts = {yes = 7,", "counts = {yes = -7,"),
            "d.toml:161: published.counts.yes must be a whole number from 0 on, found -7");
}

Term term(const std::string& name, const std::string& of, const std::string& is = "") {
  Term one;
  one.name = name;
  one.of = of;
  one.is = is;
  return one;
}

TEST(Designs, HaveItemsThatTablesCanHave) {
  const Design design = bundled_design();
  const std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/questionnaires/uno-slater-1997.toml");
  const auto says = [&](const Design& one, const std::string& from = "",
                        const std::string& to = "") {
    std::string changed = text;
    if (!from.empty()) changed.replace(changed.find(from), from.size(), to);
    return complaint([&] { check_items(one, parse_questionnaire(changed, "q.toml"), "d.toml"); });
  };
  EXPECT_EQ(says(design), "");
  Design other = design;
  std::erase_if(other.published, [](const auto& one) { return one.item == "occupation"; });
  EXPECT_THAT(says(other, "id = 'occupation'", "id = 'place'"), HasSubstr("an item 'place'"));
  other = design;
  other.terms.push_back(term("F2", "F", "2"));
  EXPECT_THAT(says(other), HasSubstr("term.is must be 0 or 1, a level of the factor, found '2'"));
  other = design;
  other.terms.push_back(term("before", "vrbefore"));
  EXPECT_THAT(says(other), HasSubstr("term.of must be with `is`"));
  // A virtual participant without the answer would have no value of the term.
  other = design;
  const auto sick = std::ranges::find(other.published, "sick", &PublishedAnswers::item);
  sick->counts.emplace_back("n/a", 1);
  EXPECT_THAT(says(other), HasSubstr("a name in published.counts must be an answer of item 'sick', "
                                     "because a term uses it, found 'n/a'"));
  EXPECT_THAT(
      complaint([&] {
        for (int i = 0; i < 40; ++i) {
          draw_answers(other, bundled_questions(), 1, {std::to_string(i), i, allot(other, 1, i)});
        }
      }),
      HasSubstr("published.counts has n/a for an item that a term uses"));
  other = design;
  std::ranges::find(other.published, "occupation", &PublishedAnswers::item)
      ->counts.emplace_back("n/a", 1);
  EXPECT_EQ(says(other), "");
}

// A level that is 1 where another is 0; of others, an answer is not asked for.
TEST(Designs, ATermMayBeOfTheOtherLevelAndOfSomePeople) {
  Design design = bundled_design();
  const Term one = term("F", "F"), zero = term("F0", "F", "0");
  for (std::size_t row = 0; row < design.rows.size(); ++row) {
    Allotted allotted;
    allotted.row = row;
    EXPECT_EQ(*value_of(one, design, allotted, {}) + *value_of(zero, design, allotted, {}), 1.0);
  }
  EXPECT_EQ(in_r(zero, design), "1 * (p$F == \"0\")");
  Term some = term("s", "sick");
  some.changed = 1;
  EXPECT_EQ(in_r(some, design), "ifelse(p$changed == \"friction\", p$sick, 0)");
}

// Each of these hides a key that must be given.
TEST(Designs, AnUnknownKeyIsToldBeforeAMissingOne) {
  const std::string begin = "name = 'd'\nscenario = 's'\nquestionnaire = 'q'\n";
  const auto says = [&](const std::string& rest) {
    return complaint([&] { parse_design(begin + rest, "d.toml"); });
  };
  EXPECT_EQ(says("[[faktor]]\nletter = 'E'"),
            "d.toml:4: unknown key 'faktor'; the nearest is factor");
  EXPECT_EQ(says("[[factor]]\nleter = 'E'"),
            "d.toml:5: unknown key 'factor.leter'; the nearest is factor.letter");
  EXPECT_EQ(says("[[term]]\nname = 'E'\nestimat = 1"),
            "d.toml:6: unknown key 'term.estimat'; the nearest is term.estimate");
  EXPECT_EQ(says("people = 3"), "d.toml:4: unknown key 'people'; the nearest is row.people");
  EXPECT_EQ(says(""), "d.toml:1: factor must be 1 to 5 tables, found nothing");
}

TEST(Questionnaires, WhatIsWrongIsSaidWithFileAndLine) {
  const std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/questionnaires/uno-slater-1997.toml");
  const auto says = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return complaint([&] { parse_questionnaire(changed, "q.toml"); });
  };
  EXPECT_THAT(says("id = 'presence2'", "id = 'presence1'"), HasSubstr("item.id must be another"));
  EXPECT_THAT(says("id = 'presence2'", "id = 'two words'"), HasSubstr("item.id must be 1 to 32"));
  EXPECT_THAT(says("id = 'sick'", "id = 'next'"), HasSubstr("item.id must be another word"));
  EXPECT_THAT(says("high = 7", "high = 1"), HasSubstr("item.high must be a whole number from 2"));
  EXPECT_THAT(says("counts_from = 6", "counts_from = 8"), HasSubstr("item.counts_from must be"));
  EXPECT_THAT(says("'en', 'de'", "'en', 'de', 'ja'"),
              HasSubstr(": item.text has no text for the language 'ja'"));
  EXPECT_EQ(says("'en', 'de'", ""),
            "q.toml:6: languages must be a list of one value or more, found []");
  EXPECT_THAT(says("id = 'presence2'", "id = 'presence2'\nlow_and = 1"),
              HasSubstr("unknown key 'item.low_and'; the nearest is item.low_end"));
  EXPECT_THAT(says("id = 'noticed'", "id = 'noticed'\nlow = 1"),
              HasSubstr("unknown key 'item.low'; known here: answer, id, text"));
}

// The answer that is typed would be taken for the first of the two.
TEST(Questionnaires, HaveChoicesThatNobodyTakesForOneAnother) {
  const auto says = [](const std::string& first, const std::string& second) {
    const std::string begin =
        "name = 'q'\nlanguages = ['en', 'de']\n[[item]]\nid = 'a'\ntext = {en = 'A', de = 'A'}\n";
    return complaint([&] {
      parse_questionnaire(begin + "[[item.answer]]\n" + first + "\n[[item.answer]]\n" + second,
                          "q.toml");
    });
  };
  const std::string low = "id = 'low'\ntext = {en = 'less', de = 'weniger'}";
  EXPECT_EQ(says(low, "id = 'high'\ntext = {en = 'more', de = 'mehr'}"), "");
  EXPECT_EQ(says(low, "id = 'high'\ntext = {en = 'Low', de = 'mehr'}"),
            "q.toml:11: item.answer.text must differ from id and texts of the answer 'low'; both "
            "have 'low', in small or capital letters");
  EXPECT_THAT(says(low, "id = 'less'\ntext = {en = 'more', de = 'mehr'}"),
              HasSubstr("both have 'less'"));
  EXPECT_THAT(says(low, "id = 'high'\ntext = {en = 'weniger', de = 'mehr'}"),
              HasSubstr("both have 'weniger'"));
}

// Appendix A has six questions, answered from 1 to 7, of which 6 and 7 count.
TEST(Questionnaires, ThePapersHasSixItemsThatCount) {
  const Questionnaire questions = bundled_questions();
  EXPECT_EQ(questions.scored(), 6);
  const Item& item = *questions.find("presence3");
  EXPECT_EQ(answer_of(item, "7"), "7");
  for (const char* wrong : {"8", "0", "", "six", "6.5", "6 7", "-1"}) {
    EXPECT_EQ(answer_of(item, wrong), std::nullopt) << wrong;
  }
  EXPECT_EQ(answer_of(item, "n/a"), "n/a");
  EXPECT_EQ(answer_of(*questions.find("vrbefore"), "Ja"), "yes");
  EXPECT_EQ(answer_of(*questions.find("vrbefore"), "perhaps"), std::nullopt);
}

}  // namespace
}  // namespace headpin::study
