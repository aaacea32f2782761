#include "devices/lines/tcp.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/lock.h"

namespace headpin::devices {
namespace {

/// Bytes that a reader may leave before the sender has to wait: as many as a terminal can hold.
constexpr int kSocketBuffer = 4096;

/// A client that has said that it sends no more stays this long after the last bytes for it: longer
/// than a Fastrak saves (3 s), which answers afterwards. A newcomer waits no longer after that word.
constexpr std::chrono::seconds kLastAnswer{4};

/// A newcomer leaves it the line for this long after its last words and each part of their answer.
constexpr std::chrono::milliseconds kAnswer{100};

[[noreturn]] void fail_tcp(const std::string& what) {
  if (errno == EADDRINUSE) throw base::Busy(what + ": " + std::strerror(errno));
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

/// What a socket brought.
struct Received {
  std::size_t size = 0;
  bool end = false;   ///< the peer sends no more
  bool gone = false;  ///< the connection is broken
};

Received receive_some(int fd, std::span<std::uint8_t> out) {
  const ssize_t n = ::recv(fd, out.data(), out.size(), 0);
  if (n > 0) return {static_cast<std::size_t>(n), false, false};
  if (n == 0) return {0, !out.empty(), false};
  return {0, false, errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR};
}

std::size_t send_some(int fd, Bytes bytes, bool* gone) {
  const ssize_t n = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (n >= 0) return static_cast<std::size_t>(n);
  if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) *gone = true;
  return 0;
}

class Socket : public ByteStream {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() override { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  std::size_t read(std::span<std::uint8_t> out) override {
    const Received received = receive_some(fd_, out);
    gone_ |= received.end || received.gone;
    return received.size;
  }
  std::size_t write(Bytes bytes) override { return gone_ ? 0 : send_some(fd_, bytes, &gone_); }
  bool closed() const override { return gone_; }
  int descriptor() const override { return fd_; }
  bool has_baud() const override { return false; }

 private:
  int fd_;
  bool gone_ = false;
};

void send_at_once(int fd) {
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/// Lets a socket ask a silent peer for a sign of life, so that one that went away without a word is
/// noticed.
void notice_death(int fd) {
  const auto set = [&](int level, int option, int value) {
    setsockopt(fd, level, option, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 4);   // s
  set(IPPROTO_TCP, TCP_KEEPINTVL, 2);  // s
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

/// Whether the peer of a socket sends no more.
bool has_ended(int fd) {
  pollfd state{fd, POLLRDHUP, 0};
  return ::poll(&state, 1, 0) == 1;
}

/// Whether the peer of a socket has closed it, or its machine has given no sign of life for a while:
/// a living one that does not read may be asked for a minute apart only, but leaves nothing unanswered.
bool has_left(int fd) {
  constexpr std::uint32_t kLong = 10'000;  // ms
  if (has_ended(fd)) return true;
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
         info.tcpi_last_ack_recv > kLong && info.tcpi_probes + info.tcpi_retransmits > 0;
}

/// Whether something that the peer of a socket sent was not read yet.
bool has_unread(int fd) {
  char byte = 0;
  return ::recv(fd, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
}

/// Connects a socket that does not block; sets errno when that fails.
bool connected(int fd, const addrinfo& to, std::chrono::milliseconds patience) {
  if (::connect(fd, to.ai_addr, to.ai_addrlen) == 0) return true;
  if (errno != EINPROGRESS) return false;
  pollfd state{fd, POLLOUT, 0};
  if (::poll(&state, 1, static_cast<int>(patience.count())) != 1) {
    errno = ETIMEDOUT;
    return false;
  }
  socklen_t size = sizeof errno;
  int why = 0;
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &why, &size);
  errno = why;
  return why == 0;
}

}  // namespace

std::unique_ptr<ByteStream> connect_tcp(const std::string& host, int port,
                                        std::chrono::milliseconds patience) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string nobody = "tcp:" + host + ":" + std::to_string(port) + ": nobody answers there";
  if (const int e = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found)) {
    throw std::runtime_error(nobody + ": " + gai_strerror(e));
  }
  int fd = -1;
  for (const addrinfo* a = found; a && fd < 0; a = a->ai_next) {
    fd = ::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol);
    if (fd >= 0 && !connected(fd, *a, patience)) {
      const int why = errno;
      ::close(fd);
      errno = why;
      fd = -1;
    }
  }
  freeaddrinfo(found);
  if (fd < 0) fail_tcp(nobody);
  send_at_once(fd);
  notice_death(fd);
  const unsigned patient = 8000;  // ms without an answer to bytes that were sent
  setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &patient, sizeof patient);
  return std::make_unique<Socket>(fd);
}

TcpServer::TcpServer(int port, const std::string& host) : address_(host) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (listener_ < 0) fail_tcp("no socket");
  const int on = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  // Small, so that a late reader gets the newest records and not records that are minutes old.
  setsockopt(listener_, SOL_SOCKET, SO_SNDBUF, &kSocketBuffer, sizeof kSocketBuffer);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  errno = EADDRNOTAVAIL;
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1 ||
      bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      listen(listener_, 1) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const int why = errno;
    ::close(listener_);
    if (why == EADDRNOTAVAIL) {
      throw std::invalid_argument(
          "expected an IPv4 address of this computer in numbers, such as 127.0.0.1:" +
          std::to_string(port) + ", found '" + host + "'");
    }
    errno = why;
    fail_tcp("this port cannot be opened");
  }
  port_ = ntohs(address.sin_port);
}

