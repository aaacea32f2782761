#include "devices/lines/byte_stream.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "base/lock.h"
#include "base/names.h"

namespace headpin::devices {
namespace {

constexpr std::array<std::pair<int, speed_t>, 7> kRates = {{{2400, B2400},
                                                            {4800, B4800},
                                                            {9600, B9600},
                                                            {19200, B19200},
                                                            {38400, B38400},
                                                            {57600, B57600},
                                                            {115200, B115200}}};

/// Bytes that a reader may leave before the sender has to wait: as many as a terminal can hold.
constexpr int kSocketBuffer = 4096;

[[noreturn]] void fail(const std::string& what) {
  if (errno == EADDRINUSE) throw base::Busy(what + ": " + std::strerror(errno));
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

std::size_t read_some(int fd, std::span<std::uint8_t> out, bool* gone) {
  const ssize_t n = ::read(fd, out.data(), out.size());
  if (n > 0) return static_cast<std::size_t>(n);
  if (gone && ((n == 0 && !out.empty()) ||
               (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR))) {
    *gone = true;
  }
  return 0;
}

std::size_t send_some(int fd, Bytes bytes, bool* gone) {
  const ssize_t n = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (n >= 0) return static_cast<std::size_t>(n);
  if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) *gone = true;
  return 0;
}

void make_raw(int fd, int baud) {
  const auto rate = std::find_if(kRates.begin(), kRates.end(),
                                 [&](const auto& pair) { return pair.first == baud; });
  if (rate == kRates.end()) {
    throw std::invalid_argument("baud rate " + std::to_string(baud) +
                                " is not one of 2400 4800 9600 19200 38400 57600 115200");
  }
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) fail("not a terminal");
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, rate->second);
  cfsetospeed(&settings, rate->second);
  if (tcsetattr(fd, TCSANOW, &settings) != 0) fail("cannot set up the terminal");
}

/// Says why a name is not that of a serial port, as far as the file system shows it.
void require_serial_port(const std::string& path) {
  struct stat there {};
  if (stat(path.c_str(), &there) != 0) {
    if (errno != ENOENT && errno != ENOTDIR) fail(path + ": cannot be opened");
    throw std::runtime_error(path +
                             ": there is no such serial port; expected a serial port such as "
                             "/dev/ttyUSB0, or tcp:HOST:PORT");
  }
  if (S_ISCHR(there.st_mode)) return;
  const bool file = S_ISREG(there.st_mode), folder = S_ISDIR(there.st_mode);
  throw std::runtime_error(path + ": expected a serial port, found " +
                           (file     ? "a file"
                            : folder ? "a folder"
                                     : "something else"));
}

class SerialPort : public ByteStream {
 public:
  SerialPort(const std::string& path, int baud) {
    require_serial_port(path);
    fd_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd_ < 0) fail(path + ": cannot be opened");
    try {
      if (!isatty(fd_)) throw std::runtime_error("expected a serial port, found another device");
      // Before any change that could disturb the program that has it open.
      if (!base::lock(fd_)) throw base::Busy("in use by another headpin");
      make_raw(fd_, baud);
    } catch (const base::Busy& error) {
      ::close(fd_);
      throw base::Busy(path + ": " + error.what());
    } catch (const std::exception& error) {
      ::close(fd_);
      throw std::runtime_error(path + ": " + error.what());
    }
    tcflush(fd_, TCIFLUSH);
  }
  ~SerialPort() override { ::close(fd_); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  std::size_t read(std::span<std::uint8_t> out) override {
    const ssize_t n = ::read(fd_, out.data(), out.size());
    if (n > 0) return static_cast<std::size_t>(n);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return 0;
    // With VMIN 0, a silent port also reads 0 bytes; only a hang-up shows that it was unplugged.
    pollfd state{fd_, POLLIN, 0};
    if (n < 0 || (::poll(&state, 1, 0) == 1 && (state.revents & (POLLHUP | POLLERR)))) gone_ = true;
    return 0;
  }
  std::size_t write(Bytes bytes) override {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) gone_ = true;
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  bool closed() const override { return gone_; }
  int descriptor() const override { return fd_; }
  void set_baud(int baud) override { make_raw(fd_, baud); }

 private:
  int fd_ = -1;
  bool gone_ = false;
};

class Socket : public ByteStream {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() override { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  std::size_t read(std::span<std::uint8_t> out) override { return read_some(fd_, out, &gone_); }
  std::size_t write(Bytes bytes) override { return gone_ ? 0 : send_some(fd_, bytes, &gone_); }
  bool closed() const override { return gone_; }
  int descriptor() const override { return fd_; }
  bool has_baud() const override { return false; }

