#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/byte_stream.h"
#include "devices/fastrak.h"
#include "devices/lcm_link.h"
#include "devices/log.h"
#include "devices/mouse3d.h"
#include "devices/viewer_messages.h"
#include "scene/spectator.h"
#include "scene/viewer.h"

namespace headpin::apps {

namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string lcm, fastrak, scenario, participant, eyes = "raw";
  std::optional<std::string> record;
  std::vector<std::string> hemispheres;
  int baud = 115200, samples = 1;
  std::optional<double> duration_s;
  bool force = false, json = false, use_lcm = false;
  Condition condition;
};

/// Several sources as one, each sample as soon as a replay would have it.
class Sources : public devices::Source {
 public:
  explicit Sources(std::vector<devices::Source*> sources) : sources_(std::move(sources)) {}
  void poll(Time now, std::vector<devices::Sample>& out) override {
    for (devices::Source* source : sources_) source->poll(now, waiting_);
    std::ranges::stable_sort(waiting_, {}, devices::available);
    const auto later = std::ranges::upper_bound(waiting_, now, {}, devices::available);
    std::move(waiting_.begin(), later, std::back_inserter(out));
    waiting_.erase(waiting_.begin(), later);
  }
  bool exhausted() const override {
    return std::ranges::all_of(sources_, [](const auto* source) { return source->exhausted(); });
  }

 private:
  std::vector<devices::Source*> sources_;
  std::vector<devices::Sample> waiting_;
};

/// Frames wait for nobody: drawn in a thread of their own, one at a time; one that comes while
/// another is drawn is late and dropped.
class Painter {
 public:
  struct Job {
    std::int64_t frame = 0, tick = 0;
    Time time{};
    std::optional<Clock::time_point> sample;  ///< when the newest head sample in it arrived
    scene::Glimpse glimpse;
  };
  struct Done {
    devices::FrameRecord record;
    std::optional<double> latency_ms;  ///< from that sample's arrival to the frame published
  };

