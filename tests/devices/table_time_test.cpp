// What the cells of a table's time say, and which of its columns is the time.

#include "devices/recordings/table_time.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/any_table.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

constexpr double kHour_s = 3600.0, kNoon_s = 43200.0, kDayLong_s = 86400.0;

/// A table with these cells in its columns.
struct TableOfCells : AnyTable {
  TableOfCells(const std::vector<std::string>& names, std::vector<std::vector<std::string>> cells)
      : texts(std::move(cells)) {
    for (const std::string& name : names)
      columns.push_back({.name = name, .last = name, .written = name, .unit = ""});
    for (std::size_t i = 0; i < texts[0].size(); ++i) {
      rows.push_back({.line = i + 2, .cells = {}});
      for (const auto& column : texts) rows.back().cells.emplace_back(column[i]);
    }
  }
  TableOfCells(const TableOfCells&) = delete;
  TableOfCells& operator=(const TableOfCells&) = delete;

  std::vector<std::vector<std::string>> texts;
};

/// How a column of a name is read, or why it is not.
struct ReadTime {
  std::vector<std::optional<double>> of_row;
  double unit_s = 0.0;
  std::vector<std::string> notes;
  std::string complaint;
};

ReadTime time_in(const std::vector<std::string>& cells, const std::string& name = "time",
                 const std::string& rate = "") {
  TableOfCells table({name}, {cells});
  if (!rate.empty()) table.facts.emplace_back("rate", rate);
  ReadTime read;
  read.complaint = complaint([&] {
    const TableTimes times = read_times(table, 0, {}, "t.csv", read.notes);
    read.of_row = times.of_row;
    read.unit_s = times.unit_s;
  });
  return read;
}

using Seconds = std::optional<double>;

Seconds seconds_in(std::string_view cell) {
  return time_of(cell, 1.0);
}

TEST(TimeOfDay, HasHoursMinutesAndSeconds) {
  EXPECT_EQ(seconds_in("12:34:56"), Seconds(12 * kHour_s + 34 * 60 + 56));
  EXPECT_EQ(seconds_in("12:34:56,5"), Seconds(12 * kHour_s + 34 * 60 + 56.5));
  EXPECT_EQ(seconds_in("24:00:00"), Seconds(kDayLong_s));
  EXPECT_EQ(seconds_in("23:59:60"), Seconds(kDayLong_s));  // a leap second
  for (const char* none : {"25:00:00", "12:60:00", "12:00:61", ":00:00", "12::00",
                           "12:00:", "1200:00", "12:0000", "12.00.00", "12:00", "noon", ""})
    EXPECT_EQ(seconds_in(none), std::nullopt) << none;
}

TEST(TimeOfDay, HasADateOfIso8601) {
  const double days = 20782;  // from 1970-01-01 to 2026-11-25
  EXPECT_EQ(seconds_in("2026-11-25T00:00:01"), Seconds(days * kDayLong_s + 1));
  EXPECT_EQ(seconds_in("2026-11-25 00:00:01Z"), Seconds(days * kDayLong_s + 1));
  EXPECT_EQ(seconds_in("1970-01-02T00:00:00"), Seconds(kDayLong_s));
  for (const char* none : {"2026-11-25", "2026-11-25X00:00:01", "2026-1125T00:00:01",
                           "2026--25T00:00:01", "2026-11-T00:00:01", "202x-11-25T00:00:01",
                           "    -11-25T00:00:01", "2026-02-29T00:00:01", "2026-13-01T00:00:01"})
    EXPECT_EQ(seconds_in(none), std::nullopt) << none;
}

TEST(TimeOfDay, HasAZoneOfUpToFifteenHoursAndFiftyNineMinutes) {
  EXPECT_EQ(seconds_in("15:59:00+15:59"), Seconds(0.0));
  EXPECT_EQ(seconds_in("00:00:00-1530"), Seconds(15.5 * kHour_s));
  EXPECT_EQ(seconds_in("12:00:00 +15"), Seconds(-3 * kHour_s));
  for (const char* none : {"12:00:00+16", "12:00:00+16:00", "12:00:00+01:60", "12:00:00+"})
    EXPECT_EQ(seconds_in(none), std::nullopt) << none;
}

TEST(TimeOfDay, HasAHalfOfTheDayInAWordOfItsOwn) {
  for (const char* am : {"AM", "am", "a.m.", "a. m.", "am.", "AM 7", "am["})
    EXPECT_EQ(seconds_in(std::string("12:00:00 ") + am), Seconds(0.0)) << am;
  for (const char* zone : {"AMT", "ama", "amz", "amA", "amZ", "Amb"})
    EXPECT_EQ(seconds_in(std::string("12:00:00 ") + zone), Seconds(kNoon_s)) << zone;
  EXPECT_EQ(seconds_in("01:00:00 pm"), Seconds(13 * kHour_s));
  EXPECT_EQ(seconds_in("12:00:00 pm"), Seconds(kNoon_s));
  EXPECT_EQ(seconds_in("13:00:00 pm"), std::nullopt);
  EXPECT_EQ(seconds_in("00:30:00 am"), std::nullopt);
}

