#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/import_explain.h"
#include "apps/import_options.h"
#include "apps/import_session.h"
#include "apps/import_thrown.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "devices/recordings/motion_files.h"
#include "scene/people/throw.h"
#include "scene/people/throw_checks.h"
#include "scene/people/throw_readings.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

scene::Scenario room_of(const ImportOptions& options) {
  return options.scenario.empty() ? scene::Scenario{} : scene::load_scenario(options.scenario);
}

scene::Heading heading(const std::string& name) {
  if (name == "gaze") return scene::Heading::gaze;
  return name == "keep" ? scene::Heading::keep : scene::Heading::release;
}

/// What to know about a recording that is imported anyway.
std::vector<std::string> doubts_about(const Thrown& thrown, const scene::Throw& found,
                                      const scene::Scenario& base) {
  std::vector<std::string> all = thrown.notes;
  if (!thrown.recording.hands_turn) {
    all.emplace_back(
        "the hands' rotations were not measured: the ball leaves without spin, at the speed of the "
        "hand");
  }
  if (!thrown.recording.head_turns || !thrown.recording.head_moves) {
    all.emplace_back("the head's rotation was not measured: it looks level, along the throw");
  }
  const double speed = found.V_TB.v.norm();
  const double after = seconds(thrown.recording.times.back() - found.release_time);
  const double needed = speed > 0.0 ? base.lane.head_pin / speed + 1.0 : 0.0;
  if (after < needed) {
    all.push_back(
        fmt::format("ends {:.2f} s after the release: a replay ends there too, before all skittles "
                    "have fallen; `replay --each-throw` goes on",
                    after));
  }
  std::ranges::move(scene::doubts(thrown.recording, found), std::back_inserter(all));
  return all;
}

void say_doubts(const ImportOptions& options, const Thrown& thrown,
                const std::vector<std::string>& doubts) {
  for (const std::string& one : doubts) {
    say("headpin import: {}: {}\n", printable(name_of(options, thrown)), printable(one));
  }
  if (thrown.throws > 1 && !options.which) {
    say("headpin import: {}: has {} throws; the fastest is used; --throw N chooses another\n",
        printable(options.file), thrown.throws);
  }
}

scene::Event said(std::string_view kind, const devices::MotionRecording& recording,
                  std::string detail) {
  scene::Event event;
  event.time = recording.times.front();
  event.kind = kind;
  event.detail = std::move(detail);
  return event;
}

/// Events for where a trial is from, and for all that import says about the recording.
std::vector<scene::Event> origin(const ImportOptions& options,
                                 const devices::MotionRecording& recording, std::size_t throws,
                                 const std::vector<std::string>& notes) {
  const std::string name = std::filesystem::path(options.file).filename().string();
  std::string from = printable(name);
  if (options.which) from += fmt::format(", throw {} of {}", *options.which, throws);
  std::vector<scene::Event> events = {said(scene::kind::imported, recording, std::move(from))};
  events.front().value = nearest_seconds(recording.start);
  for (const std::string& note : notes) {
    events.push_back(said(scene::kind::import_note, recording, printable(note)));
  }
  return events;
}

/// Events for what was not measured.
std::vector<scene::Event> not_measured(const devices::MotionRecording& recording) {
  std::vector<scene::Event> events;
  const auto add = [&](const char* detail) {
    events.push_back(said(scene::kind::not_measured, recording, detail));
  };
  if (!recording.head_moves) {
    add("the head: it stays in one place and looks along the throw");
  } else if (!recording.head_turns) {
    add("the rotation of the head: it looks level, along the throw");
  }
  if (!recording.hands_turn) add("the rotation of the hands: they do not turn");
  return events;
}

/// Events for what was found in the recording, so that it is not taken for recorded data.
std::vector<scene::Event> found_events(const devices::MotionRecording& recording,
                                       const scene::Throw& found, const scene::Scenario& scenario) {
  const auto event = [&](std::string_view kind, std::size_t sample) {
    scene::Event e;
    e.time = recording.times[sample];
    e.kind = kind;
    e.bodies = {"ball"};
    e.p_W = scenario.rig.X_WT *
            (scene::throwing_hand(recording, found.side)[sample] * scenario.hand.grip);
    return e;
  };
  std::vector<scene::Event> events = not_measured(recording);
  if (found.by_trigger) return events;
  events.push_back(event(scene::kind::grab_found, found.grab));
  events.back().detail = "where the hand rests lowest; the recording has no buttons";
  events.push_back(event(scene::kind::release_found, found.release));
  events.back().detail =
      "the hand rises out of the bottom of its swing; the recording has no buttons";
  events.back().value = found.V_TB.v.norm();
  return events;
}

/// The header and the file of a trial.
scene::Recorder recorder_for(const ImportOptions& options, const scene::Scenario& scenario) {
  scene::check(scenario, options.file + " as recorded, in this room");
  scene::TrialHeader header;
  header.participant = options.participant;
  header.condition = options.condition;
  header.scenario = scene::to_toml(scenario);
  watch_stop_signals();
  return scene::Recorder(
      base::OutputFile(*options.output, {.overwrite = options.force,
                                         .standard_output = true,
                                         .inputs = {options.file, options.scenario, options.events,
                                                    options.columns}}),
      header);
}

