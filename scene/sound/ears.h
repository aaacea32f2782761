#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/math.h"

/// How a sound reaches the two ears.
namespace headpin::scene {

inline constexpr double kSpeedOfSound = 343.0;  ///< in air at 20 degrees [m/s]
inline constexpr double kHeadRadius = 0.09;     ///< from the head's middle to each ear [m]

/// Delay, loudness and shadow of a sound on its straight way to one ear.
struct Way {
  double delay = 0.0;   ///< [samples]
  double gain = 1.0;    ///< 1 / distance, at most that at 0.1 m
  double bright = 1.0;  ///< gain of high frequencies: 2 on the side of the ear, 0.1 behind the head
};

/// The ways to the left and the right ear.
///
/// The shadow is that of a sphere, as Brown and Duda (1998, A structural model for binaural sound
/// synthesis) simplify it. The middle of the head is one head radius behind the eyes.
/// @param X_WD  head display: x right, y up, looking along -z, origin midway between the eyes
/// @param p_W   where the sound is made
std::array<Way, 2> ways_to_ears(const Pose& X_WD, const Vec3& p_W);

/// The recent samples of a source, from which each ear hears one that is somewhat older.
class DelayLine {
 public:
  /// @param longest  delay [samples]
  explicit DelayLine(double longest);
  void add(double sample);
  /// @param delay  [samples] before the newest one; a longer one than the longest becomes that
  double at(double delay) const;
  std::size_t size() const { return samples_.size(); }

 private:
  std::vector<double> samples_;  ///< a power of two
  std::size_t newest_ = 0;
  double longest_;
};

/// The filter of the head's shadow: one pole, one zero.
class HeadShadow {
 public:
  double filter(double sample, double bright);

 private:
  double in_ = 0.0, out_ = 0.0;
};

}  // namespace headpin::scene
