// Our own reader of LCM's multicast. What comes from the network is made here: recvmsg() is this
// program's own while a test says so.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include "devices/emulated/lcm_feed.h"
#include "devices/lcm/datagrams.h"
#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "devices/log/sample_messages.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

/// Datagrams that wait at every socket, numbered from 0.
struct Waiting {
  int count = 0;            ///< all of them
  int next = 0;             ///< of those that were read
  int interrupted_at = -1;  /// a signal comes before this one
  std::string channel = "TRACKER";
  std::string magic = "LC02";
  std::string data;                            ///< of each; empty: its number
  bool of_the_kernel = false;                  ///< the kernel's datagrams are read instead
  bool other_news = false;                     ///< the kernel tells something else before the time
  int joining_fails_with = 0;                  ///< errno
  int socket = -1;                             ///< that asked for the group
  std::map<std::pair<int, int>, int> options;  ///< of sockets, by level and name
};
Waiting* waiting = nullptr;

ssize_t read_one(msghdr& header) {
  if (waiting->next == waiting->interrupted_at) {
    waiting->interrupted_at = -1;
    errno = EINTR;
    return -1;
  }
  if (waiting->next == waiting->count) {
    errno = EAGAIN;
    return -1;
  }
  const std::string bytes = waiting->magic + std::string(4, '\0') + waiting->channel + '\0' +
                            (waiting->data.empty() ? std::to_string(waiting->next) : waiting->data);
  ++waiting->next;
  std::memcpy(header.msg_iov[0].iov_base, bytes.data(), bytes.size());
  sockaddr_in from{};
  from.sin_family = AF_INET;
  from.sin_addr.s_addr = htonl(192u << 24 | 168u << 16 | 1u << 8 | 20u);
  from.sin_port = htons(40'000);
  std::memcpy(header.msg_name, &from, sizeof from);
  const timeval at{12, 345};
  cmsghdr* stamp = CMSG_FIRSTHDR(&header);
  const std::size_t before = waiting->other_news ? CMSG_SPACE(sizeof at) : 0;
  if (waiting->other_news) {
    const timeval no_time{99, 99};
    stamp->cmsg_level = SOL_SOCKET;
    stamp->cmsg_type = SO_RXQ_OVFL;
    stamp->cmsg_len = CMSG_LEN(sizeof no_time);
    std::memcpy(CMSG_DATA(stamp), &no_time, sizeof no_time);
    stamp = CMSG_NXTHDR(&header, stamp);
  }
  stamp->cmsg_level = SOL_SOCKET;
  stamp->cmsg_type = SCM_TIMESTAMP;
  stamp->cmsg_len = CMSG_LEN(sizeof at);
  std::memcpy(CMSG_DATA(stamp), &at, sizeof at);
  header.msg_controllen = before + CMSG_SPACE(sizeof at);
  return static_cast<ssize_t>(bytes.size());
}

}  // namespace
}  // namespace headpin::devices

using headpin::devices::read_one;  // NOLINT: the functions below are the C library's
using headpin::devices::waiting;

extern "C" {

ssize_t recvmsg(int socket, msghdr* header, int flags) {
  if (waiting != nullptr && !waiting->of_the_kernel) return read_one(*header);
  return syscall(SYS_recvmsg, socket, header, flags);
}

// A machine without a network has no route for multicast.
int setsockopt(int socket, int level, int name, const void* value, socklen_t size) noexcept {
  if (waiting != nullptr && level == IPPROTO_IP && name == IP_ADD_MEMBERSHIP) {
    waiting->socket = socket;
    errno = waiting->joining_fails_with;
    return errno == 0 ? 0 : -1;
  }
  if (waiting != nullptr && size == sizeof(int)) {
    waiting->options[{level, name}] = *static_cast<const int*>(value);
  }
  return static_cast<int>(syscall(SYS_setsockopt, socket, level, name, value, size));
}

// Nor can liblcm open it then.
lcm_t* lcm_create(const char* url) {
  using Create = decltype(lcm_create);
  static const auto real = reinterpret_cast<Create*>(dlsym(RTLD_NEXT, "lcm_create"));
  return real(waiting != nullptr ? "memq://" : url);
}
}

