#pragma once

#include <span>
#include <string_view>

#include "scene/scenario/scenario.h"

/// Tracked devices of a browser: the headset and its controllers, or a mouse in their place.
namespace headpin::scene {

/// How a device of a browser is worn and read.
struct BrowserDevice {
  std::string_view name;
  std::string_view source;  ///< where its frames are defined
  Pose X_SH;                ///< what is tracked on the right hand -> virtual hand
  double delay_s;           ///< poses are read this long before now
  double predicted_s;       ///< and are told this long before the time that they are for
  double away_after_s;      ///< a hand that is not tracked for longer is nowhere; 0: never
  bool solid_hand;          ///< the hand pushes what it touches
};

/// All that are known; the first is the mouse.
std::span<const BrowserDevice> browser_devices();

/// @throws std::invalid_argument  naming the devices
const BrowserDevice& browser_device(std::string_view name);

/// The scenario as it is played with a device. The tracked space is WebXR's `local-floor` (x right, y
/// up, z back), which stands where an arm reaches the first ball. Stations are those of the Fastrak.
///
/// @param left_hand  the left hand takes the ball, which waits on the left then
Scenario played_with(Scenario scenario, const BrowserDevice& device, bool left_hand);

}  // namespace headpin::scene
