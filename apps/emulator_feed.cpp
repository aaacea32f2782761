#include "apps/emulator_feed.h"

#include <memory>

#include <fmt/format.h>

#include "apps/damage.h"
#include "apps/streams.h"
#include "scene/record/file.h"
#include "scene/record/unit.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

/// What a client receives that does not change settings, as text.
std::string place_report(const devices::FastrakPlace& place, const scene::TrialHeader& header,
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

Played play(const FeedOptions& options) {
  Played played;
  devices::Feed& feed = played.feed;
  feed.loop = options.loop;
  if (options.trial.empty()) {
    feed.motion = options.motion == "still" ? devices::still_motion : devices::circling_motion;
    return played;
  }
  const auto file = std::make_shared<const scene::TrialFile>(options.trial);
  file->require_trial(microseconds(options.longest_gap));
  const scene::TrialSummary& trial = file->summary();
  if (trial.sample_count == 0)
    throw std::runtime_error(options.trial + ": no device samples in it");
  say_what_is_missing("emulate", options.trial, trial);
  devices::RecordedUnit recorded = scene::recorded_unit(file);
  if (options.place == "auto") played.place = recorded.place;
  feed.motion = devices::seen_from(played.place, std::move(recorded.motion));
  feed.recorded = true;
  feed.length = recorded.length;
  feed.first = recorded.first;
  played.says = place_report(played.place, trial.header, options);
  played.buttons = std::move(recorded.buttons);
  return played;
}

}  // namespace headpin::apps