namespace headpin::devices {
namespace {

class MulticastListenerTest : public testing::Test {
 protected:
  MulticastListenerTest() { waiting = &network_; }
  ~MulticastListenerTest() override { waiting = nullptr; }

  static MulticastListener listener(std::size_t queue) {
    return {{.address = 239u << 24 | 255u << 16 | 76u << 8 | 67u, .port = 0}, {"TRACKER"}, queue};
  }
  int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(network_.socket, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }
  /// Sends it to the listener opened last, over the kernel's loopback.
  void send(const std::string& bytes) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port()));
    const int from = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(sendto(from, bytes.data(), bytes.size(), 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              std::ssize(bytes));
    close(from);
  }
  static std::string message(const std::string& text) {
    return "LC02" + std::string(4, '\0') + "TRACKER" + '\0' + text;
  }
  static bool is_open(int descriptor) { return fcntl(descriptor, F_GETFD) != -1; }

  static std::string data(const std::optional<MulticastListener::Message>& message) {
    return message ? std::string(message->data.begin(), message->data.end()) : "none";
  }

  Waiting network_;
};

// A million that are there at once are read in parts: who asks for one goes on meanwhile.
TEST_F(MulticastListenerTest, AFloodDoesNotKeepWhoAsksForOneMessage) {
  network_.count = 1'000'000;
  MulticastListener from = listener(10);
  EXPECT_NE(data(from.take()), "none");
  EXPECT_EQ(network_.next, 1000);
}

TEST_F(MulticastListenerTest, OfMoreThanMayWaitTheNewestAreKeptAndTheOthersCounted) {
  network_.count = 10;
  MulticastListener from = listener(3);
  for (const char* number : {"7", "8", "9", "none"}) EXPECT_EQ(data(from.take()), number);
  EXPECT_EQ(from.take_dropped(), 7);
  EXPECT_EQ(from.take_dropped(), 0);
  network_.count = 13;
  for (const char* number : {"10", "11", "12", "none"}) EXPECT_EQ(data(from.take()), number);
  EXPECT_EQ(from.take_dropped(), 0) << "as many as may wait";
}

TEST_F(MulticastListenerTest, AMessageHasItsSenderAndWhenTheKernelGotIt) {
  network_.count = 1;
  MulticastListener from = listener(3);
  const auto message = from.take();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "TRACKER");
  EXPECT_EQ(sender_name(message->sender), "192.168.1.20:40000");
  EXPECT_EQ(message->arrived, Time{12'000'345});
}

TEST_F(MulticastListenerTest, ASignalIsNoEndAndWhatIsNotForUsNoMessage) {
  network_.count = 5;
  network_.interrupted_at = 2;
  MulticastListener from = listener(10);
  for (const char* number : {"0", "1", "2", "3", "4", "none"}) {
    EXPECT_EQ(data(from.take()), number);
  }
  network_.count = 10;
  network_.channel = "OTHER";
  EXPECT_EQ(data(from.take()), "none");
  EXPECT_EQ(network_.next, 10);
  network_.count = 15;
  network_.channel = "TRACKER";
  network_.magic = "LC99";
  EXPECT_EQ(data(from.take()), "none");
  EXPECT_EQ(network_.next, 15);
}

TEST_F(MulticastListenerTest, ASignalBeforeTheFirstMessageIsNoEnd) {
  network_.count = 1;
  network_.interrupted_at = 0;
  MulticastListener from = listener(10);
  EXPECT_EQ(data(from.take()), "0");
}

TEST_F(MulticastListenerTest, WhatElseTheKernelTellsIsNoTime) {
  network_.count = 1;
  network_.other_news = true;
  MulticastListener from = listener(3);
  EXPECT_EQ(from.take()->arrived, Time{12'000'345});
}

