#pragma once

#include <array>
#include <optional>

#include "base/math.h"

/// Changes that a Fastrak makes to a measured pose before output. Lengths in metres.
///
/// Transmitter frame T: +X forward (away from the cable), +Y right, +Z down (manual p. 51). Sensor
/// frame S: alike. Angles are azimuth, elevation, roll in degrees.
namespace headpin::devices {

/// R = Rz(azimuth) Ry(elevation) Rx(roll) (manual p. C-1) of a rotation.
///
/// @return  azimuth and roll in [-180, 180], elevation in [-90, 90]; straight up or down, where
///          only their difference is known, roll is 0
Vec3 angles_deg(const Quat& q);

/// The rotation of azimuth, elevation and roll.
Quat from_angles_deg(const Vec3& angles_deg);

/// Frame through an origin, a point on its +X axis and one on the +Y side (manual p. 37).
///
/// @return  X_TA, or nothing when the points lie on a line (within a micrometre)
std::optional<Pose> frame_through(const Vec3& p_TO, const Vec3& p_TX, const Vec3& p_TY);

/// Which of the two positions r and -r, whose fields are the same, is reported.
///
/// @param zenith  points into the half-space that the sensor is in; a position in its boundary
///                stays as it is
inline Vec3 in_hemisphere(const Vec3& p_TS, const Vec3& zenith) {
  return zenith.dot(p_TS) < 0.0 ? Vec3(-p_TS) : p_TS;
}

/// Settings of an adaptive filter (commands v and x, manual p. 76, 82).
struct FastrakFilter {
  double sensitivity = 0.2;  ///< F
  double low = 1.0;          ///< FLOW: the least weight of a new value; 1 means no filter
  double high = 0.8;         ///< FHIGH: the largest
  double factor = 0.95;      ///< FACTOR: how slowly the weight sinks again after a motion

  bool enabled() const { return low < 1.0; }
};

/// y_k = a x_k + (1 - a) y_(k-1), with a between FLOW and FHIGH (manual p. E-3).
///
/// The available pages of the manual do not say how `a` adapts. Our choice: it rises at once to F
/// times the distance between x_k and y_(k-1) [inches, degrees] and decreases by FACTOR per step.
class AdaptiveWeight {
 public:
  double next(const FastrakFilter& filter, double distance);

 private:
  double weight_ = 1.0;  // a fresh filter starts at the first value
};

/// Deviation of the noise in a sensor's position [m] and turn [rad].
struct FastrakNoise {
  double position = 0.0;
  double rotation = 0.0;
};

/// Noise at a distance from the transmitter [m].
///
/// The data sheet's resolution, 0.0002 of the range and 0.025 degrees, is valid within 30 inches.
/// Beyond, the noise grows with the cube of the distance, because the field of a dipole decreases
/// so.
FastrakNoise noise_at(double range);

/// Where the field is too weak: 10 feet [m].
constexpr double kFastrakRange = 3.048;

/// The pose that a driver receives, in binary centimetres and as a quaternion: float32, normalised.
/// If it is sent again, it does not change.
Pose as_received(const Pose& X_TS);

}  // namespace headpin::devices
