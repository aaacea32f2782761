#include "scene/play/tracking.h"

#include <optional>

#include "scene/record/events.h"

namespace headpin::scene {

namespace {

/// After what time a hand that is not seen is lost.
Time hand_lost_after(const Rig& rig) {
  return rig.away_after_s == 0.0 ? kTrackingLost : microseconds(rig.away_after_s);
}

void watch_receiver(Tracking::Receiver& receiver, const devices::PoseTrack& track, TrackedPart part,
                    Time most, Time measured, const Tick& tick) {
  const std::optional<devices::KnownPose> known = track.read(measured);
  if (!known) return;
  const Time last = known->last;
  const bool lost = measured - last > most;
  if (lost != receiver.lost) {
    Event e = event(tick, lost ? kind::tracking_lost : kind::tracking_back, {});
    e.value = seconds(lost ? measured - last : last - receiver.last);
    e.detail = part;
    tick.events.push_back(std::move(e));
  }
  receiver = {last, lost};
}

}  // namespace

void watch_tracking(Tracking& tracking, const Player& player, Time measured, const Tick& tick) {
  watch_receiver(tracking.head, player.head, TrackedPart::head, kTrackingLost, measured, tick);
  watch_receiver(tracking.hand, player.hand, TrackedPart::hand,
                 hand_lost_after(tick.stage.scenario.rig), measured, tick);
}

}  // namespace headpin::scene
