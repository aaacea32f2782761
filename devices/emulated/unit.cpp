#include "devices/emulated/unit.h"

#include <utility>

#include "devices/fastrak/serving.h"

namespace headpin::devices {

EmulatedUnit::EmulatedUnit(FastrakEmulatorOptions options, Feed feed,
                           std::unique_ptr<EmulatedMouse> mouse)
    : has_stylus_(options.stylus > 0),
      feed_(std::move(feed)),
      mouse_(std::move(mouse)),
      emulator_(std::move(options),
                [this](int station, Time time) { return feed_.at(station, time); }) {}

void EmulatedUnit::step(Time now, ByteStream& line) {
  if (mouse_ && (streams_ > 0 || !feed_.recorded)) {
    mouse_->publish(feed_.recorded ? now - emulator_.stream_zero() : now, feed_.within(now));
  }
  serve(emulator_, line, now);
  const std::int64_t streams = emulator_.statistics().streams;
  if (streams > streams_) feed_.begin = begin_of(feed_.first, emulator_, now);
  streams_ = streams;
}

void EmulatedUnit::press(const std::string& line) {
  if (!has_stylus_ && !mouse_) throw NoSuchButton(line, false);
  feed_.pressed = line == "press";
  if (mouse_) mouse_->typed.trigger = feed_.pressed;
}

void EmulatedUnit::move_thumb(const std::string& line) {
  if (!mouse_) throw NoSuchButton(line, true);
  const bool down = line.ends_with(" down");
  if (!down && !line.ends_with(" up")) {
    throw std::invalid_argument("control line '" + line + "': expected up or down after it");
  }
  (line.starts_with("left") ? mouse_->typed.left_thumb : mouse_->typed.right_thumb) = down;
}

bool EmulatedUnit::obey(const std::string& line, Time now) {
  if (line == "power-cycle") {
    emulator_.power_cycle(now);
  } else if (line == "press" || line == "release") {
    press(line);
  } else if (line.starts_with("left-thumb ") || line.starts_with("right-thumb ")) {
    move_thumb(line);
  } else if (line == "rewind") {
    feed_.begin = begin_of(feed_.first, emulator_, now);
  } else if (line == "faults" || line.starts_with("faults ")) {
    const std::size_t spec = line.find_first_not_of(' ', 6);
    emulator_.set_faults(parse_faults(spec == std::string::npos ? "" : line.substr(spec)));
  } else if (!line.empty() && line != "quit") {
    throw std::invalid_argument(
        "control line '" + line +
        "': expected power-cycle, press, release, left-thumb or right-thumb up or down, rewind, "
        "faults SPEC or quit");
  }
  return line != "quit";
}

}  // namespace headpin::devices
