#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "base/lock.h"
#include "devices/lines/tcp.h"
#include "tests/devices/line_ends.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

// Output that it did not take counted as output, so that it kept the line for ever.
TEST(TcpServerTest, AClientThatNeitherSendsNorReadsIsHungUp) {
  OpenDoor server(0);
  const auto client = connect_tcp("127.0.0.1", server.port());
  ASSERT_EQ(::shutdown(client->descriptor(), SHUT_WR), 0);
  const std::vector<std::uint8_t> much(std::size_t{1} << 20U);  // more than a socket saves at once
  std::array<std::uint8_t, 64> bytes{};
  using Clock = std::chrono::steady_clock;
  const auto patience = Clock::now() + std::chrono::seconds(30);
  while (server.write(much) == much.size()) {  // not there yet
    if (Clock::now() > patience) FAIL() << "is not accepted";
    ::poll(nullptr, 0, 1);
  }
  while (server.write(much) < much.size()) {  // goes nowhere once it is hung up
    if (Clock::now() > patience) FAIL() << "is never hung up";
    server.read(bytes);
    ::poll(nullptr, 0, 10);
  }
}

int socket_option(const ByteStream& stream, int level, int name) {
  int value = 0;
  socklen_t size = sizeof value;
  EXPECT_EQ(getsockopt(stream.descriptor(), level, name, &value, &size), 0);
  return value;
}

/// A connection, and both its ends.
struct Connected {
  explicit Connected(int port = 0) : server(std::make_unique<TcpServer>(port)) {
    client = connect_tcp("127.0.0.1", server->port());
    while (!server->renewed()) ::poll(nullptr, 0, 1);
  }
  std::unique_ptr<TcpServer> server;
  std::unique_ptr<ByteStream> client;
};

/// The server goes without having read all: this resets the connection. Waits until the client has it.
void reset_by_server(Connected& both) {
  say(*both.client, "unread");
  ASSERT_TRUE(has_news(both.server->descriptor()));
  both.server.reset();
  ASSERT_TRUE(has_news(both.client->descriptor()));
}

TEST(TcpClientTest, IsClosedByAReadOrAWriteWhenTheConnectionWasReset) {
  std::array<std::uint8_t, 8> bytes{};
  for (const bool reads : {true, false}) {
    Connected both;
    reset_by_server(both);
    EXPECT_FALSE(both.client->closed());
    EXPECT_EQ(reads ? both.client->read(bytes) : say(*both.client, "S"), 0u);
    EXPECT_TRUE(both.client->closed()) << reads;
  }
}

TEST(TcpClientTest, IsNotClosedByNothingToReadOrWriteNorByAServerThatDoesNotRead) {
  Connected both;
  ASSERT_EQ(say(*both.server, "waits"), 5u);
  ASSERT_TRUE(has_news(both.client->descriptor()));
  errno = EPIPE;  // of another line
  EXPECT_EQ(both.client->read({}), 0u);
  EXPECT_EQ(both.client->write({}), 0u);
  EXPECT_FALSE(both.client->closed());
  const std::string much(1 << 16, 'x');
  while (say(*both.client, much) > 0) {
  }
  EXPECT_FALSE(both.client->closed());
  EXPECT_EQ(hear(*both.client, 5), "waits");
  EXPECT_FALSE(both.client->has_baud());
}

TEST(TcpClientTest, SaysWhyNobodyAnswersAndLeavesNothingOpen) {
  const std::set<int> before = descriptors();
  EXPECT_EQ(complaint([] { connect_tcp("127.0.0.1", 1); }),
            "tcp:127.0.0.1:1: nobody answers there: Connection refused");
  EXPECT_EQ(complaint([] { connect_tcp("224.0.0.1", 4001); }),
            "tcp:224.0.0.1:4001: nobody answers there: Network is unreachable");
  EXPECT_EQ(descriptors(), before);
}

