#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/bids_session.h"
#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/recordings/motion_files.h"
#include "devices/trial/log.h"
#include "scene/people/throw.h"
#include "scene/play/events.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

struct ImportOptions {
  std::optional<std::string> output;
  std::string file, scenario, participant, condition;
  std::string units, heading = "release", hand = "auto", names, axes, transmitter;
  std::optional<int> which;
  bool force = false, json = false;
};

double metres(const std::string& unit) {
  return unit == "mm" ? 0.001 : unit == "cm" ? 0.01 : 1.0;
}

scene::Heading heading(const std::string& name) {
  if (name == "gaze") return scene::Heading::gaze;
  return name == "keep" ? scene::Heading::keep : scene::Heading::release;
}

/// Reads X,Y,Z in metres.
Vec3 read_place(const std::string& text) {
  Vec3 p = Vec3::Zero();
  const char *at = text.data(), *const end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    const auto read = std::from_chars(at, end, p[i]);
    at = read.ptr;
    const bool right = read.ec == std::errc{} && std::abs(p[i]) <= 100.0 &&
                       (i == 2 ? at == end : at != end && *at++ == ',');
    if (right) continue;
    throw UsageError("--transmitter " + text + ": expected X,Y,Z, metres from -100 to 100");
  }
  return p;
}

/// The options of the reader, from the command line.
devices::MotionOptions declared(const ImportOptions& options) {
  devices::MotionOptions motion;
  if (!options.units.empty()) motion.unit_m = metres(options.units);
  if (!options.axes.empty()) motion.axes = options.axes;
  motion.only_hand_is_left = options.hand == "left";
  if (!options.transmitter.empty()) motion.p_origin = read_place(options.transmitter);
  if (options.names.empty()) return motion;
  std::istringstream names(options.names);
  for (std::string& name : motion.names) std::getline(names, name, ',');
  const auto& [head, left, right] = motion.names;
  if (std::ranges::count(options.names, ',') != 2 || head.empty() ||
      (left.empty() && right.empty())) {
    throw UsageError("--names " + options.names +
                     ": expected three names, HEAD,LEFT,RIGHT, one hand of which may be empty");
  }
  return motion;
}

/// The recording in the file, and the throwing hand.
struct Thrown {
  devices::MotionRecording recording;
  scene::Side side = scene::Side::right;
  std::size_t throws = 1;          ///< in the file
  std::vector<std::string> notes;  ///< parts of the file that were left out
};

scene::Side side_of(const ImportOptions& options, const devices::MotionRecording& recording,
                    const scene::Hand& hand) {
  if (options.hand == "auto") return scene::throwing_side(recording, hand);
  return options.hand == "left" ? scene::Side::left : scene::Side::right;
}

Thrown read_thrown(const ImportOptions& options, const scene::Hand& hand) {
  Thrown thrown;
  thrown.recording = devices::read_motion(options.file, declared(options));
  thrown.side = side_of(options, thrown.recording, hand);
  std::vector<devices::MotionRecording> throws = scene::split_throws(thrown.recording, thrown.side);
  thrown.throws = throws.size();
  thrown.notes = thrown.recording.notes;
  if (!options.which) return thrown;
  const auto wanted = static_cast<std::size_t>(*options.which);
  if (wanted > throws.size()) {
    throw std::runtime_error(fmt::format("{}: expected a throw number {}, found {} throws",
                                         options.file, wanted, throws.size()));
  }
  thrown.recording = std::move(throws[wanted - 1]);
  thrown.side = side_of(options, thrown.recording, hand);
  return thrown;
}

/// Prints warnings about a recording that is imported anyway.
void say_doubts(const ImportOptions& options, const Thrown& thrown) {
  std::vector<std::string> all = thrown.notes;
  std::ranges::move(scene::doubts(thrown.recording), std::back_inserter(all));
  for (const std::string& one : all) {
    say("headpin import: {}: {}\n", printable(options.file), printable(one));
  }
  if (thrown.throws > 1 && !options.which) {
    say("headpin import: {}: has {} throws; the fastest is used; --throw N chooses another\n",
        printable(options.file), thrown.throws);
  }
}

/// Events for what was found in the recording, so that it is not taken for recorded data.
std::vector<devices::Event> found_events(const devices::MotionRecording& recording,
                                         const scene::Throw& found,
                                         const scene::Scenario& scenario) {
  const auto event = [&](std::string_view kind, std::size_t sample) {
    devices::Event e;
    e.time = recording.times[sample];
    e.kind = kind;
    e.bodies = {"ball"};
    e.p_W = scenario.rig.X_WT *
            (scene::throwing_hand(recording, found.side)[sample] * scenario.hand.grip);
    return e;
  };
  std::vector<devices::Event> events = {event(scene::kind::grab_found, found.grab),
                                        event(scene::kind::release_found, found.release)};
  events[0].detail = "where the hand rests lowest; the recording has no buttons";
  events[1].detail = "the hand rises out of the bottom of its swing; the recording has no buttons";
  events[1].value = found.V_TB.v.norm();
  return events;
}

