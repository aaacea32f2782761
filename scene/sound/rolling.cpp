#include "scene/sound/rolling.h"

#include <cmath>

#include "base/random.h"

namespace headpin::scene {

namespace {

constexpr double kUneven = 1.27e-6;  // m, the mean of its size

/// In [-2, 2], 1 in the mean of its size.
double unevenness(std::uint64_t grain) {
  return Random(grain).uniform(-2.0, 2.0);
}

}  // namespace

RollingNoise::RollingNoise(const ContactSurface& ball, const ContactSurface& lane, double load) {
  const double compliance = (1.0 - ball.poisson * ball.poisson) / ball.modulus +
                            (1.0 - lane.poisson * lane.poisson) / lane.modulus;
  // Radius of the contact (Hertz); its stiffness is twice this radius over the compliance.
  const double contact =
      power(0.75 * load * compliance / (ball.curvature + lane.curvature), 1.0 / 3.0);
  grain_ = 2.0 * contact;
  strength_ = kUneven * 2.0 * contact / compliance;
  to_ = unevenness(grains_);
}

double RollingNoise::after(double way) {
  for (rest_ += way / grain_; rest_ >= 1.0; rest_ -= 1.0) {
    from_ = to_;
    to_ = unevenness(++grains_);
  }
  return strength_ * (from_ + rest_ * (to_ - from_));
}

}  // namespace headpin::scene
