#include "apps/mcap/export_mcap.h"

#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/live_eyes.h"
#include "apps/mcap/mcap_trial.h"
#include "apps/run_again.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/base/version.h"
#include "render/display.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

namespace {

/// Draws the pictures of a simulated trial for the file.
class McapPictures {
 public:
  McapPictures(const scene::Session& session, std::int64_t ticks, const Pose& X_WD_first,
               McapTrial& mcap)
      : eyes_(scene::open_eyes(*session.stage)),
        frames_(eyes_, plan(session, ticks, X_WD_first), {&mcap}) {
    say_instead_of("export", eyes_);
    say_not_drawn("export", session.scenario());
  }
  scene::Observer& observer() { return frames_; }

 private:
  /// The frames of `headpin frames`.
  static scene::FrameByFrame::Plan plan(const scene::Session& session, std::int64_t ticks,
                                        const Pose& X_WD_first) {
    const scene::Rates& rates = session.scenario().rates;
    const Time end = tick_time(ticks, rates.physics_hz);
    std::int64_t frames = 0;
    while (tick_time(frames, rates.frame_hz) <= end) ++frames;
    return {.fps = rates.frame_hz,
            .frames = frames,
            .wanted = [](std::int64_t) { return true; },
            .X_WD_first = X_WD_first,
            .progress = [](std::int64_t) {}};
  }

  scene::Eyes eyes_;
  scene::FrameByFrame frames_;
};

void report_mcap(const std::string& file, bool json, const std::vector<McapWriter::Topic>& topics) {
  if (json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& [name, messages] : topics)
      all.push_back({{"topic", name}, {"messages", messages}});
    return print_json({{"mcap", file}, {"topics", all}});
  }
  if (file == "-") return;
  fmt::print("{}\n", file);
  for (const auto& [name, messages] : topics) {
    fmt::print("  {:<24}{:>8} messages\n", printable(name), messages);
  }
}

}  // namespace

void export_mcap(const std::string& trial, base::OutputFile file, bool with_pictures, bool json) {
  const scene::Recorded recorded = scene::load_trial(trial);
  const scene::TrialSummary& summary = recorded.file.summary();
  say_what_is_missing("export", trial, summary);
  scene::Session session = scene::make_session(recorded.scenario);
  const Pose X_WD_first = scene::first_head_pose(recorded.file, recorded.scenario.rig);
  const std::int64_t ticks = recorded.ticks();
  devices::FileWindow log(trial);
  McapWriter writer([&](std::string_view bytes) { file.write(bytes.data(), bytes.size()); });
  McapTrial mcap(writer, session, X_WD_first, summary, log);
  std::vector<scene::Observer*> observers = {&mcap};
  std::optional<McapPictures> pictures;
  if (with_pictures) {
    observers.push_back(&pictures.emplace(session, ticks, X_WD_first, mcap).observer());
  }
  run_again(trial, recorded, session, observers);
  mcap.finish(session, {{"trial", trial},
                        {"version", devices::software_version()},
                        {"participant", summary.header.participant},
                        {"condition", summary.header.condition},
                        {"scenario", summary.header.scenario}});
  file.commit();
  if (render::has_lens(session.scenario().hmd.optics)) {
    say("headpin export: {}: its display has a lens, so the calibration of the eyes is left out\n",
        printable(trial));
  }
  report_mcap(file.path(), json, writer.topics());
}

}  // namespace headpin::apps