TcpServer::~TcpServer() {
  hang_up();
  ::close(listener_);
}

void TcpServer::hang_up() {
  if (client_ >= 0) ::close(client_);
  client_ = -1;
  end_.reset();
  newcomer_waits_ = false;
}

int TcpServer::descriptor() const {
  if (client_ >= 0 && !end_) return client_;
  return newcomer_waits_ ? -1 : listener_;
}

bool TcpServer::is_answered() {
  if (!has_ended(client_)) return false;
  const auto now = std::chrono::steady_clock::now();
  if (!end_) end_ = now;
  return now - std::max(last_heard_, last_taken_) < kAnswer && now - *end_ < kLastAnswer;
}

bool TcpServer::renewed() {
  newcomer_waits_ = false;
  pollfd door{listener_, POLLIN, 0};
  if (::poll(&door, 1, 0) != 1)
    return false;  // before the client is looked at, which may leave now
  const bool leaves = client_ >= 0 && has_left(client_);
  newcomer_waits_ = leaves && (has_unread(client_) || is_answered());
  if (newcomer_waits_) return false;
  const int newcomer = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (newcomer < 0) return false;
  if (client_ >= 0 && !leaves) {
    ::close(newcomer);
    return false;
  }
  hang_up();
  client_ = newcomer;
  send_at_once(client_);
  notice_death(client_);
  return true;
}

std::size_t TcpServer::read(std::span<std::uint8_t> out) {
  if (client_ < 0) return 0;
  const auto now = std::chrono::steady_clock::now();
  const Received received = receive_some(client_, out);
  if (received.size > 0) last_heard_ = now;
  if (received.end && !end_) end_ = now;
  if (received.gone || (received.end && now - std::max(last_taken_, *end_) > kLastAnswer)) {
    hang_up();
  }
  return received.size;
}

std::size_t TcpServer::write(Bytes bytes) {
  if (client_ < 0 || bytes.empty()) return bytes.size();
  bool gone = false;
  const std::size_t n = send_some(client_, bytes, &gone);
  if (n > 0) last_taken_ = std::chrono::steady_clock::now();
  if (gone) hang_up();
  return gone ? bytes.size() : n;
}

}  // namespace headpin::devices
