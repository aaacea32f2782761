#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/catalogue_csv.h"
#include "devices/event_log.h"
#include "devices/log.h"
#include "scene/events.h"
#include "scene/throw.h"

namespace headpin::apps {
namespace {

struct Options {
  std::optional<std::string> output;
  std::string file, scenario, participant, condition;
  std::string units = "cm", heading = "release";
  bool force = false, json = false;
};

double metres(const std::string& unit) {
  return unit == "mm" ? 0.001 : unit == "cm" ? 0.01 : 1.0;
}

scene::Heading heading(const std::string& name) {
  if (name == "gaze") return scene::Heading::gaze;
  return name == "keep" ? scene::Heading::keep : scene::Heading::release;
}

devices::MotionRecording read_recording(const std::string& path, double unit_m) {
  const devices::MappedFile file(path);
  const auto* text = reinterpret_cast<const char*>(file.bytes().data());
  return devices::parse_catalogue_csv({text, file.bytes().size()}, path, unit_m);
}

/// What was found in the recording, to be told from what was recorded.
std::vector<devices::Event> found_events(const devices::MotionRecording& recording,
                                         const scene::Throw& found,
                                         const scene::Scenario& scenario) {
  const auto event = [&](std::string_view kind, std::size_t sample) {
    devices::Event e;
    e.time = recording.times[sample];
    e.kind = kind;
    e.bodies = {"ball"};
    e.p_W = scenario.rig.X_WT * (recording.right_hand[sample] * scenario.hand.grip);
    return e;
  };
  std::vector<devices::Event> events = {event(scene::kind::grab_found, found.grab),
                                        event(scene::kind::release_found, found.release)};
  events[0].detail = "where the hand rests lowest; the recording has no buttons";
  events[1].detail = "the hand rises out of the bottom of its swing; the recording has no buttons";
  events[1].value = found.V_TB.v.norm();
  return events;
}

/// Seconds as one would write the stamp, 3.035 and not 3.0349999999999997.
double decimal_seconds(Time time) {
  return static_cast<double>(time.count()) / 1e6;
}

void run(const Options& options) {
  const scene::Scenario base =
      options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
  const devices::MotionRecording recording = read_recording(options.file, metres(options.units));
  scene::require_throw(recording, base.hand, options.file);
  const scene::Throw found = scene::find_throw(recording, base.hand);
  const scene::Scenario scenario =
      scene::stand_thrower(base, recording, found, heading(options.heading));
  scene::check(scenario, options.file + " as thrown in this room");

  devices::TrialHeader header;
  header.participant = options.participant;
  header.condition = options.condition;
  header.scenario = scene::to_toml(scenario);
  watch_stop_signals();
  devices::Recorder recorder(
      *options.output, header,
      {.overwrite = options.force, .inputs = {options.file, options.scenario}});
  devices::write(recorder, scene::to_samples(recording, found),
                 found_events(recording, found, scenario));
  check_stop();
  recorder.close();

  const std::size_t samples = recording.times.size();
  const double duration = decimal_seconds(recording.times.back() - recording.times.front());
  const double rate = static_cast<double>(samples - 1) / duration;
  const double grab = decimal_seconds(recording.times[found.grab]);
  const double release = decimal_seconds(recording.times[found.release]);
  const double speed = found.V_TB.v.norm();
  if (options.json) {
    print_json({{"output", *options.output},
                {"samples", samples},
                {"duration_s", duration},
                {"rate_hz", rate},
                {"peak_hand_speed_mps", found.peak_hand_speed},
                {"grab_s", grab},
                {"release_s", release},
                {"release_speed_mps", speed}});
    return;
  }
  std::cout << fmt::format(
      "{}\n"
      "  samples            {} of head and both hands\n"
      "  duration           {:.3f} s\n"
      "  rate               {:.1f} Hz\n"
      "  peak hand speed    {:.2f} m/s\n"
      "  grab, found        {:.3f} s\n"
      "  release, found     {:.3f} s\n"
      "  ball at release    {:.2f} m/s\n",
      *options.output, samples, duration, rate, found.peak_hand_speed, grab, release, speed);
}

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command = app.add_subcommand("import", "Make a trial of a recorded throw");
  const auto options = std::make_shared<Options>();
  command->add_option("FILE", options->file, "CSV of the XR motion catalogue")->required();
  add_output(*command, "-o,--output", options->output,
             "trial to write (.lcmlog); - is standard output")
      ->required();
  command->add_option("--units", options->units, "unit of the positions: m, cm or mm")
      ->check(CLI::IsMember({"m", "cm", "mm"}))
      ->capture_default_str();
  command
      ->add_option("--heading", options->heading,
                   "what heads down the lane: the ball at its release, the head's gaze before it, "
                   "or keep: the recording's -z")
      ->check(CLI::IsMember({"release", "gaze", "keep"}))
      ->capture_default_str();
  command->add_option("--scenario", options->scenario,
                      "its name, or a TOML file; the paper's room when not given");
  command->add_option("--participant", options->participant, "who threw");
  command->add_option("--condition", options->condition, "name of the condition");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "There are no buttons in such a file: grab and release are found, and marked as found.\n"
      "What cannot be a person's throw is refused, with the reason.\n\n"
      "Example:\n  headpin import throw.csv -o throw.lcmlog --heading gaze");
  command->callback([options] { run(*options); });
}

}  // namespace headpin::apps
