#include "devices/fastrak/motion.h"

#include <numbers>

#include "devices/fastrak/geometry.h"

namespace headpin::devices {

FastrakTruth still_motion(int station, Time) {
  FastrakTruth truth;
  truth.X_TS.p = Vec3(0.4, 0.1 * (station - 2), -0.1);
  return truth;
}

FastrakTruth circling_motion(int station, Time time) {
  constexpr Time kTurn{4'000'000};
  const double angle = 2.0 * std::numbers::pi * seconds(time % kTurn) / seconds(kTurn);
  const SinCos at = sin_cos(angle);
  FastrakTruth truth = still_motion(station, time);
  truth.X_TS.p += Vec3(0.2 * at.cos, 0.2 * at.sin, 0.0);
  truth.X_TS.q = rotation(angle * Vec3::UnitZ());
  return truth;
}

FastrakMotion seen_from(const FastrakPlace& place, FastrakMotion motion) {
  return [p_TP = place.p_TP, motion = std::move(motion)](int station, Time time) {
    FastrakTruth truth = motion(station, time);
    truth.X_TS.p -= p_TP;
    return truth;
  };
}

}  // namespace headpin::devices
