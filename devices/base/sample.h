#pragma once

#include <string>
#include <variant>

#include "engine/math.h"

/// Measurements of devices, with their time, frame and quality.
namespace headpin::devices {

/// One measurement of one tracked sensor.
struct TrackerSample {
  Time device_time{};         ///< when it was measured, on the session's clock
  Time host_time{};           ///< when its first byte arrived; 0 if it was not transmitted
  std::int64_t sequence = 0;  ///< number per station; a gap is a lost sample
  std::int32_t station = 1;   ///< 1..4
  Pose X_TS;                  ///< sensor in the transmitter's frame [m]
  char status = ' ';          ///< ' ' good, else the Fastrak's error letter
  std::uint8_t buttons = 0;   ///< bit 0: stylus switch
  std::string frame = "T";    ///< frame the pose is given in; "T", or nothing, the transmitter's
  Time session_time{};        ///< time of the tick at which a session used it; 0 outside a session

  bool good() const { return status == ' '; }
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
};

using Sample = std::variant<TrackerSample, MouseSample>;

inline Time device_time(const Sample& sample) {
  return std::visit([](const auto& s) { return s.device_time; }, sample);
}

// Where headpin's own units have them; a scenario's rig says what is worn where.
constexpr std::int32_t kHeadStation = 1;
constexpr std::int32_t kHandStation = 2;
constexpr std::int32_t kLeftHandStation = 3;

/// The device of a sample: the station of a tracker, or 0 for the 3D mouse.
inline std::int32_t device_of(const Sample& sample) {
  const auto* tracker = std::get_if<TrackerSample>(&sample);
  return tracker ? tracker->station : 0;
}

/// "head", "right hand", "left hand", "station 4"; 0: "3D mouse".
inline std::string device_name(std::int32_t device) {
  if (device == 0) return "3D mouse";
  if (device == kHeadStation) return "head";
  if (device == kHandStation) return "right hand";
  return device == kLeftHandStation ? "left hand" : "station " + std::to_string(device);
}

}  // namespace headpin::devices