TEST(TcpServerTest, LeavesNothingOpenNeitherAfterAFailureNorAtItsEnd) {
  const std::set<int> before = descriptors();
  {
    Connected both;
    const std::set<int> connected = descriptors();
    EXPECT_EQ(connected.size(), before.size() + 3);
    EXPECT_THROW(TcpServer(both.server->port()), base::Busy);
    EXPECT_THROW(TcpServer(0, "nobody"), std::invalid_argument);
    EXPECT_EQ(descriptors(), connected);
    both.client = connect_tcp("127.0.0.1", both.server->port());  // the first one goes
    while (!both.server->renewed()) ::poll(nullptr, 0, 1);
    EXPECT_EQ(descriptors().size(), connected.size());
  }
  EXPECT_EQ(descriptors(), before);
}

// As of any TCP port, some of it would be taken for a minute.
TEST(TcpServerTest, ItsPortCanBeServedAgainAtOnce) {
  Connected both;
  const int port = both.server->port();
  both.server.reset();  // hangs up first
  ASSERT_TRUE(has_news(both.client->descriptor()));
  both.client.reset();
  EXPECT_NO_THROW(TcpServer again(port));
}

TEST(TcpServerTest, BothEndsSendAtOnceNeverWaitAndNoticeADeadMachine) {
  const Connected both;
  for (const ByteStream* end :
       std::initializer_list<const ByteStream*>{both.client.get(), both.server.get()}) {
    EXPECT_EQ(socket_option(*end, IPPROTO_TCP, TCP_NODELAY), 1);
    EXPECT_EQ(socket_option(*end, SOL_SOCKET, SO_KEEPALIVE), 1);
    EXPECT_EQ(socket_option(*end, IPPROTO_TCP, TCP_KEEPIDLE), 4);
    EXPECT_EQ(socket_option(*end, IPPROTO_TCP, TCP_KEEPINTVL), 2);
    EXPECT_EQ(socket_option(*end, IPPROTO_TCP, TCP_KEEPCNT), 3);
    EXPECT_FALSE(waits(end->descriptor()));
    EXPECT_FALSE(is_inherited(end->descriptor()));
  }
  // As many bytes as a terminal can hold; Linux counts them twice, for what it keeps with them.
  EXPECT_EQ(socket_option(*both.server, SOL_SOCKET, SO_SNDBUF), 2 * 4096);
}

TEST(TcpServerTest, WhoComesAfterAClientThatSentNoMoreMaySend) {
  Connected both;
  std::array<std::uint8_t, 8> bytes{};
  ASSERT_EQ(::shutdown(both.client->descriptor(), SHUT_WR), 0);
  ASSERT_TRUE(has_news(both.server->descriptor()));
  EXPECT_EQ(both.server->read(bytes), 0u);
  EXPECT_EQ(say(*both.server, "answer"), 6u);
  EXPECT_EQ(hear(*both.client, 6), "answer");

  const auto second = connect_tcp("127.0.0.1", both.server->port());
  say(*second, "P");
  while (!both.server->renewed()) ::poll(nullptr, 0, 1);
  EXPECT_EQ(hear(*both.server, 1), "P");
}

/// From now on, nothing that is sent to a socket gets there, and it says nothing itself.
void cut_off(const ByteStream& end) {
  sock_filter nothing = BPF_STMT(BPF_RET | BPF_K, 0);
  const sock_fprog program{.len = 1, .filter = &nothing};
  const int fd = end.descriptor(), off = 0;
  EXPECT_EQ(setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program), 0);
  EXPECT_EQ(setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &off, sizeof off), 0);
}

tcp_info state_of(const ByteStream& stream) {
  tcp_info info{};
  socklen_t size = sizeof info;
  EXPECT_EQ(getsockopt(stream.descriptor(), IPPROTO_TCP, TCP_INFO, &info, &size), 0);
  return info;
}

