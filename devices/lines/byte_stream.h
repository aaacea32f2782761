#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "base/math.h"
#include "devices/base/bytes.h"

namespace headpin::devices {

/// One end of a bidirectional byte stream. No function blocks.
class ByteStream {
 public:
  virtual ~ByteStream() = default;

  /// Reads what has arrived, at most `out.size()` bytes.
  /// @return  number of bytes; 0 when nothing has arrived or the other end is closed
  virtual std::size_t read(std::span<std::uint8_t> out) = 0;

  /// Bytes that have one time of arrival.
  struct Piece {
    std::size_t size = 0;
    Time arrived{};  ///< a time at which all of them had arrived; without any, until when none had
  };
  /// Reads a piece. @param now  the time, for streams without a better clock than the caller's
  virtual Piece read_at(Time now, std::span<std::uint8_t> out) { return {read(out), now}; }

  /// Writes as many bytes from the front of `bytes` as the line accepts now.
  /// @return  number of written bytes; the caller offers the rest again
  virtual std::size_t write(Bytes bytes) = 0;

  /// Whether another client has come since the last call. Bytes that the one before it has not taken
  /// are not for it.
  virtual bool renewed() { return false; }

  /// True when no more bytes can arrive.
  virtual bool closed() const = 0;

  /// A message about why the line does not work now; empty when it works.
  virtual std::string trouble() const { return ""; }

  /// The descriptor for poll(2), or -1.
  virtual int descriptor() const { return -1; }

  /// Sets the baud rate, if the line has one.
  virtual void set_baud(int) {}
  /// False where bytes go as fast as they can, and no rate can be wrong.
  virtual bool has_baud() const { return true; }
};

/// Opens a serial port: raw, 8-N-1, without flow control. Discards bytes that arrived before.
///
/// @param baud  2400, 4800, 9600, 19200, 38400, 57600 or 115200
/// @throws std::runtime_error  when it cannot be opened or is no terminal
/// @throws base::Busy         when another headpin has it open, which is not disturbed
/// @throws std::invalid_argument  at another rate
std::unique_ptr<ByteStream> open_serial(const std::string& path, int baud);

/// Two connected ends in one process.
///
/// @param capacity  buffer size in each direction; a longer write is accepted in part
std::pair<std::unique_ptr<ByteStream>, std::unique_ptr<ByteStream>> memory_streams(
    std::size_t capacity = 65536);

/// The near end of a pseudo-terminal: programs open `name()` as if it were a serial port.
///
/// The client's end is raw and without echo, and stays so when clients change. Bytes that are sent
/// while no client is connected are lost, as on a real port.
class PseudoTerminal : public ByteStream {
 public:
  /// @param link  a symbolic link to make to the terminal; empty for none. One that points to a
  ///              pseudo-terminal that is gone is replaced. It is removed at the end.
  /// @throws std::runtime_error  when no terminal can be had, or `link` is another file
  /// @throws base::Busy         when `link` leads to the terminal of another program
  explicit PseudoTerminal(const std::string& link = "");
  ~PseudoTerminal() override;
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Makes the link to a terminal that has none yet, as the constructor does.
  void link_at(const std::string& link);

  /// The terminal's own name, /dev/pts/N.
  const std::string& name() const { return name_; }

  /// The client's baud rate; 0 when a Fastrak does not have this rate.
  int client_baud() const;

  /// From now on, bytes to and from a client at another rate arrive garbled; 0: any rate will do.
  void expect_baud(int baud) { expected_baud_ = baud; }

  std::size_t read(std::span<std::uint8_t> out) override;
  std::size_t write(Bytes bytes) override;
  bool renewed() override {
    forget_output_of_the_absence();
    return std::exchange(renewed_, false);
  }
  bool closed() const override { return false; }
  int descriptor() const override { return master_; }

 private:
  void note_open();
  void forget_output_of_the_absence();
  bool garbled() const { return expected_baud_ != 0 && client_baud() != expected_baud_; }

  int master_ = -1;
  int slave_ = -1;  ///< kept open, so that settings survive the clients
  int watch_ = -1;  ///< inotify: clients opening and closing
  int expected_baud_ = 0;
  int clients_ = 0;       ///< that have it open
  bool full_ = false;     ///< took no byte since the last client came
  bool renewed_ = false;  ///< a client came after all others had gone
  std::string name_;
  std::string link_;
};

}  // namespace headpin::devices
