#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/lcm_link.h"
#include "devices/log.h"
#include "devices/sources.h"
#include "scene/player.h"
#include "scene/quantile.h"

namespace headpin::apps {
namespace {

struct StreamOptions {
  std::string trial, url;
  double speed = 1.0, longest_gap = seconds(devices::kLongestGap);
  bool json = false;
};

/// Walks as the session did that the samples are from.
class Follower {
 public:
  explicit Follower(const scene::Scenario& scenario) : scenario_(scenario) {}

  /// Makes all ticks that begin before the sample is known, then keeps it for the next.
  void take(const devices::Sample& sample) {
    const std::int64_t hz = scenario_.rates.physics_hz;
    for (; tick_time(tick_ + 1, hz) < devices::available(sample); ++tick_) {
      const Time now = tick_time(tick_ + 1, hz) - microseconds(scenario_.rig.delay_s);
      scene::follow(player_, known_, scenario_, now);
      scene::forget(player_, now);
      known_.clear();
    }
    known_.push_back(sample);
  }
  Pose X_WP() const { return player_.walk.X_WP(); }

 private:
  const scene::Scenario& scenario_;
  scene::Player player_;
  std::vector<devices::Sample> known_;
  std::int64_t tick_ = 0;
};

/// Sends the head's and the hand's samples also as poses in the world, for those who only know
/// those.
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

void stream(const StreamOptions& options) {
  const devices::Trial trial =
      devices::read_trial(options.trial, microseconds(options.longest_gap));
  if (trial.samples.empty()) throw std::runtime_error(options.trial + ": no samples to stream");
  const scene::Scenario scenario = scene::scenario_of_trial(trial.header.scenario, options.trial);
  Follower follower(scenario);
  devices::LcmLink link(options.url);
  watch_stop_signals();

  devices::ReplaySource source(trial.samples);
  std::vector<devices::Sample> samples;
  source.poll(source.end(), samples);
  const Time begin = devices::available(samples.front());
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::vector<double> lateness_ms;  // of what was published
  std::size_t sent = 0;
  std::optional<std::chrono::steady_clock::time_point> announced;
  for (; sent < samples.size() && stop_signal() == 0; ++sent) {
    const devices::Sample& sample = samples[sent];
    if (options.speed > 0.0) {
      const double after = seconds(devices::available(sample) - begin) / options.speed;
      const auto due = start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                   std::chrono::duration<double>(after));
      // In pieces, so that a signal does not wait for the end of a long pause.
      constexpr auto kNap = std::chrono::milliseconds(50);
      while (stop_signal() == 0 && std::chrono::steady_clock::now() + kNap < due)
        std::this_thread::sleep_for(kNap);
      if (stop_signal() != 0) break;
      std::this_thread::sleep_until(due);
      lateness_ms.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - due)
              .count());
    }
    // Again and again, for those who begin to listen later.
    if (!announced || std::chrono::steady_clock::now() - *announced >= std::chrono::seconds(1)) {
      link.publish(trial.header);
      announced = std::chrono::steady_clock::now();
    }
    link.publish(sample);
    follower.take(sample);
    publish_pose(link, scenario.rig, follower.X_WP(), sample);
  }
  if (sent == samples.size()) {
    devices::Event end;
    end.time = source.end();
    end.kind = devices::kEndEvent;
    end.value = static_cast<double>(sent + 1);  // with the header
    link.publish(end);
  }

  check_stop(fmt::format("after {} of {} samples", sent, samples.size()));
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) {
    print_json({{"trial", options.trial},
                {"samples", sent},
                {"complete", sent == samples.size()},
                {"duration_s", took},
                {"lateness_median_s", 1e-3 * scene::quantile(lateness_ms, 0.5)},
                {"lateness_p99_s", 1e-3 * scene::quantile(lateness_ms, 0.99)},
                {"lateness_max_s", 1e-3 * scene::quantile(lateness_ms, 1.0)}});
    return;
  }
  std::cout << fmt::format("{} of {} samples in {:.3f} s", sent, samples.size(), took);
  if (!lateness_ms.empty()) {
    std::cout << fmt::format("; late by {:.3f} ms (median), {:.3f} ms (99 %), {:.3f} ms at most",
                             scene::quantile(lateness_ms, 0.5), scene::quantile(lateness_ms, 0.99),
                             scene::quantile(lateness_ms, 1.0));
  }
  std::cout << "\n";
}

}  // namespace

void add_stream(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("stream", "Publish a trial's samples over LCM as recorded");
  const auto options = std::make_shared<StreamOptions>();
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog)")->required();
  command->add_option("--lcm", options->url,
                      "LCM URL; LCM_DEFAULT_URL or its default when not given");
  command->add_option("--speed", options->speed, "times the recorded pace; 0: as fast as it goes")
      ->check(number_from(0, 1000))
      ->capture_default_str();
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  command->footer(
      "TRACKER and MOUSE3D as recorded; HEAD_POSE and HAND_POSE in the world, as bot_core's\n"
      "rigid_transform_t; HEADPIN_TRIAL first and every second, so that what lcm-logger records is "
      "a\ntrial again, whenever it starts.\n\n"
      "Example:\n  headpin stream trial.lcmlog --lcm 'udpm://239.255.76.67:7667?ttl=0'");
  command->callback([options] { stream(*options); });
}

}  // namespace headpin::apps
