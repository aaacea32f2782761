// Answers as they are kept, typed in from paper, counted, and drawn.

#include "study/answers.h"

#include <cmath>

#include <gmock/gmock.h>

#include "study/csv.h"
#include "study/model.h"
#include "study/paper_tables.h"
#include "study/people.h"
#include "study/report.h"
#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

using testing::HasSubstr;

class AnswerTable : public testing::Test {
 protected:
  std::string says(const std::string& rows) const {
    return complaint(
        [&] { parse_answers(answers_heading() + rows, "p001.csv", questions_, "p001"); });
  }
  std::string forms_say(const std::string& text) const {
    return complaint([&] { parse_forms(text, "forms.csv", questions_, {"p001", "p002"}); });
  }
  const Questionnaire questions_ = bundled_questions();
  const Design design_ = bundled_design();
};

TEST_F(AnswerTable, WhatIsWrongIsSaidWithFileLineAndWhatWasExpected) {
  EXPECT_EQ(says("p001,presence1,7,asked\n"), "");
  EXPECT_THAT(says("p001,presence1,8,asked\n"),
              HasSubstr("p001.csv:2: expected for presence1 a whole number from 1 to 7, or n/a, "
                        "found '8'"));
  EXPECT_THAT(says("p001,presence1,,asked\n"), HasSubstr("found ''"));
  EXPECT_THAT(says("p001,presence1,six,asked\n"), HasSubstr("found 'six'"));
  EXPECT_THAT(says("p001,presence9,6,asked\n"), HasSubstr("expected an item of the questionnaire"));
  EXPECT_THAT(says("p002,presence1,6,asked\n"), HasSubstr("expected answers of p001"));
  EXPECT_THAT(says("p001,presence1,6,guessed\n"), HasSubstr("expected asked, form or drawn"));
  EXPECT_THAT(says("p001,sick,6,asked\np001,sick,5,asked\n"),
              HasSubstr("p001.csv:3: expected one answer to sick; 6 is given already, found '5'"));
}

// Answers are added to the file as its columns stand.
TEST_F(AnswerTable, OtherColumnsAreRefused) {
  const auto of = [&](const std::string& text) {
    return complaint([&] { parse_answers(text, "p001.csv", questions_, "p001"); });
  };
  EXPECT_EQ(of("foo\n"),
            "p001.csv:1: expected the columns participant, item, answer, source, found 'foo'");
  EXPECT_THAT(of("participant,item,answer,source,note\n"), HasSubstr("expected the columns"));
  EXPECT_THAT(of("participant,answer,item,source\n"), HasSubstr("expected the columns"));
  EXPECT_EQ(of(answers_heading()), "");
  EXPECT_EQ(of(""), "");
}

TEST_F(AnswerTable, FormsAreTakenWideAndLong) {
  const auto wide = parse_forms("participant;sick;noticed\np001;3;Yes\np002;n/a;nein\n", "f.csv",
                                questions_, {"p001", "p002"});
  const auto tall = parse_forms(
      "participant,item,answer\np001,sick,3\np002,sick,n/a\np001,noticed,yes\np002,noticed,no\n",
      "f.csv", questions_, {"p001", "p002"});
  EXPECT_EQ(wide, tall);
  EXPECT_EQ(find(wide.at("p002"), "noticed")->answer, "no");
  EXPECT_THAT(forms_say("participant,sick\np001,8\n"), HasSubstr("forms.csv:2: expected for sick"));
  EXPECT_THAT(forms_say("participant,sick\np001,\n"), HasSubstr("or n/a, found ''"));
  EXPECT_THAT(forms_say("participant,dizzy\np001,1\n"), HasSubstr("forms.csv:1: expected an item"));
  EXPECT_THAT(forms_say("participant,sick\n../x,1\n"), HasSubstr("expected a participant of the"));
  EXPECT_THAT(forms_say("participant,sick\np001,1\np001,2\n"),
              HasSubstr("forms.csv:3: expected one row a participant"));
  EXPECT_THAT(forms_say("name,sick\np001,1\n"), HasSubstr("expected a column 'participant'"));
}

