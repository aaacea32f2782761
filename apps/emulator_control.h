#pragma once

#include <string>
#include <vector>

#include "apps/emulator_feed.h"
#include "apps/emulator_mouse.h"
#include "devices/fastrak/emulator.h"

namespace headpin::apps {

/// Reads control lines for a running emulator from a named pipe or standard input.
class Control {
 public:
  /// @param path  a named pipe, made if missing; - for standard input; empty: no line ever comes
  /// @throws std::runtime_error  naming the path
  explicit Control(const std::string& path);
  ~Control();
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  int descriptor() const { return fd_; }

  /// The complete lines since the last call; of very many lines, the rest comes with the next call.
  std::vector<std::string> lines();

 private:
  int fd_ = -1;
  std::string made_, text_;
  bool told_ = false;
};

/// Executes a control line.
///
/// @return  false for the line that ends the emulator
/// @throws std::invalid_argument  naming the line, and what was expected
bool obey(const std::string& line, devices::FastrakEmulator& emulator, Feed& feed, bool stylus,
          EmulatedMouse* mouse, Time now);

}  // namespace headpin::apps
