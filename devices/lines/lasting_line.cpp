#include "devices/lines/lasting_line.h"

#include <charconv>
#include <stdexcept>
#include <string_view>

#include "devices/lines/tcp.h"

namespace headpin::devices {
namespace {

constexpr std::string_view kTcp = "tcp:";
constexpr std::chrono::milliseconds kBetweenTries{200};
constexpr std::chrono::milliseconds kFirstPatience{5000}, kLaterPatience{50};

struct TcpAddress {
  std::string host;
  int port = 0;
};

TcpAddress read_address(const std::string& name) {
  const std::string address = name.substr(kTcp.size());
  const std::size_t colon = address.rfind(':');
  const std::string digits = colon == std::string::npos ? "" : address.substr(colon + 1);
  TcpAddress read;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), read.port);
  if (colon == 0 || error != std::errc{} || end != digits.data() + digits.size() || read.port < 1 ||
      read.port > 65535) {
    throw std::invalid_argument(name + ": expected tcp:HOST:PORT, a port from 1 to 65535");
  }
  read.host = address.substr(0, colon);
  return read;
}

}  // namespace

LastingLine::LastingLine(std::string name, Open open)
    : name_(std::move(name)),
      open_(std::move(open)),
      line_(open_()),
      last_try_(std::chrono::steady_clock::now()) {}

/// Whether the line is open; from time to time tries to open it again.
bool LastingLine::there() {
  if (line_ && !line_->closed()) return true;
  line_.reset();
  const auto now = std::chrono::steady_clock::now();
  if (now - last_try_ < kBetweenTries) return false;
  last_try_ = now;
  try {
    line_ = open_();
  } catch (const std::runtime_error&) {
    return false;  // not available yet
  }
  spoke_ = false;
  set_rate();
  return line_ != nullptr;
}

/// Sets the rate that was last requested. A line that cannot be set has hung up in the meantime.
void LastingLine::set_rate() {
  if (baud_ == 0) return;
  try {
    line_->set_baud(baud_);
  } catch (const std::runtime_error&) {
    line_.reset();
  }
}

std::size_t LastingLine::read(std::span<std::uint8_t> out) {
  if (!there()) return 0;
  const std::size_t n = line_->read(out);
  spoke_ |= n > 0;
  if (line_->closed()) line_.reset();
  return n;
}

std::size_t LastingLine::write(Bytes bytes) {
  return there() ? line_->write(bytes) : 0;
}

std::string LastingLine::trouble() const {
  if (line_ && !line_->closed()) return "";
  const bool refused = name_.starts_with(kTcp) && !spoke_;
  return name_ +
         (refused ? " hung up without a word, as where another client has it" : " hung up") +
         "; waiting for it to come back";
}

bool LastingLine::has_baud() const {
  return !name_.starts_with(kTcp);
}

void LastingLine::set_baud(int baud) {
  baud_ = baud;
  if (there()) set_rate();
}

std::unique_ptr<ByteStream> open_line(const std::string& name, int baud) {
  if (name.empty()) {
    throw std::invalid_argument("line '': expected the name of a serial port or tcp:HOST:PORT");
  }
  if (!name.starts_with(kTcp)) {
    return std::make_unique<LastingLine>(name, [=] { return open_serial(name, baud); });
  }
  const TcpAddress address = read_address(name);
  auto patience = std::make_shared<std::chrono::milliseconds>(kFirstPatience);
  return std::make_unique<LastingLine>(name, [address, patience] {
    return connect_tcp(address.host, address.port, std::exchange(*patience, kLaterPatience));
  });
}

}  // namespace headpin::devices