/// Imports a recording of the head alone: nothing is thrown.
void import_head(const ImportOptions& options, const scene::Scenario& base,
                 const devices::MotionRecording& recording) {
  std::vector<std::string> notes = recording.notes;
  std::ranges::move(scene::doubts_about_head(recording), std::back_inserter(notes));
  for (const std::string& note : notes) {
    say("headpin import: {}: {}\n", printable(options.file), printable(note));
  }
  if (const std::string why = scene::why_no_head(recording); !why.empty()) {
    throw std::runtime_error(fmt::format("{}: not a person's head: {}", options.file, why));
  }
  scene::Recorder recorder =
      recorder_for(options, scene::stand_onlooker(base, recording, heading(options.heading)));
  std::vector<scene::Event> events = origin(options, recording, 0, notes);
  std::ranges::move(not_measured(recording), std::back_inserter(events));
  events.push_back(said(scene::kind::not_measured, recording, "the hands: nothing is thrown"));
  scene::write(recorder, scene::head_samples(recording), events);
  check_stop();
  recorder.close();
  const double duration = nearest_seconds(recording.times.back() - recording.times.front());
  if (options.json) {
    print_json({{"output", *options.output},
                {"samples", recording.times.size()},
                {"duration_s", duration}});
    return;
  }
  std::cout << fmt::format(
      "{}\n  samples            {} of the head\n  duration           {:.3f} s\n", *options.output,
      recording.times.size(), duration);
}

/// How the ball's velocity is known, where no sample is on one side of the release.
std::string unless_tracked(const scene::Throw& found) {
  if (found.known == scene::Known::tracked) return "";
  scene::Motion ball;
  ball.known = found.known;
  ball.extrapolated = found.extrapolated;
  return ", " + scene::in_words(ball);
}

/// Imports one throw. Seconds are rounded to the stamp: 3.035 and not 3.0349999999999997.
void import_throw(const ImportOptions& options) {
  const scene::Scenario base = room_of(options);
  devices::MotionRecording read = recording_in(options, base.hand);
  if (options.hand == "none") return import_head(options, base, read);
  const Thrown thrown = thrown_in(std::move(read), options, base.hand);
  const devices::MotionRecording& recording = thrown.recording;
  if (const std::optional<Refusal> refused = refusal(options, thrown, base.hand)) {
    const std::string noted =
        thrown.notes.empty() ? "" : fmt::format(" ({})", fmt::join(thrown.notes, "; "));
    throw std::runtime_error(refused->why + noted +
                             (refused->remedy.empty() ? "" : ": " + refused->remedy));
  }
  const scene::Throw found = scene::find_throw(recording, base.hand, thrown.side);
  const std::vector<std::string> doubts = doubts_about(thrown, found, base);
  say_doubts(options, thrown, doubts);
  const scene::Scenario scenario =
      scene::stand_thrower(base, recording, found, heading(options.heading));
  scene::Recorder recorder = recorder_for(options, scenario);
  std::vector<scene::Event> events = origin(options, recording, thrown.throws, doubts);
  std::ranges::move(found_events(recording, found, scenario), std::back_inserter(events));
  scene::write(recorder, scene::to_samples(recording, found), events);
  check_stop();
  recorder.close();

  const std::size_t samples = recording.times.size();
  const double duration = nearest_seconds(recording.times.back() - recording.times.front());
  const double rate = static_cast<double>(samples - 1) / duration;
  const double grab = nearest_seconds(found.grab_time);
  const double release = nearest_seconds(found.release_time);
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
                {"by_trigger", found.by_trigger},
                {"notes", doubts},
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
      "  grab{}        {:.3f} s\n"
      "  release{}     {:.3f} s\n"
      "  ball at release    {:.2f} m/s{}\n",
      *options.output, samples,
      recording.left_hand.empty() || recording.right_hand.empty() ? "one hand" : "both hands",
      found.side == scene::Side::left ? "left" : "right", duration, rate, found.peak_hand_speed,
      found.by_trigger ? "       " : ", found", grab, found.by_trigger ? "       " : ", found",
      release, speed, unless_tracked(found));
}

/// A trial is written, or with --explain a file of columns.
void require_output(const ImportOptions& options) {
  if (!options.output) {
    if (options.explain) return;
    throw UsageError("--output is required: a trial to write (.lcmlog)");
  }
  const std::string& name = *options.output;
  if (options.explain && name.ends_with(".lcmlog")) {
    throw UsageError(fmt::format(
        "--output: expected a name that ends in .toml, found {} (--explain writes no trial)",
        name));
  }
  if (!options.explain && name.ends_with(".toml")) {
    throw UsageError(fmt::format(
        "--output: expected a name that ends in .lcmlog, found {} (.toml is written only with "
        "--explain)",
        name));
  }
}

