#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "scene/recorded.h"
#include "scene/totals.h"
#include "scene/trial_writer.h"
#include "scene/verifier.h"

namespace headpin::apps {

namespace {

struct ReplayOptions {
  std::string trial;
  std::optional<std::string> output;
  Condition condition;
  double longest_gap = seconds(devices::kLongestGap);
  bool verify = false, force = false, json = false;
};

std::string readable(const nlohmann::json& value, const char* unit) {
  if (value.is_null()) return "-";
  if (value.is_object()) {  // one of each object
    const nlohmann::json shared = scene::in_short(value);
    return shared.is_string() ? shared.get<std::string>() : readable(shared, unit);
  }
  if (value.is_number_float()) return fmt::format("{:.3g}{}", value.get<double>(), unit);
  if (value.is_string()) return value.get<std::string>() + unit;
  return value.dump() + unit;
}

void print_summary(const nlohmann::json& s) {
  const auto line = [&](const char* label, const char* key, const char* unit = "") {
    fmt::print("{:<18}{}\n", label, readable(s[key], unit));
  };
  line("version", "version");
  line("elasticity", "elasticity", " each");
  line("friction", "friction", " each");
  line("shape", "shape");
  line("response", "response");
  line("ball at release", "release_speed_mps", " m/s");
  line("at first skittle", "impact_speed_mps", " m/s");
  const std::string of =
      s["games"].empty() ? fmt::format("of {}", s["skittles"].dump()) : "of all racks";
  fmt::print("{:<18}{} {}\n", "skittles down", s["skittles_down"].dump(), of);
  for (const nlohmann::json& game : s["games"]) {
    fmt::print("{:<18}{}\n", "score sheet", game["sheet"].get<std::string>());
  }
  line("simulated", "simulated_s", " s");
  line("times real time", "realtime_factor");
  line("state hash", "state_hash");
}

void replay(const ReplayOptions& options) {
  watch_stop_signals();  // before there is anything to put away
  scene::Recorded recorded = scene::load_trial(options.trial, microseconds(options.longest_gap));
  const devices::TrialSummary& trial = recorded.file.summary();
  apply(options.condition, recorded.scenario);
  scene::Session session = scene::make_session(recorded.scenario);
  const std::int64_t ticks = scene::tick_count(trial, recorded.scenario.rates.physics_hz);

  scene::Stopwatch stopwatch;
  scene::Totals totals;
  ProgressLine progress("ticks", ticks);
  std::optional<scene::TrialWriter> writer;
  std::optional<scene::Verifier> verifier;
  std::vector<scene::Observer*> observers = {&stopwatch, &totals};
  if (options.output) {
    writer.emplace(
        *options.output, trial.header, session,
        devices::Recorder::Options{.overwrite = options.force, .inputs = {options.trial}});
    for (const devices::Event& event : trial.events) {
      if (event.tick < 0) writer->write(event);  // what was found before any simulation
    }
    observers.push_back(&*writer);
  }
  devices::TrialPlayer source(recorded.file, {.states = options.verify});
  if (options.verify) observers.push_back(&verifier.emplace(source, session));
  observers.push_back(&progress);

  scene::run(session, source, stopwatch, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  if (writer) writer->close(session);
  say_what_is_missing("replay", options.trial, trial);

  nlohmann::json result = scene::summary(session, totals.score());
  result["trial"] = options.trial;
  result["complete"] = trial.complete;
  result["participant"] = trial.header.participant;
  result["condition"] = trial.header.condition;
  result["seed"] = trial.header.seed;
  result["set"] = options.condition.set;
  result["output"] = options.output ? nlohmann::json(*options.output) : nlohmann::json();
  result["realtime_factor"] = seconds(session.now()) / stopwatch.spent_s();
  // A recording that is complete may end sooner than its samples; one that is not has lost states.
  const std::int64_t recorded_ticks = trial.complete ? trial.last_tick : session.tick;
  const std::int64_t unverified = verifier ? recorded_ticks - verifier->compared() : 0;
  if (verifier) {
    result["verified_ticks"] = verifier->compared();
    result["unverified_ticks"] = unverified;
  }
  if (options.json) {
    print_json(result);
  } else {
    print_summary(result);
    if (verifier) {
      fmt::print("{:<18}{} ticks equal the recording{}\n", "verified", verifier->compared(),
                 unverified > 0 ? fmt::format(", {} are not in it", unverified) : "");
    }
    if (writer) fmt::print("{:<18}{}\n", "written", *options.output);
  }
}

}  // namespace

void add_replay(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      app.add_subcommand("replay", "Simulate a trial again from its device samples");
  command->add_option("trial", options->trial, "a trial (.lcmlog)")->required();
  add_output(*command, "-o,--output", options->output,
             "write the new trial, states and events in it; - is standard output");
  command->add_flag("--verify", options->verify, "compare every tick with the trial's own states");
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Example:\n  headpin replay assets/trials/demo.lcmlog -o smooth.lcmlog --friction 0 "
      "--elasticity 1");
  command->callback([options] { replay(*options); });
}

}  // namespace headpin::apps
