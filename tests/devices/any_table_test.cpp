// How the cells, columns and facts of a foreign table are found in its text.

#include "devices/recordings/any_table.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/table_time.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Names or units of the columns; those of a table that is refused are none.
std::vector<std::string> cells_above(std::string_view text, std::string FoundColumn::*which) {
  std::vector<std::string> all;
  for (const FoundColumn& column : read_any_table(text, "t.csv").columns)
    all.push_back(column.*which);
  return all;
}

std::vector<std::string> names_above(const std::string& text) {
  return cells_above(text, &FoundColumn::name);
}

std::vector<std::string> units_above(const std::string& text) {
  return cells_above(text, &FoundColumn::unit);
}

std::string table_complaint(const std::string& text) {
  return complaint([&] { read_any_table(text, "t.csv"); });
}

const std::string kFourNumbers = "0.00,1,2,3\n0.01,1,2,3\n";

TEST(AnyTableCells, AreWithoutQuotesAndBlanksAroundThem) {
  const std::string text = "t,x,y,z,word\n0.00,\"1\", '2' ,+3,\"\"\n0.01,1,2,3,\" a, b \"\n";
  const AnyTable table = read_any_table(text, "t.csv");
  ASSERT_THAT(table.rows, SizeIs(2));
  EXPECT_THAT(table.rows[0].cells, ElementsAre("0.00", "1", "2", "+3", ""));
  EXPECT_THAT(table.rows[1].cells, ElementsAre("0.01", "1", "2", "3", "a, b"));
  EXPECT_EQ(table.rows[1].line, 3u);
}

TEST(AnyTableCells, BetweenTabsMayBeEmptyAtBothEndsAndBetweenBlanksNone) {
  const std::string tabs =
      "\tx\ty\tz\tname\tmore\n0.00\t1\t2\t3\ta b\t4\n\t1\t2\t3\tc d\t4\n0.01\t1\t2\t3\td e\t\n";
  const AnyTable between_tabs = read_any_table(tabs, "t.tsv");
  EXPECT_EQ(between_tabs.separator, '\t');
  EXPECT_THAT(names_above(tabs), ElementsAre("#1", "x", "y", "z", "name", "more"));
  ASSERT_THAT(between_tabs.rows, SizeIs(3));
  EXPECT_THAT(between_tabs.rows[1].cells, ElementsAre("", "1", "2", "3", "c d", "4"));
  EXPECT_THAT(between_tabs.rows[2].cells, ElementsAre("0.01", "1", "2", "3", "d e", ""));

  const std::string blanks = "  t   x  y  z \n 0.00   1  2  3 \n 0.01 \t1  2  3\n";
  const AnyTable between_blanks = read_any_table(blanks, "t.txt");
  EXPECT_EQ(between_blanks.separator, ' ');
  ASSERT_THAT(between_blanks.rows, SizeIs(2));
  EXPECT_THAT(between_blanks.rows[1].cells, ElementsAre("0.01", "1", "2", "3"));
}

// Columns between tabs that are empty in all rows, as of a hand that was not tracked, moved the names of those
// behind them.
TEST(AnyTableCells, BetweenTabsAreUnderTheirNamesWhereColumnsAreEmpty) {
  for (const int rows : {2, 200}) {
    std::string text = "t\tleft x\tleft y\thead x\thead y\thead z\n";
    for (int i = 0; i < rows; ++i) text += fmt::format("{}\t\t\t1\t2\t3\n", i);
    const AnyTable table = read_any_table(text, "t.tsv");
    EXPECT_EQ(table.separator, '\t');
    EXPECT_THAT(names_above(text),
                ElementsAre("t", "left x", "left y", "head x", "head y", "head z"));
    ASSERT_THAT(table.rows, SizeIs(rows));
    EXPECT_THAT(table.rows[1].cells, ElementsAre("1", "", "", "1", "2", "3"));
  }
  // Several tabs may be one separator.
  const std::string aligned = "time_s\tx\t\ty\tz\n0.00\t\t1\t2\t3\n0.01\t\t1\t2\t3\n";
  EXPECT_THAT(names_above(aligned), ElementsAre("time_s", "x", "y", "z"));
  EXPECT_THAT(read_any_table(aligned, "t.txt").rows[0].cells, ElementsAre("0.00", "1", "2", "3"));
}

