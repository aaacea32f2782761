#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "devices/trial/file.h"
#include "scene/page/trouble_json.h"
#include "scene/play/events.h"
#include "scene/play/outcome.h"
#include "scene/play/presence.h"
#include "scene/play/release.h"
#include "scene/play/release_timing.h"
#include "scene/play/score.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/drawn_by.h"
#include "scene/watch/totals.h"

namespace headpin::apps {
namespace {

using nlohmann::ordered_json;

/// Text from a log, fit for a terminal.
std::string shown(std::string text) {
  return text.empty() ? "-" : printable(std::move(text));
}

double rate_hz(const devices::DeviceSummary& device) {
  return device.last > device.first
             ? static_cast<double>(device.samples - 1) / seconds(device.last - device.first)
             : 0.0;
}

/// Time from the first to the last entry of the trial that has a time.
Time duration(const devices::TrialSummary& trial) {
  return trial.first ? *trial.last - *trial.first : Time{};
}

/// Receivers by station, then the mouse.
std::vector<std::pair<std::int32_t, devices::DeviceSummary>> in_order(
    const devices::TrialSummary& trial) {
  std::vector<std::pair<std::int32_t, devices::DeviceSummary>> all(trial.devices.begin(),
                                                                   trial.devices.end());
  std::stable_partition(all.begin(), all.end(), [](const auto& entry) { return entry.first != 0; });
  return all;
}

ordered_json channels_json(const devices::TrialSummary& trial) {
  ordered_json out = ordered_json::object();
  for (const auto& [name, channel] : trial.channels) {
    out[name] = {{"messages", channel.messages}, {"bytes", channel.bytes}};
  }
  return out;
}

ordered_json devices_json(const devices::TrialSummary& trial) {
  ordered_json out = ordered_json::array();
  for (const auto& [station, device] : in_order(trial)) {
    out.push_back({{"device", devices::device_name(station)},
                   {"samples", device.samples},
                   {"rate_hz", rate_hz(device)},
                   {"longest_gap_s", nearest_seconds(device.longest_gap)},
                   {"lost", device.lost},
                   {"bad", device.bad},
                   {"astray", device.astray}});
  }
  return out;
}

ordered_json events_json(const devices::TrialSummary& trial) {
  ordered_json out = ordered_json::array();
  for (const devices::Event& event : trial.events) {
    out.push_back({{"time_s", nearest_seconds(event.time)},
                   {"tick", event.tick},
                   {"kind", event.kind},
                   {"bodies", event.bodies},
                   {"value", event.value},
                   {"detail", event.detail}});
  }
  return out;
}

/// Adds the details of ledger and kept_pace events, each under a key with the kind of the event.
void add_details(ordered_json& out, const devices::TrialSummary& trial) {
  for (const devices::Event& event : trial.events) {
    if (event.kind != scene::kind::ledger && event.kind != scene::kind::kept_pace) continue;
    const ordered_json detail = ordered_json::parse(event.detail, nullptr, false);
    if (detail.is_object()) out[event.kind] = detail;
  }
}

ordered_json result_json(const devices::TrialSummary& trial) {
  const scene::Score r = scene::score(trial.events);
  const auto skittles = std::ranges::count_if(
      trial.header.body_names, [](const std::string& name) { return name.starts_with("skittle"); });
  ordered_json out = {{"skittles", skittles},
                      {"skittles_down", r.skittles_down},
                      {"felled_by_hand", r.felled_by_hand},
                      {"games", scene::to_json(r.games)},
                      {"throws", scene::to_json(r.throws)}};
  if (r.release_speed) out["release_speed_mps"] = *r.release_speed;
  if (r.impact_speed) out["impact_speed_mps"] = *r.impact_speed;
  out["approaches"] = scene::approaches_of(trial.events);
  if (r.skittles_down == 0) out["why_nothing_fell"] = scene::why_nothing_fell(trial.events);
  return out;
}

/// Adds the faults of the recording.
void add_trouble(ordered_json& out, const devices::TrialSummary& trial) {
  out["skipped"] = scene::skipped_json<ordered_json>(trial.skipped);
  out["trouble"] = scene::trouble_json<ordered_json>(trial.trouble, nearest_seconds);
  out["backwards"] = trial.backwards;
  out["late"] = trial.late;
  out["longest_gap"] = {{"from_s", nearest_seconds(trial.longest_gap.from)},
                        {"to_s", nearest_seconds(trial.longest_gap.to)}};
}

ordered_json to_json(const std::string& path, const devices::TrialSummary& trial) {
  ordered_json out{{"trial", path},
                   {"format_version", trial.header.format_version},
                   {"version", trial.header.software_version},
                   {"commit", trial.header.software_commit},
                   {"participant", trial.header.participant},
                   {"condition", trial.header.condition},
                   {"seed", trial.header.seed},
                   {"duration_s", nearest_seconds(duration(trial))},
                   {"complete", trial.complete},
                   {"ticks", trial.state_count},
                   {"frames", trial.frame_count},
                   {"channels", channels_json(trial)},
                   {"devices", devices_json(trial)},
                   {"events", events_json(trial)}};
  add_details(out, trial);
  if (trial.state_count > 0) out["result"] = result_json(trial);
  add_trouble(out, trial);
  return out;
}

/// Release timings of a trial with a complete scenario; empty otherwise.
std::vector<scene::ReleaseTiming> timings_of(const devices::TrialFile& file,
                                             const std::string& path) {
  if (!file.summary().has_header) return {};
  try {
    return scene::release_timings(file,
                                  scene::scenario_of_trial(file.summary().header.scenario, path));
  } catch (const std::invalid_argument&) {
    return {};
  }
}

ordered_json to_json(const std::vector<scene::ReleaseTiming>& timings) {
  ordered_json all = ordered_json::array();
  for (const scene::ReleaseTiming& t : timings) {
    all.push_back({{"time_s", nearest_seconds(t.release)},
                   {"fastest_s", nearest_seconds(t.fastest)},
                   {"fastest_mps", t.fastest_speed}});
  }
  return all;
}

void print_timings(const std::vector<scene::ReleaseTiming>& timings) {
  for (const scene::ReleaseTiming& t : timings) {
    const double late = seconds(t.release - t.fastest);
    std::cout << fmt::format(
        "  released at {:.3f} s, {:.0f} ms {} it would have left fastest ({:.2f} m/s)\n",
        seconds(t.release), 1e3 * std::abs(late), late < 0.0 ? "before" : "after", t.fastest_speed);
  }
}

/// Prints the messages with faults.
void print_trouble(const devices::TrialSummary& trial) {
  if (trial.trouble.empty()) return;
  std::cout << "amiss (seconds into the log)\n";
  for (const devices::Trouble& t : trial.trouble) {
    std::cout << fmt::format("  {:9.3f} s to {:9.3f} s  {:>6} {} of {}\n", nearest_seconds(t.from),
                             nearest_seconds(t.to), t.messages, t.kind, shown(t.device));
  }
  if (trial.trouble.size() == devices::kMostTroubles) {
    std::cout << "  and maybe more; all are counted above\n";
  }
}

void print_skipped(const devices::TrialSummary& trial) {
  const auto line = [](std::int64_t count, const char* what) {
    if (count > 0) std::cout << fmt::format("  {} {}\n", count, what);
  };
  if (const devices::Gap& gap = trial.longest_gap; gap.length() > devices::kLongestGap) {
    std::cout << fmt::format("no sample from {:.3f} s to {:.3f} s\n", seconds(gap.from),
                             seconds(gap.to));
  }
  if (trial.skipped.nothing() && trial.backwards == 0 && trial.late == 0) return;
  std::cout << "passed over\n";
  line(trial.skipped.cut_bytes, "bytes of an event the file ends in");
  line(trial.skipped.bytes, "bytes that belong to no event");
  line(trial.skipped.undecodable, "messages with another type or size");
  line(trial.skipped.implausible, "messages with impossible numbers");
  line(trial.skipped.other_trials, "more trial in the same file, and what follows its header");
  line(trial.skipped.foreign, "poses in another frame than the transmitter's");
  line(trial.skipped.baseless, "states stored as changes of a state that is missing");
  line(trial.skipped.misdated,
       "samples and states with a time that those around them do not share");
  line(trial.backwards, "samples not later than the one before (kept)");
  line(trial.late,
       "samples that the session got more than 50 ms later than they were there (kept)");
}

/// How well a live session kept real time, as text.
std::string pace_in_words(const devices::Event& event) {
  const nlohmann::json pace = nlohmann::json::parse(event.detail, nullptr, false);
  const auto number = [&](const char* key) {
    const auto found = pace.is_object() ? pace.find(key) : pace.end();
    return found != pace.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
  };
  return fmt::format("{} ticks, {} overruns; {} frames, {} late; drawing failed {} times",
                     number("ticks"), number("overruns"), number("frames"), number("late_frames"),
                     number("drawing_failures"));
}

/// The content of an event besides its kind, on one line.
std::string in_short(const devices::Event& event) {
  if (event.kind == scene::kind::ledger) return "";
  if (event.kind == scene::kind::kept_pace) return pace_in_words(event);
  if (event.kind == scene::kind::drawn_by) {
    const std::optional<render::Fingerprint> who = scene::drawn_by({event});
    return who ? who->renderer : "";
  }
  if (const auto motion = scene::motion_of(event); motion && event.kind == scene::kind::release) {
    return fmt::format("{}, {:.2f} m/s, {}", fmt::join(event.bodies, ", "), event.value,
                       scene::in_words(*motion));
  }
  return event.bodies.empty() ? event.detail : fmt::format("{}", fmt::join(event.bodies, ", "));
}

void print_trial(const std::string& path, const devices::TrialSummary& trial,
                 const std::vector<scene::ReleaseTiming>& timings) {
  std::cout << fmt::format("{}: {:.3f} s, {}\n", path, seconds(duration(trial)),
                           trial.complete ? "complete" : "not complete");
  if (trial.has_header) {
    std::cout << fmt::format("  participant {}, condition {}, seed {}\n",
                             shown(trial.header.participant), shown(trial.header.condition),
                             trial.header.seed)
              << fmt::format("  written by headpin {} ({})\n", shown(trial.header.software_version),
                             shown(trial.header.software_commit));
  } else {
    std::cout << "  no trial: nothing on HEADPIN_TRIAL\n";
  }
  std::cout << "devices\n";
  for (const auto& [station, device] : in_order(trial)) {
    std::cout << fmt::format("  {:<12} {:>7} samples", devices::device_name(station),
                             device.samples);
    if (station != 0) {
      std::cout << fmt::format("  {:6.1f} Hz  longest gap {:.3f} s  {} lost  {} bad  {} astray",
                               rate_hz(device), seconds(device.longest_gap), device.lost,
                               device.bad, device.astray);
    }
    std::cout << "\n";
  }
  if (trial.state_count > 0) {
    const scene::Score r = scene::score(trial.events);
    std::cout << fmt::format("simulated\n  {} ticks, {} bodies, {} frames\n", trial.state_count,
                             trial.bodies, trial.frame_count)
              << fmt::format("  skittles down {}", r.skittles_down);
    if (r.release_speed)
      std::cout << fmt::format(", ball released at {:.2f} m/s", *r.release_speed);
    if (r.impact_speed) std::cout << fmt::format(", struck at {:.2f} m/s", *r.impact_speed);
    std::cout << "\n";
    for (const scene::Sheet& game : r.games) {
      std::cout << fmt::format("  {}\n", scene::in_words(game));
    }
    for (const std::string& approach : scene::approaches_in_words(trial.events)) {
      std::cout << "  " << shown(approach) << "\n";
    }
    if (r.skittles_down == 0) {
      std::cout << "  " << shown(scene::why_nothing_fell(trial.events)) << "\n";
    }
  }
  print_timings(timings);
  if (!trial.events.empty()) std::cout << "events\n";
  for (const devices::Event& event : trial.events) {
    std::cout << fmt::format("  {:9.3f} s  {:<14} {}\n", seconds(event.time), shown(event.kind),
                             shown(in_short(event)));
  }
  std::cout << "channels\n";
  for (const auto& [name, channel] : trial.channels) {
    std::cout << fmt::format("  {:<14} {:>8} messages {:>12} bytes\n", shown(name),
                             channel.messages, channel.bytes);
  }
  print_skipped(trial);
  print_trouble(trial);
}

/// Prints the complete scenario, with the trial's values for keys that its text does not have yet.
/// As a file it has the same meaning. A text that cannot be read is printed unchanged.
void print_scenario(const std::string& text, const std::string& path) {
  try {
    std::cout << scene::whole_scenario(text, path);
  } catch (const std::invalid_argument& error) {
    std::cout << text;
    say("headpin info: {}\n", printable(error.what()));
  }
}

}  // namespace

void add_info(CLI::App& app) {
  struct Options {
    std::string trial;
    bool json = false, scenario = false;
  };
  CLI::App* command = app.add_subcommand("info", "Show what a trial contains");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("TRIAL", options->trial,
                   "a trial (.lcmlog), or any LCM event log; - is standard input")
      ->required();
  auto* json = add_json(*command, options->json);
  command->add_flag("--scenario", options->scenario, "print only its scenario (TOML)")
      ->excludes(json);
  command->footer(
      "Reads any LCM event log. Of a damaged or incomplete log, it reads what is readable.\n\n"
      "Example:\n  headpin info assets/trials/demo.lcmlog");
  command->callback([options] {
    const devices::TrialFile file(options->trial);
    if (options->scenario) {
      file.require_trial(Time::max());
      return print_scenario(file.summary().header.scenario, options->trial);
    }
    const devices::TrialSummary& trial = file.summary();
    if (options->json) {
      ordered_json all = to_json(options->trial, trial);
      all["releases"] = to_json(timings_of(file, options->trial));
      print_json(all);
    } else {
      print_trial(options->trial, trial, timings_of(file, options->trial));
    }
  });
}

}  // namespace headpin::apps
