#include "scene/play/tracking.h"

#include <optional>

#include "scene/record/events.h"

namespace headpin::scene {

namespace {

void watch_receiver(Tracking::Receiver& receiver, const devices::PoseTrack& track, TrackedPart part,
                    Time measured, const Tick& tick) {
  const std::optional<devices::KnownPose> known = track.read(measured);
  if (!known) return;
  const Time last = known->last;
  const bool lost = measured - last > kTrackingLost;
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
  watch_receiver(tracking.head, player.head, TrackedPart::head, measured, tick);
  watch_receiver(tracking.hand, player.hand, TrackedPart::hand, measured, tick);
}

}  // namespace headpin::scene
