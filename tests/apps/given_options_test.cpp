#include "apps/given_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headpin::apps {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Command {
  Command() {
    text = app.add_option("-t,--text", word, "a text");
    app.add_option("--number", number)->capture_default_str();
    app.add_option("--many", many);
    app.add_flag("--flag", flag);
  }
  std::vector<std::string> parse(std::vector<std::string> words) {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    return given_options(app, {});
  }
  CLI::App app;
  CLI::Option* text = nullptr;
  std::string word;
  int number = 7;
  std::vector<std::string> many;
  bool flag = false;
};

TEST(GivenOptions, AreThoseThatTheUserGaveInTheOrderOfTheCommand) {
  EXPECT_THAT(Command().parse({}), IsEmpty());
  EXPECT_THAT(Command().parse({"--flag", "--many", "a", "b c", "--number", "8", "-t", "x y"}),
              ElementsAre("--text=x y", "--number=8", "--many=a", "--many=b c", "--flag=true"));
  EXPECT_THAT(Command().parse({"--number", "7"}), IsEmpty());  // it has this value anyway
}

TEST(GivenOptions, GiveTheSameValuesWhenTheyAreParsedAgain) {
  Command first, second;
  second.parse(first.parse({"--text=-x", "--many", "a", "b=c", "--flag"}));
  EXPECT_EQ(second.word, "-x");
  EXPECT_EQ(second.many, first.many);
  EXPECT_THAT(second.many, ElementsAre("a", "b=c"));
  EXPECT_TRUE(second.flag);
}

TEST(GivenOptions, AreWithoutThoseThatAreNotWanted) {
  Command command;
  command.parse({"-t", "x", "--number", "8"});
  EXPECT_THAT(given_options(command.app, {command.text}), ElementsAre("--number=8"));
}

}  // namespace
}  // namespace headpin::apps