TEST_F(MulticastListenerTest, ItsSocketIsOfThisGroupAloneAndWaitsForNobody) {
  network_.of_the_kernel = true;
  int socket = -1;
  {
    MulticastListener from = listener(3);
    socket = network_.socket;
    EXPECT_NE(port(), 0);
    EXPECT_NE(fcntl(socket, F_GETFL) & O_NONBLOCK, 0);
    EXPECT_NE(fcntl(socket, F_GETFD) & FD_CLOEXEC, 0) << "not of programs that are started";
    EXPECT_EQ((network_.options.at({IPPROTO_IP, IP_MULTICAST_ALL})), 0);
    EXPECT_EQ((network_.options.at({SOL_SOCKET, SO_TIMESTAMP})), 1);
    EXPECT_EQ((network_.options.at({SOL_SOCKET, SO_RCVBUF})), 2 * 1024 * 1024);
    EXPECT_EQ(data(from.take()), "none");
    const MulticastGroup same{.address = 239u << 24, .port = static_cast<std::uint16_t>(port())};
    EXPECT_EQ(complaint([&] { MulticastListener other(same, {}, 3); }), "");  // another session's
  }
  EXPECT_FALSE(is_open(socket));
}

TEST_F(MulticastListenerTest, AGroupThatCannotBeJoinedLeavesNoSocket) {
  network_.joining_fails_with = ENODEV;
  EXPECT_EQ(complaint([] { listener(3); }),
            "cannot listen to LCM's multicast: its group: No such device" +
                std::string(LcmUrl::kMulticastHint));
  EXPECT_FALSE(is_open(network_.socket));
}

// A program without standard input gets its number for the first socket.
TEST_F(MulticastListenerTest, ADescriptorOfZeroIsOne) {
  const int input = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  EXPECT_EQ(complaint([] { listener(3); }), "");
  EXPECT_EQ(network_.socket, STDIN_FILENO);
  if (input >= 0) dup2(input, STDIN_FILENO);
  if (input >= 0) close(input);
}

TEST_F(MulticastListenerTest, AnEmptyDatagramKeepsNoOther) {
  network_.of_the_kernel = true;
  MulticastListener from = listener(3);
  send("");
  send(message("first"));
  EXPECT_EQ(data(from.take()), "first");
}

TEST_F(MulticastListenerTest, ItsThreadReadsUntilItEnds) {
  network_.of_the_kernel = true;
  int socket = -1;
  {
    MulticastListener from = listener(3);
    socket = network_.socket;
    from.start();
    for (const std::string text : {"first", "second"}) {
      send(message(text));
      std::string read = "none";
      while (read == "none") {
        std::this_thread::yield();
        read = data(from.take());
      }
      EXPECT_EQ(read, text);
    }
  }
  EXPECT_FALSE(is_open(socket));
}

/// A source over multicast, of the datagrams that wait.
class MulticastSourceTest : public MulticastListenerTest {
 protected:
  MulticastSourceTest() {
    TrackerSample sample;
    sample.device_time = Time{1'000'000};
    sample.station = kHandStation;
    sample.X_TS.p.x() = 2.0;
    Buffer bytes;
    encode(sample, bytes);
    network_.data.assign(bytes.begin(), bytes.end());
  }
  /// Of a port that is free.
  std::string url() const {
    const MulticastListener any = listener(1);
    return fmt::format("udpm://239.255.76.67:{}", port());
  }
};

TEST_F(MulticastSourceTest, TakesAllThatWaitWithTheirSenderAndCountsWhatWasDropped) {
  LcmLink link(url());
  Clocks clocks;
  {
    LcmSource source(link, clocks, 3);
    network_.count = 3;
    source.receive(Time{50'000});
    EXPECT_EQ(source.intake().counts().received, 3);
    EXPECT_EQ(source.intake().counts().dropped, 0);
    const auto& hand = source.intake().publishers().at(device_at(kHandStation));
    EXPECT_EQ(sender_name(hand.sender), "192.168.1.20:40000");
    EXPECT_EQ(hand.host_time, Time{50'000});
    network_.count = 13;
    std::vector<Sample> out;
    source.poll(Time{60'000}, out);
    EXPECT_EQ(source.intake().counts().received, 6);
    EXPECT_EQ(source.intake().counts().dropped, 7 + 3);  // on the way, and of those that waited
  }
  EXPECT_EQ(network_.next, 13);
}

TEST_F(MulticastSourceTest, AFeedDiscardsWhatWasSentBeforeIt) {
  network_.count = 1;
  LcmFeed feed(url());
  EXPECT_EQ(network_.next, 1);
  feed.poll(Time{1000});
  EXPECT_EQ(feed.at(kHandStation).X_TS.p, still_motion(kHandStation, {}).X_TS.p);
}

}  // namespace
}  // namespace headpin::devices
