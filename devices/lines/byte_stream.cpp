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

#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
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

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
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
  const ssize_t n = ::read(master_, out.data(), out.size());
  if (n <= 0) return 0;
  const auto heard = static_cast<std::size_t>(n);
  if (garbled()) garble(out.first(heard));
  return heard;
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

}  // namespace headpin::devices