 private:
  int fd_;
  bool gone_ = false;
};

void prepare_socket(int fd) {
  const int on = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
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

/// Whether the peer of a socket has closed it, or its machine has given no sign of life for a while:
/// a living one that does not read may be asked for a minute apart only, but leaves nothing unanswered.
bool has_left(int fd) {
  constexpr std::uint32_t kLong = 10'000;  // ms
  pollfd state{fd, POLLRDHUP, 0};
  if (::poll(&state, 1, 0) == 1) return true;
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
         info.tcpi_last_ack_recv > kLong && info.tcpi_probes + info.tcpi_retransmits > 0;
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

/// One direction between two memory streams.
struct Pipe {
  std::deque<std::uint8_t> bytes;
  bool writer_gone = false;
};

class MemoryStream : public ByteStream {
 public:
  MemoryStream(std::shared_ptr<Pipe> in, std::shared_ptr<Pipe> out, std::size_t capacity)
      : in_(std::move(in)), out_(std::move(out)), capacity_(capacity) {}
  ~MemoryStream() override { out_->writer_gone = true; }
  MemoryStream(const MemoryStream&) = delete;
  MemoryStream& operator=(const MemoryStream&) = delete;

  std::size_t read(std::span<std::uint8_t> out) override {
    const std::size_t n = std::min(out.size(), in_->bytes.size());
    const auto end = in_->bytes.begin() + static_cast<std::ptrdiff_t>(n);
    std::copy(in_->bytes.begin(), end, out.begin());
    in_->bytes.erase(in_->bytes.begin(), end);
    return n;
  }
  std::size_t write(Bytes bytes) override {
    const std::size_t n =
        std::min(bytes.size(), capacity_ - std::min(capacity_, out_->bytes.size()));
    out_->bytes.insert(out_->bytes.end(), bytes.begin(),
                       bytes.begin() + static_cast<std::ptrdiff_t>(n));
    return n;
  }
  bool closed() const override { return in_->writer_gone && in_->bytes.empty(); }

 private:
  std::shared_ptr<Pipe> in_, out_;  // shared: either end may be destroyed first
  std::size_t capacity_;
};

/// Changes bytes as a receiver at the wrong rate would: bits are mixed, and high bits are set.
void garble(std::span<std::uint8_t> bytes) {
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>((b * 0x4F) | 0xE0);
}

/// True if a link to the terminal `name` may be made at `path`: nothing is there, or a link that was made
/// for a terminal of its kind. A link to a real port is somebody's own.
bool may_link(const std::string& path, const std::string& name) {
  struct stat here {};
  if (lstat(path.c_str(), &here) != 0) return true;
  std::error_code no_link;
  const std::filesystem::path target = std::filesystem::read_symlink(path, no_link);
  return target.parent_path() == std::filesystem::path(name).parent_path();
}

/// The whole file, for a lock that belongs to the process that has it open. Clients of a terminal
/// lock it with base::lock(), which is independent of this lock.
struct flock whole_file() {
  struct flock all {};
  all.l_type = F_WRLCK;
  all.l_whence = SEEK_SET;
  return all;
}

/// Whether another PseudoTerminal serves the terminal to which `link` points.
bool is_served(const std::string& link) {
  const int fd = ::open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return false;
  struct flock held = whole_file();
  const bool served = fcntl(fd, F_OFD_GETLK, &held) == 0 && held.l_type != F_UNLCK;
  ::close(fd);
  return served;
}

}  // namespace

std::unique_ptr<ByteStream> open_serial(const std::string& path, int baud) {
  return std::make_unique<SerialPort>(path, baud);
}

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
  if (fd < 0) fail(nobody);
  prepare_socket(fd);
  notice_death(fd);
  const unsigned patient = 8000;  // ms without an answer to bytes that were sent
  setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &patient, sizeof patient);
  return std::make_unique<Socket>(fd);
}

std::pair<std::unique_ptr<ByteStream>, std::unique_ptr<ByteStream>> memory_streams(
    std::size_t capacity) {
  auto there = std::make_shared<Pipe>(), back = std::make_shared<Pipe>();
  return {std::make_unique<MemoryStream>(back, there, capacity),
          std::make_unique<MemoryStream>(there, back, capacity)};
}