TEST(ColonDecimals, AreThoseOfTheLongestWhereNoFramesAreCounted) {
  EXPECT_EQ(colon_decimals({"12:00:00:123", "12:00:01:456"}), 3u);
  EXPECT_EQ(colon_decimals({"12:00:00", "12:00:00:123"}), 3u);  // a whole second
  EXPECT_EQ(colon_decimals({"12:00:00:123", "12:00:01+02:00"}), 3u);
  EXPECT_EQ(colon_decimals({"12:00:00:7", "12:00:00:500"}), 3u);
  EXPECT_EQ(colon_decimals({"12:00:00:7", "12:00:00:499"}), 0u);  // may be frames
  EXPECT_EQ(colon_decimals({"12:00:00:7", "12:00:00:29"}), 0u);
  EXPECT_EQ(colon_decimals({"12:00:00:123456"}), 6u);
  EXPECT_EQ(colon_decimals({"12:00:00:123456789"}), 9u);
  EXPECT_EQ(colon_decimals({"12:00:00+02:00"}), 0u);
}

TEST(TimesOfRows, ThatAreTimesOfDayGoOnOverMidnight) {
  EXPECT_THAT(time_in({"23:59:59.5", "late", "00:00:00.5", "00:00:01", "23:59:59"}).of_row,
              ElementsAre(kDayLong_s - 0.5, std::nullopt, kDayLong_s + 0.5, kDayLong_s + 1,
                          kDayLong_s - 1));
}

TEST(TimesOfRows, ThatAreNumbersOrDatesAreAsTheyAre) {
  EXPECT_THAT(time_in({"0.00", "0.01", "n/a", "100000", "0.02"}).of_row,
              ElementsAre(0.0, 0.01, std::nullopt, 100000.0, 0.02));
  EXPECT_THAT(time_in({"1970-01-02T00:00:00", "1970-01-05T00:00:00", "1970-01-01T00:00:01"}).of_row,
              ElementsAre(kDayLong_s, 4 * kDayLong_s, 1.0));
}

TEST(TimesOfRows, ThatSayNoTimeAreRefused) {
  EXPECT_EQ(time_in({"", "soon"}).complaint, "t.csv:3: time: 'soon' is no time");
  EXPECT_EQ(time_in({"", ""}).complaint, "t.csv: time: no row has a time");
}

// Rows that are 10 ms apart in s, ms, us, ns and ticks of 100 ns.
TEST(UnitOfTime, IsFoundByTheStepsOfRows) {
  struct {
    double step, unit_s;
    const char* name;
  } const units[] = {{0.01, 1.0, "s"},
                     {10, 1e-3, "ms"},
                     {1e4, 1e-6, "us"},
                     {1e7, 1e-9, "ns"},
                     {1e5, 1e-7, "ticks of 100 ns"}};
  for (const auto& unit : units) {
    std::vector<std::string> cells;
    for (int i = 0; i < 20; ++i) cells.push_back(fmt::format("{}", i * unit.step));
    const ReadTime read = time_in(cells);
    EXPECT_EQ(read.unit_s, unit.unit_s) << unit.name;
    EXPECT_THAT(read.notes, ElementsAre(fmt::format(
                                "the time has no unit; read in {}, as it advances by {:.4g} "
                                "a row",
                                unit.name, unit.step)));
  }
}

TEST(UnitOfTime, IsTheOneInWhichRowsAre2500To50000UsApart) {
  EXPECT_EQ(time_in({"0", "0.0025"}).unit_s, 1.0);
  EXPECT_EQ(time_in({"0", "0.05"}).unit_s, 1.0);
  EXPECT_EQ(time_in({"0", "2.5"}).unit_s, 1e-3);
  EXPECT_EQ(time_in({"-1", "-0.99"}).unit_s, 1.0);
  const std::string refused = "t.csv: time: expected a unit of the time, as it advances by ";
  EXPECT_THAT(time_in({"0", "0.0024"}).complaint, StartsWith(refused + "0.0024 a row"));
  EXPECT_THAT(time_in({"0", "0.051"}).complaint, StartsWith(refused + "0.051 a row"));
  EXPECT_THAT(time_in({"3", "3"}).complaint, StartsWith(refused + "0 a row"));
  EXPECT_EQ(time_in({"0", "0.051"}, "time_ms").unit_s, 1e-3);
}

