#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "devices/emulated/feed.h"
#include "devices/emulated/mouse.h"
#include "devices/fastrak/emulator.h"

namespace headpin::devices {

/// A control line needs a button that the unit does not have.
struct NoSuchButton : std::invalid_argument {
  NoSuchButton(const std::string& line, bool thumb)
      : std::invalid_argument("control line '" + line + "': there is no such button"),
        of_thumb(thumb) {}
  bool of_thumb;  ///< and so of the mouse; else the trigger, which a mouse or a stylus has
};

/// An emulated Fastrak that measures a feed, with the 3D mouse beside it.
class EmulatedUnit {
 public:
  /// @param mouse  null: there is none
  EmulatedUnit(FastrakEmulatorOptions options, Feed feed,
               std::unique_ptr<EmulatedMouse> mouse = nullptr);
  EmulatedUnit(const EmulatedUnit&) = delete;
  EmulatedUnit& operator=(const EmulatedUnit&) = delete;

  /// Publishes the mouse's buttons, and passes bytes from the line to the unit and back. To be
  /// called about every millisecond, which determines the timing of the bytes.
  ///
  /// A recording begins when a client starts the stream, and again for the next client. The times
  /// of its buttons are on the clock of the unit's records.
  void step(Time now, ByteStream& line);

  /// Carries out a control line: power-cycle, press, release, left-thumb down, left-thumb up,
  /// right-thumb down, right-thumb up, rewind, `faults` with a list as parse_faults takes it, quit.
  ///
  /// @return  false for `quit`
  /// @throws std::invalid_argument  naming the line, and what was expected
  bool obey(const std::string& line, Time now);

  const FastrakEmulator& emulator() const { return emulator_; }

 private:
  void press(const std::string& line);
  void move_thumb(const std::string& line);

  bool has_stylus_;
  Feed feed_;
  std::unique_ptr<EmulatedMouse> mouse_;
  FastrakEmulator emulator_;
  std::int64_t streams_ = 0;  ///< that clients have started
};

}  // namespace headpin::devices
