#pragma once

#include <vector>

#include "devices/base/sample.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// What a hand does: poses 60 times a second, and the trigger.
class HandScript {
 public:
  explicit HandScript(const Scenario& scenario) : scenario_(scenario) {}

  /// Stays at a place for some seconds, with the ball's centre there.
  void stay(const Vec3& p_WB, double seconds) {
    for (int i = 0; i < static_cast<int>(60.0 * seconds); ++i) put(p_WB);
  }
  void trigger(bool down) {
    samples.emplace_back(devices::MouseSample{.device_time = now(), .trigger = down});
  }
  /// Takes the ball from its stand and throws it along y from beside the middle of the lane.
  ///
  /// @param wait_s  how long the hand is out of everybody's way then
  /// @param y       where it lets go
  void throw_from(double x, double speed = 6.0, double wait_s = 9.5, double y = 0.0) {
    stay(scenario_.ball.home, 0.3);
    trigger(true);
    stay(scenario_.ball.home, 0.2);
    const double swing_s = 0.5, a = speed / swing_s;
    for (int i = 0; i < 30; ++i) {
      const double t = i / 60.0;
      put(Vec3(x, y + 0.5 * a * (t * t - swing_s * swing_s), 0.14));
    }
    put(Vec3(x, y, 0.14));
    trigger(false);
    for (int i = 1; i < 6; ++i) put(Vec3(x, y + speed * i / 60.0, 0.14 + 0.1 * i));
    stay(Vec3(-1.2, -1.0, 1.0), wait_s);
  }
  void touch(const Vec3& button) {
    stay(button + Vec3(0.0, -0.6, 0.0), 0.2);
    stay(button + scenario_.hand.grip, 0.3);
    stay(button + Vec3(0.0, -0.6, 0.0), 0.2);
  }

  std::vector<devices::Sample> samples;

 private:
  Time now() const { return tick_time(count_, 60); }
  void put(const Vec3& p_WB) {
    devices::TrackerSample hand;
    hand.device_time = now();
    hand.sequence = count_++;
    hand.station = devices::kHandStation;
    hand.X_TS.p = p_WB - scenario_.hand.grip;
    samples.emplace_back(hand);
  }

  const Scenario& scenario_;
  std::int64_t count_ = 0;
};

}  // namespace headpin::scene
