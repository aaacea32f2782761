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
#include "apps/stop.h"
#include "apps/streams.h"
#include "render/hmd.h"
#include "render/video.h"
#include "scene/eye_frames.h"
#include "scene/recorded.h"
#include "scene/verifier.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

struct FramesOptions {
  std::string trial, frames;
  std::optional<std::string> folder, video;
  std::int64_t fps = 0;
  double longest_gap = seconds(devices::kLongestGap);
  bool verify = false, force = false, json = false;
};

/// Both eyes side by side, as a video.
class VideoSink : public scene::FrameSink {
 public:
  VideoSink(const FramesOptions& options, const render::Optics& optics, std::int64_t fps)
      : writer_(*options.video, 2 * optics.width, optics.height, fps, optics.pixel_aspect(),
                options.force, std::vector<fs::path>{options.trial}) {}

  void add(const scene::EyeFrame& frame) override {
    writer_.add(render::side_by_side(frame.images[0], frame.images[1]));
  }
  void close() { writer_.close(); }

 private:
  render::VideoWriter writer_;
};

/// How many frames there are until a time.
std::int64_t frames_until(Time end, std::int64_t fps) {
  std::int64_t frames = 0;
  while (tick_time(frames, fps) <= end) ++frames;
  return frames;
}

void draw_frames(const FramesOptions& options) {
  if (!options.folder && !options.video && !options.verify) {
    throw UsageError("nothing to write: expected -o DIR, --video FILE or both, or --verify");
  }
  const FrameRanges wanted = options.frames.empty() ? FrameRanges() : FrameRanges(options.frames);
  const scene::Recorded recorded =
      scene::load_trial(options.trial, microseconds(options.longest_gap));
  const devices::TrialSummary& trial = recorded.file.summary();
  const scene::Rates& rates = recorded.scenario.rates;
  const std::int64_t fps = options.fps > 0 ? options.fps : rates.frame_hz;
  const std::int64_t ticks = scene::tick_count(trial, rates.physics_hz);
  const std::int64_t frames = frames_until(tick_time(ticks, rates.physics_hz), fps);
  const std::int64_t total = wanted.count_below(frames);
  if (total == 0) {
    throw UsageError(
        fmt::format("--frames {}: expected frames from 0 to {}", options.frames, frames - 1));
  }
  const Pose X_WD_first = scene::first_head_pose(recorded.file, recorded.scenario.rig);

  scene::Session session = scene::make_session(recorded.scenario);
  scene::Eyes eyes = scene::open_eyes(*session.stage);
  std::vector<scene::FrameSink*> sinks;
  watch_stop_signals();
  std::optional<FrameFolder> folder;
  if (options.folder) {
    std::vector<fs::path> others = {options.trial};
    if (options.video) others.push_back(*options.video);
    sinks.push_back(&folder.emplace(
        *options.folder, eyes.optics.pixel_aspect(),
        files::OutputFolder::Options{.overwrite = options.force, .others = others}));
  }
  std::optional<VideoSink> video;
  if (options.video) sinks.push_back(&video.emplace(options, eyes.optics, fps));

  devices::TrialPlayer source(recorded.file, {.states = true, .frames = options.verify});
  Progress progress("frames", total);
  scene::FrameByFrame drawing(eyes,
                              {.fps = fps,
                               .frames = frames,
                               .wanted = [&](std::int64_t frame) { return wanted.contains(frame); },
                               .X_WD_first = X_WD_first,
                               .progress = [&](std::int64_t drawn) { progress.show(drawn); }},
                              sinks);
  std::vector<scene::Observer*> observers;
  std::optional<scene::Verifier> verifier;  // what is shown is what was recorded, or nothing is
  if (source.has_states()) observers.push_back(&verifier.emplace(source, session));
  std::optional<scene::FrameVerifier> looking;
  if (options.verify) observers.push_back(&looking.emplace(eyes, source));
  if (!sinks.empty()) observers.push_back(&drawing);

  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  if (video) video->close();
  if (folder) folder->close();
  const std::int64_t compared = looking ? looking->compared() : 0;
  if (options.json) {
    const auto path = [](const std::optional<std::string>& name) {
      return name ? nlohmann::ordered_json(*name) : nlohmann::ordered_json();
    };
    print_json({{"trial", options.trial},
                {"output", path(options.folder)},
                {"video", path(options.video)},
                {"frames", drawing.drawn()},
                {"verified_frames", compared},
                {"fps", fps},
                {"width", eyes.optics.width},
                {"height", eyes.optics.height},
                {"renderer", eyes.renderer.description()}});
    return;
  }
  if (looking) fmt::print("{} frames equal the recording\n", compared);
  if (!sinks.empty()) {
    fmt::print("{} frames of two eyes, {}x{} each, drawn by {}\n", drawing.drawn(),
               eyes.optics.width, eyes.optics.height, eyes.renderer.description());
  }
}

}  // namespace

void add_frames(CLI::App& app) {
  auto options = std::make_shared<FramesOptions>();
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
  command->add_flag("--verify", options->verify,
                    "draw what a live session recorded of its frames, and compare the pictures");
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  command->footer(
      "The display is the trial's own. To look through another, change it first:\n"
      "  headpin replay TRIAL --set hmd.profile=NAME -o OTHER\nNAME is one of " +
      render::hmd_profile_names() +
      "; a single value is changed likewise, as by --set hmd.eye_distance=0.06.\n\n"
      "Example:\n  headpin frames assets/trials/demo.lcmlog -o frames --video "
      "stereo.mkv");
  command->callback([options] { draw_frames(*options); });
}

}  // namespace headpin::apps
