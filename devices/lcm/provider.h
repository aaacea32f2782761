#pragma once

#include <cerrno>
#include <chrono>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <lcm/lcm.h>
#include <sys/socket.h>

#include "devices/lcm/link.h"
#include "devices/log/event_log.h"

/// The inside of an LcmLink, for link.cpp and source.cpp.
namespace headpin::devices {

struct LcmLink::Lcm {
  lcm_t* handle = nullptr;
  bool has_server = false;

  /// Whether the server of tcpq has closed the connection. liblcm would then connect again, which may
  /// block, and it aborts when it waits for messages without a socket.
  bool lost() const {
    if (!has_server) return false;
    const int fd = lcm_get_fileno(handle);
    if (fd < 0) return true;
    char next = 0;
    const ssize_t n = recv(fd, &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
  }
  /// @throws std::runtime_error  when the connection is lost
  void require_server(const LcmUrl& url) const {
    if (lost()) throw std::runtime_error(url.name() + ": the LCM server has closed the connection");
  }

  ~Lcm() {
    if (handle) lcm_destroy(handle);
  }
};

/// A log that is written. It stays our own code, because liblcm truncates any existing file of that
/// name and does not report write errors.
class LcmLink::LogWriter {
 public:
  explicit LogWriter(base::OutputFile file) : file_(std::move(file)) {}

  void write(const std::string& channel, std::span<const std::uint8_t> bytes) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();  // like liblcm's stamps
    bytes_.clear();
    append({number_++, std::chrono::duration_cast<Time>(now), channel, bytes}, bytes_);
    file_.write(bytes_.data(), bytes_.size());
  }

 private:
  base::OutputFile file_;
  std::int64_t number_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace headpin::devices
