#include "apps/emulator_feed.h"

#include <fmt/format.h>

#include "apps/damage.h"
#include "apps/streams.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

/// What a client receives that does not change settings, as text.
std::string place_report(const devices::FastrakPlace& place, const devices::TrialHeader& header,
                         const FeedOptions& options) {
  std::string text = fmt::format(
      "{}: in inches until a client says otherwise; positions up to {:.2f} m along an axis are not "
      "flagged{}",
      options.trial, place.envelope,
      place.envelope > devices::FastrakPlace().envelope ? " (factory: 2.00)" : "");
  if (place.p_TP.isZero()) return text + "; transmitter where it was recorded";
  const Vec3& p = place.p_TP;
  text += fmt::format(
      "; transmitter moved by {:.3f}, {:.3f}, {:.3f} m (ahead, right, down), so that all receivers "
      "are ahead of it, {:.2f} m at most",
      p.x(), p.y(), p.z(), place.farthest);
  const scene::Rig rig = scene::scenario_of_trial(header.scenario, options.trial).rig;
  const Vec3 p_W = rig.X_WT * p;
  return text + fmt::format(
                    "; in the trial's room that is rig.X_WT p = [{:.4f}, {:.4f}, {:.4f}] "
                    "(--place recorded leaves it there)",
                    p_W.x(), p_W.y(), p_W.z());
}

}  // namespace

Feed feed_of(const FeedOptions& options) {
  Feed feed;
  feed.loop = options.loop;
  if (options.trial.empty()) {
    feed.motion = options.motion == "still" ? devices::still_motion : devices::circling_motion;
    return feed;
  }
  const auto file = std::make_shared<const devices::TrialFile>(options.trial);
  file->require_trial(microseconds(options.longest_gap));
  const devices::TrialSummary& trial = file->summary();
  if (trial.sample_count == 0)
    throw std::runtime_error(options.trial + ": no device samples in it");
  say_what_is_missing("emulate", options.trial, trial);
  devices::RecordedUnit recorded = devices::recorded_unit(file);
  if (options.place == "auto") feed.place = recorded.place;
  feed.motion = devices::seen_from(feed.place, std::move(recorded.motion));
  feed.length = recorded.length;
  feed.first = recorded.first;
  feed.says = place_report(feed.place, trial.header, options);
  if (options.with_buttons) feed.buttons = std::move(recorded.buttons);
  return feed;
}

LcmFeed::LcmFeed(const std::string& url) : lcm_(devices::open_source("lcm:" + url, clocks_, {})) {
  for (int s = 0; s < devices::kFastrakStations; ++s) {
    newest_[static_cast<std::size_t>(s)] = devices::still_motion(s + 1, Time{});
  }
  lcm_.start();
}

void LcmFeed::poll(Time now) {
  samples_.clear();
  lcm_.source->poll(now, samples_);
  for (const std::string& what : faults_.take(lcm_.source->status(now).faults, now)) {
    say("headpin emulate: {}\n", what);
  }
  for (const devices::Sample& sample : samples_) {
    if (const auto* mouse = std::get_if<devices::MouseSample>(&sample)) {
      trigger_ = mouse->trigger;
      continue;
    }
    const auto& tracker = std::get<devices::TrackerSample>(sample);
    if (tracker.station < 1 || tracker.station > devices::kFastrakStations) continue;
    newest_[static_cast<std::size_t>(tracker.station - 1)] = {
        tracker.X_TS, (tracker.buttons & 1) != 0, tracker.status};
  }
}

devices::FastrakTruth LcmFeed::at(int station) const {
  devices::FastrakTruth truth = newest_[static_cast<std::size_t>(station - 1)];
  truth.pressed = truth.pressed || trigger_;
  return truth;
}

}  // namespace headpin::apps
