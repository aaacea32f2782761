#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/frame_folder.h"
#include "apps/frame_ranges.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/simulate.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/hmd.h"
#include "render/video.h"
#include "scene/spectator.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::string trial, frames;
  std::optional<std::string> folder, video;
  std::int64_t fps = 0;
  bool force = false, json = false;
};

/// Where the head is before any sample of it has come: where the first one will find it.
Pose first_head_pose(const LoadedTrial& loaded) {
  for (const devices::Sample& sample : loaded.trial.samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (tracker && tracker->station == devices::kHeadStation && tracker->good()) {
      return loaded.scenario.rig.X_WT * tracker->X_TS * loaded.scenario.rig.X_SD;
    }
  }
  throw std::runtime_error("expected samples of the head (station 1), found none");
}

void run(const Options& options) {
  if (!options.folder && !options.video) {
    throw UsageError("nothing to write: expected -o DIR, --video FILE or both");
  }
  const FrameRanges wanted = options.frames.empty() ? FrameRanges() : FrameRanges(options.frames);
  const LoadedTrial loaded = load_trial(options.trial);
  scene::Session session = scene::make_session(loaded.scenario);
  const std::int64_t fps = options.fps > 0 ? options.fps : loaded.scenario.rates.frame_hz;
  const Pose first_head = first_head_pose(loaded);

  scene::Spectator spectator = scene::make_spectator(loaded.scenario);
  const double pixel_aspect = spectator.optics.pixel_aspect();
  watch_stop_signals();
  std::optional<FrameFolder> folder;
  if (options.folder) {
    std::vector<fs::path> others = {options.trial};
    if (options.video) others.push_back(*options.video);
    folder.emplace(*options.folder, pixel_aspect,
                   files::OutputFolder::Options{.overwrite = options.force, .others = others});
  }
  std::optional<render::VideoWriter> video;
  if (options.video) {
    video.emplace(*options.video, 2 * spectator.optics.width, spectator.optics.height, fps,
                  pixel_aspect, options.force, std::vector<fs::path>{options.trial});
  }

  const Time end =
      tick_time(tick_count(loaded.trial, loaded.scenario), session.scenario.rates.physics_hz);
  std::int64_t frames = 0;
  while (tick_time(frames, fps) <= end) ++frames;
  const std::int64_t total = wanted.count_below(frames);
  if (total == 0) {
    throw UsageError(
        fmt::format("--frames {}: expected frames from 0 to {}", options.frames, frames - 1));
  }

  Progress progress("frames", total);
  Frame frame;
  std::int64_t written = 0;
  const auto draw_up_to_now = [&](const scene::Session& s) {
    for (; frame.number < frames && tick_time(frame.number, fps) <= s.now(); ++frame.number) {
      if (!wanted.contains(frame.number)) continue;
      frame.tick = s.world.tick;
      frame.time = tick_time(frame.number, fps);
      frame.views = scene::see(
          spectator, scene::glimpse(s, scene::head_pose(s).value_or(first_head)), frame.images);
      if (folder) folder->add(frame);
      if (video) video->add(render::side_by_side(frame.images[0], frame.images[1]));
      check_stop();
      progress.show(++written);
    }
  };
  std::optional<Verifier> verifier;  // what is shown is what was recorded, or nothing is
  if (!loaded.trial.states.empty()) verifier.emplace(loaded.trial, session);
  devices::TickState state;
  draw_up_to_now(session);
  simulate(session, loaded.trial, [&](const scene::Session& s) {
    if (verifier) {
      scene::tick_state(s, state);
      verifier->compare(state);
    }
    draw_up_to_now(s);
  });
  if (video) video->close();
  if (folder) folder->close();
  if (options.json) {
    print_json({{"frames", written},
                {"fps", fps},
                {"width", spectator.optics.width},
                {"height", spectator.optics.height},
                {"renderer", spectator.renderer.description()}});
  } else {
    fmt::print("{} frames of two eyes, {}x{} each, drawn by {}\n", written, spectator.optics.width,
               spectator.optics.height, spectator.renderer.description());
  }
}

}  // namespace

void add_frames(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("frames", "Draw what the participant saw: both eyes, frame by frame");
  command->add_option("trial", options->trial, "a trial (.lcmlog), replayed or not")->required();
  add_output(*command, "-o,--output", options->folder,
             "folder for left_NNNNNN.png, right_NNNNNN.png and frames.csv: a new or empty one, or "
             "with --force one that headpin filled");
  add_output(*command, "--video", options->video,
             "both eyes side by side, lossless (.mkv); a copy beside it (.mp4) plays anywhere");
  command->add_option("--frames", options->frames, "only these, such as 10-20,35");
  command->add_option("--fps", options->fps, "frames a second; the scenario's when not given")
      ->check(CLI::Range(1, 1000));
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "The display is the trial's own. To look through another, change it first:\n"
      "  headpin replay TRIAL --set hmd.profile=NAME -o OTHER\nNAME is one of " +
      devices::hmd_profile_names() +
      "; a single value is changed likewise, as by --set hmd.eye_distance=0.06.\n\n"
      "Example:\n  headpin frames assets/trials/demo.lcmlog -o frames --video "
      "stereo.mkv");
  command->callback([options] { run(*options); });
}

}  // namespace headpin::apps
