#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/damage.h"
#include "apps/frame_outputs.h"
#include "apps/frame_parts.h"
#include "apps/frame_ranges.h"
#include "apps/given_options.h"
#include "apps/live_eyes.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "render/data/hmd.h"
#include "render/display.h"
#include "scene/record/events.h"
#include "scene/watch/drawn_by.h"
#include "scene/watch/eye_frames.h"
#include "scene/watch/recorded.h"
#include "scene/watch/verifier.h"

namespace headpin::apps {

namespace {

/// The rendering quality: that of the trial, unless the options give another.
render::Quality look_of(const FramesOptions& options, scene::Scenario scenario) {
  Condition other;
  other.look = options.look;
  if (options.samples) other.set.push_back(fmt::format("look.samples={}", *options.samples));
  apply_condition(other, scenario);
  return scenario.look;
}

/// The reason why the recorded hashes of frames may differ from the new ones; empty if they must be
/// equal.
std::string why_not_compared(const scene::TrialSummary& trial, scene::Eyes& eyes,
                             const render::Quality& own, bool from_the_head) {
  if (!from_the_head) return "they are not what the eyes saw";
  if (std::ranges::find(trial.events, scene::kind::played_with, &scene::Event::kind) !=
      trial.events.end()) {
    return "a browser drew them, and its log has no hashes of pictures";
  }
  if (eyes.renderer.quality() != own) return "the look is another than the trial's";
  const std::optional<render::Fingerprint> then = scene::drawn_by(trial.events);
  if (!then) return "";  // an older trial does not say it; the comparison will show
  const render::Fingerprint now = render::fingerprint(eyes.renderer);
  return then->picture == now.picture
             ? ""
             : "a test picture comes out otherwise: " + render::difference(*then, now);
}

/// The wanted frames among those that were shown in the trial.
std::vector<std::int64_t> frames_shown(const scene::Recorded& recorded, const FrameRanges& wanted,
                                       const std::string& asked) {
  std::vector<std::int64_t> frames;
  std::int64_t first = -1, last = -1;
  recorded.file.walk([&](const scene::TrialFile::Item& item) {
    if (const auto* frame = std::get_if<scene::FrameRecord>(&item)) {
      if (wanted.contains(frame->frame, frame->time)) frames.push_back(frame->frame);
      if (first < 0) first = frame->frame;
      last = frame->frame;
    }
    return true;
  });
  if (frames.empty() && last >= 0) {
    throw UsageError(
        fmt::format("--frames {}: expected recorded frames, from {} to {}, or their times", asked,
                    first, last));
  }
  return frames;
}

/// The wanted frames until a time.
std::vector<std::int64_t> frames_until(Time end, std::int64_t fps, const FrameRanges& wanted,
                                       const std::string& asked) {
  std::vector<std::int64_t> frames;
  std::int64_t frame = 0;
  for (; tick_time(frame, fps) <= end; ++frame) {
    if (wanted.contains(frame, tick_time(frame, fps))) frames.push_back(frame);
  }
  if (frames.empty()) {
    throw UsageError(fmt::format("--frames {}: expected frames from 0 to {}, or times to {:.3f}s",
                                 asked, frame - 1, seconds(end)));
  }
  return frames;
}

/// Tells of named frames that do not exist; the others are drawn.
void say_not_there(const std::string& asked, const FrameRanges& wanted,
                   std::span<const std::int64_t> frames) {
  if (const std::optional<std::int64_t> missing = wanted.first_not_in(frames)) {
    say("headpin frames: --frames {}: frame {} does not exist; of the wanted ones {} do\n", asked,
        *missing, frames.size());
  }
}

void check_use(const FramesOptions& options) {
  if (!options.writes() && !options.verify) {
    throw UsageError(
        "nothing to write: expected -o DIR, --video FILE, --y4m FILE, --sound FILE, --cameras FILE, "
        "--colmap DIR or --verify");
  }
  if (options.verify && (options.look || options.samples || options.view != "eyes")) {
    throw UsageError(
        "--verify compares with what was shown: expected no --look, no --samples and no --view");
  }
  if (!options.folder && (options.files.labels() || options.layout != "separate")) {
    throw UsageError("--depth, --ids, --flow and --layout need -o DIR");
  }
  if (options.colmap && options.layout != "separate") {
    throw UsageError("--colmap names a picture of each eye: expected no --layout side-by-side");
  }
  if (options.in_parts() && (!options.folder || options.video || options.y4m || options.verify)) {
    throw UsageError("--jobs and --resume need -o DIR, without --video, --y4m or --verify");
  }
}

void check_has_sound(const FramesOptions& options, const scene::Scenario& scenario) {
  if (!options.sound || scenario.sound.on) return;
  throw std::runtime_error(fmt::format(
      "{}: its scenario has no sound: for --sound expected sound.on = true, found false",
      printable(options.trial)));
}

/// A lens bends the picture, which a camera's matrix cannot describe.
void check_pinhole(const FramesOptions& options, const render::Optics& optics) {
  if (!render::has_lens(optics) || !(options.writes_cameras() || options.files.flow)) return;
  throw std::runtime_error(
      fmt::format("{}: its display has a lens: for --cameras, --colmap and --flow expected "
                  "hmd.lens_k1 = 0 and hmd.lens_k2 = 0, found {} and {}",
                  printable(options.trial), optics.lens_k1, optics.lens_k2));
}

scene::FrameExtras extras_of(const FramesOptions& options, const scene::Scenario& scenario) {
  scene::FrameExtras extras{.pictures = options.writes_pictures(),
                            .labels = options.folder && options.files.labels()};
  if (options.view == "third-person") extras.X_WC = scene::third_person_camera(scenario);
  if (options.view == "top") extras.X_WC = scene::top_camera(scenario);
  return extras;
}

/// The frames to draw, and whether they are compared.
struct Task {
  std::vector<std::int64_t> frames;
  std::int64_t fps, ticks;
  bool compares;        ///< the frames drawn as shown, or all shown with --verify
  std::string why_not;  ///< empty if hashes must be equal
  Pose X_WD_first;      ///< of the head at the start
};

/// The result.
struct Done {
  std::int64_t drawn = 0, compared = 0, there_already = 0;
};

std::string check_comparable(const FramesOptions& options, const scene::Recorded& recorded,
                             scene::Eyes& eyes) {
  const std::string why_not = why_not_compared(recorded.file.summary(), eyes,
                                               recorded.scenario.look, options.view == "eyes");
  if (why_not.empty()) return why_not;
  if (options.verify) {
    throw std::runtime_error(options.trial + ": its pictures cannot be compared here: " + why_not);
  }
  say("headpin frames: {}: pictures are not compared: {}\n", printable(options.trial), why_not);
  return why_not;
}

/// The parts of the sound that belong to the frames.
std::vector<SoundPart> sound_parts(const FramesOptions& options, const Task& task,
                                   const scene::Recorded& recorded) {
  if (!options.as_shown) return sound_of_frames(task.frames, task.fps);
  const std::int64_t first = scene::first_tick_with_head(recorded.file, recorded.scenario);
  std::vector<Time> times;
  recorded.file.walk([&](const scene::TrialFile::Item& item) {
    const auto* frame = std::get_if<scene::FrameRecord>(&item);  // drawn if the head is known
    if (frame && frame->tick >= first && std::ranges::binary_search(task.frames, frame->frame)) {
      times.push_back(tick_time(frame->tick, recorded.scenario.rates.physics_hz));
    }
    return true;
  });
  return sound_as_shown(times, timing_of(options, task.fps));
}

/// Opens the outputs before anything is drawn.
FrameOutputs outputs_of(const FramesOptions& options, const Task& task,
                        const scene::Recorded& recorded, const scene::Session& session,
                        const scene::Eyes& eyes) {
  const scene::FrameExtras extras = extras_of(options, recorded.scenario);
  std::optional<Heard> heard;
  if (options.sound || (options.video && recorded.scenario.sound.on)) {
    heard.emplace(Heard{recorded, session, task.ticks, sound_parts(options, task, recorded)});
  }
  return {options,  *session.stage, eyes.optics, scene::views_of(eyes, {.X_WC = extras.X_WC}),
          task.fps, heard};
}

/// Runs the session and gives the frames to the outputs.
Done watch(const FramesOptions& options, const Task& task, const scene::Recorded& recorded,
           scene::Session session, scene::Eyes& eyes, const FrameOutputs& outputs) {
  scene::FrameExtras extras = extras_of(options, recorded.scenario);
  scene::TrialPlayer source(recorded.file,
                            {.states = true, .frames = options.as_shown || options.verify});
  Progress progress("frames", static_cast<std::int64_t>(task.frames.size()));
  const auto is_wanted = [&](std::int64_t frame) {
    return std::ranges::binary_search(task.frames, frame);
  };
  const auto show = [&](std::int64_t drawn) { progress.show(drawn); };
  std::vector<scene::Observer*> observers;
  std::optional<scene::Verifier> verifier;  // checks that the simulation is the recorded one
  if (source.has_states()) observers.push_back(&verifier.emplace(options.trial, source, session));
  std::optional<scene::FramesAsShown> shown;
  std::optional<scene::FrameByFrame> drawing;
  if (options.as_shown) {
    const bool compare = task.compares && task.why_not.empty();
    extras.pictures = extras.pictures || compare;
    observers.push_back(&shown.emplace(eyes, source,
                                       scene::FramesAsShown::Plan{compare, is_wanted, show, extras},
                                       outputs.sinks()));
  } else {
    if (options.verify) {
      const auto all = [](std::int64_t) { return true; };
      observers.push_back(
          &shown.emplace(eyes, source, scene::FramesAsShown::Plan{true, all, [](std::int64_t) {}}));
    }
    if (options.writes()) {
      observers.push_back(
          &drawing.emplace(eyes,
                           scene::FrameByFrame::Plan{task.fps, task.frames.back() + 1, is_wanted,
                                                     task.X_WD_first, show, extras},
                           outputs.sinks()));
    }
  }
  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= task.ticks;
  });
  return {drawing            ? drawing->drawn()
          : options.as_shown ? shown->drawn()
                             : 0,
          shown ? shown->compared() : 0};
}

