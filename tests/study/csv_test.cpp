// Tables as they come from people and spreadsheets.

#include "study/csv.h"

#include <gmock/gmock.h>

#include "tests/support/folder.h"

namespace headpin::study {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Csv, QuotesCommasAndLinesWithinACellComeBack) {
  const std::vector<std::string> cells = {"plain", "a,b", "say \"yes\"", "two\nlines", "", "ä日本"};
  std::string text = csv_line({"a", "b", "c", "d", "e", "f"}) + csv_line(cells) + csv_line(cells);
  const CsvTable table = parse_csv(text, "t.csv");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].cells, cells);
  EXPECT_EQ(table.rows[0].line, 2);
  EXPECT_EQ(table.rows[1].line, 4);  // behind a cell of two lines
}

TEST(Csv, WhatASpreadsheetMakesOfItIsTheSameTable) {
  const CsvTable table = parse_csv(
      "\xef\xbb\xbf"
      "a;b\r\n 0,7 ;x\r\n;\r\n",
      "t.csv");
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0].cells, ElementsAre("0,7", "x"));
  EXPECT_EQ(number_in(table, "0,7"), 0.7);
  EXPECT_EQ(number_in(parse_csv("a,b\n", "t.csv"), "0,7"), std::nullopt);
}

// As old programs on a Mac write them, and Excel where it is asked for "Macintosh".
TEST(Csv, ACarriageReturnAloneEndsALine) {
  const CsvTable table = parse_csv("a;b\r1;\"two\rlines\"\r3;4\r", "t.csv");
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_THAT(table.rows[1].cells, ElementsAre("3", "4"));
  EXPECT_EQ(table.rows[1].line, 4);
  const auto says = [](const std::string& text) {
    return complaint([&] { parse_csv(text, "t.csv"); });
  };
  EXPECT_THAT(says("a\rb\rz\xfcrich\r"), HasSubstr("t.csv:3: expected text in UTF-8"));
  EXPECT_THAT(says("a,b\r1\r"), HasSubstr("t.csv:2: expected 2 cells, found 1"));
}

TEST(Csv, WhatIsNoTableIsRefusedWithFileAndLine) {
  const auto says = [](const std::string& text) {
    return complaint([&] { parse_csv(text, "t.csv"); });
  };
  EXPECT_THAT(says(""), HasSubstr("t.csv:1: expected a line of column names"));
  EXPECT_THAT(says("a,b\n1,2\n3\n"), HasSubstr("t.csv:3: expected 2 cells, found 1"));
  EXPECT_THAT(says("a,b\n\"1,2\n"), HasSubstr("t.csv:2: expected a quote"));
  EXPECT_THAT(says("a,a\n"), HasSubstr("t.csv:1: column 'a' occurs twice"));
  EXPECT_THAT(says("a,\n"), HasSubstr("t.csv:1: column 2 has no name"));
  EXPECT_THAT(says("a,b\n\"1\"x,2\n"), HasSubstr("t.csv:2:"));
  EXPECT_THAT(says(std::string("\xff\xfe"
                               "a\0",
                               4)),
              HasSubstr("t.csv:1: expected text in UTF-8"));
  EXPECT_THAT(says("a\nb\nz\xfcrich\n"), HasSubstr("t.csv:3: expected text in UTF-8"));
}

}  // namespace
}  // namespace headpin::study
