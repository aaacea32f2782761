#include "scene/sound/ears.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "scene/play/score.h"

namespace headpin::scene {

namespace {

constexpr double kNearestSource = 0.1;  // m
const Vec3 kHeadMiddle(0.0, 0.0, kHeadRadius);

/// Brown and Duda's formula 5, of the angle between the direction of the ear and that of the source.
double brightness(const Vec3& to_ear, const Vec3& to_source) {
  const double along = to_ear.dot(to_source), across = to_ear.cross(to_source).norm();
  const double angle_deg = std::abs(degrees_from_y(Vec3(across, along, 0.0)));
  return 1.05 + 0.95 * sin_cos(angle_deg / 150.0 * std::numbers::pi).cos;
}

}  // namespace

std::array<Way, 2> ways_to_ears(const Pose& X_WD, const Vec3& p_W) {
  std::array<Way, 2> ways;
  const Vec3 p_D = X_WD.inverse() * p_W;
  const Vec3 to_source = p_D - kHeadMiddle;
  for (std::size_t ear = 0; ear < 2; ++ear) {
    const Vec3 to_ear(ear == 0 ? -kHeadRadius : kHeadRadius, 0.0, 0.0);
    const double distance = std::max(kNearestSource, (to_source - to_ear).norm());
    ways[ear] = {distance / kSpeedOfSound * static_cast<double>(kSoundRate), 1.0 / distance,
                 brightness(to_ear, to_source)};
  }
  return ways;
}

DelayLine::DelayLine(double longest)
    : samples_(std::bit_ceil(static_cast<std::size_t>(longest) + 3), 0.0), longest_(longest) {}

void DelayLine::add(std::span<const double> samples) {
  for (const double sample : samples) {
    newest_ = (newest_ + 1) & (samples_.size() - 1);
    samples_[newest_] = sample;
  }
}

}  // namespace headpin::scene