// "the number of high ('6' or '7') answers over the six questions"
TEST_F(AnswerTable, TheScoreIsTheNumberOfSixesAndSevens) {
  const std::array<const char*, 6> given = {"6", "7", "5", "1", "6", "4"};
  Answers answers;
  for (std::size_t i = 0; i < given.size(); ++i) {
    answers.push_back({"presence" + std::to_string(i + 1), given[i], kAsked});
  }
  answers.push_back({"sick", "7", kAsked});  // is none of them
  EXPECT_EQ(score_of(questions_, answers), 3);
  answers[1].answer = kNoAnswer;
  EXPECT_EQ(score_of(questions_, answers), std::nullopt);
  answers.erase(answers.begin() + 1);
  EXPECT_EQ(score_of(questions_, answers), std::nullopt);
}

// Table 5: for somebody whose friction changes the predictor is const - 0.7 sick + 3.8 S - 3.8 E, for
// the others const - 0.7 sick + 2.1 F; Table 6 has the numbers.
TEST_F(AnswerTable, TheLinearPredictorIsTableSix) {
  const auto eta = [&](const char* cell, const char* changed, const char* sick,
                       const char* before) {
    for (std::size_t row = 0; row < design_.rows.size(); ++row) {
      if (design_.rows[row].cell != cell ||
          design_.factors[design_.rows[row].changed].key != changed) {
        continue;
      }
      const Answers answers = {{"sick", sick, kAsked}, {"vrbefore", before, kAsked}};
      const double p =
          published_probability(design_, values_of(design_, {row, false, false}, answers).value());
      return std::log(p / (1.0 - p));
    }
    throw std::runtime_error("no such row");
  };
  EXPECT_NEAR(eta("000", "elasticity", "1", "yes"), 1.501 - 0.698, 1e-9);
  EXPECT_NEAR(eta("011", "elasticity", "4", "no"), 1.501 + 2.112 - 4 * 0.698 - 1.580 - 1.496, 1e-9);
  EXPECT_NEAR(eta("101", "friction", "2", "no"), -0.9969 - 2 * 0.698 - 1.580 + 3.786 - 3.836, 1e-9);
  EXPECT_NEAR(eta("110", "shape", "7", "yes"), 0.7149 + 2.112 - 7 * 0.698 - 0.5273, 1e-9);
}

class DrawnAnswers : public AnswerTable {
 protected:
  std::vector<Person> drawn(int people, std::uint64_t seed) const {
    Plan plan;
    extend(plan, design_, seed, people);
    std::vector<Person> all;
    for (const PlannedParticipant& one : plan) {
      all.push_back(
          {.planned = one, .answers = draw_answers(design_, questions_, seed, one), .played = {}});
    }
    return all;
  }
};

// Table 3 in counts (28 % of 18 is 5), Table 4 as it is printed, 7 of 18 with earlier VR, 12 men.
TEST_F(DrawnAnswers, EighteenHaveThePapersMargins) {
  for (const std::uint64_t seed : {3u, 4u}) {
    const std::vector<Person> people = drawn(18, seed);
    const auto tables = paper_tables(design_, questions_, people, "yes");
    ASSERT_EQ(tables.size(), 3u);
    const int counts[] = {5, 5, 3, 0, 3, 1, 1}, percents[] = {28, 28, 17, 0, 17, 6, 6};
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_EQ(tables[1].rows[i][1], std::to_string(counts[i]));
      EXPECT_EQ(tables[1].rows[i][2], std::to_string(percents[i]));
      EXPECT_EQ(tables[1].rows[i][1], tables[1].rows[i][3]);
    }
    EXPECT_EQ(tables[1].rows[7][2], "102");  // as in the paper
    const std::vector<std::string> noticed = {"elasticity", "yes", "3", "3", "yes"};
    EXPECT_EQ(tables[2].rows[0], noticed);
    const int four[] = {3, 3, 6, 0, 0, 6};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(tables[2].rows[i][2], std::to_string(four[i]));
    int before = 0, men = 0;
    for (const Person& one : people) {
      before += find(one.answers, "vrbefore")->answer == "yes";
      men += find(one.answers, "sex")->answer == "male";
      EXPECT_TRUE(one.is_virtual());
      EXPECT_EQ(why_not(design_, questions_, one), "");
    }
    EXPECT_EQ(before, 7);
    EXPECT_EQ(men, 12);
  }
}

