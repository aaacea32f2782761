#include "scene/game.h"

namespace headpin::scene {

bool has_fallen(const Pose& X_WB) {
  constexpr double kCos20Degrees = 0.93969262078590838;
  return (X_WB.q * Vec3::UnitZ()).z() < kCos20Degrees;
}

}  // namespace headpin::scene
