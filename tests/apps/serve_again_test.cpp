// Another link of a participant whose page was closed in the middle of a game.

#include "tests/apps/serving.h"

namespace headpin {
namespace {

using testing::HasSubstr;

// Until the server was started anew, no link was for a participant whose page was closed in a game.
TEST_F(Serve, AParticipantWhoseGameWasCutOffBeginsAgainByAnotherLink) {
  ASSERT_EQ(headpin("experiment plan -o study --people 2").code, 0);
  start("study --links 2");
  const auto again = [&](const std::string& link) {
    return ask("POST", "/links" + operator_.substr(1) + "&again=" + link.substr(6));
  };
  EXPECT_EQ(again(links_[0]).status, 409);  // it can be used
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  const std::string log = slurp(kDemoLog);
  EXPECT_EQ(post(links_[0], "log?at=0", log.substr(0, 20'000)).status, 200);
  const Reply made = again(links_[0]);
  ASSERT_EQ(made.status, 200) << made.body;
  const auto other = nlohmann::json::parse(made.body);
  EXPECT_EQ(other["participant"], "p001");
  EXPECT_EQ(again(links_[0]).body, made.body);
  // The page may go on until the other one begins.
  EXPECT_EQ(post(links_[0], "log?at=20000", log.substr(20'000, 5000)).status, 200);
  EXPECT_EQ(ask("GET", other["path"]).status, 200);
  EXPECT_EQ(post(other["path"], "begin", "", kOtherKey).body, R"({"size":0})");
  EXPECT_EQ(post(other["path"], "log?at=0", log, kOtherKey).status, 200);
  const Reply late = post(links_[0], "log?at=25000", "x");
  EXPECT_EQ(late.status, 403);
  EXPECT_THAT(late.body, HasSubstr("this game goes on by another link"));
  EXPECT_EQ(post(links_[0], "begin").status, 403);
  EXPECT_EQ(guest(0)["state"], "cut off");
  expect_refusal("experiment run study --participant p001 --virtual", 75, "p001");
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(slurp(folder_ / "study/sessions/p001/run-01.lcmlog"), log.substr(0, 25'000));
  EXPECT_EQ(slurp(folder_ / "study/sessions/p001/run-02.lcmlog"), log);
}

// The page came back and ended its game before the other link was used.
TEST_F(Serve, AnotherLinkBeginsNoGameAfterTheEndOfTheFirst) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  const std::string again = "/links" + operator_.substr(1) + "&again=" + links_[0].substr(6);
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", "all").status, 200);
  const std::string other = nlohmann::json::parse(ask("POST", again).body)["path"];
  EXPECT_EQ(post(links_[0], "end?at=3").status, 200);
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 409);
  EXPECT_EQ(ask("POST", again).status, 409);
}

// The lock was given back before it was known whether the other game can begin.
TEST_F(Serve, TheSessionStaysLockedWhenAnotherLinkCannotBeginItsGame) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  const std::string again = "/links" + operator_.substr(1) + "&again=" + links_[0].substr(6);
  const std::string log = slurp(kDemoLog);
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", log.substr(0, 20'000)).status, 200);
  const std::string other = nlohmann::json::parse(ask("POST", again).body)["path"];
  const fs::path sessions = folder_ / "study/sessions/p001", aside = folder_ / "aside";
  fs::rename(sessions, aside);
  spit(sessions, "no folder");
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 500);
  fs::remove(sessions);
  fs::rename(aside, sessions);
  expect_refusal("experiment run study --participant p001 --virtual", 75, "p001");
  EXPECT_EQ(post(links_[0], "log?at=20000", log.substr(20'000, 5000)).status, 200);
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 200);
  EXPECT_EQ(post(other, "log?at=0", log, kOtherKey).status, 200);
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(slurp(folder_ / "study/sessions/p001/run-02.lcmlog"), log);
}

// The folder was missing until the server was started anew.
TEST_F(Serve, AnotherLinkBeginsItsGameWhereTheFolderOfTheFirstOneWasPutAside) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  const std::string again = "/links" + operator_.substr(1) + "&again=" + links_[0].substr(6);
  const std::string log = slurp(kDemoLog);
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", log.substr(0, 20'000)).status, 200);
  const std::string other = nlohmann::json::parse(ask("POST", again).body)["path"];
  fs::rename(folder_ / "study/sessions/p001", folder_ / "aside");
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 200);
  EXPECT_EQ(post(other, "log?at=0", log, kOtherKey).status, 200);
  expect_refusal("experiment run study --participant p001 --virtual", 75, "p001");
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(slurp(folder_ / "aside/run-01.lcmlog"), log.substr(0, 20'000));
  EXPECT_EQ(slurp(folder_ / "study/sessions/p001/run-01.lcmlog"), log);
}

}  // namespace
}  // namespace headpin
