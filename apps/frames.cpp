#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/frame_ranges.h"
#include "apps/progress.h"
#include "apps/simulate.h"
#include "devices/hmd.h"
#include "render/video.h"
#include "scene/spectator.h"

namespace headpin::apps {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::string trial, folder, video, frames;
  std::int64_t fps = 0;
  bool force = false, json = false;
};

/// One rendered frame of both eyes.
struct Frame {
  std::int64_t number = 0, tick = 0;
  Time time{};
  std::array<render::View, 2> views;
  std::array<render::Image, 2> images;
};

constexpr std::array<const char*, 2> kEyes = {"left", "right"};

/// PNG files and their index in a folder that gets its name when all are there.
class FolderSink {
 public:
  FolderSink(const fs::path& folder, double pixel_aspect, bool force)
      : folder_(folder), part_(folder.string() + ".part"), pixel_aspect_(pixel_aspect) {
    if (fs::exists(folder_) && !force) {
      throw std::runtime_error(folder_.string() + ": exists already; --force replaces it");
    }
    fs::remove_all(part_);
    fs::create_directories(part_);
    index_.open(part_ / "frames.csv");
    index_ << "frame,time_s,tick";
    for (const char* eye : kEyes) {
      for (const char* name : {"x", "y", "z", "qw", "qx", "qy", "qz"})
        index_ << ',' << eye << '_' << name;
      index_ << ',' << eye << "_hash";
    }
    index_ << '\n';
  }

  ~FolderSink() {
    writing_ = {};  // wait for what is still being written
    std::error_code ignored;
    fs::remove_all(part_, ignored);
  }

  /// Takes the frame over; the files are written while the next one is drawn.
  void add(const Frame& frame) {
    index_ << fmt::format("{},{:.6f},{}", frame.number, seconds(frame.time), frame.tick);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Pose& X_WE = frame.views[eye].X_WE;
      index_ << fmt::format(",{},{},{},{},{},{},{},{:016x}", X_WE.p.x(), X_WE.p.y(), X_WE.p.z(),
                            X_WE.q.w(), X_WE.q.x(), X_WE.q.y(), X_WE.q.z(),
                            render::pixel_hash(frame.images[eye]));
    }
    index_ << '\n';
    wait();
    writing_ = std::async(std::launch::async, [this, number = frame.number, images = frame.images] {
      for (std::size_t eye = 0; eye < 2; ++eye) {
        render::write_png(part_ / fmt::format("{}_{:06}.png", kEyes[eye], number), images[eye],
                          pixel_aspect_);
      }
    });
  }

  void close() {
    wait();
    index_.close();
    if (!index_) throw std::runtime_error((part_ / "frames.csv").string() + ": cannot be written");
    fs::remove_all(folder_);
    fs::rename(part_, folder_);
  }

 private:
  void wait() {
    if (writing_.valid()) writing_.get();
  }

  fs::path folder_, part_;
  double pixel_aspect_;
  std::ofstream index_;
  std::future<void> writing_;
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
  if (options.folder.empty() && options.video.empty()) {
    throw UsageError("nothing to write: expected -o DIR, --video FILE or both");
  }
  const FrameRanges wanted = options.frames.empty() ? FrameRanges() : FrameRanges(options.frames);
  const LoadedTrial loaded = load_trial(options.trial);
  scene::Session session = scene::make_session(loaded.scenario);
  const std::int64_t fps = options.fps > 0 ? options.fps : loaded.scenario.rates.frame_hz;
  const Pose first_head = first_head_pose(loaded);

  scene::Spectator spectator = scene::make_spectator(loaded.scenario);
  const double pixel_aspect = spectator.optics.pixel_aspect();
  std::optional<FolderSink> folder;
  if (!options.folder.empty()) folder.emplace(options.folder, pixel_aspect, options.force);
  std::optional<render::VideoWriter> video;
  if (!options.video.empty()) {
    video.emplace(options.video, 2 * spectator.optics.width, spectator.optics.height, fps,
                  pixel_aspect, options.force);
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
    fmt::print("{}\n", nlohmann::json{{"frames", written},
                                      {"fps", fps},
                                      {"width", spectator.optics.width},
                                      {"height", spectator.optics.height},
                                      {"renderer", spectator.renderer.description()}}
                           .dump());
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
  command->add_option("-o,--output", options->folder,
                      "folder for left_NNNNNN.png, right_NNNNNN.png and frames.csv");
  command->add_option(
      "--video", options->video,
      "both eyes side by side, lossless (.mkv); a copy beside it (.mp4) plays anywhere");
  command->add_option("--frames", options->frames, "only these, such as 10-20,35");
  command->add_option("--fps", options->fps, "frames a second; the scenario's when not given")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--force", options->force, "replace what is there");
  command->add_flag("--json", options->json, "print one JSON object");
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
