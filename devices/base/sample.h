#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "base/math.h"

/// Measurements of devices, with their time, frame and quality.
namespace headpin::devices {

/// One measurement of one tracked sensor.
struct TrackerSample {
  Time device_time{};  ///< when the pose is valid: it was measured then, or predicted for then
  Time host_time{};    ///< when its first byte arrived; 0 if it was not transmitted
  std::int64_t sequence = 0;  ///< number per station; a gap is a lost sample
  std::int32_t station = 1;   ///< from 1, of foreign publishers any; a Fastrak has four
  Pose X_TS;                  ///< sensor in the transmitter's frame [m]
  char status = ' ';          ///< ' ' good, else the Fastrak's error letter
  std::uint8_t buttons = 0;   ///< bit 0: stylus switch
  std::string frame = "T";    ///< frame the pose is given in; "T", or nothing, the transmitter's
  Time session_time{};        ///< time of the tick at which a session used it; 0 outside a session
  Time sent_time{};  ///< when the device told it; 0: at `device_time`, nothing is predicted
  /// The device did not track it at that time, and tells what it estimates.
  bool position_estimated = false, orientation_estimated = false;

  bool good() const { return status == ' '; }
  /// Whether it shows where a hand is.
  bool places_hand() const { return good() && !position_estimated; }
  /// When the device told it, by its own clock.
  Time told() const { return sent_time == Time{} ? device_time : sent_time; }
  /// The only supported frame; sources skip and count samples in other frames.
  bool in_transmitters_frame() const { return frame.empty() || frame == "T"; }
};

/// State of the 3D mouse's buttons, at each change.
struct MouseSample {
  Time device_time{};
  Time host_time{};
  bool left_thumb = false;   ///< walk forward
  bool right_thumb = false;  ///< walk backward
  bool trigger = false;      ///< grab
  Time session_time{};       ///< as in TrackerSample

  Time told() const { return device_time; }
};

using Sample = std::variant<TrackerSample, MouseSample>;

inline Time device_time(const Sample& sample) {
  return std::visit([](const auto& s) { return s.device_time; }, sample);
}

inline Time told(const Sample& sample) {
  return std::visit([](const auto& s) { return s.told(); }, sample);
}

// Where headpin's own units have them; a scenario's rig says what is worn where.
constexpr std::int32_t kHeadStation = 1;
constexpr std::int32_t kHandStation = 2;
constexpr std::int32_t kLeftHandStation = 3;

/// What samples are from: the 3D mouse, or a station of the tracker, whose value is its number. In
/// order, the mouse is first.
enum class Device : std::int64_t { mouse = std::numeric_limits<std::int64_t>::min() };

constexpr Device device_at(std::int32_t station) {
  return Device{station};
}

/// Nothing for the mouse.
constexpr std::optional<std::int32_t> station_of(Device device) {
  if (device == Device::mouse) return std::nullopt;
  return static_cast<std::int32_t>(device);
}

inline Device device_of(const Sample& sample) {
  const auto* tracker = std::get_if<TrackerSample>(&sample);
  return tracker ? device_at(tracker->station) : Device::mouse;
}

/// "head", "right hand", "left hand", "station 4", "3D mouse".
inline std::string device_name(Device device) {
  if (device == Device::mouse) return "3D mouse";
  if (device == device_at(kHeadStation)) return "head";
  if (device == device_at(kHandStation)) return "right hand";
  if (device == device_at(kLeftHandStation)) return "left hand";
  return "station " + std::to_string(*station_of(device));
}

}  // namespace headpin::devices