Done draw_here(const FramesOptions& options, const Task& task, const scene::Recorded& recorded,
               scene::Session session, scene::Eyes& eyes) {
  FrameOutputs outputs = outputs_of(options, task, recorded, session, eyes);
  const Done done = watch(options, task, recorded, std::move(session), eyes, outputs);
  outputs.finish();
  outputs.commit();
  return done;
}

Done draw_apart(const FramesOptions& options, const Task& task, const scene::Recorded& recorded,
                scene::Session session, scene::Eyes& eyes) {
  const auto total = static_cast<std::int64_t>(task.frames.size());
  base::OutputFolder folder = open_picture_folder(options);
  // The cameras need no pictures: this process writes them all.
  FramesOptions cameras_alone = options;
  cameras_alone.folder.reset();
  Task without_pictures = task;
  without_pictures.compares = false;
  FrameOutputs cameras = outputs_of(cameras_alone, task, recorded, session, eyes);
  if (options.writes_cameras()) {
    watch(cameras_alone, without_pictures, recorded, std::move(session), eyes, cameras);
  }
  cameras.finish();
  Progress progress("frames", total);
  const render::Fingerprint who = render::fingerprint(eyes.renderer);
  const DrawnParts drawn =
      draw_in_parts({.folder = *options.folder,
                     .trial = options.trial,
                     .arguments = options.of_pictures,
                     .frames = task.frames,
                     .flow = options.files.flow,
                     .jobs = options.jobs,
                     .resume = options.resume,
                     .made_by = fmt::format("{:016x} {}", who.picture, who.renderer),
                     .progress = [&](std::int64_t done) { progress.show(done); }},
                    folder);
  cameras.commit();
  return {drawn.frames, options.as_shown && task.why_not.empty() ? drawn.frames : 0,
          drawn.there_already};
}

