#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <list>
#include <thread>

#include <fmt/format.h>

#include "tests/apps/serving.h"
#include "tests/support/lcm_server.h"

namespace headpin {
namespace {

using testing::HasSubstr;

TEST_F(Serve, NothingIsSaidWithoutAToken) {
  start("paper-room -o games");
  EXPECT_EQ(ask("GET", operator_).status, 200);
  EXPECT_EQ(ask("GET", links_[0]).status, 200);
  const std::string wrong = "?token=" + std::string(32, '0');
  for (const std::string& target :
       {std::string("/"), "/" + wrong, "/state" + wrong, std::string("/state"), kNowhere,
        std::string("/play/"), links_[0] + "x", links_[0].substr(0, 20), std::string("/page.html"),
        std::string("/../../../etc/passwd"), std::string("/play/../page.html"),
        std::string("/play/%2e%2e/page.html"), std::string("/said.json") + operator_.substr(1),
        links_[0] + "/log", std::string("*"), "/" + std::string(20'000, 'x')}) {
    const Reply reply = ask("GET", target);
    EXPECT_GE(reply.status, 400) << target;
    EXPECT_LT(reply.status, 500) << target;
    EXPECT_EQ(reply.body.find("headpin:data"), reply.body.npos) << target;
    const bool plain = target.size() < 100 && target != "*";
    EXPECT_TRUE(reply.status == 403 || !plain) << target;
  }
  for (const char* const method : {"PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "NONSENSE"}) {
    EXPECT_EQ(ask(method, links_[0]).status, 403) << method;
    EXPECT_EQ(ask(method, "/").status, 403) << method;
  }
  EXPECT_EQ(files_in("games"), 0u);
  EXPECT_EQ(stop(), 0);
}

TEST_F(Serve, TheLogThatCameInPiecesIsTheLog) {
  start("paper-room -o games --links 2");
  const std::string log = slurp(kDemoLog);
  EXPECT_EQ(post(links_[0], "log?at=0", "x").status, 403);  // nobody has begun
  EXPECT_EQ(post(links_[0], "begin").body, R"({"size":0})");
  const auto piece = [&](std::size_t at, std::size_t size) {
    return post(links_[0], fmt::format("log?at={}", at), log.substr(at, size));
  };
  EXPECT_EQ(piece(0, 1000).body, R"({"size":1000})");
  EXPECT_EQ(piece(0, 1000).body, R"({"size":1000})");    // its answer was lost
  EXPECT_EQ(piece(500, 1000).body, R"({"size":1500})");  // some of it is there
  EXPECT_EQ(piece(2000, 10).status, 409);                // a gap
  EXPECT_EQ(post(links_[0], "log?at=1400", std::string(200, 'x')).status, 409);  // other bytes
  EXPECT_EQ(post(links_[0], "log?at=-5", "x").status, 400);
  EXPECT_EQ(post(links_[0], "log?at=9999999999999999999", "x").status, 400);
  EXPECT_EQ(post(links_[0], "log", "x").status, 400);
  EXPECT_EQ(post(links_[0], "begin").body, R"({"size":1500})");  // where it goes on
  EXPECT_EQ(piece(1500, log.size()).status, 200);
  EXPECT_EQ(post(links_[0], "end?at=7").status, 409);
  EXPECT_FALSE(guest(0)["state"] == "ended");
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 200);
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 200);
  EXPECT_EQ(post(links_[0], fmt::format("log?at={}", log.size()), "more").status, 409);
  EXPECT_EQ(slurp(folder_ / "games/guest-01.lcmlog"), log);
  EXPECT_EQ(guest(0)["state"], "ended");
  EXPECT_EQ(guest(0)["game"]["participant"], "demo");
  EXPECT_EQ(guest(1)["state"], "invited");
  EXPECT_EQ(stop(), 0);
  EXPECT_EQ(json("info --json games/guest-01.lcmlog")["complete"], true);
}

// The answer to the end is lost: the page asks what has arrived, and ends once more.
TEST_F(Serve, TheKeyOfAnEndedGameIsToldItsSize) {
  start("paper-room -o games");
  post(links_[0], "begin");
  EXPECT_EQ(post(links_[0], "log?at=0", "all of it").status, 200);
  EXPECT_EQ(post(links_[0], "end?at=9").status, 200);
  EXPECT_EQ(post(links_[0], "begin").body, R"({"size":9})");
  EXPECT_EQ(post(links_[0], "end?at=9").status, 200);
  EXPECT_EQ(post(links_[0], "begin", "", kOtherKey).status, 403);
  EXPECT_EQ(guest(0)["state"], "ended");
}

TEST_F(Serve, ALinkWorksOnce) {
  start("paper-room -o games");
  EXPECT_EQ(post(links_[0], "begin", "", "short").status, 400);
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(ask("GET", links_[0]).status, 403);
  EXPECT_EQ(post(links_[0], "begin", "", kOtherKey).status, 403);
  EXPECT_EQ(post(links_[0], "log?at=0", "x", kOtherKey).status, 403);
  EXPECT_EQ(post(links_[0], "end?at=0", "", kOtherKey).status, 403);
  const std::string more = ask("POST", "/links" + operator_.substr(1)).body;
  const std::string link = nlohmann::json::parse(more)["path"];
  EXPECT_EQ(ask("GET", link).status, 200);
  EXPECT_EQ(ask("POST", "/links").status, 403);
  EXPECT_EQ(post(link, "begin").status, 200);
  EXPECT_EQ(files_in("games"), 2u);
}

TEST_F(Serve, ExistingLogsAreKept) {
  fs::create_directory(folder_ / "games");
  std::ofstream(folder_ / "games/guest-01.lcmlog") << "yesterday";
  start("paper-room -o games");
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", "today").status, 200);
  EXPECT_EQ(slurp(folder_ / "games/guest-01.lcmlog"), "yesterday");
  EXPECT_EQ(slurp(folder_ / "games/guest-02.lcmlog"), "today");
  stop(SIGKILL);
  EXPECT_EQ(slurp(folder_ / "games/guest-02.lcmlog"), "today");
}

TEST_F(Serve, TooLongBodiesAreRefusedInFlatMemory) {
  start("paper-room -o games");
  post(links_[0], "begin");
  const std::string head =
      "POST " + links_[0] + "/log?at=0&key=" + kKey + " HTTP/1.1\r\nHost: x\r\n";
  {  // It says how long it is.
    Connection connection(port_);
    connection.send(head + "Content-Length: 1000000000\r\n\r\n");
    EXPECT_EQ(reply_of(connection.rest()).status, 413);
  }
  {  // It does not say.
    Connection connection(port_);
    connection.send(head + "Connection: close\r\nTransfer-Encoding: chunked\r\n\r\n");
    const std::string chunk = "100000\r\n" + std::string(0x100000, 'x') + "\r\n";
    for (int i = 0; i < 200; ++i) connection.send(chunk);
    connection.send("0\r\n\r\n");
    EXPECT_EQ(reply_of(connection.rest()).status, 413);
  }
  for (const std::string& start : {std::string("GET /"), head + "X: "}) {  // A line without an end.
    Connection connection(port_);
    const std::string more(1'000'000, 'x');
    connection.send(start);
    for (int i = 0; i < 200 && connection.send(more); ++i) continue;
    EXPECT_EQ(connection.rest().find("200 OK"), std::string::npos);
  }
  EXPECT_EQ(post(links_[0], "log?at=9223372036854775807", "x").status, 413);  // the largest number
  EXPECT_EQ(guest(0)["bytes"], 0);
  EXPECT_LT(most_memory_kb(), 400'000);  // under sanitizers too
  EXPECT_EQ(ask("GET", operator_).status, 200);
}

TEST_F(Serve, ManyAndSlowConnectionsAreAnswered) {
  start("paper-room -o games");
  const std::string whole = request("GET", state_query());
  std::list<Connection> slow;
  for (int i = 0; i < 200; ++i) slow.emplace_back(port_).send(whole.substr(0, 10));
  EXPECT_EQ(ask("GET", links_[0]).status, 200);  // meanwhile
  for (Connection& connection : slow) connection.send(whole.substr(10));
  for (Connection& connection : slow) EXPECT_EQ(reply_of(connection.rest()).status, 200);
}

TEST_F(Serve, AFullDiskIsSaidAndTheRestIsKept) {
  start("paper-room -o games", "trap '' XFSZ; ulimit -f 8;");
  post(links_[0], "begin");
  const std::string piece(6000, 'x');
  EXPECT_EQ(post(links_[0], "log?at=0", piece).status, 200);
  EXPECT_EQ(post(links_[0], "log?at=6000", piece).status, 507);
  EXPECT_EQ(post(links_[0], "log?at=6000", "short").status, 200);
  EXPECT_EQ(slurp(folder_ / "games/guest-01.lcmlog"), piece + "short");
  EXPECT_EQ(stop(), 0);
  EXPECT_THAT(slurp(folder_ / "said.txt"), HasSubstr("guest-01.lcmlog: cannot be written"));
}

// Somebody truncates the log: the page is asked for the rest again.
TEST_F(Serve, WhatSomebodyTruncatesComesAgain) {
  start("paper-room -o games");
  const std::string log = slurp(kDemoLog), path = folder_ / "games/guest-01.lcmlog";
  post(links_[0], "begin");
  const auto piece = [&](std::size_t at, std::size_t size) {
    return post(links_[0], fmt::format("log?at={}", at), log.substr(at, size));
  };
  EXPECT_EQ(piece(0, 20000).status, 200);
  fs::resize_file(path, 300);
  EXPECT_EQ(piece(20000, 1000).status, 409);
  EXPECT_EQ(slurp(path), log.substr(0, 300));
  EXPECT_EQ(post(links_[0], "begin").body, R"({"size":300})");
  EXPECT_EQ(piece(300, log.size()).status, 200);
  fs::resize_file(path, 5000);
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 409);
  EXPECT_EQ(piece(5000, log.size()).status, 200);
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 200);
  EXPECT_EQ(slurp(path), log);
  EXPECT_EQ(guest(0)["game"]["participant"], "demo");
  EXPECT_EQ(stop(), 0);
}

TEST_F(Serve, AStudysPlanIsFollowed) {
  ASSERT_EQ(headpin("experiment plan -o study").code, 0);
  start("study --links 3");
  ASSERT_EQ(links_.size(), 3u);
  EXPECT_EQ(guest(0)["participant"], "p001");
  EXPECT_EQ(guest(2)["participant"], "p003");
  EXPECT_THAT(guest(1)["condition"].get<std::string>(), HasSubstr("of EFS"));
  EXPECT_EQ(post(links_[1], "begin").status, 200);
  EXPECT_EQ(post(links_[1], "log?at=0", slurp(kDemoLog)).status, 200);
  // Another command does not play the same session meanwhile.
  expect_refusal("experiment run study --participant p002 --virtual", 75, "p002");
  EXPECT_EQ(post(links_[1], "answers", "no").status, 400);
  const Reply wrong = post(links_[1], "answers", R"({"presence1":"9"})");
  EXPECT_EQ(wrong.status, 400);
  EXPECT_THAT(wrong.body, HasSubstr("a question has none of its answers"));
  EXPECT_THAT(wrong.body, testing::Not(HasSubstr("presence1")));  // that is for the operator
  EXPECT_FALSE(fs::exists(folder_ / "study/answers/p002.csv"));
  nlohmann::json answers = all_answers();
  const Reply stored = post(links_[1], "answers", answers.dump());
  EXPECT_EQ(stored.status, 200) << stored.body;
  EXPECT_THAT(slurp(folder_ / "study/answers/p002.csv"), HasSubstr("p002,presence1,6,asked"));
  // A page whose first answer was lost asks again; others, as of its copy, are not taken.
  EXPECT_EQ(post(links_[1], "answers", answers.dump()).status, 200);
  answers["presence1"] = "2";
  const Reply others = post(links_[1], "answers", answers.dump());
  EXPECT_EQ(others.status, 409);
  EXPECT_THAT(others.body, HasSubstr("the questions were answered already"));
  EXPECT_EQ(stop(), 0);
  EXPECT_THAT(slurp(folder_ / "said.txt"), HasSubstr("presence1: expected"));
  EXPECT_THAT(slurp(folder_ / "study/answers/p002.csv"), HasSubstr("p002,presence1,6,asked"));
  EXPECT_EQ(slurp(folder_ / "study/sessions/p002/run-01.lcmlog"), slurp(kDemoLog));
}

TEST_F(Serve, HasACertificateForOtherMachines) {
  start("paper-room -o games --bind 0.0.0.0");
  const auto said = nlohmann::json::parse(slurp(folder_ / "said.json"));
  EXPECT_THAT(said["operator"].get<std::string>(), testing::StartsWith("https://"));
  const std::string ask = fmt::format(
      "import ssl, hashlib, urllib.request as u\n"
      "pem = ssl.get_server_certificate(('127.0.0.1', {0}))\n"
      "print(hashlib.sha256(ssl.PEM_cert_to_DER_cert(pem)).hexdigest().upper())\n"
      "open('pem', 'w').write(pem)\n"
      "own = ssl.create_default_context(cafile='pem')\n"
      "print(u.urlopen('https://localhost:{0}{1}', context=own).status)\n",
      port_, operator_);
  std::ofstream(folder_ / "ask.py") << ask;
  const std::string command = "cd '" + folder_.string() + "' && python3 ask.py >asked.txt 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << slurp(folder_ / "asked.txt");
  std::string sha = said["certificate_sha256"];
  std::erase(sha, ':');
  EXPECT_EQ(slurp(folder_ / "asked.txt"), sha + "\n200\n");
}

TEST_F(Serve, RefusesInWords) {
  const std::string pages = " --page page.html --watch-page watch.html ";
  expect_refusal("serve" + pages, 2, "--output");
  expect_refusal("serve -o OUT --key k.pem" + pages, 2, "--certificate and --key");
  expect_refusal("serve -o OUT --bind nowhere" + pages, 2, "--bind");
  expect_refusal("serve -o OUT --bind 198.51.100.77" + pages, 2, "--bind: expected an address of");
  expect_refusal("serve -o OUT --port 70000" + pages, 2, "70000");
  expect_refusal("serve -o OUT --certificate page.html --key page.html" + pages, 1, "certificate");
  expect_refusal("serve no-such-room -o OUT" + pages, 1, "no-such-room");
  expect_refusal("serve -o OUT --page said.txt --watch-page watch.html", 1, "said.txt");
  ASSERT_EQ(headpin("experiment plan -o study").code, 0);
  expect_refusal("serve study -o OUT" + pages, 2, "--output");
  expect_refusal("serve study --friction 0.1" + pages, 2, "the plan of a study");
  start("paper-room -o games");
  expect_refusal(fmt::format("serve -o OUT --port {}", port_) + pages, 75,
                 "Address already in use");
}

TEST_F(Serve, AnswersOfAGuestAreKeptWhereSomeHadBeenDrawn) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  ASSERT_EQ(headpin("experiment ask study --all --virtual").code, 0);
  const std::string drawn = slurp(folder_ / "study/answers/p001.csv");
  start("study --links 1");
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", slurp(kDemoLog)).status, 200);
  nlohmann::json answers = all_answers();
  const Reply stored = post(links_[0], "answers", answers.dump());
  EXPECT_EQ(stored.status, 200) << stored.body;
  EXPECT_EQ(stop(), 0);
  const std::string given = slurp(folder_ / "study/answers/p001.csv");
  EXPECT_THAT(given, HasSubstr("p001,occupation,n/a,asked\n"));
  EXPECT_THAT(given, testing::Not(HasSubstr("drawn")));
  EXPECT_EQ(slurp(folder_ / "study/answers/p001.drawn"), drawn);
}

// The page may be loaded again: its questions are all that the link still shows, until they are answered.
TEST_F(Serve, TheLinkOfAnEndedGameShowsTheQuestionsUntilTheyAreAnswered) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  const std::string log = slurp(kDemoLog);
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  EXPECT_EQ(post(links_[0], "log?at=0", log).status, 200);
  EXPECT_EQ(ask("GET", links_[0]).status, 403);  // a game goes on
  EXPECT_EQ(post(links_[0], fmt::format("end?at={}", log.size())).status, 200);
  EXPECT_EQ(ask("GET", links_[0]).status, 200);
  EXPECT_EQ(post(links_[0], "begin", "", kOtherKey).status, 403);  // it is for no other game
  nlohmann::json answers = all_answers();
  EXPECT_EQ(post(links_[0], "answers", answers.dump(), kOtherKey).status, 403);
  EXPECT_EQ(post(links_[0], "answers", answers.dump()).status, 200);
  EXPECT_EQ(ask("GET", links_[0]).status, 403);
  EXPECT_EQ(stop(), 0);
}

