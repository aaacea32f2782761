#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/info_json.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "scene/play/outcome.h"
#include "scene/play/presence.h"
#include "scene/play/release_timing.h"
#include "scene/play/score.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/record/file.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {
namespace {

/// Text from a log, fit for a terminal.
std::string shown(std::string text) {
  return text.empty() ? "-" : printable(std::move(text));
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
void print_trouble(const scene::TrialSummary& trial) {
  if (trial.trouble.empty()) return;
  std::cout << "amiss (seconds into the log)\n";
  for (const scene::Trouble& t : trial.trouble) {
    std::cout << fmt::format("  {:9.3f} s to {:9.3f} s  {:>6} {} of {}\n", nearest_seconds(t.from),
                             nearest_seconds(t.to), t.messages, t.kind, shown(t.device));
  }
  if (trial.trouble.size() == scene::kMostTroubles) {
    std::cout << "  and maybe more; all are counted above\n";
  }
}

void print_skipped(const scene::TrialSummary& trial) {
  const auto line = [](std::int64_t count, const char* what) {
    if (count > 0) std::cout << fmt::format("  {} {}\n", count, what);
  };
  if (const scene::Gap& gap = trial.longest_gap; gap.length() > devices::kLongestGap) {
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
  line(trial.skipped.doubled, "messages that equal an earlier one to the byte");
  line(trial.skipped.misdated,
       "samples and states with a time that those around them do not share");
  line(trial.backwards, "samples not later than the one before (kept)");
  line(trial.late,
       "samples that the session got more than 50 ms later than they were there (kept)");
}

/// How well a live session kept real time, as text.
std::string pace_in_words(const scene::KeptPace& pace) {
  return fmt::format("{} ticks, {} overruns; {} frames, {} late; drawing failed {} times",
                     pace.ticks, pace.overruns, pace.frames, pace.late_frames,
                     pace.drawing_failures);
}

/// The content of an event besides its kind, on one line.
std::string in_short(const scene::Event& event) {
  if (event.kind == scene::kind::ledger) return "";
  if (event.kind == scene::kind::kept_pace) {
    return pace_in_words(event.detail.value_or(scene::KeptPace{}));
  }
  if (event.kind == scene::kind::drawn_by) {
    const auto* who = event.detail.get_if<render::Fingerprint>();
    return who ? who->renderer : "";
  }
  if (const auto motion = scene::motion_of(event.detail)) {
    return fmt::format("{}, {:.2f} m/s, {}", fmt::join(event.bodies, ", "), event.value,
                       scene::in_words(*motion));
  }
  return event.bodies.empty() ? event.detail.text()
                              : fmt::format("{}", fmt::join(event.bodies, ", "));
}

void print_trial(const std::string& path, const scene::TrialSummary& trial,
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
  for (const auto& [device, summary] : in_order(trial)) {
    std::cout << fmt::format("  {:<12} {:>7} samples", devices::device_name(device),
                             summary.samples);
    if (device != devices::Device::mouse) {
      std::cout << fmt::format("  {:6.1f} Hz  longest gap {:.3f} s  {} lost  {} bad  {} astray",
                               rate_hz(summary), seconds(summary.longest_gap), summary.lost,
                               summary.bad, summary.astray);
      if (summary.estimated > 0) {
        std::cout << fmt::format("  {} with an estimated position", summary.estimated);
      }
    }
    std::cout << "\n";
  }
  if (trial.state_count > 0) {
    const scene::Score r = scene::score(trial);
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
    const std::string why = scene::why_nothing_fell(trial.events);
    if (!why.empty()) std::cout << "  " << shown(why) << "\n";
  }
  print_timings(timings);
  if (!trial.events.empty()) std::cout << "events\n";
  for (const scene::Event& event : trial.events) {
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
    const scene::TrialFile file(options->trial);
    if (options->scenario) {
      file.require_trial(Time::max());
      return print_scenario(file.summary().header.scenario, options->trial);
    }
    const scene::TrialSummary& trial = file.summary();
    if (options->json) {
      print_json(info_json(options->trial, file));
    } else {
      print_trial(options->trial, trial, timings_of(file, options->trial));
    }
  });
}

}  // namespace headpin::apps
