#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "base/math.h"
#include "devices/fastrak/commands.h"
#include "devices/lines/byte_stream.h"

namespace headpin::devices {

/// A data record that was sent, for comparisons.
struct FastrakSent {
  int station = 1;
  Time measured{};                  ///< mid-sampling
  std::vector<std::uint8_t> bytes;  ///< the record itself
  bool damaged = false;             ///< by a fault
};

/// Bytes that are sent in one piece.
struct FastrakMessage {
  std::vector<std::uint8_t> bytes;
  Time due{};                        ///< not before
  std::size_t sent = 0;              ///< bytes that have left
  bool stream = false;               ///< a record of the continuous output
  bool lost = false;                 ///< takes its time on the line, and nobody gets its bytes
  std::vector<FastrakSent> records;  ///< the data records in it
  std::size_t garbage = 0;           ///< bytes in it that belong to no record
};

/// What a unit sends: messages wait in a queue and leave, byte by byte, as fast as the line is.
class FastrakSending {
 public:
  /// @return  false if too much is waiting; then the message is dropped
  bool add(FastrakMessage message);
  /// Drops the messages of which nothing was sent: all, or only those of the continuous output.
  void drop_unsent(bool only_stream);
  void drop_all() { queue_.clear(); }

  /// Whether a record that is added now leaves without waiting for others.
  bool is_free() const;

  /// Between ^S and ^Q nothing leaves.
  void suspend() { suspended_ = true; }
  void resume(Time now);
  /// Nothing is suspended after a start.
  void start() { suspended_ = false; }

  /// The line, and what happens on it.
  struct Line {
    FastrakPort port;                                   ///< with the baud rate that it really has
    std::function<bool(Time)> silent;                   ///< whether a message that is due is lost
    std::function<void(const FastrakMessage&)> on_end;  ///< called as its last byte leaves
  };
  /// Sends what has time to leave until `now`.
  void pump(Time now, const Line& line);

  /// Bytes that have left and are not taken yet, oldest first.
  Bytes out() const { return outbox_; }
  void taken(std::size_t count);

 private:
  std::deque<FastrakMessage> queue_;
  std::int64_t line_free_ns_ = 0;  ///< when the last byte has left
  std::vector<std::uint8_t> outbox_;
  bool suspended_ = false;
};

}  // namespace headpin::devices