// Whose link it is.
TEST_F(Serve, ANewLinkSaysForWhomItIs) {
  ASSERT_EQ(headpin("experiment plan -o study --people 2").code, 0);
  start("study --links 1");
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  const std::string links = "/links" + operator_.substr(1);
  const auto made = nlohmann::json::parse(ask("POST", links).body);
  EXPECT_EQ(made["participant"], "p002");
  EXPECT_EQ(ask("GET", made["path"]).status, 200);
  const Reply none = ask("POST", links);
  EXPECT_EQ(none.status, 404);
  EXPECT_THAT(none.body, HasSubstr("has played or has a link"));
}

TEST_F(Serve, AGuestIsToldWhereAnswersCannotBeStored) {
  ASSERT_EQ(headpin("experiment plan -o study --people 1").code, 0);
  start("study --links 1");
  EXPECT_EQ(post(links_[0], "begin").status, 200);
  nlohmann::json answers = all_answers();
  const fs::path file = folder_ / "study/answers/p001.csv";
  fs::create_directories(file);  // where the file should be
  const Reply refused = post(links_[0], "answers", answers.dump());
  EXPECT_EQ(refused.status, 507);
  EXPECT_THAT(refused.body, HasSubstr("tell the people who invited you"));
  EXPECT_THAT(refused.body, testing::Not(HasSubstr("p001.csv")));  // that is for the operator
  fs::remove(file);
  EXPECT_EQ(post(links_[0], "answers", answers.dump()).status, 200);
  EXPECT_EQ(stop(), 0);
  EXPECT_THAT(slurp(folder_ / "said.txt"), HasSubstr("p001.csv"));
}

