#include <chrono>
#include <cstdlib>
#include <functional>
#include <future>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/fastrak.h"
#include "devices/lasting_line.h"
#include "devices/lcm_link.h"
#include "devices/log.h"
#include "devices/messages.h"
#include "devices/mouse3d.h"
#include "devices/sources.h"
#include "devices/stamped_stream.h"
#include "devices/trial_file.h"
#include "devices/viewer_messages.h"
#include "scene/eye_frames.h"
#include "scene/quantile.h"
#include "scene/totals.h"
#include "scene/trial_writer.h"
#include "scene/viewer.h"

namespace headpin::apps {

namespace {

struct Options {
  std::string lcm, fastrak, scenario, participant, eyes = "png";
  std::optional<std::string> record;
  std::vector<std::string> hemispheres;
  int baud = 115200, samples = 1;
  std::optional<double> duration_s;
  bool force = false, json = false, use_lcm = false, no_trial = false;
  Condition condition;
};

/// Time on the session's clock, for those who stamp what arrives. It begins with the pace.
struct SessionClock {
  scene::RealTime::Clock::time_point start = scene::RealTime::Clock::now();
  Time now() const {
    return std::chrono::duration_cast<Time>(scene::RealTime::Clock::now() - start);
  }
};

/// Ticks and readers go first; where that takes a right we lack, drawing gives way all the same.
void go_first() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), -10);
}

/// For the thread that draws, and those that it starts: they take the cores that are left.
void give_way() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
}

/// Mesa's software renderer takes a thread a core unless it is told.
void leave_a_core_to_ticks() {
  const unsigned cores = std::thread::hardware_concurrency();
  const std::string others = std::to_string(cores > 2 ? cores - 1 : 1);
  setenv("LP_NUM_THREADS", others.c_str(), 0);
}

/// Frames over LCM, raw or as PNG.
class LcmEyes : public scene::FrameSink {
 public:
  LcmEyes(const std::string& url, bool png, double pixel_aspect)
      : link_(url), png_(png), pixel_aspect_(pixel_aspect) {}

  void add(const scene::EyeFrame& frame) override {
    std::array<std::vector<std::uint8_t>, 2> files;
    if (png_) {  // one beside the other
      auto left = std::async(std::launch::async, render::encode_png, std::cref(frame.images[0]),
                             pixel_aspect_);
      files[1] = render::encode_png(frame.images[1], pixel_aspect_);
      files[0] = left.get();
    }
    link_.publish({.sequence = static_cast<std::int32_t>(frame.number),
                   .time = frame.time,
                   .width = frame.images[0].width,
                   .height = frame.images[0].height,
                   .png = png_,
                   .left = png_ ? files[0] : frame.images[0].rgb,
                   .right = png_ ? files[1] : frame.images[1].rgb});
  }

 private:
  devices::LcmLink link_;
  bool png_;
  double pixel_aspect_;
};

/// The scene for Drake's viewer, at the frames' rate; whole every five seconds, for viewers that
/// come later.
class Viewer : public scene::Observer {
 public:
  explicit Viewer(devices::LcmLink& link) : link_(link) {}

  void start(const scene::Session& session) override { show(session, true); }
  void tick(const scene::Session& session) override {
    const std::int64_t fps = session.scenario().rates.frame_hz;
    if (tick_time(frame_, fps) > session.now()) return;
    show(session, frame_ % (5 * fps) == 0);
    ++frame_;
  }

 private:
  void show(const scene::Session& session, bool whole) {
    if (whole) link_.publish(scene::viewer_links(session));
    link_.publish(session.now(), scene::viewer_poses(session));
  }

  devices::LcmLink& link_;
  std::int64_t frame_ = 0;
};

/// Everything a live session holds.
struct Live {
  scene::Session session;
  std::unique_ptr<devices::LcmLink> link;
  std::unique_ptr<devices::LcmSource> lcm;
  std::shared_ptr<SessionClock> clock = std::make_shared<SessionClock>();
  devices::StampedStream* line = nullptr;     ///< within the Fastrak
  devices::FastrakDriver* fastrak = nullptr;  ///< within `tracker`
  std::unique_ptr<devices::Source> tracker;   ///< the Fastrak
  std::unique_ptr<scene::TrialWriter> writer;
  std::unique_ptr<devices::LcmLink> session_link;
  std::unique_ptr<scene::TrialWriter> publisher;  ///< over it
  scene::Totals totals;
  std::unique_ptr<scene::RealTime> pace;
  std::unique_ptr<scene::FramesBeside> eyes;
  std::int64_t samples = 0, frames = 0;
  scene::FrameLatency latency;
};

