#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"

/// What is asked of a Fastrak at its line, and what its answers must be.
namespace headpin::devices {

/// A client's end of the line to a unit.
class FastrakLine {
 public:
  virtual ~FastrakLine() = default;
  void send(std::string_view text) {
    sent_ = text;
    put(text);
  }
  /// The bytes that were sent last.
  const std::string& sent() const { return sent_; }
  /// Waits and returns all received bytes, until there are `enough`.
  virtual std::string wait(Time span, std::size_t enough = std::string::npos) = 0;
  /// Discards the bytes received so far, like tcflush.
  virtual void flush() = 0;
  virtual int baud() const { return 115200; }

  std::string ask(std::string_view text, Time span, std::size_t enough = std::string::npos) {
    send(text);
    return wait(span, enough);
  }

 private:
  virtual void put(std::string_view text) = 0;

  std::string sent_;
};

/// One requirement of a client.
struct FastrakDemand {
  std::string sent;  ///< the last bytes that were sent before, as text
  std::string what;
  bool met = false;
  std::string found;            ///< what was found instead
  bool receivers_move = false;  ///< it was met as far as can be told of receivers that move
};
using FastrakDemands = std::vector<FastrakDemand>;

/// Bytes as text: their number and values.
std::string shown_bytes(std::string_view bytes);

/// How long the line needs for this many bytes, with a start and a stop bit for each.
Time time_of(std::size_t bytes, const FastrakLine& line);

/// Adds a requirement of the bytes that were sent last.
void demand(FastrakLine& line, FastrakDemands& demands, std::string what, bool met,
            std::string_view found);

/// Sends a text that must have no answer.
void tell(FastrakLine& line, FastrakDemands& demands, std::string_view text, Time span);

/// Sends a command for each station, from the first to the last; '#' is replaced by its digit.
void tell_each(FastrakLine& line, FastrakDemands& demands, int last, std::string_view command,
               Time span);

}  // namespace headpin::devices