/// The sockets that a process has open.
std::ptrdiff_t sockets_of(pid_t process) {
  std::ptrdiff_t count = 0;
  for (const auto& entry : fs::directory_iterator(fmt::format("/proc/{}/fd", process))) {
    std::error_code gone;
    if (fs::read_symlink(entry, gone).string().starts_with("socket:")) ++count;
  }
  return count;
}

// 500 are served at once; who comes then waits until some have gone.
TEST_F(Serve, SilentConnectionsKeepNobodyOutAndLeaveNothingOpen) {
  start("paper-room -o games");
  const std::ptrdiff_t before = sockets_of(process_);
  const auto wait_until = [&](auto reached) {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!reached(sockets_of(process_) - before)) {
      ASSERT_LT(std::chrono::steady_clock::now(), patience) << sockets_of(process_) << " are open";
      std::this_thread::yield();
    }
  };
  const auto none = [](std::ptrdiff_t more) { return more == 0; };
  post(links_[0], "begin");
  EXPECT_EQ(post(links_[0], "log?at=0", "a").status, 200);
  std::list<Connection> silent;
  for (int i = 0; i < 300; ++i) silent.emplace_back(port_);
  EXPECT_EQ(post(links_[0], "log?at=1", "b").status, 200);
  EXPECT_GE(sockets_of(process_), before + 300);  // it was the last to come
  silent.clear();
  ASSERT_NO_FATAL_FAILURE(wait_until(none));
  EXPECT_EQ(post(links_[0], "log?at=2", "c").status, 200);

  for (int i = 0; i < 560; ++i) silent.emplace_back(port_);
  ASSERT_NO_FATAL_FAILURE(wait_until([](std::ptrdiff_t more) { return more >= 499; }));
  Connection late(port_);
  EXPECT_TRUE(late.send(request("POST", links_[0] + "/log?at=3&key=" + kKey, "d")));
  EXPECT_LE(sockets_of(process_), before + 501);  // one may be about to be refused
  EXPECT_EQ(slurp(folder_ / "games/guest-01.lcmlog"), "abc");
  silent.clear();
  EXPECT_EQ(reply_of(late.rest()).status, 200);
  ASSERT_NO_FATAL_FAILURE(wait_until(none));
  EXPECT_EQ(slurp(folder_ / "games/guest-01.lcmlog"), "abcd");
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace headpin