/// Takes note of what was drawn and says every ten seconds how the session goes.
class Reporter : public scene::Observer {
 public:
  explicit Reporter(Live& live) : live_(live) {}
  void tick(const scene::Session& session) override;
  void take_frames();

 private:
  void report_unusable();
  void report_loss();

  Live& live_;
  std::int64_t unusable_ = 0;  ///< messages that were reported
  Time next_complaint_{};
  std::string trouble_;  ///< of the Fastrak's line, as reported
  Time next_line_{10'000'000};
  Time next_look_{};  ///< at the recording
  bool lost_ = false;
};

/// A session that nobody took part in has failed, whatever was recorded of it.
void require_samples(const Live& live, const Options& options) {
  if (live.samples > 0) return;
  std::string from = options.fastrak;
  if (live.link) from += (from.empty() ? "" : " or ") + live.link->url();
  throw std::runtime_error(
      fmt::format("no sample came in {:.1f} s from {}", seconds(live.session.now()), from));
}

/// Says so where the samples of a log are taken into another scenario than the one they are from.
void tell_of_another_scenario(const Live& live) {
  if (!live.link || !live.link->is_replay()) return;
  const std::string path = live.link->url().substr(std::string_view("file://").size());
  const devices::TrialFile file(path.substr(0, path.find('?')));
  const devices::TrialSummary& trial = file.summary();
  if (!trial.has_header) return;
  std::string own;
  try {
    scene::Scenario its = scene::scenario_of_trial(trial.header.scenario, path);
    its.look = live.session.scenario().look;  // how it is drawn is not what it is
    own = scene::to_toml(its);
  } catch (const std::invalid_argument&) {  // not whole, so it is not this session's
  }
  if (own == scene::to_toml(live.session.scenario())) return;
  say("headpin live: {} is from another scenario than this session's; `headpin info {} "
      "--scenario` prints its own, for --scenario FILE\n",
      printable(path), printable(path));
}

nlohmann::json summary(const Live& live, const Options& options) {
  nlohmann::json j = scene::summary(live.session, live.totals.score());
  j["output"] = options.record ? nlohmann::json(*options.record) : nlohmann::json();
  j["duration_s"] = seconds(live.session.now());
  j["samples"] = live.samples;
  j["frames"] = live.frames;
  j["late_frames"] = live.eyes->late();
  j["overruns"] = live.pace->overruns();
  j["latency_median_s"] = scene::quantile(live.latency.each_s, 0.5);
  j["latency_p99_s"] = scene::quantile(live.latency.each_s, 0.99);
  const scene::FrameStages mean = live.latency.mean();
  j["latency_mean_s"] = mean.sum();
  j["latency_stages"] = {{"ticked_s", mean.ticked},
                         {"waited_s", mean.waited},
                         {"drawn_s", mean.drawn},
                         {"published_s", mean.published}};
  j["dropped_samples"] = live.lcm ? live.lcm->counts().dropped : 0;
  if (live.fastrak) {
    const devices::FastrakStatistics& f = live.fastrak->statistics();
    j["fastrak"] = {{"records", f.records},
                    {"skipped_bytes", f.skipped_bytes},
                    {"missed", f.missed},
                    {"restarts", f.restarts},
                    {"activity", live.fastrak->activity()}};
  }
  return j;
}

std::string fastrak_report(const devices::FastrakDriver& fastrak) {
  const devices::FastrakStatistics& f = fastrak.statistics();
  std::string text = fmt::format("; Fastrak {}, {} records missed, {} bytes skipped, {} restarts",
                                 fastrak.activity(), f.missed, f.skipped_bytes, f.restarts);
  for (const std::string& setting : fastrak.unconfirmed()) text += ", " + setting;
  return text;
}

/// How old the newest sample of each publisher is, and how late it came.
std::string lcm_report(const Live& live) {
  std::string text;
  for (const auto& [station, publisher] : live.lcm->publishers()) {
    if (station == devices::LcmSource::kMouse) continue;
    text += fmt::format("; station {}: {:.0f} ms old, came {:.0f} ms late", station,
                        1e3 * seconds(live.session.now() - publisher.device_time),
                        1e3 * seconds(publisher.late()));
  }
  return text;
}