void report(const FramesOptions& options, const Task& task, const Done& done, bool complete,
            scene::Eyes& eyes) {
  if (options.json) {
    const auto path = [](const std::optional<std::string>& name) {
      return name ? nlohmann::ordered_json(*name) : nlohmann::ordered_json();
    };
    print_json({{"trial", options.trial},
                {"output", path(options.folder)},
                {"video", path(options.video)},
                {"y4m", path(options.y4m)},
                {"sound", path(options.sound)},
                {"cameras", path(options.cameras)},
                {"colmap", path(options.colmap)},
                {"complete", complete},
                {"frames", done.drawn},
                {"frames_there_already", done.there_already},
                {"verified_frames", done.compared},
                {"fps", task.fps},
                {"width", eyes.optics.width},
                {"height", eyes.optics.height},
                {"renderer", eyes.renderer.description()},
                {"drawn_by",
                 scene::stored_json<nlohmann::ordered_json>(render::fingerprint(eyes.renderer))}});
    return;
  }
  if (task.compares && task.why_not.empty()) {
    fmt::print("{} frames equal the recording\n", done.compared);
  }
  if (!options.writes()) return;
  fmt::print("{} frames of two eyes, {}x{} each, {}\n", done.drawn, eyes.optics.width,
             eyes.optics.height,
             options.writes_pictures()  ? "drawn by " + eyes.renderer.description()
             : options.writes_cameras() ? "their cameras only"
                                        : "their sound only");
  if (done.there_already > 0) fmt::print("{} of them were there already\n", done.there_already);
}