TEST(AnyTableCells, AreNumbersOfUpTo64Characters) {
  const AnyTable table;
  EXPECT_EQ(table.number("1." + std::string(62, '0')), 1.0);
  EXPECT_EQ(table.number("1." + std::string(63, '0')), std::nullopt);
  EXPECT_EQ(table.number("+0.5"), 0.5);
  EXPECT_EQ(table.number("0,5"), std::nullopt);
}

// A row of a body that was not seen yet is the first row, and no line of the header.
TEST(AnyTableRows, BeginWithTheFirstOneWhoseCellsAreNumbersOrBlank) {
  for (const char* blank : {"", "n/a", "N/A", "NA", "NaN", "null", "None"}) {
    const std::string text =
        fmt::format("t,a,b,c,d\n0.00,1,{},low,high\n0.01,1,2,3,4\n0.02,1,2,3,4\n", blank);
    EXPECT_THAT(read_any_table(text, "t.csv").rows, SizeIs(3)) << blank;
  }
  EXPECT_THAT(read_any_table("t,a,b,c,d\n0.00,1,mid,low,high\n0.01,1,2,3,4\n", "t.csv").rows,
              SizeIs(1));
  EXPECT_THAT(read_any_table("t,a,b,c\n0.00,1,low,high\n0.01,1,2,3\n", "t.csv").rows, SizeIs(2));
}

TEST(AnyTableRows, HaveFourCellsAtLeast) {
  EXPECT_THAT(read_any_table(kFourNumbers, "t.csv").rows, SizeIs(2));
  EXPECT_EQ(table_complaint("0.00,1,2\n0.01,1,2\n"),
            "t.csv: expected a table: lines with at least four cells, most of them numbers; found "
            "none in 2 lines");
}

TEST(AnyTableRows, AreNoComments) {
  for (const char* sign : {"#", "%", "//"}) {
    const std::string text = fmt::format(
        "{0}\n{0} of 2026\nt,x,y,z\n0.00,1,2,3\n{0}0.5,1,2,3\n  {0} 1,2\n0.01,1,2,3\n", sign);
    const AnyTable table = read_any_table(text, "t.csv");
    EXPECT_THAT(table.rows, SizeIs(2)) << sign;
    EXPECT_THAT(table.notes, IsEmpty()) << sign;
    EXPECT_THAT(names_above(text), ElementsAre("t", "x", "y", "z")) << sign;
  }
}

TEST(AnyTableRows, WithOneMoreSeparatorAtTheirEndsHaveNoMoreCells) {
  const std::string some = "t,x,y,z\n0.00,1,2,3\n0.01,1,2,3,\n0.02,1,2,3\n";
  const AnyTable table = read_any_table(some, "t.csv");
  EXPECT_THAT(table.rows, SizeIs(3));
  EXPECT_THAT(table.notes, IsEmpty());
  const std::string all = "t,x,y,z\n0.00,1,2,3,\n# remark\n0.01,1,2,3,\n0.02,1,2,3,\n";
  EXPECT_THAT(names_above(all), ElementsAre("t", "x", "y", "z"));
  EXPECT_THAT(read_any_table(all, "t.csv").rows, SizeIs(3));
  // Of four cells the last one is empty; so is one that a row fills.
  EXPECT_THAT(names_above("t,x,y,z\n0.00,1,2,\n0.01,1,2,\n"), ElementsAre("t", "x", "y", "z"));
  EXPECT_THAT(names_above("t,x,y,z,a\n0.00,1,2,3,\n0.01,1,2,3,4\n"), SizeIs(5));
}

TEST(AnyTableRows, WithAnotherNumberOfCellsThanMostOfTheFirst200AreLeftOut) {
  std::string text = "t,x,y,z\n";
  for (int i = 0; i < 500; ++i) text += fmt::format("{},1,2,3{}\n", i, i < 100 ? "" : ",4");
  // 100 of each: that of fewer cells.
  const AnyTable table = read_any_table(text, "t.csv");
  EXPECT_THAT(table.rows, SizeIs(100));
  EXPECT_THAT(table.notes,
              ElementsAre("400 of 500 lines have another number of cells than 4, the first is line "
                          "102: ignored"));
}

