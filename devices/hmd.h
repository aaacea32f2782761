#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "engine/math.h"

/// The head-mounted display as a device: what it shows, where its receiver sits, where the eyes
/// are.
namespace headpin::devices {

/// A display with its optics, the same for both eyes but mirrored.
struct HmdProfile {
  std::string_view name;
  std::string_view source;
  int width;                  ///< picture elements per eye
  int height;                 ///< picture elements per eye
  double horizontal_fov_deg;  ///< per eye
  double vertical_fov_deg;    ///< per eye
  double eye_distance;        ///< between the lens axes [m]
  double outward_deg = 0.0;   ///< how far each eye's axis is turned outward

  /// Width of a picture element over its height, on the picture plane.
  double pixel_aspect() const;
  /// Part of one eye's horizontal field that the other sees too, far away: 1 with parallel axes.
  double overlap() const;
};

/// All profiles known; the first is the default.
std::span<const HmdProfile> hmd_profiles();

/// Their names, separated by commas.
std::string hmd_profile_names();

/// @throws std::invalid_argument  naming those there are
const HmdProfile& hmd_profile(std::string_view name);

/// A helmet on a head: display, receiver and eyes.
struct Hmd {
  HmdProfile profile;
  /// Head display in the receiver's frame. By default the receiver sits on top of the helmet, 0.12
  /// m above and 0.10 m behind the eyes, its cable to the back: its x forward, y right, z down are
  /// D's -z, x and -y.
  Pose X_SD;
  double eye_distance;  ///< between the pupils [m]; the profile's where none was measured

  explicit Hmd(const HmdProfile& profile);
};

/// The display's pose from the receiver's: X_TD.
inline Pose head_pose(const Hmd& hmd, const Pose& X_TS) {
  return X_TS * hmd.X_SD;
}

/// Left and right eye in the head's frame: x right, y up, looking along -z.
std::array<Pose, 2> eyes_in_head(const Hmd& hmd);

/// Finds X_SD from moments at which the head's own pose was known, e.g. while both sights of a
/// calibration target were in line.
///
/// Each moment gives X_TS^-1 X_TD; their mean is taken, of positions as such and of rotations as
/// the quaternion closest to all of them.
///
/// @param X_TS  receiver as measured, one a moment
/// @param X_TD  display as known at the same moments
/// @throws std::invalid_argument  without moments, or with unequal numbers of them
Pose calibrate_receiver(std::span<const Pose> X_TS, std::span<const Pose> X_TD);

/// How far the moments disagree with X_SD: root mean square of position [m] and turn [rad].
struct CalibrationError {
  double position = 0.0;
  double rotation = 0.0;
};
CalibrationError calibration_error(std::span<const Pose> X_TS, std::span<const Pose> X_TD,
                                   const Pose& X_SD);

}  // namespace headpin::devices