  Painter(const scene::Scenario& scenario, const Options& options)
      : thread_([this, scenario, options] { work(scenario, options); }) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ready_ || failure_; });
  }
  ~Painter() {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  /// @return  whether the frame will be drawn
  bool offer(Job job) {
    {
      const std::lock_guard lock(mutex_);
      if (failure_) std::rethrow_exception(failure_);
      if (job_ || busy_) return false;
      job_ = std::move(job);
    }
    changed_.notify_all();
    return true;
  }

  /// What was finished since the last call.
  std::vector<Done> take_done() {
    const std::lock_guard lock(mutex_);
    return std::exchange(done_, {});
  }

 private:
  void work(const scene::Scenario& scenario, const Options& options) {
    try {
      scene::Spectator spectator =
          scene::make_spectator(scenario, render::Quality{.samples = options.samples});
      std::unique_ptr<devices::LcmLink> link;
      if (options.use_lcm && options.eyes != "none") {
        link = std::make_unique<devices::LcmLink>(options.lcm);
        if (link->is_replay()) link.reset();
      }
      std::array<render::Image, 2> images;
      scene::see(spectator, {.X_WD = {}, .X_WB_skittles = {}, .X_WB_ball = {}, .X_WH = {}},
                 images);  // so that the first frame need not wait for shaders
      std::unique_lock lock(mutex_);
      ready_ = true;
      changed_.notify_all();
      for (;;) {
        changed_.wait(lock, [this] { return job_ || closing_; });
        if (!job_) return;
        const Job job = std::move(*job_);
        job_.reset();
        busy_ = true;
        lock.unlock();
        Done done = paint(spectator, job, images, link.get(), options.eyes == "png");
        lock.lock();
        busy_ = false;
        done_.push_back(std::move(done));
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      changed_.notify_all();
    }
  }

  static Done paint(scene::Spectator& spectator, const Job& job,
                    std::array<render::Image, 2>& images, devices::LcmLink* link, bool png) {
    const auto views = scene::see(spectator, job.glimpse, images);
    Done done;
    done.record.time = job.time;
    done.record.frame = job.frame;
    done.record.tick = job.tick;
    std::array<std::vector<std::uint8_t>, 2> files;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      done.record.X_WE[eye] = views[eye].X_WE;
      done.record.hash[eye] = render::pixel_hash(images[eye]);
      if (link && png)
        files[eye] = render::encode_png(images[eye], spectator.optics.pixel_aspect());
    }
    if (link) {
      link->publish({.sequence = static_cast<std::int32_t>(job.frame),
                     .time = job.time,
                     .width = images[0].width,
                     .height = images[0].height,
                     .png = png,
                     .left = png ? files[0] : images[0].rgb,
                     .right = png ? files[1] : images[1].rgb});
    }
    if (job.sample) {
      done.latency_ms =
          std::chrono::duration<double, std::milli>(Clock::now() - *job.sample).count();
    }
    return done;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Job> job_;
  std::vector<Done> done_;
  std::exception_ptr failure_;
  bool ready_ = false, busy_ = false, closing_ = false;
  std::thread thread_;  // last, so that all it uses is there before it starts
};

struct Statistics {
  std::int64_t samples = 0, frames = 0, late_frames = 0, overruns = 0;
  std::vector<double> latencies_ms;

  double latency(double share) const {
    if (latencies_ms.empty()) return 0.0;
    std::vector<double> sorted = latencies_ms;
    const auto at = sorted.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  }
};

/// Everything a live session holds.
struct Live {
  scene::Session session;
  std::unique_ptr<devices::LcmLink> link;
  std::unique_ptr<devices::LcmSource> lcm;
  devices::FastrakDriver* fastrak = nullptr;  ///< within `tracker`
  std::unique_ptr<devices::Source> tracker;   ///< the Fastrak, its stylus switch as the trigger
  std::unique_ptr<devices::Recorder> recorder;
  Statistics statistics;
};

nlohmann::json summary(const Live& live) {
  const Statistics& s = live.statistics;
  nlohmann::json j = {
      {"duration_s", seconds(live.session.now())},
      {"ticks", live.session.world.tick},
      {"samples", s.samples},
      {"frames", s.frames},
      {"late_frames", s.late_frames},
      {"overruns", s.overruns},
      {"latency_median_s", 1e-3 * s.latency(0.5)},
      {"latency_p99_s", 1e-3 * s.latency(0.99)},
      {"skittles_down", live.session.score.skittles_down()},
      {"state_hash", fmt::format("{:016x}", engine::state_hash(live.session.world))}};
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
  return fmt::format("; Fastrak {}, {} records missed, {} bytes skipped, {} restarts",
                     fastrak.activity(), f.missed, f.skipped_bytes, f.restarts);
}

void print_line(const Live& live) {
  const Statistics& s = live.statistics;
  fmt::print(stderr,
             "{:7.1f} s  {} samples, {} frames ({} late), sample to frame {:.1f} ms median, {:.1f} "
             "ms p99, {} dropped, {} overruns, {} skittles down{}\n",
             seconds(live.session.now()), s.samples, s.frames, s.late_frames, s.latency(0.5),
             s.latency(0.99), live.lcm ? live.lcm->counts().dropped : 0, s.overruns,
             live.session.score.skittles_down(), live.fastrak ? fastrak_report(*live.fastrak) : "");
}

void publish_scene(Live& live, bool whole) {
  if (!live.link || live.link->is_replay()) return;
  if (whole) live.link->publish(scene::viewer_links(live.session));
  live.link->publish(live.session.now(), scene::viewer_poses(live.session));
}

/// One tick, and all that is said and written about it.
void run_tick(Live& live, Sources& sources, devices::TickState& state) {
  scene::advance(live.session, sources);
  live.statistics.samples += static_cast<std::int64_t>(live.session.samples.size());
  if (!live.recorder) return;
  for (const devices::Sample& sample : live.session.samples) live.recorder->write(sample);
  for (const devices::Event& event : live.session.events) live.recorder->write(event);
  scene::tick_state(live.session, state);
  live.recorder->write(state);
}

Live open(const Options& options) {
  scene::Scenario scenario =
      options.scenario.empty() ? scene::Scenario() : scene::load_scenario(options.scenario);
  apply(options.condition, scenario);
  Live live;
  live.session = scene::make_session(scenario);
  if (options.use_lcm) {
    live.link = std::make_unique<devices::LcmLink>(options.lcm);
    live.lcm = std::make_unique<devices::LcmSource>(*live.link);
  }
  if (!options.fastrak.empty()) {
    devices::FastrakOptions unit;
    unit.baud = options.baud;
    for (const std::string& hemisphere : options.hemispheres) {
      try {
        devices::read_zenith(hemisphere, unit.zenith);
      } catch (const std::invalid_argument& error) {
        throw UsageError(error.what());
      }
    }
    auto driver = std::make_unique<devices::FastrakDriver>(
        devices::open_serial(options.fastrak, options.baud), unit);
    live.fastrak = driver.get();
    live.tracker = std::make_unique<devices::StylusMouse>(std::move(driver));
  }
  if (options.record) {
    devices::TrialHeader header;
    header.participant = options.participant;
    header.scenario = scene::to_toml(scenario);
    header.body_names = scene::body_names(live.session);
    const Time epoch =
        std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
    live.recorder =
        std::make_unique<devices::Recorder>(*options.record, header,
                                            devices::Recorder::Options{.overwrite = options.force,
                                                                       .live = true,
                                                                       .inputs = {options.scenario},
                                                                       .epoch = epoch});
  }
  return live;
}

void run(const Options& options) {
  if (!options.use_lcm && options.fastrak.empty()) {
    throw UsageError("nothing to listen to: expected --lcm URL, --fastrak TTY or both");
  }
  watch_stop_signals();
  Live live = open(options);
  const scene::Scenario& scenario = live.session.scenario;
  std::vector<devices::Source*> list;
  if (live.lcm) list.push_back(live.lcm.get());
  if (live.tracker) list.push_back(live.tracker.get());
  Sources sources(list);
  Painter painter(scenario, options);

  const std::int64_t rate = scenario.rates.physics_hz, fps = scenario.rates.frame_hz;
  const Time end = microseconds(options.duration_s.value_or(0.0));
  const Clock::time_point start = Clock::now();
  devices::TickState state;
  std::int64_t frame = 0;
  std::optional<Time> newest, shown;  // arrival of the head sample at hand, and in the last frame
  Time since{};                       // when the session got the newest
  Time lead{};  // of the frames' clock: brings them close behind the head's samples
  Time next_line{10'000'000};
  publish_scene(live, true);
  const auto over = [&] {  // at the end of a log there is nothing more to come
    return (end != Time{} && live.session.now() >= end) ||
           (live.lcm && live.lcm->exhausted() && !live.tracker);
  };
  while (stop_signal() == 0 && !over()) {
    const Time due = tick_time(live.session.world.tick + 1, rate);
    std::this_thread::sleep_until(start + due);
    const Clock::time_point woken = Clock::now();
    // A tick that begins more than one tick late is an overrun; it is made all the same.
    if (woken - (start + due) > std::chrono::microseconds(1'000'000 / rate))
      ++live.statistics.overruns;
    if (live.lcm) live.lcm->receive(due);
    run_tick(live, sources, state);

    if (live.session.player.head_arrival != newest) {
      newest = live.session.player.head_arrival;
      since = live.session.now();
    }
    if (tick_time(frame, fps) - lead <= live.session.now()) {
      const std::optional<Pose> X_WD = scene::head_pose(live.session);
      if (X_WD) {
        Painter::Job job{frame,
                         live.session.world.tick,
                         live.session.now(),
                         {},
                         scene::glimpse(live.session, *X_WD)};
        if (newest != shown) {
          job.sample = start + *newest;  // latency is that of fresh samples
          const Time tick = tick_time(1, rate);
          if (live.session.now() - since > tick) lead += tick;
        }
        shown = newest;
        if (!painter.offer(std::move(job))) ++live.statistics.late_frames;
      }
      publish_scene(live, frame % (5 * fps) == 0);  // for viewers that come later
      ++frame;
    }
    for (const Painter::Done& done : painter.take_done()) {
      ++live.statistics.frames;
      if (done.latency_ms) live.statistics.latencies_ms.push_back(*done.latency_ms);
      if (live.recorder) live.recorder->write(done.record);
    }
    if (live.session.now() >= next_line) {
      print_line(live);
      next_line += Time{10'000'000};
    }
  }
  if (live.recorder) live.recorder->close();
  print_line(live);
  if (options.json) print_json(summary(live));
}

}  // namespace