/// Whether somebody who comes now gets the line, and is not hung up.
bool gives_the_line_to_a_newcomer(TcpServer& server) {
  const int before = server.descriptor();
  const auto newcomer = connect_tcp("127.0.0.1", server.port());
  std::array<std::uint8_t, 8> bytes{};
  while (server.descriptor() == before && !newcomer->closed()) {
    server.renewed();
    newcomer->read(bytes);
  }
  return !newcomer->closed();
}

TEST(TcpClientTest, WaitsForAnAnswerNoLongerThanItsPatience) {
  const TcpServer server(0);
  cut_off(server);
  const auto connect = [&] {
    connect_tcp("127.0.0.1", server.port(), std::chrono::milliseconds(1));
  };
  EXPECT_EQ(
      complaint(connect),
      fmt::format("tcp:127.0.0.1:{}: nobody answers there: Connection timed out", server.port()));
}

TEST(TcpServerTest, AClientWhoseAnswerIsMissingForAMomentKeepsTheLine) {
  Connected both;
  cut_off(*both.client);
  ASSERT_EQ(say(*both.server, "record"), 6u);
  while (state_of(*both.server).tcpi_retransmits == 0) ::poll(nullptr, 0, 1);
  EXPECT_FALSE(gives_the_line_to_a_newcomer(*both.server));
}

