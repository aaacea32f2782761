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
#include "base/output_file.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/each_throw.h"
#include "scene/watch/entered.h"
#include "scene/watch/notes.h"
#include "scene/watch/recorded.h"
#include "scene/watch/recorded_display.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"
#include "scene/watch/verifier.h"

namespace headpin::apps {

namespace {

struct ReplayOptions {
  std::string trial;
  std::optional<std::string> output;
  scene::States states = scene::States::changes;
  Condition condition;
  double longest_gap = seconds(devices::kLongestGap);
  std::optional<double> from_s;
  bool verify = false, each_throw = false, force = false, json = false;
};

std::string readable(const nlohmann::json& value, const char* unit) {
  if (value.is_null()) return "-";
  if (value.is_object()) {  // one value per object
    const nlohmann::json shared = scene::in_short(value);
    return shared.is_string() ? shared.get<std::string>() : readable(shared, unit);
  }
  if (value.is_number_float()) return fmt::format("{:.3g}{}", value.get<double>(), unit);
  if (value.is_string()) return value.get<std::string>() + unit;
  return value.dump() + unit;
}

/// "elasticity 0.7 each, friction 0.7 each, shape true"
std::string condition_in_words(const nlohmann::json& condition) {
  return fmt::format("elasticity {}, friction {}, shape {}",
                     readable(condition["elasticity"], " each"),
                     readable(condition["friction"], " each"), readable(condition["shape"], ""));
}

void print_summary(const nlohmann::json& s) {
  const auto line = [&](const char* label, const char* key, const char* unit = "") {
    fmt::print("{:<18}{}\n", label, readable(s[key], unit));
  };
  line("version", "version");
  if (s["versions"].is_null()) {
    line("elasticity", "elasticity", " each");
    line("friction", "friction", " each");
    line("shape", "shape");
  } else {
    for (const char* name : {"red", "blue"}) {
      fmt::print("{:<18}{}\n", fmt::format("{} version", name),
                 condition_in_words(s["versions"][name]));
    }
  }
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
  line("game hash", "game_hash");
}

/// Stores the events of throws.
struct ThrowEvents : scene::Observer {
  void tick(const scene::Session& session) override {
    for (const scene::Event& event : session.events) add(event);
  }
  void add(const scene::Event& event) {
    using namespace scene::kind;
    for (const std::string_view kept : {version, grab, missed_grab, release, delivery}) {
      if (event.kind == kept) events.push_back(event);
    }
  }
  std::vector<scene::Event> events;
};

void print_throws(const nlohmann::json& result) {
  for (const auto& [key, what] :
       {std::pair("throws_without_counterpart", "of the trial, has no counterpart here: "),
        {"new_throws", "of this replay, has no counterpart in the trial: "}}) {
    for (const nlohmann::json& one : result[key]) {
      fmt::print("{:<18}{}{}\n", "throw", what, scene::unpaired_in_words(one));
    }
  }
}

/// Prints the releases with incomplete tracker data.
void print_releases(const std::vector<scene::Event>& events) {
  for (const scene::Event& event : events) {
    const auto motion = scene::motion_of(event.detail);
    if (!motion || (motion->known == scene::Known::tracked && motion->left_out == 0)) continue;
    fmt::print("{:<18}of {} at {:.3f} s: {}\n", "release", event.bodies.front(),
               seconds(event.time), scene::in_words(*motion));
  }
}

std::string count_in_words(const nlohmann::json& result) {
  if (!result["felled"].is_null()) return result["felled"].dump();
  return fmt::format("{} down", result["skittles_down"].dump());
}

scene::EachThrow each_throw_of(const scene::Session& session, const scene::Scenario& other) {
  try {
    return {session, other};
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// The condition, with the trial's own headset in place of the profile `recorded`.
Condition with_display(Condition condition, const scene::TrialSummary& trial) {
  const auto asked = std::ranges::find(condition.set, "hmd.profile=recorded");
  if (asked == condition.set.end()) return condition;
  try {
    const std::vector<std::string> keys = scene::recorded_display(trial.events);
    condition.set.insert(condition.set.erase(asked), keys.begin(), keys.end());
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--set: {}", error.what()));
  }
  return condition;
}

/// Simulates every throw separately, under the trial's condition and the other one.
void replay_each_throw(const ReplayOptions& options) {
  if (options.output || options.verify || options.from_s) {
    throw UsageError(
        "--each-throw excludes -o, --verify and --from: separate throws are not one session");
  }
  scene::Recorded recorded = scene::load_trial(options.trial, microseconds(options.longest_gap));
  const scene::TrialSummary& trial = recorded.file.summary();
  scene::Scenario other = recorded.scenario;
  apply_condition(options.condition, other);
  scene::Session session = scene::make_session(recorded.scenario);
  const std::int64_t ticks = recorded.ticks();
  scene::EachThrow each = each_throw_of(session, other);
  ProgressLine progress("ticks", ticks);
  const std::vector<scene::Observer*> observers = {&each, &progress};
  scene::TrialPlayer source(recorded.file);
  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  each.finish();
  say_what_is_missing("replay", options.trial, trial);
  const nlohmann::json result = {
      {"trial", options.trial},
      {"scenario_differences", scene::to_json(scene::differences(recorded.scenario, other))},
      {"each_throw", scene::to_json(each.throws())}};
  if (options.json) return print_json(result);
  fmt::print("{:<8}{:<10}{:<14}{:<12}{:<12}{}\n", "throw", "version", "let go [s]", "recorded",
             "as it was", "other condition");
  for (const nlohmann::json& one : result["each_throw"]) {
    const std::string name = one["name"];
    fmt::print("{:<8}{:<10}{:<14.3f}{:<12}{:<12}{}\n", one["throw"].get<int>(),
               name.empty() ? "-" : name, one["time_s"].get<double>(),
               one["felled"].is_null() ? "-" : one["felled"].dump(),
               count_in_words(one["as_it_was"]), count_in_words(one["other_condition"]));
  }
}

/// A replay: its session, and what has been seen of it.
struct Run {
  scene::Session session;
  std::unique_ptr<scene::TrialPlayer> source;
  scene::Stopwatch stopwatch{};
  scene::Totals totals{};
  ThrowEvents happened{};
  Time begun{};  ///< time from which it is simulated
};

void simulate(Run& run, std::vector<scene::Observer*> observers,
              const std::function<bool(const scene::Session&)>& over) {
  observers.insert(observers.begin(), {&run.stopwatch, &run.totals, &run.happened});
  scene::run(run.session, *run.source, run.stopwatch, observers, [&](const scene::Session& s) {
    check_stop();
    return over(s);
  });
}

/// Enters the trial at the time of `--from`: as recorded up to its last snapshot, simulated as it was
/// from there, and under the other condition from then on.
void enter(const ReplayOptions& options, const scene::Recorded& recorded,
           const scene::Scenario& other, Run& run) {
  const Time from = microseconds(*options.from_s);
  const std::int64_t rate_hz = recorded.scenario.rates.physics_hz;
  const Time end = tick_time(recorded.ticks(), rate_hz);
  if (from > end) {
    throw UsageError(fmt::format("--from {:g}: expected a time of the trial, at most {:g} s",
                                 *options.from_s, seconds(end)));
  }
  scene::Entered entered = scene::enter(recorded, from, {.states = options.verify});
  run.session = std::move(entered.session);
  run.source = std::move(entered.source);
  run.begun = run.session.now();
  for (const scene::Event& event : recorded.file.summary().events) {
    if (event.tick < 0 || event.tick > run.session.tick) continue;
    run.totals.add(event, recorded.scenario);
    run.happened.add(event);
  }
  simulate(run, {}, [&](const scene::Session& s) { return s.next_tick() > from; });
  try {
    run.session = scene::under_from_now_on(std::move(run.session), recorded.scenario, other);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--from: {}", error.what()));
  }
}

nlohmann::json result_of(const ReplayOptions& options, const scene::Recorded& recorded,
                         const scene::Scenario& other, const Run& run) {
  nlohmann::json result = scene::summary(run.session, run.totals.score_at_end(run.session));
  result.update(scene::whose(options.trial, recorded.file.summary(), options.condition.set));
  result["output"] = options.output ? nlohmann::json(*options.output) : nlohmann::json();
  const bool same = scene::differences(recorded.scenario, other).empty();
  result.update(scene::compared_throws(recorded.file, recorded.scenario, same, run.happened.events,
                                       [] { check_stop(); }));
  const std::string why = run.totals.why_nothing_fell();
  if (!why.empty()) result["why_nothing_fell"] = why;
  if (options.from_s) {
    result["from_s"] = *options.from_s;
    result["simulated_from_s"] = seconds(run.begun);
  }
  result["realtime_factor"] = seconds(run.session.now() - run.begun) / run.stopwatch.spent_s();
  return result;
}

void print_result(const nlohmann::json& result, const std::vector<scene::Event>& events) {
  print_summary(result);
  if (result.contains("from_s")) {
    fmt::print("{:<18}{:g} s, entered at {:g} s\n", "from", result["from_s"].get<double>(),
               result["simulated_from_s"].get<double>());
  }
  if (result.contains("why_nothing_fell")) {
    fmt::print("{:<18}{}\n", "nothing fell", result["why_nothing_fell"].get<std::string>());
  }
  print_releases(events);
  print_throws(result);
  if (result.contains("verified_ticks")) {
    const auto unverified = result["unverified_ticks"].get<std::int64_t>();
    fmt::print("{:<18}{} ticks equal the recording{}\n", "verified",
               result["verified_ticks"].dump(),
               unverified > 0 ? fmt::format(", {} are not in it", unverified) : "");
  }
}

void replay(const ReplayOptions& options) {
  watch_stop_signals();  // before the first output exists
  if (options.each_throw) return replay_each_throw(options);
  if (options.from_s && options.output) {
    throw UsageError("--from excludes -o: a trial starts at its first tick");
  }
  const scene::Recorded recorded =
      scene::load_trial(options.trial, microseconds(options.longest_gap));
  const scene::TrialSummary& trial = recorded.file.summary();
  scene::Scenario other = recorded.scenario;
  apply_condition(with_display(options.condition, trial), other);
  Run run;
  if (options.from_s) {
    enter(options, recorded, other, run);
  } else {
    run.session = scene::make_session(other);
    run.source = std::make_unique<scene::TrialPlayer>(
        recorded.file, scene::TrialPlayer::Beside{.states = options.verify});
  }
  const std::int64_t ticks = recorded.ticks(other.rates.physics_hz);
  ProgressLine progress("ticks", ticks);
  std::optional<scene::TrialWriter> writer;
  std::optional<scene::Notes> notes;
  std::optional<scene::Verifier> verifier;
  std::vector<scene::Observer*> observers;
  if (options.output) {
    base::OutputFile file(
        *options.output,
        {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
    writer.emplace(std::make_unique<scene::Recorder>(
        std::move(file), scene::header_of(trial.header, run.session),
        scene::Recorder::Options{.states = options.states}));
    observers.push_back(&notes.emplace(trial, *writer));
    observers.push_back(&*writer);
  }
  if (options.verify) {
    observers.push_back(&verifier.emplace(options.trial, *run.source, run.session));
  }
  observers.push_back(&progress);
  simulate(run, observers, [&](const scene::Session& s) { return s.tick >= ticks; });
  if (notes) notes->finish(run.session);
  if (writer) writer->close(run.session);
  say_what_is_missing("replay", options.trial, trial);
  const std::int64_t unverified = verifier ? verifier->finish(trial, run.session) : 0;
  nlohmann::json result = result_of(options, recorded, other, run);
  if (verifier) {
    result["verified_ticks"] = verifier->compared();
    result["unverified_ticks"] = unverified;
  }
  if (options.json) return print_json(result);
  print_result(result, run.happened.events);
  if (writer) fmt::print("{:<18}{}\n", "written", *options.output);
}

}  // namespace

void add_replay(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      app.add_subcommand("replay", "Simulate a trial again from its device samples");
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog); - is standard input")
      ->required();
  add_output(*command, "-o,--output", options->output,
             "file for the new trial with its states and events (.lcmlog); - is standard output",
             {".lcmlog"});
  add_states(*command, options->states);
  command->add_flag("--verify", options->verify, "compare every tick with the states in the trial");
  command
      ->add_option("--from", options->from_s,
                   "start at this time [s], as the session was then, from the last snapshot in the "
                   "trial; another condition holds from then on")
      ->check(number_from(0.0, 1e9));
  command->add_flag("--each-throw", options->each_throw,
                    "simulate every recorded throw separately, from its state at the release; "
                    "under another condition each throw then has exactly one counterpart");
  add_force(*command, options->force);
  add_longest_gap(*command, options->longest_gap);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Example:\n  headpin replay assets/trials/demo.lcmlog -o smooth.lcmlog --friction 0 "
      "--elasticity 1\n"
      "  headpin replay assets/trials/demo.lcmlog --each-throw --friction 0");
  command->callback([options] { replay(*options); });
}

}  // namespace headpin::apps
