#include "devices/recordings/table_trigger.h"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_files.h"
#include "devices/recordings/table_motion.h"

namespace headpin::devices {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Forty rows at 100 Hz of a head and a right hand, with a trigger as a function of the row.
MotionTracks with_trigger(const std::function<std::string(int)>& cell,
                          const std::string& header = "") {
  std::string text = header.empty()
                         ? "time,head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz,"
                           "right_x,right_y,right_z,right_qw,right_qx,right_qy,right_qz,trigger\n"
                         : header;
  for (int i = 0; i < 40; ++i) {
    text += fmt::format("{:.2f},0,1.6,0,1,0,0,0,0.2,{:.3f},0,1,0,0,0,{}\n", 0.01 * i,
                        1.0 + 0.001 * i, cell(i));
  }
  return parse_motion_table(text, "t.csv", {});
}

std::vector<std::pair<std::int64_t, bool>> changes_ms(const MotionTracks& tracks) {
  std::vector<std::pair<std::int64_t, bool>> all;
  for (const Stamped<bool>& change : tracks.triggers[1]) {
    all.emplace_back(change.time.count() / 1000, change.value);
  }
  return all;
}

bool held(int i) {
  return i >= 10 && i < 30;
}

TEST(TableTrigger, BlankCellsKeepTheValueBeforeAndAreNoted) {
  const auto whole = with_trigger([](int i) { return held(i) ? "100" : "0"; });
  EXPECT_THAT(changes_ms(whole), ElementsAre(std::pair(100, true), std::pair(300, false)));
  const auto blank = with_trigger([](int i) -> std::string {
    return i % 7 == 5 ? "" : held(i) ? "100" : "0";
  });
  EXPECT_EQ(changes_ms(blank), changes_ms(whole));
  EXPECT_THAT(blank.notes,
              Contains("the trigger 'trigger' is blank or no number in 5 of 40 rows: the value "
                       "before is kept"));
}

TEST(TableTrigger, ThatIsOnlySaidWhilePressedIsNotPressedInBlankCells) {
  const auto tracks = with_trigger([](int i) { return held(i) ? "1" : ""; });
  EXPECT_THAT(changes_ms(tracks), ElementsAre(std::pair(100, true), std::pair(300, false)));
  EXPECT_THAT(tracks.notes, Contains(HasSubstr("in 20 of 40 rows: not pressed")));
}

TEST(TableTrigger, MayBeWords) {
  const auto marks = with_trigger([](int i) {
    return i == 10 ? "grab" : i == 30 ? "release" : "";
  });
  EXPECT_THAT(changes_ms(marks), ElementsAre(std::pair(100, true), std::pair(300, false)));
  const auto truth = with_trigger([](int i) { return held(i) ? "TRUE" : "False"; });
  EXPECT_EQ(changes_ms(truth), changes_ms(marks));
  const auto none = with_trigger([](int) { return "n/a"; });
  EXPECT_THAT(changes_ms(none), IsEmpty());
  EXPECT_THAT(none.notes, Contains("the trigger 'trigger' has no numbers, and no words such as "
                                   "grab and release: ignored"));
}

// Of a grip and a trigger the first was taken, so a recorded release was not used.
TEST(TableTrigger, OfSeveralColumnsIsTheOneThatIsPressedAndLetGo) {
  const std::string poses =
      "time,head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz,"
      "right_x,right_y,right_z,right_qw,right_qx,right_qy,right_qz,";
  const auto ms = [&](const std::string& names, const std::function<std::string(int)>& cells) {
    return changes_ms(with_trigger(cells, poses + names + "\n"));
  };
  const auto pressed = [](int i) { return held(i) ? "1" : "0"; };
  const auto early = [](int i) { return i > 2 && i < 5 ? "1" : "0"; };
  const std::vector<std::pair<std::int64_t, bool>> wanted = {{100, true}, {300, false}};
  const auto both = [](const auto& a, const auto& b) {
    return [a, b](int i) { return std::string(a(i)) + "," + b(i); };
  };
  const auto never = [](int) { return "0"; };
  EXPECT_EQ(ms("right_grip,right_trigger", both(never, pressed)), wanted);
  EXPECT_EQ(ms("right_trigger,right_grip", both(never, pressed)), wanted);
  EXPECT_EQ(ms("right_grip,right_trigger", both(early, pressed)), wanted);
  EXPECT_EQ(ms("button,trigger", both(never, pressed)), wanted);
  EXPECT_EQ(ms("button,trigger", both(pressed, never)), wanted);
  EXPECT_EQ(ms("menu_button,trigger", both(early, pressed)), wanted);
}

TEST(TableTrigger, ThatIsNeverPressedAndLetGoIsNoted) {
  const std::string note = "the trigger 'trigger' is never pressed and let go: not used";
  EXPECT_THAT(with_trigger([](int) { return "0"; }).notes, Contains(note));
  EXPECT_THAT(with_trigger([](int i) { return i > 20 ? "1" : "0"; }).notes, Contains(note));
  EXPECT_THAT(with_trigger([](int i) { return held(i) ? "1" : "0"; }).notes,
              testing::Not(Contains(note)));
}

TEST(TableTrigger, MayBePressedOrNotPressed) {
  const auto tracks = with_trigger([](int i) { return held(i) ? "pressed" : "not pressed"; });
  EXPECT_THAT(changes_ms(tracks), ElementsAre(std::pair(100, true), std::pair(300, false)));
}

// Rows of units as programs write them: in brackets, and with words that are no unit here.
TEST(TableHeader, HasARowOfUnits) {
  const std::string names =
      "timestamp,head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz,"
      "right_x,right_y,right_z,right_qw,right_qx,right_qy,right_qz,trigger\n";
  const auto cell = [](int i) { return held(i) ? "1" : "0"; };
  for (const char* units : {"s,cm,cm,cm,,,,,cm,cm,cm,,,,,%\n", "s,cm,cm,cm,,,,,cm,cm,cm,,,,,V\n",
                            "[s],[cm],[cm],[cm],,,,,[cm],[cm],[cm],,,,,[0/1]\n",
                            "(s),(cm),(cm),(cm),-,-,-,-,(cm),(cm),(cm),-,-,-,-,percent\n"}) {
    SCOPED_TRACE(units);
    const MotionTracks tracks = with_trigger(cell, names + units);
    EXPECT_EQ(tracks.reading.unit_m, 0.01);
    EXPECT_EQ(tracks.reading.time_unit_s, 1.0);
    EXPECT_EQ(changes_ms(tracks).size(), 2u);
  }
}

TEST(TableHeader, IsNotMixedWithALineOfOtherWords) {
  const auto tracks =
      with_trigger([](int i) { return held(i) ? "1" : "0"; },
                   "Laboratory 3,P07,throw 2\n"
                   "time,head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz,"
                   "right_x,right_y,right_z,right_qw,right_qx,right_qy,right_qz,trigger\n");
  EXPECT_EQ(tracks.tracks.size(), 2u);
  EXPECT_EQ(changes_ms(tracks).size(), 2u);
}

/// A table of two columns that may be a trigger.
std::string two_columns(const std::vector<std::pair<double, double>>& rows,
                        const std::string& names = "menu,pull") {
  std::string text = fmt::format("time,{},number\n", names);
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += fmt::format("{:.2f},{},{},1\n", 0.01 * static_cast<double>(i), rows[i].first,
                        rows[i].second);
  return text;
}

// A press is above half of the largest value, so at half of it a trigger is let go.
TEST(TableTrigger, OfTwoColumnsIsTheOneThatComesBackToHalfOfItsLargestValue) {
  const auto better = [](const std::vector<std::pair<double, double>>& rows,
                         const std::string& names = "menu,pull") {
    const std::string text = two_columns(rows, names);
    return better_trigger(read_any_table(text, "t.csv"), 1, 2);
  };
  EXPECT_EQ(better({{0, 50}, {0, 100}, {0, 50}, {0, 50}}), 2u);
  EXPECT_EQ(better({{0, 40}, {0, 100}, {0, 40}, {0, 100}}), 2u);
  EXPECT_EQ(better({{0, 51}, {0, 100}, {0, 51}, {0, 100}}), 1u);
  EXPECT_EQ(better({{0, 0}, {0, 0.2}, {0, 0.09}, {0, 0.2}}), 2u);
  // One that stays pressed is not let go.
  EXPECT_EQ(better({{0, 0}, {1, 1}, {1, 1}, {1, 0}}), 2u);
  // Of none, and of two of them, the one of that name, else the first.
  EXPECT_EQ(better({{0, 0}, {0, 0}, {0, 0}}), 1u);
  EXPECT_EQ(better({{0, 0}, {0, 0}, {0, 0}}, "menu,trigger"), 2u);
  EXPECT_EQ(better({{-1, -1}, {-3, -1}, {0, -1}, {-1, -1}}, "menu,pull"), 1u);
}

TEST(TableTrigger, IsPressedAboveHalfOfItsLargestValueWithoutANote) {
  const std::string text = two_columns({{0, 0}, {50, 0}, {51, 0}, {100, 0}, {50, 0}, {40, 0}});
  const AnyTable table = read_any_table(text, "t.csv");
  TimedRows rows;
  for (const AnyTable::Row& row : table.rows)
    rows.emplace_back(Time{10'000} * static_cast<int>(rows.size()), &row);
  std::vector<std::string> notes;
  const std::vector<Stamped<bool>> changes = presses(table, 1, rows, notes);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].time, Time{20'000});
  EXPECT_TRUE(changes[0].value);
  EXPECT_EQ(changes[1].time, Time{40'000});
  EXPECT_FALSE(changes[1].value);
  EXPECT_THAT(notes, IsEmpty());
  EXPECT_THAT(presses(table, 2, rows, notes), IsEmpty());
  EXPECT_THAT(notes, ElementsAre("the trigger 'pull' is never pressed and let go: not used"));
}

}  // namespace
}  // namespace headpin::devices
