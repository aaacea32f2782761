#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "devices/lines/byte_stream.h"

namespace headpin::devices {

/// A line that is reopened after a failure, such as a unit that is switched off and on, or an
/// adapter that is unplugged and plugged in again.
///
/// It never counts as closed. While the line is unavailable, nothing can be read or written, and
/// `trouble` gives the reason.
class LastingLine : public ByteStream {
 public:
  using Open = std::function<std::unique_ptr<ByteStream>()>;

  /// Opens it for the first time.
  /// @param name  for people
  /// @param open  opens it, quickly; throws std::runtime_error while that is impossible
  /// @throws std::runtime_error  when it cannot be opened now
  LastingLine(std::string name, Open open);

  std::size_t read(std::span<std::uint8_t> out) override;
  std::size_t write(Bytes bytes) override;
  bool closed() const override { return false; }
  std::string trouble() const override;
  int descriptor() const override { return line_ ? line_->descriptor() : -1; }
  void set_baud(int baud) override;
  bool has_baud() const override;

 private:
  bool there();
  void set_rate();

  std::string name_;
  Open open_;
  std::unique_ptr<ByteStream> line_;
  bool spoke_ = false;  ///< it has sent something since it was opened
  int baud_ = 0;        ///< as last set; 0: as it was opened
  std::chrono::steady_clock::time_point last_try_;
};

/// Opens the line that a user names: `tcp:HOST:PORT`, for serial lines behind an Ethernet adapter,
/// or the path of a serial port. It is reopened after failures.
///
/// @throws std::runtime_error  when it cannot be opened now
/// @throws std::invalid_argument  without a name, for a port that is no number from 1 to 65535, or
///                                for another rate than a Fastrak's
std::unique_ptr<ByteStream> open_line(const std::string& name, int baud);

}  // namespace headpin::devices
