#include "scene/play/tracking.h"

#include <algorithm>
#include <string>

#include "scene/play/events.h"

namespace headpin::scene {

namespace {

/// Time of the last sample up to a time, or of the first sample if all are later. The track is not
/// empty.
Time last_until(const devices::PoseTrack& track, Time time) {
  const std::vector<Stamped<Pose>>& samples = track.samples();
  const auto after = std::ranges::upper_bound(samples, time, {}, &Stamped<Pose>::time);
  return after == samples.begin() ? after->time : (after - 1)->time;
}

void watch_receiver(Tracking::Receiver& receiver, const devices::PoseTrack& track,
                    const std::string& name, Time measured, const engine::World& world,
                    const Moment& moment, std::vector<devices::Event>& out) {
  if (track.samples().empty()) return;
  const Time last = last_until(track, measured);
  const bool lost = measured - last > kTrackingLost;
  if (lost != receiver.lost) {
    devices::Event e = event(moment, lost ? kind::tracking_lost : kind::tracking_back, world, {});
    e.value = seconds(lost ? measured - last : last - receiver.last);
    e.detail = name;
    out.push_back(std::move(e));
  }
  receiver = {last, lost};
}

}  // namespace

void watch_tracking(Tracking& tracking, const Player& player, Time measured,
                    const engine::World& world, const Moment& moment,
                    std::vector<devices::Event>& out) {
  watch_receiver(tracking.head, player.head, "head", measured, world, moment, out);
  watch_receiver(tracking.hand, player.hand, "hand", measured, world, moment, out);
}

}  // namespace headpin::scene
