#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/frame_folder.h"
#include "apps/frame_ranges.h"
#include "apps/live_eyes.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "render/hmd.h"
#include "render/video.h"
#include "scene/drawn_by.h"
#include "scene/eye_frames.h"
#include "scene/recorded.h"
#include "scene/verifier.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

struct FramesOptions {
  std::string trial, frames, gl;
  std::optional<std::string> folder, video, look;
  std::optional<int> samples;
  std::int64_t fps = 0;
  double longest_gap = seconds(devices::kLongestGap);
  bool verify = false, as_shown = false, force = false, json = false;
};

/// The trial's look, unless another is asked for.
render::Quality look_of(const FramesOptions& options, scene::Scenario scenario) {
  Condition other;
  other.look = options.look;
  if (options.samples) other.set.push_back(fmt::format("look.samples={}", *options.samples));
  apply(other, scenario);
  return scenario.look;
}

/// Both eyes side by side, as a video.
class VideoSink : public scene::FrameSink {
 public:
  /// @param hold  a picture stays until the number of the next one: what was left out took its time
  VideoSink(const FramesOptions& options, const render::Optics& optics, std::int64_t fps, bool hold)
      : writer_(*options.video, 2 * optics.width, optics.height, fps, optics.pixel_aspect(),
                options.force, std::vector<fs::path>{options.trial}),
        hold_(hold) {}

  void add(const scene::EyeFrame& frame) override {
    if (hold_ && !last_.rgb.empty()) {
      for (std::int64_t i = number_ + 1; i < frame.number; ++i) writer_.add(last_);
    }
    last_ = render::side_by_side(frame.images[0], frame.images[1]);
    number_ = frame.number;
    writer_.add(last_);
  }
  void close() { writer_.close(); }

 private:
  render::VideoWriter writer_;
  bool hold_;
  std::int64_t number_ = 0;
  render::Image last_;
};

/// Why the hashes that a trial kept of its frames need not come back here; empty where they must.
std::string why_not_compared(const devices::TrialSummary& trial, scene::Eyes& eyes,
                             const render::Quality& own) {
  if (eyes.look != own) return "the look is another than the trial's";
  const std::optional<render::Fingerprint> then = scene::drawn_by(trial.events);
  if (!then) return "";  // from before trials told; who compares all the same finds out
  const render::Fingerprint now = render::fingerprint(eyes.renderer);
  return then->picture == now.picture
             ? ""
             : "a test picture comes out otherwise: " + render::difference(*then, now);
}

/// The frames of a trial that were shown and are wanted.
std::int64_t count_shown(const scene::Recorded& recorded, const FrameRanges& wanted,
                         const std::string& asked) {
  std::int64_t count = 0, first = -1, last = -1;
  recorded.file.walk([&](const devices::TrialFile::Item& item) {
    if (const auto* frame = std::get_if<devices::FrameRecord>(&item)) {
      count += wanted.contains(frame->frame);
      if (first < 0) first = frame->frame;
      last = frame->frame;
    }
    return true;
  });
  if (count == 0 && last >= 0) {
    throw UsageError(fmt::format("--frames {}: expected some of those shown, from {} to {}", asked,
                                 first, last));
  }
  return count;
}

/// How many frames there are until a time.
std::int64_t frames_until(Time end, std::int64_t fps) {
  std::int64_t frames = 0;
  while (tick_time(frames, fps) <= end) ++frames;
  return frames;
}

void check_use(const FramesOptions& options) {
  if (!options.folder && !options.video && !options.verify) {
    throw UsageError("nothing to write: expected -o DIR, --video FILE or both, or --verify");
  }
  if (options.verify && (options.look || options.samples)) {
    throw UsageError("--verify compares with what was shown: expected no --look and no --samples");
  }
}