TEST(TcpServerTest, AClientWhoseMachineHasNotAnsweredForTenSecondsGivesWay) {
  Connected both;
  cut_off(*both.client);
  ASSERT_EQ(say(*both.server, "record"), 6u);
  tcp_info state{};
  do {
    ::poll(nullptr, 0, 10);
    state = state_of(*both.server);
    ASSERT_EQ(state.tcpi_state, TCP_ESTABLISHED);
  } while (state.tcpi_last_ack_recv <= 10'000);  // ms
  EXPECT_TRUE(gives_the_line_to_a_newcomer(*both.server));
}

/// The client sends its last, and somebody comes who sends too.
std::unique_ptr<ByteStream> come_behind_last_words(const Connected& both, std::string_view last) {
  say(*both.client, last);
  EXPECT_EQ(::shutdown(both.client->descriptor(), SHUT_WR), 0);
  pollfd end{both.server->descriptor(), POLLRDHUP, 0};
  EXPECT_EQ(::poll(&end, 1, 10'000), 1);
  auto newcomer = connect_tcp("127.0.0.1", both.server->port());
  say(*newcomer, "S");
  return newcomer;
}

// Two `printf P | nc -N` at a time: the second hung up the first one, whose bytes nobody had read, and then
// got its answer. In the order of serve(), which reads again where a read brings all that it takes.
TEST(TcpServerTest, ANewcomerWaitsUntilLastWordsAreReadAndAnswered) {
  for (const std::size_t size : {1u, 512u}) {
    Connected both;
    const auto newcomer = come_behind_last_words(both, std::string(size, 'P'));
    std::array<std::uint8_t, 512> bytes{};
    EXPECT_FALSE(both.server->renewed());
    const auto heard = std::chrono::steady_clock::now();
    EXPECT_EQ(both.server->read(bytes), size);
    EXPECT_EQ(both.server->read(bytes), 0u);
    EXPECT_EQ(say(*both.server, "record"), 6u);
    EXPECT_EQ(hear(*both.client, 6), "record");
    while (!both.server->renewed()) ::poll(nullptr, 0, 1);
    EXPECT_GE(std::chrono::steady_clock::now() - heard, std::chrono::milliseconds(100));
    EXPECT_EQ(hear(*both.server, 1), "S");
  }
}

TEST(TcpServerTest, WhatWasForAClientThatBrokeOffIsNotForTheNext) {
  Connected both;
  EXPECT_FALSE(both.server->renewed());
  say(*both.server, "unread");
  ASSERT_TRUE(has_news(both.client->descriptor()));
  both.client.reset();  // this resets the connection
  const auto newcomer = connect_tcp("127.0.0.1", both.server->port());
  ASSERT_TRUE(has_news(both.server->descriptor()));
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(both.server->read(bytes), 0u);
  EXPECT_EQ(say(*both.server, "old"), 3u);
  while (!both.server->renewed()) ::poll(nullptr, 0, 1);
  EXPECT_EQ(say(*both.server, "new"), 3u);
  EXPECT_EQ(hear(*newcomer, 3), "new");
}

TEST(TcpClientTest, WorksInAProgramWithoutStandardInput) {
  OpenDoor server(0);
  const OtherInput none;
  {
    const auto client = connect_tcp("127.0.0.1", server.port());
    EXPECT_EQ(client->descriptor(), STDIN_FILENO);
    say(*client, "S");
    EXPECT_EQ(hear(server, 1), "S");
  }
  EXPECT_FALSE(has_input());
  EXPECT_THROW(connect_tcp("127.0.0.1", 1), std::runtime_error);
  EXPECT_FALSE(has_input());
}

TEST(TcpServerTest, WorksInAProgramWithoutStandardInput) {
  {
    const OtherInput none;
    const TcpServer server(0);
    EXPECT_EQ(server.descriptor(), STDIN_FILENO);
  }
  auto server = std::make_unique<TcpServer>(0);
  const auto client = connect_tcp("127.0.0.1", server->port());
  ASSERT_TRUE(has_news(server->descriptor()));
  const OtherInput none;
  ASSERT_TRUE(server->renewed());
  EXPECT_EQ(server->descriptor(), STDIN_FILENO);
  EXPECT_FALSE(gives_the_line_to_a_newcomer(*server));
  say(*client, "S");
  EXPECT_EQ(hear(*server, 1), "S");
  server.reset();
  EXPECT_FALSE(has_input());
}

// Of the 55 bytes that answer `S`, at 2400 baud, 22 came where a newcomer waited.
TEST(TcpServerTest, ANewcomerWaitsForAnAnswerOfALongTimeButNotForAStreamWithoutEnd) {
  using Clock = std::chrono::steady_clock;
  constexpr auto kPause = std::chrono::milliseconds(100);  // after which a newcomer may come
  for (const bool ends : {true, false}) {
    Connected both;
    const auto newcomer = come_behind_last_words(both, "S");
    const auto begin = Clock::now();
    auto last = begin;
    EXPECT_EQ(hear(*both.server, 1), "S");
    std::array<std::uint8_t, 8> bytes{};
    EXPECT_EQ(both.server->read(bytes), 0u);
    bool renewed = false;
    while (!ends || last - begin < 10 * kPause) {
      renewed = both.server->renewed();
      const auto now = Clock::now();
      if (renewed && now - last < kPause) {  // else this process was kept waiting itself
        EXPECT_FALSE(ends) << "cut off";
        EXPECT_GE(now - begin, std::chrono::seconds(4)) << "cut off";
      }
      if (renewed) break;
      ASSERT_LT(now - begin, std::chrono::seconds(60)) << "keeps the line for ever";
      last = Clock::now();
      ASSERT_EQ(say(*both.server, "r"), 1u);
      ASSERT_EQ(hear(*both.client, 1), "r");
      ::poll(nullptr, 0, 1);
    }
    while (!renewed) renewed = both.server->renewed();
    EXPECT_EQ(hear(*both.server, 1), "S");
  }
}

// Whoever served the line looked at it without a pause for up to 4 s: the newcomer was news all the time.
TEST(TcpServerTest, ANewcomerWhoWaitsIsNoNewsUntilTheLineIsFree) {
  Connected both;
  const auto newcomer = come_behind_last_words(both, "S");
  ASSERT_TRUE(has_news(both.server->descriptor()));
  EXPECT_EQ(hear(*both.server, 1), "S");
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(both.server->read(bytes), 0u);
  while (!both.server->renewed()) {
    ASSERT_EQ(both.server->descriptor(), -1);
    ::poll(nullptr, 0, 1);
  }
  ASSERT_TRUE(has_news(both.server->descriptor()));
  EXPECT_EQ(hear(*both.server, 1), "S");
}

}  // namespace
}  // namespace headpin::devices