void print_line(const Live& live) {
  say("{:7.1f} s  {} samples, {} frames ({} late), sample to frame {:.1f} ms median, {:.1f} "
      "ms p99, {} dropped, {} overruns, {} skittles down{}{}\n",
      seconds(live.session.now()), live.samples, live.frames, live.eyes->late(),
      1e3 * scene::quantile(live.latency.each_s, 0.5),
      1e3 * scene::quantile(live.latency.each_s, 0.99), live.lcm ? live.lcm->counts().dropped : 0,
      live.pace->overruns(), live.totals.score().skittles_down,
      live.fastrak ? fastrak_report(*live.fastrak) : "", live.lcm ? lcm_report(live) : "");
}

/// Where the time went from a head's sample to its frame.
void print_stages(const scene::FrameLatency& latency) {
  const scene::FrameStages mean = latency.mean();
  say("{:11}mean {:.1f} ms: {:.1f} until its tick was made, {:.1f} until a frame was due, {:.1f} "
      "until it was drawn, {:.1f} until it was out\n",
      "", 1e3 * mean.sum(), 1e3 * mean.ticked, 1e3 * mean.waited, 1e3 * mean.drawn,
      1e3 * mean.published);
}

void Reporter::take_frames() {
  for (const scene::FramesBeside::Done& done : live_.eyes->take_done()) {
    ++live_.frames;
    if (done.stages) live_.latency.add(*done.stages);
    if (live_.writer) live_.writer->write(done.record);
    if (live_.publisher) live_.publisher->write(done.record);
  }
}

/// Says at once, and then every ten seconds, what comes and cannot be used.
void Reporter::report_unusable() {
  if (live_.fastrak && live_.fastrak->trouble() != trouble_) {
    trouble_ = live_.fastrak->trouble();
    say("{:7.1f} s  {}\n", seconds(live_.session.now()),
        trouble_.empty() ? "the Fastrak's line is back" : trouble_);
  }
  if (!live_.lcm || live_.session.now() < next_complaint_) return;
  const devices::LcmSource::Counts& counts = live_.lcm->counts();
  const std::int64_t unusable = counts.undecodable + counts.implausible + counts.foreign;
  if (unusable == unusable_) return;
  say("{:7.1f} s  messages that cannot be used: {} of another type or size than TRACKER's "
      "and MOUSE3D's, {} with numbers that cannot be, {} in another frame than \"T\"\n",
      seconds(live_.session.now()), counts.undecodable, counts.implausible, counts.foreign);
  unusable_ = unusable;
  next_complaint_ = live_.session.now() + Time{10'000'000};
}

/// Says at once when nothing of the recording will be found; its end is the session's.
void Reporter::report_loss() {
  if (!live_.writer || lost_ || live_.session.now() < next_look_) return;
  next_look_ = live_.session.now() + Time{1'000'000};
  try {
    live_.writer->require_kept();
  } catch (const std::runtime_error& error) {
    lost_ = true;
    say("{:7.1f} s  {}; the session goes on unrecorded\n", seconds(live_.session.now()),
        error.what());
  }
}

void Reporter::tick(const scene::Session& session) {
  live_.samples += static_cast<std::int64_t>(session.samples.size());
  take_frames();
  report_unusable();
  report_loss();
  if (session.now() < next_line_) return;
  print_line(live_);
  next_line_ += Time{10'000'000};
}

