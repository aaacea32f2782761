// The R program of a study.

#include "study/script.h"

#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "study/csv.h"
#include "tests/study/study_files.h"

namespace headpin::study {
namespace {

// Its first line is a comment; a line break in it would begin a line of R.
TEST(Script, HasTheNameOfItsDesignOnOneLine) {
  Design design = bundled_design();
  design.name = "two\nstop('lines')\rmore";
  EXPECT_THAT(r_script(design),
              testing::StartsWith(
                  "# The analysis of a study by the design two stop('lines') more. `headpin"));
}

TEST(Script, SaysWhichTermsAreInWhichChange) {
  const std::string script = r_script(bundled_design());
  EXPECT_THAT(script,
              testing::HasSubstr("  \"friction\" = c(\"change(2)\", \"sick\", \"vrbefore(2)\", "
                                 "\"change(2).S\", \"change(2).E\"),\n"));
  EXPECT_THAT(script,
              testing::HasSubstr(
                  "published_constants <- c(\"change(1)\", \"change(2)\", \"change(3)\")\n"));
}

/// Cell, change, score, sickness and earlier VR of a participant.
struct Row {
  std::string cell, changed;
  int score, sick;
  std::string before;
};

/// The script run by R on a table of its own.
class ScriptInR : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("Rscript --version >/dev/null 2>&1") != 0) {
      GTEST_SKIP() << "Rscript is not installed: the model is not fitted";
    }
  }

  void fit(const Design& design, const std::vector<Row>& rows) const {
    std::string table = "participant,virtual,counts,cell,changed,E,F,S,score,of,sick,vrbefore\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Row& r = rows[i];
      table += fmt::format("p{},no,yes,{},{},{},{},{},{},6,{},{}\n", i, r.cell, r.changed,
                           r.cell[0], r.cell[1], r.cell[2], r.score, r.sick, r.before);
    }
    spit(folder_ / "participants.csv", table);
    spit(folder_ / "model.R", r_script(design));
    const std::string run = "cd '" + folder_.path().string() +
                            "' && Rscript --vanilla model.R participants.csv . >said.txt 2>&1";
    ASSERT_EQ(std::system(run.c_str()), 0) << slurp(folder_ / "said.txt");
  }

  /// A cell of a table that R wrote, in the row that begins with `row`.
  std::string cell(const std::string& name, const std::string& row,
                   const std::string& column) const {
    const CsvTable table = parse_csv(slurp(folder_ / name), name);
    for (const CsvRow& one : table.rows) {
      if (one.cells[0] == row) return table.cell(one, column);
    }
    return "no such row";
  }

  TemporaryFolder folder_;
  /// Of a study in which friction separates: where E is 1 no answer is high.
  const std::vector<Row> people_ = {
      {"000", "elasticity", 0, 1, "no"},  {"101", "friction", 0, 1, "no"},
      {"011", "elasticity", 0, 6, "no"},  {"000", "friction", 0, 5, "no"},
      {"010", "shape", 5, 1, "no"},       {"010", "elasticity", 4, 2, "no"},
      {"000", "shape", 3, 1, "yes"},      {"101", "friction", 0, 5, "yes"},
      {"000", "friction", 0, 7, "no"},    {"110", "shape", 2, 3, "no"},
      {"001", "friction", 1, 5, "yes"},   {"100", "friction", 0, 2, "yes"},
      {"000", "elasticity", 4, 2, "yes"}, {"100", "shape", 1, 3, "no"},
      {"110", "shape", 6, 3, "yes"},      {"001", "elasticity", 2, 2, "yes"},
      {"000", "shape", 0, 2, "no"},       {"011", "elasticity", 4, 1, "no"}};
};

// What was published does not depend on who took part.
TEST_F(ScriptInR, PublishedPredictorsAreWholeWhoeverTookPart) {
  for (const auto& rows : {people_, std::vector<Row>{people_[0], people_[2], people_[5]}}) {
    fit(bundled_design(), rows);
    EXPECT_EQ(cell("table-5.csv", "friction", "published"),
              "-1.0 - 0.7*sick - 1.6*vrbefore(2) + 3.8*S - 3.8*E");
    EXPECT_EQ(cell("table-5.csv", "elasticity", "published"),
              "1.5 + 2.1*F - 0.7*sick - 1.6*vrbefore(2) - 1.5*S");
  }
  EXPECT_EQ(cell("table-5.csv", "friction", "predictor"), "n/a");
  EXPECT_EQ(cell("table-5.csv", "friction", "significant"), "n/a");
  Design design = bundled_design();
  for (Term& term : design.terms) term.estimate.reset();
  fit(design, people_);
  EXPECT_EQ(cell("table-5.csv", "friction", "published"), "n/a");
}

// With separation, an estimate's own error says nothing; what the deviance grows by does.
TEST_F(ScriptInR, SignificantIsWhatTheDevianceGrowsByMuchWithout) {
  fit(bundled_design(), people_);
  EXPECT_GT(std::stod(cell("table-6.csv", "sick", "p")), 0.05);
  EXPECT_LT(std::stod(cell("drop.csv", "sick", "p")), 0.05);
  EXPECT_EQ(cell("table-5.csv", "shape", "significant"),
            "1.4 + 3.8*F - 1.0*sick - 3.5*vrbefore(2)");
  EXPECT_THAT(
      cell("table-5.csv", "friction", "predictor"),
      testing::MatchesRegex("-[0-9.]+\\(endless\\) - 1.0\\*sick - 3.5\\*vrbefore\\(2\\) \\+ "
                            "[0-9.]+\\(endless\\)\\*S - [0-9.]+\\(endless\\)\\*E"));
}

// R takes a column of inf and nan for numbers, which are no words of a design.
TEST_F(ScriptInR, AnAnswerCalledInfIsAWord) {
  Design design = bundled_design();
  for (Term& term : design.terms) {
    if (term.of == "vrbefore") term.is = "nan";
  }
  std::vector<Row> rows = people_;
  fit(bundled_design(), rows);
  const std::string estimate = cell("table-6.csv", "vrbefore(2)", "estimate");
  for (Row& row : rows) row.before = row.before == "no" ? "nan" : "inf";
  fit(design, rows);
  EXPECT_EQ(cell("table-6.csv", "vrbefore(2)", "estimate"), estimate);
}

// A script of another version or design is known by its hash; a change anywhere is an edit.
TEST(Script, IsUneditedAsLongAsItsLastLineIsTheHashOfTheOthers) {
  Design design = bundled_design();
  design.name = "another";
  design.terms.pop_back();
  for (const std::string& script : {r_script(bundled_design()), r_script(design)}) {
    EXPECT_TRUE(is_unedited_script(script));
    EXPECT_FALSE(is_unedited_script(script + "stop('mine')\n"));
    EXPECT_FALSE(is_unedited_script("# mine\n" + script));
    std::string edited = script;
    edited[script.size() / 2] ^= 1;
    EXPECT_FALSE(is_unedited_script(edited));
    const std::string older = script.substr(0, script.rfind("# SHA-256"));
    EXPECT_FALSE(is_unedited_script(older));
  }
  EXPECT_FALSE(is_unedited_script(""));
}

}  // namespace
}  // namespace headpin::study
