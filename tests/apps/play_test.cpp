#include <fstream>

#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

/// The page is made elsewhere (apps/report); here stands what a scenario is put into.
class Play : public CommandLine {
 protected:
  Play() { std::ofstream(folder_ / "page.html") << "<html><!--headpin:data--></html>"; }
};

TEST_F(Play, WritesAPageOfAnyScenario) {
  const nlohmann::json made = json("play --json paper-experiment -o play.html --page page.html");
  EXPECT_EQ(made["scenario"], "paper-experiment");
  EXPECT_EQ(made["bytes"], fs::file_size(folder_ / "play.html"));
  const std::string page = slurp(folder_ / "play.html");
  EXPECT_THAT(page, HasSubstr("data-block=\"play\""));
  EXPECT_THAT(page, HasSubstr("data-block=\"play-numbers\""));
  EXPECT_LT(page.size(), 200'000u);  // beside the page itself
  ASSERT_EQ(headpin("play paper-experiment -o - --page page.html").out, page);
  ASSERT_NE(headpin("play paper-experiment --set ball.mass=5 -o - --page page.html").out, page);
}

TEST_F(Play, RefusesInWords) {
  ASSERT_EQ(headpin("play -o play.html --page page.html").code, 0);
  expect_refusal("play -o play.html --page page.html", 1, "--force");
  expect_refusal("play no-such-room -o OUT.html --page page.html", 1, "no-such-room");
  expect_refusal("play -o OUT.html --page other.html", 1, "other.html");
  expect_refusal("play -o OUT.html --set ball.mass=-1 --page page.html", 2, "ball.mass");
  expect_refusal("play -o OUT.txt --page page.html", 2, ".html");
}

}  // namespace
}  // namespace headpin