/// Refuses options about a throw where nothing is thrown.
void refuse_throw_without_hand(const ImportOptions& options) {
  if (options.hand != "none") return;
  for (const auto& [name, given] : {std::pair("--throw", options.which.has_value()),
                                    {"--events", !options.events.empty()},
                                    {"--no-trigger", options.no_trigger}}) {
    if (!given) continue;
    throw UsageError(fmt::format("{0}: with --hand none nothing is thrown; expected no {0}", name));
  }
}

/// Options that say how the file is read.
void add_reading(CLI::App& command, ImportOptions& options) {
  command
      .add_option("--columns", options.columns,
                  "columns of a table, such as 'time=t, head=HMD_*, right=ctrl_*', or a .toml file "
                  "from --explain; default: found by their names")
      ->type_name("WHAT=COLUMN,...|FILE");
  command
      .add_option(
          "--units", options.units,
          "unit of the positions: m, cm, mm, in or ft; default: what the file or its format "
          "says, else m")
      ->check(one_of({"m", "cm", "mm", "in", "ft"}));
  command
      .add_option(
          "--axes", options.axes,
          "directions of +x, +y and +z: three of R right, L left, S up, I down, A ahead, P "
          "back; a second three if rotations have other axes; default: what the file or its "
          "format says, else RSP")
      ->type_name("XYZ[,XYZ]");
  command
      .add_option("--time-unit", options.time_unit,
                  "unit of the times: s, ms, us, ns, or the rate of frames such as 90Hz; default: "
                  "what the file says, or what fits")
      ->type_name("UNIT");
  command
      .add_option(
          "--rotations", options.rotations,
          "order of a quaternion's columns (xyzw, wxyz) or of angles (YXZ about turning axes, "
          "zxy about fixed ones); vector; none; and inverse, deg or rad")
      ->type_name("WORD,...");
  command
      .add_option("--names", options.names,
                  "names of head, left hand and right hand in the file, such as 0,,1 without a "
                  "left hand; default: names that contain these words, or the sensors 0, 1 and 2; "
                  "of two sensors the second is the hand")
      ->type_name("HEAD,LEFT,RIGHT");
  command
      .add_option("--transmitter", options.transmitter,
                  "place of the tracker's transmitter, the origin of the positions: metres to the "
                  "right, above the floor, and back; default: 0,0,0")
      ->type_name("X,Y,Z");
  command
      .add_option(
          "--head", options.head,
          "place of a head that was not recorded: metres to the right, above the floor, and "
          "back")
      ->type_name("X,Y,Z");
  command
      .add_option(
          "--events", options.events,
          "file with the times of grab and release, a line each, on the recording's clock, in its "
          "unit or in seconds")
      ->type_name("FILE");
  command.add_flag("--no-trigger", options.no_trigger,
                   "find grab and release in the motion, though the file has a trigger");
}

}  // namespace

void add_import(CLI::App& app) {
  CLI::App* command = app.add_subcommand("import", "Convert a recorded throw to a trial");
  const auto options = std::make_shared<ImportOptions>();
  command
      ->add_option(
          "FILE", options->file,
          "recording: a text table with a time and the poses of head and hand (CSV, TSV), "
          "the folder of a UXF session or one of its tracker files, a Motion-BIDS "
          "..._motion.tsv, a VRPN log, a recording of LabRecorder (XDF), or the folder of `export`")
      ->required();
  add_output(*command, "-o,--output", options->output,
             "trial to write (.lcmlog); - is standard output; with --explain a .toml file",
             {".lcmlog", ".toml"});
  command->add_flag("--explain", options->explain,
                    "import nothing: print what is understood of the file and what is missing; -o "
                    "then writes the columns to a .toml file");
  add_reading(*command, *options);
  command
      ->add_option(
          "--hand", options->hand,
          "hand that throws: left, right, auto (found in the recording), or none (the head "
          "alone was recorded)")
      ->check(one_of({"left", "right", "auto", "none"}))
      ->capture_default_str();
  command->add_option("--throw", options->which, "number of the throw in the file, from 1")
      ->check(whole_number_from(1, 10'000));
  command
      ->add_option("--heading", options->heading,
                   "what points down the lane: release (the ball's velocity at its release), gaze "
                   "(the head's direction before it), or keep (the recording's -z axis)")
      ->check(one_of({"release", "gaze", "keep"}))
      ->capture_default_str();
  command->add_option("--scenario", options->scenario,
                      "name of a bundled scenario or a TOML file; default: the paper's room");
  command->add_option("--participant", options->participant, "name of the participant");
  command->add_option("--condition", options->condition, "name of the condition");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Without a trigger in the file, or --events, the program finds grab and release in the "
      "motion, and\nmarks them as found. A recording that cannot be a person's throw is refused, "
      "with the "
      "reason. A "
      "session from\n`experiment export`, `export` or `export --xdf` is read back complete, with its "
      "buttons.\n\n"
      "Example:\n  headpin import throw.csv -o throw.lcmlog --heading gaze");
  command->callback([options] {
    require_output(*options);
    if (import_session(*options)) return;
    refuse_throw_without_hand(*options);
    if (options->explain) return explain_import(*options, room_of(*options));
    import_throw(*options);
  });
}

}  // namespace headpin::apps