TEST(AnyTableStyle, IsTheOneWithManyNumbersAndFewWords) {
  const AnyTable points = read_any_table("t;x;y;z\n0.5;1;2;3\n1.5;1;2;3\n", "t.csv");
  EXPECT_EQ(points.separator, ';');
  EXPECT_FALSE(points.decimal_comma);
  const std::string remarks =
      "t;x;y;z;remark\n0,5;1,5;2,5;3,5;seen in the frames 1 2 3 4\n"
      "1,5;1,5;2,5;3,5;seen in the frames 1 2 3 4\n";
  const AnyTable commas = read_any_table(remarks, "t.csv");
  EXPECT_EQ(commas.separator, ';');
  EXPECT_TRUE(commas.decimal_comma);
  EXPECT_EQ(commas.number(commas.rows.at(1).cells[1]), 1.5);

  std::string words_below = kFourNumbers;
  for (int i = 0; i < 60; ++i) words_below += "no,more,of,them\n";
  const AnyTable plain = read_any_table(words_below, "t.csv");
  EXPECT_EQ(plain.separator, ',');
  EXPECT_FALSE(plain.decimal_comma);
}

TEST(AnyTableHeader, OfSeveralLinesNamesColumnsByAllOfThem) {
  EXPECT_THAT(names_above(",head,,,right\nt,x,y,z,x\n0.00,1,2,3,4\n0.01,1,2,3,4\n"),
              ElementsAre("t", "head x", "head y", "head z", "right x"));
  EXPECT_THAT(names_above("a,head,head,right\nt,x,,y\n" + kFourNumbers),
              ElementsAre("a t", "head x", "head", "right y"));
  // A name above a later column alone is one of a group, and no title.
  EXPECT_THAT(names_above(",,right,\nt,s,x,y\n" + kFourNumbers),
              ElementsAre("t", "s", "right x", "right y"));
}

TEST(AnyTableHeader, NamesColumnsWithoutANameByTheirNumber) {
  EXPECT_THAT(names_above(kFourNumbers), ElementsAre("#1", "#2", "#3", "#4"));
  EXPECT_THAT(names_above("t,x,,z\n" + kFourNumbers), ElementsAre("t", "x", "#3", "z"));
  EXPECT_THAT(names_above("t,x,y\n0.00,1,2,3,4\n0.01,1,2,3,4\n"),
              ElementsAre("t", "x", "y", "#4", "#5"));
  EXPECT_THAT(names_above("a,b,c,d\n0.00,1,2,3,4\n0.01,1,2,3,4\n"),
              ElementsAre("a", "b", "c", "d", "#5"));
  EXPECT_THAT(names_above("t,x,y,z,more,and more\n" + kFourNumbers),
              ElementsAre("t", "x", "y", "z"));
}

TEST(AnyTableHeader, HasNoTitles) {
  const std::string six = "0.00,1,2,3,4,5\n0.01,1,2,3,4,5\n", names = "t,x,y,z,a,b\n";
  for (const char* title : {"Throw 7", "Throw 7,,,,,", "Laboratory 3,P07", "Lab 3,P07,throw 2"}) {
    EXPECT_THAT(names_above(title + ("\n" + names) + six),
                ElementsAre("t", "x", "y", "z", "a", "b"))
        << title;
  }
  EXPECT_THAT(names_above("Lab 3,P07,throw 2,1\n" + names + six)[0], "Lab 3 t");
  // Just above the numbers, a few names are those of the first columns.
  EXPECT_THAT(names_above("t,x,y\n" + six), ElementsAre("t", "x", "y", "#4", "#5", "#6"));
  EXPECT_THAT(names_above("Throw 7\nt,x,y,z\n" + kFourNumbers), ElementsAre("t", "x", "y", "z"));
}

TEST(AnyTableHeader, MayBeACommentWithAsManyNamesAsColumnsJustAboveTheNumbers) {
  const std::vector<std::string> names = {"t", "x", "y", "z"};
  for (const char* line : {"# t,x,y,z", "#t,x,y,z,", "%% t, x, y, z", "// t,x,y,z"})
    EXPECT_EQ(names_above(line + ("\n" + kFourNumbers)), names) << line;
  const std::vector<std::string> none = {"#1", "#2", "#3", "#4"};
  for (const char* line : {"# t,x,y", "# t,x,y,z,a", "# t,x,y,z\n# of 2026", "#", "##"})
    EXPECT_EQ(names_above(line + ("\n" + kFourNumbers)), none) << line;
}