/// Imports one throw. Seconds are rounded to the stamp: 3.035 and not 3.0349999999999997.
void import_throw(const ImportOptions& options) {
  const scene::Scenario base =
      options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
  const Thrown thrown = read_thrown(options, base.hand);
  const devices::MotionRecording& recording = thrown.recording;
  scene::require_throw(recording, base.hand, options.file, thrown.side);
  say_doubts(options, thrown);
  const scene::Throw found = scene::find_throw(recording, base.hand, thrown.side);
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
  const double duration = nearest_seconds(recording.times.back() - recording.times.front());
  const double rate = static_cast<double>(samples - 1) / duration;
  const double grab = nearest_seconds(recording.times[found.grab]);
  const double release = nearest_seconds(recording.times[found.release]);
  const double speed = found.V_TB.v.norm();
  if (options.json) {
    print_json({{"output", *options.output},
                {"hand", found.side == scene::Side::left ? "left" : "right"},
                {"throw_count", thrown.throws},
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
      "  samples            {} of head and {}\n"
      "  thrown by          the {} hand\n"
      "  duration           {:.3f} s\n"
      "  rate               {:.1f} Hz\n"
      "  peak hand speed    {:.2f} m/s\n"
      "  grab, found        {:.3f} s\n"
      "  release, found     {:.3f} s\n"
      "  ball at release    {:.2f} m/s\n",
      *options.output, samples,
      recording.left_hand.empty() || recording.right_hand.empty() ? "one hand" : "both hands",
      found.side == scene::Side::left ? "left" : "right", duration, rate, found.peak_hand_speed,
      grab, release, speed);
}

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command = app.add_subcommand("import", "Convert a recorded throw to a trial");
  const auto options = std::make_shared<ImportOptions>();
  command
      ->add_option("FILE", options->file,
                   "recording: a CSV file of the XR motion catalogue, the folder of a UXF session "
                   "or one of its tracker files, a Motion-BIDS ..._motion.tsv, or a VRPN log")
      ->required();
  add_output(*command, "-o,--output", options->output,
             "trial to write (.lcmlog); - is standard output", {".lcmlog"})
      ->required();
  command
      ->add_option("--units", options->units,
                   "unit of the positions, if the file does not say it: m, cm or mm; default: cm "
                   "for the catalogue, m for VRPN")
      ->check(CLI::IsMember({"m", "cm", "mm"}));
  command
      ->add_option(
          "--axes", options->axes,
          "directions of +x, +y and +z, for VRPN, or for Motion-BIDS if the file does not say it: "
          "three of R right, L left, S up, I down, A ahead, P back; default for VRPN: RSP")
      ->type_name("XYZ");
  command
      ->add_option("--names", options->names,
                   "names of head, left hand and right hand in the file, such as 0,,1 without a "
                   "left hand; default: names that contain these words, or the sensors 0, 1 and 2; "
                   "of two sensors the second is the hand")
      ->type_name("HEAD,LEFT,RIGHT");
  command
      ->add_option("--transmitter", options->transmitter,
                   "place of the tracker's transmitter, the origin of the positions: metres to the "
                   "right, above the floor, and back; default: 0,0,0")
      ->type_name("X,Y,Z");
  command
      ->add_option("--hand", options->hand,
                   "hand that throws: left, right, or auto (found in the recording)")
      ->check(CLI::IsMember({"left", "right", "auto"}))
      ->capture_default_str();
  command->add_option("--throw", options->which, "number of the throw in the file, from 1")
      ->check(CLI::Range(1, 10'000));
  command
      ->add_option("--heading", options->heading,
                   "what points down the lane: release (the ball's velocity at its release), gaze "
                   "(the head's direction before it), or keep (the recording's -z axis)")
      ->check(CLI::IsMember({"release", "gaze", "keep"}))
      ->capture_default_str();
  command->add_option("--scenario", options->scenario,
                      "name of a bundled scenario or a TOML file; default: the paper's room");
  command->add_option("--participant", options->participant, "name of the participant");
  command->add_option("--condition", options->condition, "name of the condition");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Such files have no buttons: the program finds grab and release in the motion, and marks "
      "them as found.\nA recording that cannot be a person's throw is refused, with the reason. A "
      "session from\n`experiment export` is read back complete, with its buttons.\n\n"
      "Example:\n  headpin import throw.csv -o throw.lcmlog --heading gaze");
  command->callback([options] {
    if (is_bids_session(options->file)) {
      import_bids_session(options->file, *options->output, options->force, options->json);
    } else {
      import_throw(*options);
    }
  });
}

}  // namespace headpin::apps
