// tcpq with servers of this test, over real sockets: one that is not there, one that closes the
// connection at once, and one that goes away later.

#include "tests/support/lcm_server.h"

#include <array>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include "devices/lcm/link.h"
#include "devices/lcm/server.h"
#include "devices/lcm/source.h"
#include "devices/live/source.h"
#include "tests/support/folder.h"

#ifdef HEADPIN_SANITIZED
#include <sanitizer/lsan_interface.h>
#endif

namespace headpin::devices {
namespace {

/// How often somebody has waited for bytes; null while nobody counts.
int* counted_waits = nullptr;

}  // namespace
}  // namespace headpin::devices

// The C library's poll(), by another name: its header may define it already.
extern "C" int counting_poll(pollfd* all, nfds_t count, int timeout_ms) __asm__("poll");

extern "C" int counting_poll(pollfd* all, nfds_t count, int timeout_ms) {
  using headpin::devices::counted_waits;
  if (counted_waits != nullptr && count == 1 && all->events == POLLIN) ++*counted_waits;
  static const auto real = reinterpret_cast<decltype(&counting_poll)>(dlsym(RTLD_NEXT, "poll"));
  return real(all, count, timeout_ms);
}

namespace headpin::devices {
namespace {

using testing::EndsWith;

const std::string kNobody = ": no LCM server answers there; expected a running lcm-tcpq-server";
const std::string kGone = ": the LCM server has closed the connection";

TEST(LcmServerTest, WhereNobodyListensThereIsNoSession) {
  const LocalPort closed;
  Clocks clocks;
  EXPECT_EQ(complaint([&] { open_device("lcm:" + closed.url(), clocks, {}); }),
            "lcm:" + closed.url() + kNobody);
  EXPECT_EQ(complaint([&] { LcmLink link(LcmUrl(closed.url(), "--lcm ")); }),
            "--lcm " + closed.url() + kNobody);
}

TEST(LcmServerTest, WhoClosesAtOnceIsNoServer) {
  const LocalLcmServer closes(false);
  Clocks clocks;
  EXPECT_EQ(complaint([&] { open_device("lcm:" + closes.url(), clocks, {}); }),
            "lcm:" + closes.url() + kNobody);
}

// liblcm then has no socket, and aborts when it is asked to wait for messages.
TEST(LcmServerTest, AServerThatGoesAwayEndsTheSessionWithAWord) {
#ifdef HEADPIN_SANITIZED
  const __lsan::ScopedDisabler liblcm_leaks;  // eight bytes, when it is closed without its server
#endif
  LocalLcmServer server(true);
  Clocks clocks;
  const OpenSource opened = *open_device("lcm:" + server.url(), clocks, {});
  LiveSource* const source = opened.source.get();
  opened.source->start();
  std::vector<Sample> samples;
  source->poll(Time{1000}, samples);
  server.close_all();
  std::string said;
  for (Time now{2000}; said.empty(); now += Time{1000}) {  // until the end has come over the line
    said = complaint([&] { source->poll(now, samples); });
  }
  EXPECT_EQ(said, "lcm:" + server.url() + kGone);
  EXPECT_EQ(complaint([&] { source->poll(Time{1'000'000'000}, samples); }), said);
}

// What came before a session starts is discarded, for which it is read.
TEST(LcmServerTest, AServerThatGoesAwayBeforeTheStartIsToldAtTheStart) {
#ifdef HEADPIN_SANITIZED
  const __lsan::ScopedDisabler liblcm_leaks;
#endif
  LocalLcmServer server(true);
  Clocks clocks;
  const OpenSource opened = *open_device("lcm:" + server.url(), clocks, {});
  server.close_all();
  std::string said;
  while (said.empty()) said = complaint([&] { opened.source->start(); });
  EXPECT_EQ(said, "lcm:" + server.url() + kGone);
}

TEST(LcmServerTest, WhoPublishesToAServerThatGoesAwayIsTold) {
  LocalLcmServer server(true);
  LcmLink link(server.url());
  link.publish(Sample(TrackerSample{}));
  server.close_all();
  std::string said;
  while (said.empty()) said = complaint([&] { link.publish(Sample(TrackerSample{})); });
  EXPECT_THAT(said, EndsWith(server.url() + kGone));
}

/// A server of something else: answers its first client, and closes the connection.
class OtherServer {
 public:
  explicit OtherServer(std::string answer) : answer_(std::move(answer)) {
    if (::listen(port_.descriptor(), 1) != 0) throw std::runtime_error("cannot listen");
    thread_ = std::thread([this] {
      const int connection = accept4(port_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC);
      std::array<char, 8> greeting{};
      recv(connection, greeting.data(), greeting.size(), MSG_WAITALL);
      send(connection, answer_.data(), answer_.size(), MSG_NOSIGNAL);
      close(connection);
    });
  }
  ~OtherServer() { thread_.join(); }
  OtherServer(const OtherServer&) = delete;
  OtherServer& operator=(const OtherServer&) = delete;

  std::string url() const { return port_.url(); }

 private:
  LocalPort port_;
  std::string answer_;
  std::thread thread_;
};

// LCM's server answers with its magic number and the version of the protocol. Who answers is not asked
// again and again, as long as one may be silent.
TEST(LcmServerTest, WhoAnswersOtherwiseIsNoServer) {
  int count = 0;
  const auto find = [&](const OtherServer& server) {
    counted_waits = &(count = 0);
    const std::string said = complaint([&] { find_server(LcmUrl(server.url())); });
    counted_waits = nullptr;
    EXPECT_GE(count, 1);
    EXPECT_LE(count, 100);
    return said;
  };
  for (const char* answer : {"", "\x28\x76\x17\xfa", "HTTP/1.1 400 Bad Request"}) {
    const OtherServer other(answer);
    EXPECT_EQ(find(other), other.url() + kNobody);
  }
  const OtherServer good(std::string("\x28\x76\x17\xfa\0\0\1\0", 8));
  EXPECT_EQ(find(good), "");
}

}  // namespace
}  // namespace headpin::devices