TEST(AnyTableUnits, AreInBracketsBehindANameOrInARow) {
  const std::string in_names = "t [ms],x (MM),pos[0] raw,z (raw]\n" + kFourNumbers;
  EXPECT_THAT(units_above(in_names), ElementsAre("ms", "mm", "", ""));
  EXPECT_THAT(names_above(in_names), ElementsAre("t", "x", "pos[0] raw", "z (raw]"));
  EXPECT_THAT(cells_above(in_names, &FoundColumn::written),
              ElementsAre("t [ms]", "x (MM)", "pos[0] raw", "z (raw]"));

  const std::string five = "0.00,1,2,3,4\n0.01,1,2,3,4\n", names = "t,a,b,c,d\n";
  EXPECT_THAT(units_above(names + "[s],(mm),deg,[mm,\n" + five),
              ElementsAre("s", "mm", "deg", "", ""));
  EXPECT_THAT(units_above(names + "[s],(mm),deg,(mm,mm]\n" + five),
              ElementsAre("s", "mm", "deg", "", ""));
  EXPECT_THAT(names_above(names + "[s],(mm),deg,[mm,\n" + five),
              ElementsAre("t", "a", "b", "c", "d"));
  EXPECT_THAT(units_above(names + "s,m,apples,,\n" + five), ElementsAre("s", "m", "", "", ""));
  // Words of which half are units are names.
  EXPECT_THAT(names_above("s,m,a,b\n" + kFourNumbers), ElementsAre("s", "m", "a", "b"));
  EXPECT_THAT(names_above("s,m,a,b,c\n" + five), ElementsAre("s", "m", "a", "b", "c"));
}

TEST(AnyTableFacts, AreInTheFirstLinesOfMotiveAndVicon) {
  const std::string motive =
      "Format Version,1.23,Length Units,Meters,Rotation Type,XYZ,Odd\nt,x,y,z\n" + kFourNumbers;
  const AnyTable table = read_any_table(motive, "t.csv");
  using Fact = std::pair<std::string, std::string>;
  EXPECT_EQ(table.kind, "Motive");
  EXPECT_THAT(table.facts,
              ElementsAre(Fact("format version", "1.23"), Fact("length units", "meters"),
                          Fact("rotation type", "xyz")));
  EXPECT_THAT(names_above(motive), ElementsAre("t", "x", "y", "z"));
  EXPECT_EQ(table.fact("rate"), "");
  for (const char* first : {"Segments", "Objects"}) {
    const std::string vicon = first + ("\n100\nt,x,y,z\n" + kFourNumbers);
    const AnyTable segments = read_any_table(vicon, "t.csv");
    EXPECT_EQ(segments.kind, "Vicon") << first;
    EXPECT_EQ(segments.fact("rate"), "100") << first;
    EXPECT_THAT(names_above(vicon), ElementsAre("t", "x", "y", "z")) << first;
  }
  EXPECT_EQ(read_any_table("Throws\nt,x,y,z\n" + kFourNumbers, "t.csv").kind, "");
}

