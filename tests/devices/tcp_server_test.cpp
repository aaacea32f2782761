#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include "devices/lines/tcp.h"

namespace headpin::devices {
namespace {

// Output that it did not take counted as output, so that it kept the line for ever.
TEST(TcpServerTest, AClientThatNeitherSendsNorReadsIsHungUp) {
  TcpServer server(0);
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

}  // namespace
}  // namespace headpin::devices