PseudoTerminal::PseudoTerminal(const std::string& link) {
  try {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 128> name{};
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0) {
      fail("no pseudo-terminal");
    }
    name_ = name.data();
    slave_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (slave_ < 0) fail(name_);
    struct flock ours = whole_file();
    fcntl(slave_, F_OFD_SETLK, &ours);
    make_raw(slave_, 115200);  // before the name is known to others: no echo, no line editing
    watch_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (watch_ >= 0) inotify_add_watch(watch_, name_.c_str(), IN_OPEN | IN_CLOSE);
    if (!link.empty()) link_at(link);
  } catch (...) {
    for (const int fd : {watch_, slave_, master_}) {
      if (fd >= 0) ::close(fd);
    }
    throw;
  }
}

void PseudoTerminal::link_at(const std::string& link) {
  if (!may_link(link, name_)) {
    throw std::runtime_error(link + ": exists and is not a link to a pseudo-terminal");
  }
  // A link that a killed emulator left may name our own terminal: the system gives free names again.
  std::error_code no_link;
  const bool ours = std::filesystem::read_symlink(link, no_link) == name_;
  if (!ours && is_served(link)) throw base::Busy(link + ": another emulator uses it");
  struct stat terminal {};
  if (!ours && ::stat(link.c_str(), &terminal) == 0) {
    throw base::Busy(
        link + ": another program's terminal is behind it; remove the link, or take another name");
  }
  base::place_link(name_, link);
  link_ = link;
}

PseudoTerminal::~PseudoTerminal() {
  if (!link_.empty()) base::remove_link(name_, link_);
  for (const int fd : {watch_, slave_, master_}) {
    if (fd >= 0) ::close(fd);
  }
}

int PseudoTerminal::client_baud() const {
  termios settings{};
  if (tcgetattr(slave_, &settings) != 0) return 0;
  const speed_t speed = cfgetospeed(&settings);
  for (const auto& [baud, code] : kRates) {
    if (code == speed) return baud;
  }
  return 0;
}

/// Openings may be told as one, and closings: a terminal that was full counts as one that nobody had.
void PseudoTerminal::note_open() {
  if (clients_++ > 0 && !full_) return;
  tcflush(slave_, TCIFLUSH);
  clients_ = 1;
  full_ = false;
  renewed_ = true;
}

void PseudoTerminal::forget_output_of_the_absence() {
  alignas(inotify_event) std::array<char, 4096> events{};
  ssize_t n = 0;
  while (watch_ >= 0 && (n = ::read(watch_, events.data(), events.size())) > 0) {
    for (ssize_t at = 0; at + static_cast<ssize_t>(sizeof(inotify_event)) <= n;) {
      inotify_event event{};
      std::memcpy(&event, events.data() + at, sizeof event);
      if (event.mask & IN_OPEN) note_open();
      if (event.mask & IN_CLOSE) clients_ = std::max(0, clients_ - 1);
      at += static_cast<ssize_t>(sizeof event + event.len);
    }
  }
}

std::size_t PseudoTerminal::read(std::span<std::uint8_t> out) {
  forget_output_of_the_absence();
  const std::size_t n = read_some(master_, out, nullptr);
  if (n > 0 && garbled()) garble(out.first(n));
  return n;
}

std::size_t PseudoTerminal::write(Bytes bytes) {
  forget_output_of_the_absence();
  std::vector<std::uint8_t> other;
  if (garbled()) {
    other.assign(bytes.begin(), bytes.end());
    garble(other);
    bytes = other;
  }
  const ssize_t n = ::write(master_, bytes.data(), bytes.size());
  if (n < static_cast<ssize_t>(bytes.size()) && clients_ == 0) {  // nobody hears it
    tcflush(slave_, TCIFLUSH);
    return bytes.size();
  }
  full_ |= n <= 0 && !bytes.empty();
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

TcpServer::TcpServer(int port, const std::string& host) : address_(host) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (listener_ < 0) fail("no socket");
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
    fail("this port cannot be opened");
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
}

void TcpServer::accept_newcomer() {
  const int newcomer = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (newcomer < 0) return;
  if (client_ >= 0 && !has_left(client_)) {
    ::close(newcomer);
    return;
  }
  hang_up();
  client_ = newcomer;
  renewed_ = true;
  prepare_socket(client_);
  notice_death(client_);
}

std::size_t TcpServer::read(std::span<std::uint8_t> out) {
  accept_newcomer();
  if (client_ < 0) return 0;
  bool gone = false;
  const std::size_t n = read_some(client_, out, &gone);
  if (gone) hang_up();
  return n;
}

std::size_t TcpServer::write(Bytes bytes) {
  accept_newcomer();
  if (client_ < 0) return bytes.size();
  bool gone = false;
  const std::size_t n = send_some(client_, bytes, &gone);
  if (gone) hang_up();
  return gone ? bytes.size() : n;
}

}  // namespace headpin::devices