TEST(AnyTableLimits, AreAMillionBytesALineAndFourThousandColumns) {
  const std::string padded = "0.00,1,2,3" + std::string(999'990, ' ');
  EXPECT_EQ(table_complaint(padded + "\n" + kFourNumbers), "");
  EXPECT_EQ(table_complaint(padded + " \n" + kFourNumbers),
            "t.csv:1: expected a line of a table, found one of 1000001 bytes");
  std::string row = "0";
  for (int i = 1; i < 4000; ++i) row += ",1";
  EXPECT_EQ(table_complaint(row + "\n"), "");
  EXPECT_EQ(table_complaint("\n" + row + ",1\n"),
            "t.csv:2: expected at most 4000 columns, found 4001");
}

TEST(AnyTableNames, AloneAreSaidToBeSoForUpToFourLines) {
  std::string text;
  for (int lines = 1; lines <= 5; ++lines) {
    text += "time,head x,head y,head z\n";
    EXPECT_THAT(table_complaint(text),
                HasSubstr(lines <= 4 ? "has column names but no rows" : "found none in 5 lines"));
  }
}

TEST(AnyTableNames, InMessagesHaveUpTo120Characters) {
  AnyTable table;
  table.columns.push_back({.name = std::string(120, 'a'), .last = "", .written = "", .unit = ""});
  EXPECT_EQ(names_in(table), "the 1 columns are " + std::string(120, 'a'));
  table.columns.push_back(table.columns[0]);
  EXPECT_EQ(names_in(table), "the 2 columns are " + std::string(120, 'a') + ", ...");
  table.columns[0].name += 'a';
  EXPECT_EQ(names_in(table), "the 2 columns are ...");
}

TEST(SplitCells, KeepsACommaInANumberBeforeABlank) {
  EXPECT_THAT(split_cells("1,2 grab"), ElementsAre("1,2", "grab"));
  EXPECT_THAT(split_cells("1,2"), ElementsAre("1", "2"));
  EXPECT_THAT(split_cells("1, grab"), ElementsAre("1", "grab"));
  EXPECT_THAT(split_cells("1.5 let go"), ElementsAre("1.5", "let", "go"));
  EXPECT_THAT(split_cells("let go,2"), ElementsAre("let go", "2"));
  EXPECT_THAT(split_cells("1,2;let go"), ElementsAre("1,2", "let go"));
  EXPECT_THAT(split_cells("1,2\tlet go"), ElementsAre("1,2", "let go"));
  EXPECT_THAT(split_cells(""), IsEmpty());
}

std::string rows_of(int count, std::string_view row) {
  std::string rows;
  for (int i = 0; i < count; ++i) rows += fmt::format("{}{}\n", i, row);
  return rows;
}

// A line with another number of words than the rows have says nothing of what several tabs are.
TEST(AnyTableTabs, ThatAlignAreOneSeparator) {
  const std::vector<std::string> names = {"time_s", "hmd_x", "hmd_y", "hmd_z"};
  const std::string header = "time_s\t\thmd_x\thmd_y\thmd_z\n",
                    rows = rows_of(60, "\t\t1\t\t2\t\t3");
  for (const std::string& text :
       {header + rows, "Session\n" + header + rows, header + rows + "60\t\t1.6",
        header + "s\t\tm\n" + rows, "# a\tb\tc\td\te\tf\n" + header + rows + "60\t\t1"}) {
    EXPECT_EQ(names_above(text), names) << text.substr(0, 60);
    const AnyTable table = read_any_table(text, "t.txt");
    ASSERT_THAT(table.rows, SizeIs(60));
    EXPECT_THAT(table.rows[1].cells, ElementsAre("1", "1", "2", "3"));
  }
}

// Values of eight characters reach the next tab stop, and are behind one tab.
TEST(AnyTableTabs, BehindWhichValuesAreAtTabStopsAreOneSeparator) {
  std::string text = "Room 3\ntimestamp\t\thmd_x\t\thmd_y\t\thmd_z\t\thmd_w\n";
  for (int i = 0; i < 300; ++i) {
    const std::string x = fmt::format("{}", i % 10 == 0 ? 0.00699428 : 0.5);
    text += fmt::format("{}\t\t{}{}1.7\t\t0.05\t\t1\n", i, x, x.size() < 8 ? "\t\t" : "\t");
  }
  const AnyTable table = read_any_table(text, "t.txt");
  EXPECT_THAT(names_above(text), ElementsAre("timestamp", "hmd_x", "hmd_y", "hmd_z", "hmd_w"));
  EXPECT_THAT(table.notes, IsEmpty());
  ASSERT_THAT(table.rows, SizeIs(300));
  EXPECT_THAT(table.rows[10].cells, ElementsAre("10", "0.00699428", "1.7", "0.05", "1"));
}

TEST(AnyTableTabs, ThatAlignMayBeBelowALineWithAsManyTabs) {
  // A word that few rows have is behind one tab more.
  const std::string events = "timestamp\tx\ty\tz\tevent\n" + rows_of(30, "\t\t1\t2\t3") +
                             "30\t\t1\t2\t3\tgrab\n" + rows_of(60, "\t\t1\t2\t3");
  EXPECT_THAT(read_any_table(events, "t.txt").rows.at(1).cells, ElementsAre("1", "1", "2", "3"));
  // One without a name may be that of the tab that aligns.
  const std::string open = "timestamp\tx\ty\tz\t\n" + rows_of(60, "\t\t1\t2\t3");
  EXPECT_THAT(names_above(open), ElementsAre("timestamp", "x", "y", "z"));
  EXPECT_THAT(read_any_table(open, "t.txt").rows.at(1).cells, ElementsAre("1", "1", "2", "3"));
  // Rows without empty cells, and a header that is aligned.
  const std::string aligned =
      "# a\tb\tc\td\nevent\t\tx\t\ty\t\tz\n" + rows_of(20, ".00001\t1\t2\t3");
  EXPECT_THAT(names_above(aligned), ElementsAre("event", "x", "y", "z"));
}

// The names may be in a comment, and rows may be cut, or have no name above their first cells.
TEST(AnyTableTabs, BelowNamesOfAllColumnsBeginOneEach) {
  const std::string names = "t\tlx\tly\thx\thy\thz", row = "\t\t\t1\t2\t3";
  for (const std::string& text :
       {"# " + names + "\n" + rows_of(60, row), names + "\n" + rows_of(60, row) + "60\t\t\t1.",
        "Session 3\n# of 2026\n" + names + "\n# remark\n" + rows_of(60, row) + "the end\n",
        names + "\t\n" + rows_of(60, row + "\t"), "# " + names + "\n" + rows_of(60, row + "\t")}) {
    EXPECT_THAT(names_above(text), ElementsAre("t", "lx", "ly", "hx", "hy", "hz")) << text;
    const AnyTable table = read_any_table(text, "t.tsv");
    ASSERT_THAT(table.rows, SizeIs(60));
    EXPECT_EQ(table.rows[1].cells[3], "1");
  }
  const std::string numbered = "\t" + names + "\n" + rows_of(60, "\t0.5" + row);
  EXPECT_THAT(names_above(numbered), ElementsAre("#1", "t", "lx", "ly", "hx", "hy", "hz"));
}

// The last columns are empty in all rows: the last separator of a row is then one at its end.
TEST(AnyTableHeader, InACommentMayNameTheColumnBehindTheLastSeparators) {
  for (const char separator : {',', ';', '\t'}) {
    std::string text = "# t,x,y,z,rx,ry,rz\n" + rows_of(20, ",1,2,3,,,");
    std::ranges::replace(text, ',', separator);
    EXPECT_THAT(names_above(text), ElementsAre("t", "x", "y", "z", "rx", "ry")) << separator;
    EXPECT_THAT(names_above(text + "20"), ElementsAre("t", "x", "y", "z", "rx", "ry", "rz"));
  }
}

TEST(AnyTableStyle, IsOneOfFewNumbersAmongManyEmptyCells) {
  std::string text = "t;x;y;z";
  for (int i = 0; i < 100; ++i) text += fmt::format(";n{}", i);
  text += "\n" + rows_of(60, ",5;1,5;2,5;3,5" + std::string(100, ';'));
  const AnyTable table = read_any_table(text, "t.csv");
  EXPECT_EQ(table.separator, ';');
  EXPECT_TRUE(table.decimal_comma);
  EXPECT_THAT(table.rows, SizeIs(60));
}

// A rate with a comma was no rate, and the time had no unit.
TEST(AnyTableFacts, AreNumbersAsTheTableHasThem) {
  for (const auto& [rate, hz] : {std::pair{"120,5", 120.5}, {"120.5", 120.5}, {"120", 120.0}}) {
    const std::string text =
        fmt::format("Segments\n{}\nFrame;x;y;z\n", rate) + rows_of(20, ";1,5;2,5;3,5");
    const AnyTable table = read_any_table(text, "t.csv");
    EXPECT_EQ(table.number(table.fact("rate")), hz) << rate;
    std::vector<std::string> notes;
    EXPECT_DOUBLE_EQ(read_times(table, 0, {}, "t.csv", notes).unit_s, 1.0 / hz) << rate;
  }
  const std::string points = "Segments\n120,5\nt;x;y;z\n" + rows_of(20, ";1.5;2.5;3.5");
  const AnyTable mixed = read_any_table(points, "t.csv");
  EXPECT_EQ(mixed.number(mixed.fact("rate")), 120.5);
}

}  // namespace
}  // namespace headpin::devices
