#include "sweep/report.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sweep/result.h"
#include "tests/support/folder.h"

namespace headpin::sweep {
namespace {

using testing::HasSubstr;
using testing::Not;

const Design kDesign = parse_design(
    "trials = ['a.lcmlog', \"it's.lcmlog\"]\n[grid]\nelasticity = [0, 0.5, 1]\nfriction = [0, 1]\n"
    "shape = ['ellipsoid', 'true']\n[random]\ndraws = 3\nball.mass = {from = 5, to = 7}\n",
    "s.toml");

/// The cells of a row that felled so many.
std::vector<std::string> cells_with(const Rows& rows, std::int64_t number, double down,
                                    const char* islands = "0", const char* error = "") {
  std::vector<std::string> cells = cells_of(rows, rows.at(number));
  for (const ResultColumn& column : result_columns()) {
    const std::string_view name = column.name;
    cells.push_back(name == "skittles_down"      ? fmt::format("{}", down)
                    : name == "unsolved_islands" ? islands
                    : name == "error"            ? error
                                                 : "");
  }
  return cells;
}

TEST(SweepAverages, AreTheMeanOverTrialsAndDrawsOfAPoint) {
  const Rows rows(kDesign, {"A", "B"});
  ASSERT_EQ(rows.size(), 3 * 2 * 2 * 3 * 2);
  Averages averages(rows);
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    const bool unsolved = i == 7, failed = i == 14;
    averages.add(i, cells_with(rows, i, static_cast<double>(i), unsolved ? "2" : "0",
                               failed ? "no, \"never\"" : ""));
  }
  // Elasticity 0.5, friction 1, true: the eighth point of twelve, rows 42 to 47.
  const Point& point = averages.at({1, 1, 1});
  EXPECT_EQ(point.rows, 6);
  EXPECT_EQ(point.first, 42);
  EXPECT_DOUBLE_EQ(mean(point, 0), 44.5);
  EXPECT_TRUE(std::isnan(mean(point, 2)));
  EXPECT_EQ(averages.at({0, 0, 1}).unsolved, 1);
  EXPECT_EQ(averages.at({0, 1, 0}).failed, 1);
  EXPECT_EQ(averages.at({0, 0, 0}).failed, 0);
}

TEST(SweepAverages, RefuseALineThatIsNone) {
  const Rows rows(kDesign, {"A", "B"});
  Averages averages(rows);
  EXPECT_THAT(complaint([&] { averages.add(4, {"1", "2", "3"}); }), HasSubstr("row 5: expected"));
}

// docs/guides/sweeps.md tells what each column is.
TEST(SweepResult, ColumnsAreTheOnesOfTheGuide) {
  const std::string page = slurp(HEADPIN_SOURCE_DIR "/docs/guides/sweeps.md");
  for (const ResultColumn& column : result_columns()) {
    const std::string unit = *column.unit ? fmt::format("{} ", column.unit) : "";
    EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` | {}| {}", column.name, unit, column.meaning)));
  }
}

TEST(SweepReport, ACommandSimulatesItsRow) {
  const Rows rows(kDesign, {"A", "B"});
  const Row row = rows.at(1);
  EXPECT_EQ(command_of(rows, row, "my sweep"),
            "headpin replay 'my sweep/trials/it'\\''s.lcmlog' --elasticity 0 --friction 0 --shape "
            "ellipsoid --set ball.mass=" +
                row.values[3]);
}

// `replay --iterations` is refused beside converged detection, and the profile sets all of the display.
TEST(SweepReport, ACommandIsTakenWhateverTheRow) {
  const Design design = parse_design(
      "trials = ['a.lcmlog']\n[grid]\nhmd.width = [640]\nhmd.profile = ['flight-helmet']\n"
      "detection = ['converged', 'paper']\niterations = [5]\n",
      "s.toml");
  const Rows rows(design, {"A"});
  EXPECT_EQ(command_of(rows, rows.at(0), "sweep"),
            "headpin replay sweep/trials/a.lcmlog --set hmd.profile=flight-helmet --set "
            "hmd.width=640 --detection converged --set collision.iterations=5");
}

TEST(SweepReport, APointSaysHowManyOfItsRowsHaveTheNumber) {
  const Rows rows(kDesign, {"A", "B"});
  Averages averages(rows);
  for (std::int64_t i = 0; i < 12; ++i) {
    averages.add(i, cells_with(rows, i, 4.0, "0", i > 6 ? "no" : ""));
  }
  const std::string html = html_report(rows, averages, 0, 1, "sweep");
  EXPECT_THAT(html, HasSubstr("shape = ellipsoid: 4, the mean of 6 rows<"));
  Averages some(rows);
  for (std::int64_t i = 0; i < 6; ++i) {
    std::vector<std::string> cells = cells_with(rows, i, 4.0);
    if (i > 0) cells[cells.size() - result_columns().size()].clear();  // skittles_down
    some.add(i, cells);
  }
  EXPECT_THAT(html_report(rows, some, 0, 1, "sweep"),
              HasSubstr("shape = ellipsoid: 4, the mean of 1 of 6 rows<"));
}

TEST(SweepReport, HasAMapForEachShapeWithItsExtremesAndNoForeignMarkup) {
  Design design = kDesign;
  design.grid[2].values[1] = "</script><b>";
  const Rows rows(design, {"A", "B"});
  Averages averages(rows);
  for (std::int64_t i = 0; i < 40; ++i) {
    averages.add(i, cells_with(rows, i, i < 6 ? 2.0 : 7.0));
  }
  const std::string html = html_report(rows, averages, 0, 1, "<i>");
  EXPECT_THAT(html, HasSubstr("40 of 72 rows"));
  EXPECT_THAT(html, HasSubstr("shape = ellipsoid"));
  EXPECT_THAT(html, HasSubstr("shape = &lt;/script&gt;&lt;b&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<b>")));
  EXPECT_THAT(html, Not(HasSubstr("<i>")));
  // The least is the first colour of viridis, the most its last.
  EXPECT_THAT(html, HasSubstr("fill='#440154' data-i='0'"));
  EXPECT_THAT(html, HasSubstr("fill='#fde725' data-i='1'"));
  EXPECT_THAT(html, HasSubstr("fill='#eee' data-i='11'"));  // not simulated yet
  EXPECT_THAT(html, HasSubstr("not simulated yet"));
}

// A page of failed rows alone said only that no row has the numbers.
TEST(SweepReport, SaysOfEachReasonHowManyRowsFailedAndTheFirst) {
  const Rows rows(kDesign, {"A", "B"});
  Averages averages(rows);
  for (std::int64_t i = 0; i < 12; ++i) {
    averages.add(i, cells_with(rows, i, 4.0, "0", i == 0 ? "lane <wide>" : i < 4 ? "" : "no ball"));
  }
  const std::vector<Failure> failures = averages.failures();
  ASSERT_EQ(failures.size(), 2u);
  EXPECT_EQ(failures[0].reason, "no ball");
  EXPECT_EQ(failures[0].rows, 8);
  EXPECT_EQ(failures[0].first, 4);
  EXPECT_EQ(failures[1].rows, 1);
  EXPECT_EQ(failures[1].first, 0);
  const std::string html = html_report(rows, averages, 0, 1, "sweep");
  EXPECT_THAT(html, HasSubstr("<td>8</td><td>5</td><td>no ball</td><td>headpin replay "
                              "sweep/trials/a.lcmlog --elasticity 0 --friction 0 "));
  EXPECT_THAT(html, HasSubstr("<td>1</td><td>1</td><td>lane &lt;wide&gt;</td>"));
  Averages none(rows);
  none.add(0, cells_with(rows, 0, 4.0));
  EXPECT_THAT(html_report(rows, none, 0, 1, "sweep"), Not(HasSubstr("rows that failed")));
}

// Reasons with drawn numbers in them all differ.
TEST(SweepReport, CountsReasonsBeyondAThousandTogether) {
  const Rows rows(
      parse_design("trials = ['a.lcmlog']\n[grid]\nfriction = {from = 0, to = 1, steps = 1010}\n",
                   "s.toml"),
      {"A"});
  Averages averages(rows);
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    averages.add(i, cells_with(rows, i, 4.0, "0", fmt::format("found {}", i).c_str()));
  }
  const std::vector<Failure> failures = averages.failures();
  ASSERT_EQ(failures.size(), 1001u);
  EXPECT_EQ(failures.back().rows, 10);
  EXPECT_EQ(failures.back().first, 1000);
  EXPECT_THAT(html_report(rows, averages, 0, 0, "sweep"), HasSubstr("There are 981 more reasons."));
}

TEST(SweepAverages, OfAChosenValueLeaveOutTheRowsOfOthers) {
  const Rows rows(kDesign, {"A", "B"});
  const Chosen chosen = {std::nullopt, 1, std::nullopt};  // friction 1
  Averages all(rows), some(rows, chosen);
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    const auto cells = cells_with(rows, i, static_cast<double>(i));
    all.add(i, cells);
    some.add(i, cells);
  }
  EXPECT_EQ(point_count(kDesign.grid), 12);
  ASSERT_EQ(some.points().size(), 6u);
  for (std::size_t elasticity = 0; elasticity < 3; ++elasticity) {
    for (std::size_t shape = 0; shape < 2; ++shape) {
      const Point& point = some.at({elasticity, 0, shape});
      EXPECT_EQ(point.rows, 6);
      EXPECT_EQ(point.first, all.at({elasticity, 1, shape}).first);
      EXPECT_EQ(mean(point, 0), mean(all.at({elasticity, 1, shape}), 0));
    }
  }
  const std::string html = html_report(rows, some, 0, 2, "sweep");
  EXPECT_THAT(html, HasSubstr("friction = 1"));
  EXPECT_THAT(html, Not(HasSubstr("friction = 0")));
  EXPECT_THAT(html, HasSubstr("data-i='5'"));
  EXPECT_THAT(html, Not(HasSubstr("data-i='6'")));
}

// It said how many rows the whole sweep has.
TEST(SweepReport, OfAChosenValueCountsItsRowsAlone) {
  const Rows rows(kDesign, {"A", "B"});
  Averages all(rows), some(rows, {std::nullopt, 1, 0}), none(rows, {2, 0, 1});
  for (std::int64_t i = 0; i < 40; ++i) {  // all of elasticity 0, none of 1
    for (Averages* one : {&all, &some, &none}) {
      one->add(i, cells_with(rows, i, 4.0, "0", i == 12 ? "no ball" : ""));
    }
  }
  EXPECT_EQ(all.planned(), rows.size());
  EXPECT_EQ(all.done(), 40);
  EXPECT_EQ(all.chosen_in_words(), "");
  EXPECT_EQ(some.planned(), 3 * 6);
  EXPECT_EQ(some.done(), 6 + 4);
  EXPECT_EQ(some.failures().size(), 1u);
  const std::string html = html_report(rows, some, 0, 0, "sweep");
  EXPECT_THAT(html, HasSubstr("<p>10 of 18 rows with friction = 1, shape = ellipsoid."));
  EXPECT_THAT(html_report(rows, none, 0, 0, "sweep"),
              HasSubstr("<p>0 of 6 rows with elasticity = 1, friction = 0, shape = true."));
  EXPECT_THAT(html_report(rows, none, 0, 0, "sweep"),
              HasSubstr("none of these rows has this number"));
}

}  // namespace
}  // namespace headpin::sweep
