#include "scene/page/browser_device.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "devices/base/sample.h"

namespace headpin::scene {

namespace {

/// WebXR's grip space (WebXR Device API, section 11.2; OpenXR 1.0, section 6.3.1): for the right hand,
/// x leaves the back of the hand and -z leaves the fist on the thumb's side. The virtual hand's back
/// is along y, and its fingers along -z.
Quat hand_in_grip() {
  Mat3 R_SH;
  R_SH << 0.0, 1.0, 0.0,  //
      0.0, 0.0, 1.0,      //
      1.0, 0.0, 0.0;
  return Quat(R_SH);
}

/// Of the left hand: the mirror image in the plane x = 0 of both frames.
Pose of_left_hand(const Pose& X_SH) {
  return {Quat(X_SH.q.w(), X_SH.q.x(), -X_SH.q.y(), -X_SH.q.z()),
          Vec3(-X_SH.p.x(), X_SH.p.y(), X_SH.p.z())};
}

constexpr double kFrame = 0.017;       // s, of a headset with 60 frames a second
constexpr double kReach = 0.35;        // the first ball is so far to the side of the player [m]
constexpr double kBehind = 0.20;       // and so far ahead
constexpr double kMouseWindow = 0.05;  // of the velocity at a release [s]

}  // namespace

std::span<const BrowserDevice> browser_devices() {
  static const std::array<BrowserDevice, 3> kAll = {{
      {"mouse", "the page computes the pose of the virtual hand from the pointer or from keys",
       Pose{}, 0.020, 0.0, 0.0, false},
      {"generic-webxr", "WebXR Device API: grip space", Pose{hand_in_grip(), Vec3::Zero()}, kFrame,
       0.0, 0.1, true},
      {"predicting-webxr",
       "WebXR Device API: grip space; XRFrame.predictedDisplayTime is 25 ms ahead or more",
       Pose{hand_in_grip(), Vec3::Zero()}, 0.0, 0.025, 0.1, true},
  }};
  return kAll;
}

const BrowserDevice& browser_device(std::string_view name) {
  const auto found = std::ranges::find(browser_devices(), name, &BrowserDevice::name);
  if (found != browser_devices().end()) return *found;
  std::string names;
  for (const BrowserDevice& device : browser_devices()) {
    names.append(names.empty() ? "" : ", ").append(device.name);
  }
  throw std::invalid_argument("device '" + std::string(name) + "': expected one of " + names);
}

Scenario played_with(Scenario scenario, const BrowserDevice& device, bool left_hand) {
  const double side = left_hand ? -1.0 : 1.0;
  Vec3& home = scenario.ball.home;
  home.x() = side * std::abs(home.x());
  Rig& rig = scenario.rig;
  rig.head_station = devices::kHeadStation;
  rig.hand_station = left_hand ? devices::kLeftHandStation : devices::kHandStation;
  rig.X_WT = {rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0)),
              Vec3(home.x() - side * kReach, home.y() - kBehind, 0.0)};
  rig.X_SD = {};
  rig.X_SH = left_hand ? of_left_hand(device.X_SH) : device.X_SH;
  rig.delay_s = device.delay_s;
  rig.predicted_s = device.predicted_s;
  rig.away_after_s = device.away_after_s;
  Hand& hand = scenario.hand;
  if (!device.solid_hand) {
    hand.solid = false;
    hand.release_window_s = kMouseWindow;
  }
  if (left_hand) {
    hand.grip = Vec3(-hand.grip.x(), hand.grip.y(), hand.grip.z());
    hand.spin = Vec3(hand.spin.x(), -hand.spin.y(), -hand.spin.z());
  }
  return scenario;
}

}  // namespace headpin::scene
