// Our own reader of LCM's multicast. What comes from the network is made here: recvmsg() is this
// program's own while a test says so.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include "devices/lcm/datagrams.h"

namespace headpin::devices {
namespace {

/// Datagrams that wait at every socket, numbered from 0.
struct Waiting {
  int count = 0;            ///< all of them
  int next = 0;             ///< of those that were read
  int interrupted_at = -1;  /// a signal comes before this one
  std::string channel = "TRACKER";
  std::string magic = "LC02";
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
                            std::to_string(waiting->next);
  ++waiting->next;
  std::memcpy(header.msg_iov[0].iov_base, bytes.data(), bytes.size());
  sockaddr_in from{};
  from.sin_family = AF_INET;
  from.sin_addr.s_addr = htonl(192u << 24 | 168u << 16 | 1u << 8 | 20u);
  from.sin_port = htons(40'000);
  std::memcpy(header.msg_name, &from, sizeof from);
  const timeval at{12, 345};
  cmsghdr* const stamp = CMSG_FIRSTHDR(&header);
  stamp->cmsg_level = SOL_SOCKET;
  stamp->cmsg_type = SCM_TIMESTAMP;
  stamp->cmsg_len = CMSG_LEN(sizeof at);
  std::memcpy(CMSG_DATA(stamp), &at, sizeof at);
  header.msg_controllen = CMSG_SPACE(sizeof at);
  return static_cast<ssize_t>(bytes.size());
}

}  // namespace
}  // namespace headpin::devices

using headpin::devices::read_one;  // NOLINT: the functions below are the C library's
using headpin::devices::waiting;

extern "C" {

ssize_t recvmsg(int socket, msghdr* header, int flags) {
  if (waiting != nullptr) return read_one(*header);
  return syscall(SYS_recvmsg, socket, header, flags);
}

// A machine without a network has no route for multicast.
int setsockopt(int socket, int level, int name, const void* value, socklen_t size) noexcept {
  if (waiting != nullptr && level == IPPROTO_IP && name == IP_ADD_MEMBERSHIP) return 0;
  return static_cast<int>(syscall(SYS_setsockopt, socket, level, name, value, size));
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
  EXPECT_GT(network_.next, 10);
  EXPECT_LT(network_.next, network_.count / 10);
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

}  // namespace
}  // namespace headpin::devices
