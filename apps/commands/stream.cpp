#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/base/sources.h"
#include "devices/lcm/link.h"
#include "scene/play/delays.h"
#include "scene/play/player.h"
#include "scene/record/file.h"
#include "scene/record/publisher.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

struct StreamOptions {
  std::string trial, url;
  double speed = 1.0, longest_gap = seconds(devices::kLongestGap);
  bool force = false, json = false;
};

/// Repeats the walk of the session from which the samples are.
class Follower {
 public:
  explicit Follower(const scene::Scenario& scenario) : scenario_(scenario) {}

  /// Makes all ticks up to the time at which the samples are available, also the one of that time, which uses
  /// them. Then the walk is that of the samples' rows in trackers.csv.
  /// @param samples  all that are available at one time
  void take(std::span<const devices::Sample> samples) {
    const Time time = devices::available(samples.front());
    while (next_tick() < time) step();
    known_.insert(known_.end(), samples.begin(), samples.end());
    while (next_tick() <= time) step();
  }
  Pose X_WP() const { return player_.walk.X_WP(); }

 private:
  Time next_tick() const { return tick_time(tick_ + 1, scenario_.rates.physics_hz); }
  void step() {
    const Time now = next_tick() - microseconds(scenario_.rig.delay_s);
    scene::follow(player_, known_, scenario_, now);
    scene::forget(player_, now);
    known_.clear();
    ++tick_;
  }

  const scene::Scenario& scenario_;
  scene::Player player_;
  std::vector<devices::Sample> known_;
  std::int64_t tick_ = 0;
};

/// Also sends the samples of head and hand as poses in the world, for programs that use only these.
void publish_pose(devices::LcmLink& link, const scene::Rig& rig, const Pose& X_WP,
                  const devices::Sample& sample) {
  const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
  if (!tracker || !tracker->good()) return;
  const Pose X_WS = X_WP * scene::sensor_in_space(*tracker, rig);
  if (tracker->station == rig.head_station) {
    link.publish_pose("HEAD_POSE", tracker->device_time, X_WS * rig.X_SD);
  }
  if (tracker->station == rig.hand_station) {
    link.publish_pose("HAND_POSE", tracker->device_time, X_WS * rig.X_SH);
  }
}

/// The samples of a trial in the order in which they were available, one by one.
class InOrder {
 public:
  explicit InOrder(const scene::TrialFile& file) : player_(file) {}

  /// The next sample, valid until the next call; null at the end.
  const devices::Sample* next() {
    if (++at_ >= samples_.size()) {
      samples_.clear();
      at_ = 0;
      if (const std::optional<Time> time = player_.next_time()) player_.poll(*time, samples_);
    }
    return at_ < samples_.size() ? &samples_[at_] : nullptr;
  }
  /// All samples that are available at the time of the current one, if it is the first of them; else none.
  std::span<const devices::Sample> new_ones() const {
    return at_ == 0 ? std::span(samples_) : std::span<const devices::Sample>();
  }

 private:
  scene::TrialPlayer player_;
  std::vector<devices::Sample> samples_;  // available at one time
  std::size_t at_ = 0;
};

using Clock = std::chrono::steady_clock;

/// Sleeps in pieces, so that a signal does not wait for the end of a long pause.
/// @return  false if a signal came
bool wait_until(Clock::time_point due) {
  constexpr auto kNap = std::chrono::milliseconds(50);
  while (stop_signal() == 0 && Clock::now() + kNap < due) std::this_thread::sleep_for(kNap);
  if (stop_signal() != 0) return false;
  std::this_thread::sleep_until(due);
  return true;
}

/// The result of streaming a trial.
struct Streamed {
  std::int64_t sent = 0;
  Time end{};         ///< when the last one was available
  double took = 0.0;  ///< [s]
  scene::Delays lateness;
};

