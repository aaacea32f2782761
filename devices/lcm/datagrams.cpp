#include "devices/lcm/datagrams.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace headpin::devices {
namespace {

constexpr std::uint32_t kShortMagic = 0x4c433032, kFragmentMagic = 0x4c433033;  // "LC02", "LC03"
constexpr std::size_t kShortHeader = 8, kFragmentHeader = 20;                   // bytes
constexpr std::size_t kLongestChannel = 63;
constexpr std::size_t kLargestDatagram = 65536;
constexpr int kReceiveBuffer = 1 << 21;  // bytes; the kernel may give less
constexpr int kMostAtOnce = 1000;        // datagrams, so that a flood cannot block this
constexpr int kListenFor_ms = 50;

/// A big-endian number of `bytes` at `at`.
std::uint32_t number_at(std::span<const std::uint8_t> all, std::size_t at, std::size_t bytes) {
  std::uint32_t number = 0;
  for (const std::uint8_t byte : all.subspan(at, bytes)) number = number << 8 | byte;
  return number;
}

[[noreturn]] void cannot_listen(const char* what) {
  throw std::runtime_error(fmt::format("cannot listen to LCM's multicast: {}: {}{}", what,
                                       std::strerror(errno), LcmUrl::kMulticastHint));
}

int open_group(const MulticastGroup& group) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) cannot_listen("no socket");
  const int on = 1, off = 0;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(group.port);
  ip_mreq membership{};
  membership.imr_multiaddr.s_addr = htonl(group.address);
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  setsockopt(fd, SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on);
  setsockopt(fd, IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off);  // only of this group
  const char* failed = nullptr;
  if (setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    failed = "its port";
  } else if (setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0) {
    failed = "its group";
  }
  if (!failed) return fd;
  const int why = errno;
  close(fd);
  errno = why;
  cannot_listen(failed);
}

/// Time at which the kernel received it.
Time arrival_of(msghdr& header) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c; c = CMSG_NXTHDR(&header, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMP) continue;
    timeval at{};
    std::memcpy(&at, CMSG_DATA(c), sizeof at);
    return std::chrono::seconds(at.tv_sec) + Time{at.tv_usec};
  }
  return std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
}

}  // namespace

std::optional<LcmDatagram> read_lcm_datagram(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kShortHeader) return std::nullopt;
  const std::uint32_t magic = number_at(bytes, 0, 4);
  LcmDatagram read{.channel = {}, .data = {}, .whole = magic == kShortMagic};
  if (!read.whole) {
    if (magic != kFragmentMagic || bytes.size() < kFragmentHeader) return std::nullopt;
    if (number_at(bytes, 16, 2) != 0) return read;  // not the first fragment: it has no channel
  }
  const std::span<const std::uint8_t> rest =
      bytes.subspan(read.whole ? kShortHeader : kFragmentHeader);
  const auto end = std::ranges::find(rest, std::uint8_t{0});
  const auto length = static_cast<std::size_t>(end - rest.begin());
  if (end == rest.end() || length == 0 || length > kLongestChannel) return std::nullopt;
  read.channel = {reinterpret_cast<const char*>(rest.data()), length};
  if (read.whole) read.data = rest.subspan(length + 1);
  return read;
}

MulticastListener::MulticastListener(const MulticastGroup& group, std::vector<std::string> channels,
                                     std::size_t queue)
    : socket_(open_group(group)),
      channels_(std::move(channels)),
      queue_(queue),
      bytes_(kLargestDatagram) {}

MulticastListener::~MulticastListener() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
  close(socket_);
}

void MulticastListener::start() {
  thread_ = std::thread([this] {
    while (!stopping_) hear(kListenFor_ms);
  });
}

std::optional<MulticastListener::Message> MulticastListener::take() {
  if (!thread_.joinable()) hear(0);
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  Message message = std::move(waiting_.front());
  waiting_.pop_front();
  return message;
}

void MulticastListener::hear(int wait_ms) {
  pollfd one{socket_, POLLIN, 0};
  if (wait_ms > 0 && poll(&one, 1, wait_ms) <= 0) return;
  for (int i = 0; i < kMostAtOnce && hear_one(); ++i) continue;
}

/// Reads one datagram. @return  whether there was one
bool MulticastListener::hear_one() {
  sockaddr_in from{};
  alignas(cmsghdr) std::array<char, 128> control{};
  iovec into{bytes_.data(), bytes_.size()};
  msghdr header{};
  header.msg_name = &from;
  header.msg_namelen = sizeof from;
  header.msg_iov = &into;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  const ssize_t n = recvmsg(socket_, &header, 0);
  if (n < 0) return errno == EINTR;
  const auto datagram = read_lcm_datagram(std::span(bytes_).first(static_cast<std::size_t>(n)));
  if (!datagram || std::ranges::find(channels_, datagram->channel) == channels_.end()) return true;
  const std::uint64_t sender =
      std::uint64_t{ntohl(from.sin_addr.s_addr)} << 16 | ntohs(from.sin_port);
  keep(*datagram, sender, arrival_of(header));
  return true;
}

void MulticastListener::keep(const LcmDatagram& datagram, std::uint64_t sender, Time arrived) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back({std::string(datagram.channel),
                      {datagram.data.begin(), datagram.data.end()},
                      sender,
                      arrived});
  if (waiting_.size() <= queue_) return;
  waiting_.pop_front();
  ++dropped_;
}

std::string sender_name(std::uint64_t sender) {
  return fmt::format("{}.{}.{}.{}:{}", sender >> 40 & 0xFF, sender >> 32 & 0xFF,
                     sender >> 24 & 0xFF, sender >> 16 & 0xFF, sender & 0xFFFF);
}

}  // namespace headpin::devices