TEST(UnitOfTime, IsOfTheMiddleStepForward) {
  EXPECT_EQ(time_in({"0", "10", "20", "30.5", "5000", "5010", "5020"}).unit_s, 1e-3);
  EXPECT_EQ(time_in({"0", "10", "3000", "6000", "6010", "6020"}).unit_s, 1e-3);
  EXPECT_EQ(time_in({"0", "0", "0", "10", "10", "10", "20", "20", "20"}).unit_s, 1e-3);
  EXPECT_EQ(time_in({"40", "50", "30", "40", "20", "30", "0", "10"}).unit_s, 1e-3);
  // Few are short or long: the first, those at both ends and the one in the middle.
  std::vector<std::string> cells = {"0"};
  int at = 0;
  for (int step = 0; step < 21; ++step) {
    at += step == 0 ? 1 : step == 1 || step == 10 || step == 20 ? 5000 : 10;
    cells.push_back(fmt::format("{}", at));
  }
  EXPECT_EQ(time_in(cells).unit_s, 1e-3);
}

TEST(UnitOfTime, OfFramesIsByTheRateOfTheTable) {
  const ReadTime frames = time_in({"1", "2", "3", "4"}, "frame", "100");
  EXPECT_EQ(frames.unit_s, 0.01);
  EXPECT_THAT(frames.notes, IsEmpty());
  EXPECT_EQ(time_in({"0.00", "0.01", "0.02"}, "time", "100").unit_s, 1.0);
  EXPECT_EQ(time_in({"10", "20", "30"}, "frame", "100").unit_s, 1e-3);
  EXPECT_THAT(time_in({"1", "2", "3", "4"}, "frame").complaint,
              StartsWith("t.csv: frame: expected a unit of the time, as it advances by 1 a row"));
}

/// The cells of a column of rows that are 10 ms apart; several rows in turn have the same time.
std::vector<std::string> each_for(int rows, int of_41 = 41) {
  std::vector<std::string> cells;
  for (int i = 0; i < of_41; ++i) cells.push_back(fmt::format("{:.2f}", 0.01 * (i / rows)));
  cells.resize(41);
  return cells;
}

using Found = std::optional<std::size_t>;

TEST(ColumnOfTheTime, IsTheFirstThatAdvancesAtLeastHalfAsOftenAsAnother) {
  const std::vector<std::string> fine = each_for(1);
  EXPECT_EQ(find_time(TableOfCells({"time", "elapsed"}, {each_for(2), fine})), Found(0));
  EXPECT_EQ(find_time(TableOfCells({"time", "elapsed"}, {each_for(3), fine})), Found(1));
  EXPECT_EQ(find_time(TableOfCells({"elapsed", "time"}, {fine, each_for(3)})), Found(0));
  // Of the rows that have it.
  EXPECT_EQ(find_time(TableOfCells({"time", "elapsed"}, {each_for(1, 9), fine})), Found(0));
  EXPECT_EQ(find_time(TableOfCells({"time", "elapsed"}, {each_for(41), each_for(41)})), Found(0));
  EXPECT_EQ(find_time(TableOfCells({"head_x"}, {fine})), std::nullopt);
}

TEST(ColumnOfTheTime, IsNoNumberOfFramesWhereAnotherIs) {
  const std::vector<std::string> cells = each_for(1);
  EXPECT_EQ(find_time(TableOfCells({"frame"}, {cells})), Found(0));
  EXPECT_EQ(find_time(TableOfCells({"frame", "seconds"}, {cells, cells})), Found(1));
  EXPECT_EQ(find_time(TableOfCells({"time_frame", "timestamps"}, {cells, cells})), Found(1));
  EXPECT_EQ(find_time(TableOfCells({"time_frame", "head_x"}, {cells, cells})), Found(0));
  EXPECT_EQ(find_time(TableOfCells({"seconds", "time"}, {cells, cells})), Found(1));
}

TEST(OtherTimes, AdvanceAtLeastHalfAsOften) {
  const std::vector<std::string> fine = each_for(1), resting = each_for(41);
  using Columns = std::vector<std::size_t>;
  const std::vector<std::string> names = {"time", "elapsed", "utc", "frame", "t"};
  const TableOfCells table(names, {fine, each_for(2), each_for(3), fine, resting});
  EXPECT_EQ(other_times(table, 0), Columns{1});
  EXPECT_EQ(other_times(table, 2), (Columns{0, 1}));
  EXPECT_EQ(other_times(table, 4), (Columns{0, 1, 2}));
  EXPECT_EQ(other_times(TableOfCells({"time", "elapsed"}, {resting, resting}), 0), Columns{});
}

}  // namespace
}  // namespace headpin::devices