/// Publishes the samples, and repeats the header for later listeners.
Streamed publish_samples(const StreamOptions& options, const scene::TrialFile& file,
                         const scene::Scenario& scenario, devices::LcmLink& link) {
  Streamed done;
  Follower follower(scenario);
  InOrder samples(file);
  std::optional<Time> begin;
  const Clock::time_point start = Clock::now();
  std::optional<Clock::time_point> announced;
  while (stop_signal() == 0) {
    const devices::Sample* sample = samples.next();
    if (!sample) break;
    done.end = devices::available(*sample);
    if (!begin) begin = done.end;
    if (options.speed > 0.0) {
      constexpr double kLongest =
          1e9;  // s: no clock of this machine goes further than ten of these
      const double after = std::min(kLongest, seconds(done.end - *begin) / options.speed);
      const auto due =
          start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(after));
      if (!wait_until(due)) break;
      done.lateness.add(std::chrono::duration<double>(Clock::now() - due).count());
    }
    if (!announced || Clock::now() - *announced >= std::chrono::seconds(1)) {
      scene::publish(link, file.summary().header);
      announced = Clock::now();
    }
    link.publish(*sample);
    if (const auto new_ones = samples.new_ones(); !new_ones.empty()) follower.take(new_ones);
    publish_pose(link, scenario.rig, follower.X_WP(), *sample);
    ++done.sent;
  }
  done.took = std::chrono::duration<double>(Clock::now() - start).count();
  return done;
}

void print_streamed(const StreamOptions& options, const Streamed& done, std::int64_t all) {
  const scene::Delays& late = done.lateness;
  if (options.json) {
    print_json({{"trial", options.trial},
                {"samples", done.sent},
                {"complete", done.sent == all},
                {"duration_s", done.took},
                {"lateness_median_s", late.quantile(0.5)},
                {"lateness_p99_s", late.quantile(0.99)},
                {"lateness_max_s", late.quantile(1.0)}});
    return;
  }
  std::cout << fmt::format("{} of {} samples in {:.3f} s", done.sent, all, done.took);
  if (late.count() > 0) {
    std::cout << fmt::format("; late by {:.3f} ms (median), {:.3f} ms (99 %), {:.3f} ms at most",
                             1e3 * late.quantile(0.5), 1e3 * late.quantile(0.99),
                             1e3 * late.quantile(1.0));
  }
  std::cout << "\n";
}

std::unique_ptr<devices::LcmLink> open_link(const StreamOptions& options,
                                            const devices::LcmUrl& url) {
  const auto& log = url.log();
  if (!log) return std::make_unique<devices::LcmLink>(url);
  base::OutputFile file(log->path,
                        {.overwrite = options.force, .live = true, .inputs = {options.trial}});
  return std::make_unique<devices::LcmLink>(url, std::move(file));
}

void stream(const StreamOptions& options) {
  const devices::LcmUrl url = lcm_url("--lcm", options.url, devices::LcmUse::publishing);
  const scene::TrialFile file(options.trial);
  file.require_trial(microseconds(options.longest_gap));
  const std::int64_t all = file.summary().sample_count;
  if (all == 0) throw std::runtime_error(options.trial + ": no samples to stream");
  const scene::Scenario scenario =
      scene::scenario_of_trial(file.summary().header.scenario, options.trial);
  say_what_is_missing("stream", options.trial, file.summary());
  const std::unique_ptr<devices::LcmLink> link = open_link(options, url);
  watch_stop_signals();

  const Streamed done = publish_samples(options, file, scenario, *link);
  if (done.sent == all && file.summary().complete) {
    scene::Event end;
    end.time = done.end;
    end.kind = scene::kEndEvent;
    end.value = static_cast<double>(all + 1);  // with the header
    scene::publish(*link, end);
  }
  check_stop(fmt::format("after {} of {} samples", done.sent, all));
  print_streamed(options, done, all);
}

}  // namespace

void add_stream(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("stream", "Publish a trial's samples over LCM at the recorded times");
  const auto options = std::make_shared<StreamOptions>();
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog); - is standard input")
      ->required();
  command->add_option("--lcm", options->url,
                      "LCM URL; default: LCM_DEFAULT_URL, or else LCM's default URL");
  command
      ->add_option("--speed", options->speed,
                   "playback speed, 1 is the recorded one; 0: as fast as possible")
      ->check(number_from(0, 1000))
      ->capture_default_str();
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  command->footer(
      "Channels: TRACKER and MOUSE3D as recorded; HEAD_POSE and HAND_POSE in the world frame, as "
      "bot_core's\nrigid_transform_t; HEADPIN_TRIAL first and then every second, so that a "
      "recording by lcm-logger is a\ntrial too, whenever it starts. It is complete if TRIAL is.\n\n"
      "Example:\n  headpin stream trial.lcmlog --lcm 'udpm://239.255.76.67:7667?ttl=0'");
  command->callback([options] { stream(*options); });
}

}  // namespace headpin::apps