void add_live(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("live", "Run a session in real time, recorded as it runs");
  CLI::Option* lcm =
      command->add_option("--lcm", options->lcm,
                          "poses and buttons in, eyes and bodies out; \"\" is LCM's default URL; a "
                          "file:// is only read");
  CLI::Option* fastrak = command->add_option("--fastrak", options->fastrak,
                                             "poses from a Fastrak on this serial line");
  command->add_option("--baud", options->baud, "of that line")->capture_default_str();
  command
      ->add_option("--hemisphere", options->hemispheres,
                   "side of the transmitter that its receivers stay on, a direction in its frame "
                   "(x ahead, y right, z down); 0,0,0: follow each from ahead; may be repeated; "
                   "1,0,0 when not given")
      ->type_name("[STATION:]X,Y,Z")
      ->allow_extra_args(false)
      ->needs(fastrak);
  command->add_option("--scenario", options->scenario,
                      "TOML file; the paper's room when not given");
  add_output(*command, "--record", options->record,
             "write the trial here, safe from the first event");
  command->add_option("--participant", options->participant, "name in the trial");
  add_duration(*command, options->duration_s, "seconds; until interrupted when not given");
  command->add_option("--eyes", options->eyes, "raw, png or none, on HEADPIN_EYES")
      ->check(CLI::IsMember({"raw", "png", "none"}))
      ->capture_default_str();
  command->add_option("--samples", options->samples, "anti-aliasing: samples along a pixel's side")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  add_force(*command, options->force);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Example:\n  headpin live --lcm udpm://239.255.76.67:7667?ttl=0 --record session.lcmlog");
  command->callback([options, lcm] {
    options->use_lcm = lcm->count() > 0;
    run(*options);
  });
}

}  // namespace headpin::apps
