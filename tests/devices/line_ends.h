#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "devices/lines/byte_stream.h"
#include "devices/lines/tcp.h"

namespace headpin::devices {

/// The descriptors that this process has.
inline std::set<int> descriptors() {
  std::set<int> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    all.insert(std::stoi(entry.path().filename().string()));
  }
  std::erase_if(all, [](int fd) { return fcntl(fd, F_GETFD) < 0; });  // that of the list itself
  return all;
}

inline bool waits(int fd) {
  return (fcntl(fd, F_GETFL) & O_NONBLOCK) == 0;
}

/// Whether programs that this one starts have it too.
inline bool is_inherited(int fd) {
  return (fcntl(fd, F_GETFD) & FD_CLOEXEC) == 0;
}

/// Standard input is another descriptor as long as this lives; without one it is closed, as where a
/// service starts a program. The next that is opened is then descriptor 0.
class OtherInput {
 public:
  explicit OtherInput(int other = -1) : kept_(fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 100)) {
    if (other >= 0) {
      dup2(other, STDIN_FILENO);
    } else {
      ::close(STDIN_FILENO);
    }
  }
  ~OtherInput() {
    ::close(STDIN_FILENO);
    if (kept_ >= 0) dup2(kept_, STDIN_FILENO);
    if (kept_ >= 0) ::close(kept_);
  }
  OtherInput(const OtherInput&) = delete;
  OtherInput& operator=(const OtherInput&) = delete;

 private:
  int kept_;
};

inline bool has_input() {
  return fcntl(STDIN_FILENO, F_GETFD) >= 0;
}

/// A server that looks for a newcomer whenever it is read or written.
class OpenDoor : public TcpServer {
 public:
  using TcpServer::TcpServer;
  std::size_t read(std::span<std::uint8_t> out) override {
    renewed();
    return TcpServer::read(out);
  }
  std::size_t write(Bytes bytes) override {
    renewed();
    return TcpServer::write(bytes);
  }
};

inline std::size_t say(ByteStream& stream, std::string_view text) {
  return stream.write(Bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

/// Waits for something to read, or for an end; no longer than a fault needs to be seen.
inline bool has_news(int fd) {
  pollfd state{fd, POLLIN, 0};
  return ::poll(&state, 1, 10'000) == 1;
}

/// What arrives, up to `count` bytes; less when no more comes.
inline std::string hear(ByteStream& stream, std::size_t count) {
  std::string heard;
  while (heard.size() < count) {
    std::array<std::uint8_t, 256> bytes{};
    const std::size_t room = std::min(bytes.size(), count - heard.size());
    const std::size_t n = stream.read(std::span(bytes).first(room));
    heard.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    if (n == 0 && (stream.closed() || !has_news(stream.descriptor()))) break;
  }
  return heard;
}

}  // namespace headpin::devices
