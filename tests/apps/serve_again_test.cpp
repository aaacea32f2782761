// Another link of a participant whose page was closed in the middle of a game.

#include <algorithm>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

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
  EXPECT_EQ(post(links_[0], "log?at=0", slurp(kDemoLog).substr(0, 20'000)).status, 200);
  const std::string other = nlohmann::json::parse(ask("POST", again).body)["path"];
  EXPECT_EQ(post(links_[0], "end?at=20000").status, 200);
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 409);
  EXPECT_EQ(ask("POST", again).status, 409);
}

// Nobody can tell whether it is a whole game: no run follows it.
TEST_F(Serve, AParticipantWhoseLogIsNoneGetsNoOtherLink) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", "no log").status, 200);
  const Reply no = ask("POST", "/links" + operator_.substr(1) + "&again=" + links_[0].substr(6));
  EXPECT_EQ(no.status, 409);
  EXPECT_THAT(no.body, HasSubstr("run-01.lcmlog: not an LCM event log"));
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

// The page was closed behind the last piece, before it could say that this was the end.
TEST_F(Serve, AParticipantWhoseWholeGameIsThereGetsNoOtherLink) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  fs::copy(folder_ / "study", folder_ / "copy", fs::copy_options::recursive);
  ASSERT_EQ(headpin("experiment run copy --participant p001 --virtual").code, 0);
  const std::string log = slurp(folder_ / "copy/sessions/p001/run-01.lcmlog");
  start("study --links 1");
  const std::string again = "/links" + operator_.substr(1) + "&again=" + links_[0].substr(6);
  const auto send = [&](std::size_t from, std::size_t to) {
    constexpr std::size_t kPiece = 1'000'000;
    for (std::size_t at = from; at < to; at += kPiece) {
      const std::string piece = log.substr(at, std::min(kPiece, to - at));
      ASSERT_EQ(post(links_[0], fmt::format("log?at={}", at), piece).status, 200);
    }
  };
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  ASSERT_NO_FATAL_FAILURE(send(0, log.size() / 2));
  const std::string other = nlohmann::json::parse(ask("POST", again).body)["path"];
  ASSERT_NO_FATAL_FAILURE(send(log.size() / 2, log.size()));
  EXPECT_EQ(guest(0)["state"], "playing");
  for (const Reply& no : {ask("POST", again), post(other, "begin", "", kOtherKey)}) {
    EXPECT_EQ(no.status, 409);
    EXPECT_THAT(no.body, HasSubstr("p001 has played already; a session is played only once"));
  }
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 200);
  const Reply ended = ask("POST", again);
  EXPECT_EQ(ended.status, 409);
  EXPECT_THAT(ended.body, HasSubstr("this game was played to its end"));
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(files_in("study/sessions/p001"), 1u);
}

TEST_F(Serve, AParticipantWhoPlaysByAnotherLinkOrElsewhereGetsNoOtherLink) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  const auto again = [&](const std::string& link) {
    return ask("POST", "/links" + operator_.substr(1) + "&again=" + link.substr(6));
  };
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  const std::string other = nlohmann::json::parse(again(links_[0]).body)["path"];
  EXPECT_EQ(post(other, "begin", "", kOtherKey).status, 200);
  const Reply replaced = again(links_[0]);
  EXPECT_EQ(replaced.status, 409);
  EXPECT_THAT(replaced.body, HasSubstr("this game goes on by another link"));
  // Somebody puts the folder aside, and another program plays the session in a new one.
  const fs::path session = folder_ / "study/sessions/p001";
  fs::rename(session, folder_ / "aside");
  fs::create_directory(session);
  const int elsewhere = open(session.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(elsewhere, LOCK_EX | LOCK_NB), 0);
  const Reply busy = again(other);
  EXPECT_EQ(busy.status, 409);
  EXPECT_THAT(busy.body, HasSubstr("another headpin is playing the session of p001"));
  close(elsewhere);
  EXPECT_EQ(again(other).status, 200);
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace headpin