void draw_frames(const FramesOptions& options) {
  check_use(options);
  const FrameRanges wanted = options.frames.empty() ? FrameRanges() : FrameRanges(options.frames);
  scene::Recorded recorded = scene::load_trial(options.trial, microseconds(options.longest_gap));
  const devices::TrialSummary& trial = recorded.file.summary();
  const scene::Rates& rates = recorded.scenario.rates;
  const std::int64_t fps = options.fps > 0 ? options.fps : rates.frame_hz;
  const std::int64_t ticks = scene::tick_count(trial, rates.physics_hz);
  const std::int64_t frames = frames_until(tick_time(ticks, rates.physics_hz), fps);
  const std::int64_t total =
      options.as_shown ? count_shown(recorded, wanted, options.frames) : wanted.count_below(frames);
  if (total == 0 && !options.as_shown) {
    throw UsageError(
        fmt::format("--frames {}: expected frames from 0 to {}", options.frames, frames - 1));
  }
  const Pose X_WD_first = scene::first_head_pose(recorded.file, recorded.scenario.rig);

  scene::Session session = scene::make_session(recorded.scenario);
  scene::Eyes eyes =
      scene::open_eyes(*session.stage, look_of(options, recorded.scenario), options.gl);
  say_instead_of("frames", eyes);
  const bool compares = options.verify || options.as_shown;
  const std::string why_not =
      compares ? why_not_compared(trial, eyes, recorded.scenario.look) : std::string();
  if (!why_not.empty()) {
    if (options.verify) {
      throw std::runtime_error(options.trial +
                               ": its pictures cannot be compared here: " + why_not);
    }
    say("headpin frames: {}: pictures are not compared: {}\n", printable(options.trial), why_not);
  }
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
  if (options.video) {
    const bool hold = options.as_shown && options.frames.empty();
    sinks.push_back(&video.emplace(options, eyes.optics, fps, hold));
  }

  devices::TrialPlayer source(recorded.file, {.states = true, .frames = compares});
  Progress progress("frames", total);
  const auto is_wanted = [&](std::int64_t frame) { return wanted.contains(frame); };
  const auto show = [&](std::int64_t drawn) { progress.show(drawn); };
  std::vector<scene::Observer*> observers;
  std::optional<scene::Verifier> verifier;  // what is shown is what was recorded, or nothing is
  if (source.has_states()) observers.push_back(&verifier.emplace(source, session));
  std::optional<scene::FramesAsShown> shown;
  std::optional<scene::FrameByFrame> drawing;
  if (options.as_shown) {
    observers.push_back(&shown.emplace(
        eyes, source, scene::FramesAsShown::Plan{why_not.empty(), is_wanted, show}, sinks));
  } else {
    if (options.verify) {
      observers.push_back(
          &shown.emplace(eyes, source,
                         scene::FramesAsShown::Plan{true, [](std::int64_t) { return true; },
                                                    [](std::int64_t) {}}));
    }
    if (!sinks.empty()) {
      observers.push_back(&drawing.emplace(
          eyes, scene::FrameByFrame::Plan{fps, frames, is_wanted, X_WD_first, show}, sinks));
    }
  }

  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  if (video) video->close();
  if (folder) folder->close();
  const std::int64_t compared = shown ? shown->compared() : 0;
  const std::int64_t drawn = drawing ? drawing->drawn() : options.as_shown ? shown->drawn() : 0;
  if (options.json) {
    const auto path = [](const std::optional<std::string>& name) {
      return name ? nlohmann::ordered_json(*name) : nlohmann::ordered_json();
    };
    print_json({{"trial", options.trial},
                {"output", path(options.folder)},
                {"video", path(options.video)},
                {"frames", drawn},
                {"verified_frames", compared},
                {"fps", fps},
                {"width", eyes.optics.width},
                {"height", eyes.optics.height},
                {"renderer", eyes.renderer.description()},
                {"drawn_by", scene::to_json(render::fingerprint(eyes.renderer))}});
    return;
  }
  if (shown && why_not.empty()) fmt::print("{} frames equal the recording\n", compared);
  if (!sinks.empty()) {
    fmt::print("{} frames of two eyes, {}x{} each, drawn by {}\n", drawn, eyes.optics.width,
               eyes.optics.height, eyes.renderer.description());
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
  add_gl(*command, options->gl);
  add_look(*command, options->look);
  command
      ->add_option("--samples", options->samples,
                   "samples along a pixel's side, instead of the trial's or the look's")
      ->check(CLI::Range(1, 8));
  command
      ->add_flag("--as-shown", options->as_shown,
                 "the frames that a live session showed, at their ticks, each held against its "
                 "recorded hash; a video keeps their times")
      ->excludes("--fps");
  command->add_flag("--verify", options->verify,
                    "draw what a live session recorded of its frames, and compare the pictures");
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  command->footer(
      "Display and look are the trial's own. To look through another, change it first:\n"
      "  headpin replay TRIAL --set hmd.profile=NAME -o OTHER\nNAME is one of " +
      render::hmd_profile_names() +
      "; a single value is changed likewise, as by --set hmd.eye_distance=0.06.\n\n"
      "Example:\n  headpin frames assets/trials/demo.lcmlog -o frames --video "
      "stereo.mkv");
  command->callback([options] { draw_frames(*options); });
}

}  // namespace headpin::apps