void draw_frames(const FramesOptions& options) {
  check_use(options);
  const FrameRanges wanted = options.frames.empty() ? FrameRanges() : FrameRanges(options.frames);
  const scene::Recorded recorded =
      scene::load_trial(options.trial, microseconds(options.longest_gap));
  const scene::TrialSummary& trial = recorded.file.summary();
  const scene::Rates& rates = recorded.scenario.rates;
  Task task{.frames = {},
            .fps = options.fps > 0 ? options.fps : rates.frame_hz,
            .ticks = recorded.ticks(),
            .compares = options.verify || options.as_shown,
            .why_not = "",
            .X_WD_first = {}};
  const Time end = tick_time(task.ticks, rates.physics_hz);
  task.frames = options.as_shown ? frames_shown(recorded, wanted, options.frames)
                                 : frames_until(end, task.fps, wanted, options.frames);
  if (task.compares && trial.frame_count == 0) {
    throw std::runtime_error(options.trial +
                             ": has no recorded frames; expected a recording of `headpin live`");
  }
  task.X_WD_first = scene::first_head_pose(recorded.file, recorded.scenario.rig);

  scene::Session session = scene::make_session(recorded.scenario);
  scene::Eyes eyes =
      scene::open_eyes(*session.stage, look_of(options, recorded.scenario), options.gl);
  check_pinhole(options, eyes.optics);
  check_has_sound(options, recorded.scenario);
  say_instead_of("frames", eyes);
  say_not_drawn("frames", recorded.scenario);
  if (task.compares) task.why_not = check_comparable(options, recorded, eyes);
  say_what_is_missing("frames", options.trial, trial);
  say_not_there(options.frames, wanted, task.frames);
  watch_stop_signals();
  const Done done = options.in_parts()
                        ? draw_apart(options, task, recorded, std::move(session), eyes)
                        : draw_here(options, task, recorded, std::move(session), eyes);
  say_left_out(options, task.frames.size(), done.drawn);
  report(options, task, done, trial.complete, eyes);
}

/// Options of the whole task and not of its pictures: processes that draw a part do not get them.
using OfTheTask = std::set<const CLI::Option*>;

/// Adds the options for the output.
void add_output_options(CLI::App& command, FramesOptions& options, OfTheTask& task) {
  task.insert(add_output(
      command, "-o,--output", options.folder,
      "folder for left_NNNNNN.png, right_NNNNNN.png and frames.csv: a new or empty folder; "
      "with --force also one that headpin wrote",
      {}));
  task.insert(
      add_output(command, "--video", options.video,
                 "video to write, both eyes side by side, lossless (.mkv), with sound if the "
                 "scenario has sound.on = true; a copy with the ending .mp4 plays in any player",
                 {".mkv"})
          ->check(ending_in(".mkv")));
  task.insert(
      command.add_flag("--no-mp4", options.no_copy, "with --video: do not write the .mp4 copy"));
  task.insert(add_output(
      command, "--y4m", options.y4m,
      "raw video to write (YUV4MPEG2, 4:4:4, BT.601), both eyes side by side, for other programs; "
      "- is standard output. Colours are rounded, so do not use it to compare pictures",
      {".y4m"}));
  task.insert(add_output(command, "--sound", options.sound,
                         "sound of the frames to write, as a video has it: WAV, 48 kHz, 16 bits, "
                         "two ears",
                         {".wav"})
                  ->check(ending_in(".wav")));
  command
      .add_option("--layout", options.layout,
                  "layout of the PNG files: one file per eye, or both eyes in one file")
      ->check(one_of({"separate", "side-by-side"}))
      ->capture_default_str();
  command.add_flag(
      "--depth", options.files.depth,
      "write the depth of each pixel along the viewing axis: NAME_depth.png has millimetres in 16 "
      "bits, 0 where nothing is seen and 65535 also for all beyond 65.535 m; NAME_depth.raw has "
      "metres as 32-bit floats, of any depth");
  command.add_flag("--ids", options.files.ids,
                   "write which object each pixel shows: NAME_ids.png has 16-bit numbers, ids.csv "
                   "has the object of each number");
  command.add_flag("--flow", options.files.flow,
                   "write the displacement of each pixel until the next frame that is drawn: "
                   "NAME.flo has pixels in Middlebury's format; the last frame has none");
  // Internal, not shown in the help: the frame is only for the flow to it.
  task.insert(command.add_option("--flow-to", options.files.flow_to)->group(""));
  task.insert(
      add_output(command, "--cameras", options.cameras,
                 "cameras to write (.json): the matrix of each eye, and its pose in each frame, in "
                 "OpenCV's convention",
                 {".json"})
          ->check(ending_in(".json")));
  task.insert(
      add_output(command, "--colmap", options.colmap,
                 "folder for the same as COLMAP's cameras.txt and images.txt: a new or empty "
                 "folder; with --force also one that headpin wrote",
                 {}));
}