/// Its line read in a thread of its own, which `live.line` starts.
std::unique_ptr<devices::FastrakDriver> open_fastrak(const Options& options, Live& live) {
  devices::FastrakOptions unit;
  unit.baud = options.baud;
  for (const std::string& hemisphere : options.hemispheres) {
    try {
      devices::read_zenith(hemisphere, unit.zenith);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }
  try {
    auto line =
        std::make_unique<devices::StampedStream>(devices::open_line(options.fastrak, options.baud),
                                                 [clock = live.clock] { return clock->now(); });
    live.line = line.get();
    return std::make_unique<devices::FastrakDriver>(std::move(line), unit);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// What a player at the foul line sees who looks down the lane.
scene::Glimpse at_the_foul_line(std::shared_ptr<const scene::Stage> stage) {
  const Pose X_WD{rotation(0.5 * std::numbers::pi * Vec3::UnitX()), Vec3(0.0, -0.5, 1.65)};
  return scene::glimpse(scene::make_session(std::move(stage)), X_WD);
}

/// What this machine can draw at this look, measured on a frame of that.
void say_rate(scene::Eyes& eyes, const scene::Glimpse& glimpse, bool png, std::int64_t wanted) {
  using Clock = scene::RealTime::Clock;
  std::array<render::Image, 2> images;
  scene::see(eyes, glimpse, images);  // the first one waits for shaders
  const Clock::time_point begin = Clock::now();
  scene::see(eyes, glimpse, images);
  for (const render::Image& image : images) {
    if (png) render::encode_png(image, eyes.optics.pixel_aspect());
  }
  const double rate = 1.0 / std::chrono::duration<double>(Clock::now() - begin).count();
  say("eyes: some {:.0f} frames a second at this look, {} wanted{}\n", rate, wanted,
      rate < static_cast<double>(wanted)
          ? "; those that are not drawn in time are left out, ticks never"
          : "");
}

std::unique_ptr<scene::FramesBeside> open_eyes(const Options& options,
                                               std::shared_ptr<const scene::Stage> stage,
                                               bool publish) {
  return std::make_unique<scene::FramesBeside>(scene::FramesBeside::Makers{
      .eyes =
          [stage, png = publish && options.eyes == "png"] {
            give_way();
            scene::Eyes eyes = scene::open_eyes(*stage);
            say_rate(eyes, at_the_foul_line(stage), png, stage->scenario.rates.frame_hz);
            return eyes;
          },
      .sink = [url = options.lcm, how = options.eyes,
               publish](const scene::Eyes& eyes) -> std::unique_ptr<scene::FrameSink> {
        if (!publish || how == "none") return nullptr;
        return std::make_unique<LcmEyes>(url, how == "png", eyes.optics.pixel_aspect());
      }});
}

Live open(const Options& options) {
  scene::Scenario scenario =
      options.scenario.empty() ? scene::Scenario() : scene::load_scenario(options.scenario);
  scenario.look.samples = options.samples;
  apply(options.condition, scenario);
  Live live;
  live.session = scene::make_session(scenario);
  if (options.use_lcm) {
    live.link = std::make_unique<devices::LcmLink>(options.lcm);
    live.lcm = std::make_unique<devices::LcmSource>(*live.link);
    if (!live.link->is_replay()) live.lcm->use_clock([clock = live.clock] { return clock->now(); });
  }
  if (!options.fastrak.empty()) {
    auto driver = open_fastrak(options, live);
    live.fastrak = driver.get();
    live.tracker = std::move(driver);
  }
  if (live.link && !live.link->is_replay() && !options.no_trial) {
    live.session_link = std::make_unique<devices::LcmLink>(options.lcm, devices::kSessionPrefix);
    devices::TrialHeader header;
    header.participant = options.participant;
    live.publisher = std::make_unique<scene::TrialWriter>(std::make_unique<devices::TrialPublisher>(
        *live.session_link, scene::header_of(header, live.session)));
  }
  return live;
}

/// Begins the recording. It comes last: who waits for its file may send from then on.
void open_recording(const Options& options, Live& live) {
  if (!options.record) return;
  devices::TrialHeader header;
  header.participant = options.participant;
  const Time epoch =
      std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
  live.writer = std::make_unique<scene::TrialWriter>(
      *options.record, header, live.session,
      devices::Recorder::Options{
          .overwrite = options.force, .live = true, .inputs = {options.scenario}, .epoch = epoch});
}

/// All that comes in; a stylus switch is the trigger where no mouse of its own says more.
std::unique_ptr<devices::Source> source_of(const Live& live) {
  std::vector<devices::Source*> list;
  if (live.lcm) list.push_back(live.lcm.get());
  if (live.tracker) list.push_back(live.tracker.get());
  auto merged = std::make_unique<devices::MergedSource>(list);
  if (!live.tracker) return merged;
  return std::make_unique<devices::StylusMouse>(std::move(merged));
}

/// Runs the session until it is told to stop, and gives the recording its end whatever comes.
void run_recorded(Live& live, devices::Source& source, Reporter& reporter,
                  std::span<scene::Observer* const> observers, Time end) {
  try {
    scene::run(live.session, source, *live.pace, observers, [&](const scene::Session& s) {
      return stop_signal() != 0 || (end != Time{} && s.now() >= end) || source.exhausted();
    });
  } catch (...) {
    for (scene::TrialWriter* writer : {live.writer.get(), live.publisher.get()}) {
      try {
        if (writer) writer->close(live.session);
      } catch (const std::exception&) {  // it is what failed, or is lost beside it
      }
    }
    throw;
  }
  heed_stop();
  reporter.take_frames();
  if (live.writer) live.writer->close(live.session);
  if (live.publisher) live.publisher->close(live.session);
}

void run(const Options& options) {
  if (!options.use_lcm && options.fastrak.empty()) {
    throw UsageError("nothing to listen to: expected --lcm URL, --fastrak TTY or both");
  }
  watch_stop_signals();
  leave_a_core_to_ticks();
  Live live = open(options);
  tell_of_another_scenario(live);
  const std::unique_ptr<devices::Source> merged = source_of(live);
  devices::Source& source = *merged;

  const bool publish = live.link && !live.link->is_replay();
  live.eyes = open_eyes(options, live.session.stage, publish);
  const Time end = microseconds(options.duration_s.value_or(0.0));
  live.pace =
      std::make_unique<scene::RealTime>(tick_time(1, live.session.scenario().rates.physics_hz));
  live.eyes->begin(live.pace->start());
  live.clock->start = live.pace->start();
  go_first();
  if (live.line) live.line->start();
  if (live.lcm) live.lcm->drain();  // what waited while the eyes were opened
  open_recording(options, live);

  std::vector<scene::Observer*> observers = {&live.totals};
  if (live.writer) observers.push_back(live.writer.get());
  if (live.publisher) observers.push_back(live.publisher.get());
  observers.push_back(live.eyes.get());
  std::optional<Viewer> viewer;
  if (publish) observers.push_back(&viewer.emplace(*live.link));
  Reporter reporter(live);
  observers.push_back(&reporter);
  run_recorded(live, source, reporter, observers, end);
  print_line(live);
  if (!live.latency.each_s.empty()) print_stages(live.latency);
  require_samples(live, options);
  if (options.json) print_json(summary(live, options));
}

}  // namespace

void add_live(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("live", "Run a session in real time, recorded as it runs");
  CLI::Option* lcm =
      command->add_option("--lcm", options->lcm,
                          "poses and buttons in, eyes and bodies out; \"\" is LCM's default URL; a "
                          "file:// is only read");
  CLI::Option* fastrak = command->add_option(
      "--fastrak", options->fastrak, "poses from a Fastrak on this serial line, or tcp:HOST:PORT");
  command->add_option("--baud", options->baud, "of that line")
      ->check(CLI::IsMember({2400, 4800, 9600, 19200, 38400, 57600, 115200}))
      ->capture_default_str();
  command
      ->add_option("--hemisphere", options->hemispheres,
                   "side of the transmitter that its receivers stay on, a direction in its frame "
                   "(x ahead, y right, z down); 0,0,0: follow each from ahead; may be repeated; "
                   "1,0,0 when not given")
      ->type_name("[STATION:]X,Y,Z")
      ->allow_extra_args(false)
      ->needs(fastrak);
  command->add_option("--scenario", options->scenario,
                      "its name, or a TOML file; the paper's room when not given");
  add_output(*command, "--record", options->record,
             "write the trial here, safe from the first event");
  command->add_option("--participant", options->participant, "name in the trial");
  add_duration(*command, options->duration_s, "seconds; until interrupted when not given");
  command
      ->add_option("--eyes", options->eyes,
                   "as raw or png on HEADPIN_EYES; none: drawn for the recording alone")
      ->check(CLI::IsMember({"raw", "png", "none"}))
      ->capture_default_str();
  command
      ->add_flag("--no-trial", options->no_trial,
                 "do not publish the session's own trial, which is on SESSION_* else")
      ->needs(lcm);
  command
      ->add_option("--samples", options->samples,
                   "anti-aliasing: samples along a pixel's side; kept in the trial as look.samples")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  add_force(*command, options->force);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Example:\n  headpin live --lcm 'udpm://239.255.76.67:7667?ttl=0' --record session.lcmlog");
  command->callback([options, lcm] {
    options->use_lcm = lcm->count() > 0;
    run(*options);
  });
}

}  // namespace headpin::apps