// Each high answer is a Bernoulli draw, so of n of them sum(high - p) has the variance sum p (1 - p).
TEST_F(DrawnAnswers, AreHighAsOftenAsTheModelSays) {
  double excess = 0.0, variance = 0.0;
  for (const Person& one : drawn(900, 11)) {
    const double p = published_probability(
        design_, values_of(design_, one.planned.allotted, one.answers).value());
    excess += score_of(questions_, one.answers).value() - 6.0 * p;
    variance += 6.0 * p * (1.0 - p);
  }
  EXPECT_LT(std::abs(excess), 4.0 * std::sqrt(variance));
  EXPECT_GT(variance, 100.0);
}

TEST_F(DrawnAnswers, DependOnSeedAndPersonAlone) {
  const auto few = drawn(5, 3), many = drawn(60, 3), others = drawn(5, 4);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(few[i].answers, many[i].answers);
  EXPECT_NE(few[0].answers, others[0].answers);
  const Design without = bundled_design("elasticity-friction-shape");
  Plan plan;
  extend(plan, without, 1, 1);
  EXPECT_THAT(complaint([&] { draw_answers(without, questions_, 1, plan[0]); }),
              HasSubstr("no published model"));
}

TEST_F(DrawnAnswers, TheTableOfParticipantsHasARowAPersonAndADictionary) {
  const std::vector<Person> people = drawn(18, 3);
  const CsvTable table = parse_csv(people_csv(design_, questions_, people), "participants.csv");
  const auto columns = people_columns(design_, questions_);
  ASSERT_EQ(table.columns.size(), columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    EXPECT_EQ(table.columns[i], columns[i].name);
    EXPECT_FALSE(columns[i].meaning.empty()) << columns[i].name;
  }
  ASSERT_EQ(table.rows.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) {
    EXPECT_EQ(table.cell(table.rows[i], "virtual"), "yes");
    EXPECT_EQ(table.cell(table.rows[i], "score"),
              std::to_string(score_of(questions_, people[i].answers).value()));
    const std::string efs = table.cell(table.rows[i], "E") + table.cell(table.rows[i], "F") +
                            table.cell(table.rows[i], "S");
    EXPECT_EQ(efs, table.cell(table.rows[i], "cell"));
  }
}

// R names the letters of every picture alike: two of them in one document would share them.
TEST_F(DrawnAnswers, PicturesOfAReportAreDocumentsOfTheirOwn) {
  ReportParts parts{.tables = {}, .pictures = {}, .pages = {}};
  parts.pictures = {"<svg><g id=\"glyph0-1\"/>50 %</svg>", "<svg><g id=\"glyph0-1\"/></svg>"};
  const std::string page = html_report(design_, questions_, drawn(2, 3), parts);
  EXPECT_THAT(page, testing::Not(HasSubstr("id=\"glyph0-1\"")));
  EXPECT_THAT(page, HasSubstr("src=\"data:image/svg+xml,%3Csvg%3E%3Cg id=%22glyph0-1%22/%3E50 "
                              "%25%3C/svg%3E\""));
}

TEST_F(DrawnAnswers, WhoDoesNotCountSaysWhy) {
  Person one = drawn(1, 3)[0];
  for (Answer& answer : one.answers) answer.source = kAsked;
  EXPECT_EQ(why_not(design_, questions_, one), "no session that counts");
  one.played.run = "run-01";
  EXPECT_EQ(why_not(design_, questions_, one), "");
  EXPECT_FALSE(one.is_virtual());
  Person other = one;
  other.replaced_by = "p002";
  EXPECT_THAT(why_not(design_, questions_, other), HasSubstr("p002"));
  other = one;
  other.answers.pop_back();
  EXPECT_EQ(why_not(design_, questions_, other), "questions not answered");
  other = one;
  for (Answer& answer : other.answers) {
    if (answer.item == "sick") answer.answer = kNoAnswer;
  }
  EXPECT_EQ(why_not(design_, questions_, other), "no answer to an item of the model");
}

// Answers may be drawn before somebody plays: then they are nobody's.
TEST_F(DrawnAnswers, DoNotCountBesideAPersonsSession) {
  Person one = drawn(1, 3)[0];
  EXPECT_TRUE(one.is_virtual());
  one.played.run = "run-01";
  EXPECT_FALSE(one.is_virtual());
  EXPECT_EQ(why_not(design_, questions_, one), "a person's session with drawn answers");
  for (Answer& answer : one.answers) {
    if (answer.item != "sick") answer.source = kForm;
  }
  EXPECT_EQ(why_not(design_, questions_, one), "a person's session with drawn answers");
  one.played.is_virtual = true;
  EXPECT_TRUE(one.is_virtual());
  EXPECT_EQ(why_not(design_, questions_, one), "");
}