/// Adds the options for the pictures.
void add_picture_options(CLI::App& command, FramesOptions& options, OfTheTask& task) {
  command
      .add_option("--view", options.view,
                  "viewpoint: eyes; third-person, from behind the participant; or top, from above")
      ->check(one_of({"eyes", "third-person", "top"}))
      ->capture_default_str();
  task.insert(command.add_option("--frames", options.frames,
                                 "draw only these frames, such as 10-20,35 or 3.9s-4.1s"));
  command.add_option("--fps", options.fps, "frame rate; default: that of the scenario")
      ->check(whole_number_from(1, 1000));
  task.insert(
      command
          .add_option(
              "--jobs", options.jobs,
              "number of processes that draw the folder in parallel; the files do not depend on it")
          ->check(whole_number_from(1, 256))
          ->capture_default_str());
  task.insert(command.add_flag("--resume", options.resume,
                               "continue an interrupted run: finished parts of the folder are kept "
                               "in DIR.parts and are not drawn again"));
  add_gl(command, options.gl);
  add_look(command, options.look);
  command
      .add_option("--samples", options.samples,
                  "anti-aliasing: N^2 + 1 samples per pixel, or one with N = 1; default: as the "
                  "trial or --look says")
      ->check(whole_number_from(1, 8));
  command
      .add_flag("--as-shown", options.as_shown,
                "draw the frames that a live session showed, and compare each with its recorded "
                "hash; in a video each frame lasts until the next one, and the video begins with "
                "the trial or, with --frames, with the first of the chosen frames")
      ->excludes("--fps");
  task.insert(command.add_flag("--verify", options.verify,
                               "draw the frames that a live session recorded, and compare the "
                               "pictures with their recorded hashes"));
}

}  // namespace

void add_frames(CLI::App& app) {
  auto options = std::make_shared<FramesOptions>();
  CLI::App* command =
      app.add_subcommand("frames", "Draw what the participant saw: one picture per eye and frame");
  OfTheTask task;
  task.insert(command
                  ->add_option("TRIAL", options->trial,
                               "a trial (.lcmlog), replayed or not; - is standard input")
                  ->required());
  add_output_options(*command, *options, task);
  add_picture_options(*command, *options, task);
  task.insert(add_force(*command, options->force));
  add_longest_gap(*command, options->longest_gap);
  task.insert(add_json(*command, options->json));
  command->footer(
      "Display and rendering quality are those of the trial. To use another display, change it "
      "first:\n"
      "  headpin replay TRIAL --set hmd.profile=NAME -o OTHER\nNAME is one of " +
      render::hmd_profile_names() +
      ". A single value is changed in the same way, for example with --set "
      "hmd.eye_distance=0.06.\n\n"
      "Example:\n  headpin frames assets/trials/demo.lcmlog -o frames --video "
      "stereo.mkv");
  command->callback([options, command, task] {
    options->of_pictures = given_options(*command, task);
    draw_frames(*options);
  });
}

}  // namespace headpin::apps
