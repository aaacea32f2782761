#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math.h"
#include "scene/sound/modal.h"

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
  void add(std::span<const double> samples);
  /// @param delay  [samples] before the newest one; a longer one than the longest becomes that
  double at(double delay) const {
    const double back = delay < longest_ ? delay : longest_;
    const auto whole = static_cast<std::int32_t>(back);
    const double rest = back - whole;
    const std::size_t mask = samples_.size() - 1;
    const std::size_t newer = (newest_ - static_cast<std::size_t>(whole)) & mask;
    return (1.0 - rest) * samples_[newer] + rest * samples_[(newer - 1) & mask];
  }
  std::size_t size() const { return samples_.size(); }

 private:
  std::vector<double> samples_;  ///< a power of two
  std::size_t newest_ = 0;
  double longest_;
};

/// The filter of the head's shadow: one pole, one zero.
///
/// H(s) = (1 + bright s / 2 w0) / (1 + s / 2 w0) with w0 = c / a, by the bilinear transformation.
class HeadShadow {
 public:
  double filter(double sample, double bright) {
    constexpr double kCorner = 2.0 * kSpeedOfSound / kHeadRadius;
    constexpr double kTwice = 2.0 * static_cast<double>(kSoundRate);
    constexpr double kLow = kCorner / (kCorner + kTwice), kHigh = kTwice / (kCorner + kTwice);
    out_ = kLow * (sample + in_) + kHigh * bright * (sample - in_) + (kHigh - kLow) * out_;
    in_ = sample;
    return out_;
  }

 private:
  double in_ = 0.0, out_ = 0.0;
};

}  // namespace headpin::scene
