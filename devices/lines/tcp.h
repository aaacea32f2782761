#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "devices/lines/byte_stream.h"

namespace headpin::devices {

/// Connects to a byte stream on TCP. It is closed about 8 s after the other end went away without a
/// word, as a machine does that is switched off.
///
/// @param host      name or number
/// @param patience  how long to wait for an answer
/// @throws std::runtime_error  when nobody answers there
std::unique_ptr<ByteStream> connect_tcp(
    const std::string& host, int port,
    std::chrono::milliseconds patience = std::chrono::seconds(5));

/// A TCP server; one client at a time: a newcomer is hung up while one is there that may still send.
///
/// Bytes that are written while no client is connected are lost. A client that has shut its sending
/// half, as `printf S | nc -N` does, still gets its answers: it is hung up when nothing was written
/// for 4 s, or when a newcomer takes its place, who waits until nothing was read from it nor taken by it
/// for 0.1 s: an answer is sent whole, but a stream keeps a newcomer waiting for 4 s only.
class TcpServer : public ByteStream {
 public:
  /// @param port     0 for any free one
  /// @param address  of the interface to serve, a number; the default only this machine
  /// @throws base::Busy         when the port is taken; these errors name neither address nor port
  /// @throws std::runtime_error  when the port cannot be opened
  /// @throws std::invalid_argument  when the address is not one of this computer
  explicit TcpServer(int port, const std::string& address = "127.0.0.1");
  ~TcpServer() override;
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;

  int port() const { return port_; }
  /// tcp:ADDRESS:PORT, as open_line() takes it
  std::string name() const { return "tcp:" + address_ + ":" + std::to_string(port_); }

  std::size_t read(std::span<std::uint8_t> out) override;
  std::size_t write(Bytes bytes) override;
  /// Only here a newcomer takes the line, so that nothing is read or written for another client before this
  /// says so.
  bool renewed() override;
  bool closed() const override { return false; }
  /// The client's while it may send. -1 while a newcomer waits for the answers of one that sends no more: no
  /// descriptor has news when that is over, and the newcomer's would have them all the time.
  int descriptor() const override;

 private:
  void hang_up();
  /// Whether the client sends no more, and an answer to what it sent is under way or due.
  bool is_answered();

  using TimePoint = std::chrono::steady_clock::time_point;
  int listener_ = -1;
  int client_ = -1;
  std::optional<TimePoint> end_;  ///< since when it is known that the client sends no more
  bool newcomer_waits_ = false;   ///< until the client has its answers
  TimePoint last_taken_{};        ///< when it last took bytes
  TimePoint last_heard_{};        ///< when bytes were last read
  std::string address_;
  int port_ = 0;
};

}  // namespace headpin::devices