// Whether they count or not: with nobody who counts, a report said of nobody that they are virtual.
TEST_F(DrawnAnswers, AReportSaysHowManyOfItsParticipantsAreVirtual) {
  std::vector<Person> people = drawn(3, 3);
  const auto page = [&] { return html_report(design_, questions_, people, {}); };
  EXPECT_THAT(page(), HasSubstr(">3 of these 3 participants are virtual: "));
  people[0].answers.clear();
  EXPECT_THAT(page(), HasSubstr(">2 of these 3 participants are virtual: "));
  for (Person& one : people) one.replaced_by = "p009";
  EXPECT_THAT(page(), HasSubstr("3 participants, 0 of whom count"));
  EXPECT_THAT(page(), HasSubstr(">2 of these 3 participants are virtual: "));
  people[1].answers.clear();
  EXPECT_THAT(page(),
              HasSubstr(">1 of these 3 participants is virtual: nobody played that session. "
                        "The answers of 1 participant are drawn from a model.<"));
  people[2].answers.clear();
  EXPECT_THAT(page(), testing::Not(HasSubstr("virtual: ")));
  people = drawn(1, 3);
  EXPECT_THAT(page(), HasSubstr(">The participant is virtual: nobody played that session. The "));
}

// The small picture has 10 units a metre and is 44 wide; its line is that of 6 m ahead.
TEST_F(DrawnAnswers, LinesOfThrowsEndAtTheEdgeOfTheirPictures) {
  const auto line_of = [&](const Vec3& v_WB) {
    std::vector<Person> people = drawn(1, 3);
    scene::ThrowRow one;
    one.p_WB = Vec3(0.2, 0.4, 0.1);
    one.v_WB = v_WB;
    people[0].played.measures.throws = {one};
    const std::string page = html_report(design_, questions_, people, {});
    const std::size_t at = page.find("<line x1='24.0'");
    return page.substr(at, page.find(" stroke", at) - at);
  };
  EXPECT_EQ(line_of(Vec3(0.5, 5.0, 0.0)), "<line x1='24.0' y1='80.0' x2='30.0' y2='20.0'");
  EXPECT_EQ(line_of(Vec3(5.0, 5.0, 0.0)), "<line x1='24.0' y1='80.0' x2='44.0' y2='60.0'");
  EXPECT_EQ(line_of(Vec3(-5.0, 5.0, 0.0)), "<line x1='24.0' y1='80.0' x2='0.0' y2='56.0'");
  EXPECT_EQ(line_of(Vec3(0.0, 5.0, 0.0)), "<line x1='24.0' y1='80.0' x2='24.0' y2='20.0'");
}

// A virtual participant's session may have the answers of a form, and a person's drawn ones.
TEST_F(DrawnAnswers, AReportSaysApartWhoDidNotPlayAndWhoDidNotAnswer) {
  std::vector<Person> people = drawn(3, 3);
  const auto page = [&] { return html_report(design_, questions_, people, {}); };
  for (Person& one : people) {
    one.played.run = "run-01";
    one.played.is_virtual = true;
    for (Answer& answer : one.answers) answer.source = kForm;
  }
  EXPECT_THAT(page(), HasSubstr(">3 of these 3 participants are virtual: nobody played their "
                                "sessions.<"));
  EXPECT_THAT(page(), testing::Not(HasSubstr("drawn from a model")));
  people[0].answers.back().source = kDrawn;
  people[1].played.is_virtual = false;
  people[1].answers.back().source = kDrawn;
  EXPECT_THAT(page(),
              HasSubstr(">2 of these 3 participants are virtual: nobody played their "
                        "sessions. The answers of 2 participants are drawn from a model.<"));
  for (Person& one : people) one.played.is_virtual = false;
  EXPECT_THAT(page(), HasSubstr("<p class=virtual>The answers of 2 participants are drawn"));
  EXPECT_THAT(page(), testing::Not(HasSubstr("nobody played")));
}

}  // namespace
}  // namespace headpin::study
