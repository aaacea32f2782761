#include "scene/sound/modal.h"

#include <cmath>
#include <numbers>

#include "base/math.h"

namespace headpin::scene {

namespace {

constexpr double kInaudible = 1e-6;  // Pa at 1 m: a twentieth of the threshold of hearing

}  // namespace

Resonator::Resonator(const Mode& mode) {
  constexpr double kStep = 1.0 / static_cast<double>(kSoundRate);
  const double angle = 2.0 * std::numbers::pi * mode.frequency * kStep;
  const double damping = exponential(-mode.decay * kStep);
  const SinCos once = sin_cos(angle), twice = sin_cos(2.0 * angle);
  by_last_ = 2.0 * damping * once.cos;
  by_before_ = -damping * damping;
  last_of_one_ = -once.sin / damping;
  before_of_one_ = -twice.sin / (damping * damping);
}

bool Resonator::fade() {
  if (std::abs(last_) + std::abs(before_) > kInaudible) return false;
  last_ = before_ = 0.0;
  return true;
}

}  // namespace headpin::scene
