#pragma once

#include <array>
#include <vector>

#include "scene/play/player.h"
#include "scene/stage/stage.h"

/// Whether head and hand are where they are seen. A receiver that is pulled out, or out of reach of
/// its transmitter, gives no usable sample; its last pose stays, or the hand is away
/// (`rig.away_after_s`).
namespace headpin::scene {

/// A receiver without a usable sample for as long as this is lost. The slowest Fastrak, with four
/// receivers, gives one each 33 ms; a line may deliver them late. `rig.away_after_s` takes its place
/// for the hand.
inline constexpr Time kTrackingLost{250'000};

struct Tracking {
  struct Receiver {
    Time last{};  ///< its last usable sample, on the device's clock
    bool lost = false;
  };
  Receiver head, hand;
};

/// Reports when head or hand is lost, and when it is back; one that was never seen is not lost.
/// @param measured  time of the poses of this tick: `rig.delay_s` before it
void watch_tracking(Tracking& tracking, const Player& player, Time measured, const Tick& tick);

}  // namespace headpin::scene
