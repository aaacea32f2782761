#include "apps/wrap.h"

#include <sstream>

#include <gmock/gmock.h>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using apps::wrapped;

TEST(Wrap, ADescriptionGoesOnBelowItsBeginning) {
  const std::string option = "  --fps INT" + std::string(19, ' '), below(30, ' ');
  EXPECT_EQ(wrapped(option + "frame rate of the pictures\n", 42),
            option + "frame rate\n" + below + "of the\n" + below + "pictures\n");
  EXPECT_EQ(wrapped(below + "standard: five samples\n", 42),
            below + "standard:\n" + below + "five samples\n");
}

TEST(Wrap, TextGoesOnBelowItsFirstWord) {
  EXPECT_EQ(wrapped("What the program does\n  for a reader\n", 10),
            "What the\nprogram\ndoes\n  for a\n  reader\n");
  EXPECT_EQ(wrapped("no end of line", 10), "no end of\nline");
}

TEST(Wrap, AValueInALineIsCutBetweenLetters) {
  EXPECT_EQ(apps::in_a_line("a\nb"), "ab");
  EXPECT_EQ(apps::in_a_line(std::string(39, 'a') + "üb"), std::string(39, 'a') + "...");
  EXPECT_EQ(apps::in_a_line(std::string(38, 'a') + "üb"), std::string(38, 'a') + "ü...");
  EXPECT_EQ(apps::in_a_line(std::string(38, 'a') + "山b"), std::string(38, 'a') + "...");
}

TEST(Wrap, WhatFitsOrCannotBeBrokenStays) {
  for (const std::string text : {"", "\n", "ten letter\n", "muchtoolongaword\n", "   \n",
                                 "  headpin replay trial.lcmlog -o out.lcmlog\n"}) {
    EXPECT_EQ(wrapped(text, 10), text);
  }
  EXPECT_EQ(wrapped("muchtoolongaword and another", 10), "muchtoolongaword\nand\nanother");
  EXPECT_EQ(wrapped("a line of any length\n", 0), "a line of any length\n");
}

/// Lines that are longer, without those of commands to copy.
int longer_lines(const std::string& help, std::size_t width) {
  int longer = 0;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    longer += line.size() > width && line.find("  headpin ") != 0;
  }
  return longer;
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\r'; });
  return text;
}

// On a real terminal; elsewhere a line is as long as its text, for grep and for documents.
TEST_F(CommandLine, HelpFitsTheTerminal) {
  for (const std::string words : {"frames --help", "help frames", "--help"}) {
    const std::string file = headpin(words).out;
    const std::string command = "cd '" + folder_.string() +
                                "' && script -qec 'stty cols 78; \"" HEADPIN_PROGRAM "\" " + words +
                                "' /dev/null >terminal.txt </dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const std::string terminal = slurp(folder_ / "terminal.txt");
    EXPECT_EQ(without_spaces(terminal), without_spaces(file)) << words;
    EXPECT_EQ(longer_lines(terminal, 78), 0) << terminal;
    EXPECT_GT(longer_lines(file, 78), 0) << words;
  }
}

}  // namespace
}  // namespace headpin
