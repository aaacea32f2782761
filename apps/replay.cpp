#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/condition.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/simulate.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/log.h"
#include "devices/version.h"

namespace headpin::apps {

namespace {

struct Options {
  std::string trial;
  std::optional<std::string> output;
  Condition condition;
  bool verify = false, force = false, json = false;
};

/// Energy that each phase of the steps has added [J]; together the change of the whole.
nlohmann::json ledger(const engine::World& world) {
  const engine::Ledger& l = world.ledger;
  return {{"gravity_j", l.gravity.energy},
          {"hand_j", l.hand.energy},
          {"impact_j", l.impact.energy},
          {"sustained_j", l.sustained.energy},
          {"correction_j", l.correction.energy}};
}

/// Caps, counts and residuals of all steps.
nlohmann::json counts(const engine::Statistics& s) {
  return {{"pairs", s.pairs},
          {"contacts", s.contacts},
          {"queries", s.queries.queries},
          {"query_iterations", s.queries.iterations},
          {"capped_queries", s.queries.capped},
          {"impacts", s.impacts},
          {"impact_sweeps", s.impact_sweeps},
          {"unfinished_impacts", s.unfinished_impacts},
          {"pulling_impulses", s.pulls},
          {"solver_iterations", s.solver_iterations},
          {"unsolved_islands", s.unsolved},
          {"largest_residual_mps", s.residual},
          {"deepest_overlap_m", s.deepest_overlap}};
}

/// What a replay comes to, as `--json` prints it.
nlohmann::json summary(const scene::Session& s, double wall_s) {
  const scene::Scenario& scenario = s.scenario;
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  const double simulated_s = seconds(s.now());
  return {{"version", devices::software_version()},
          {"elasticity", common_value(scenario.material, &scene::Material::elasticity)},
          {"friction", common_value(scenario.material, &scene::Material::friction)},
          {"shape", scenario.collision.shape},
          {"response", scenario.collision.response},
          {"detection", scenario.collision.detection},
          {"skittles", s.score.down.size()},
          {"skittles_down", s.score.skittles_down()},
          {"release_speed_mps", number(s.score.release_speed)},
          {"impact_speed_mps", number(s.score.impact_speed)},
          {"simulated_s", simulated_s},
          {"realtime_factor", simulated_s / wall_s},
          {"ticks", s.world.tick},
          {"ledger", ledger(s.world)},
          {"statistics", counts(s.statistics)},
          {"state_hash", fmt::format("{:016x}", engine::state_hash(s.world))}};
}

std::string readable(const nlohmann::json& value, const char* unit) {
  if (value.is_null()) return "-";
  if (value.is_number_float()) return fmt::format("{:.3g}{}", value.get<double>(), unit);
  if (value.is_string()) return value.get<std::string>() + unit;
  return value.dump() + unit;
}

void print(const nlohmann::json& s) {
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
  fmt::print("{:<18}{} of {}\n", "skittles down", s["skittles_down"].dump(), s["skittles"].dump());
  line("simulated", "simulated_s", " s");
  line("times real time", "realtime_factor");
  line("state hash", "state_hash");
}

void run(const Options& options) {
  LoadedTrial loaded = load_trial(options.trial);
  apply(options.condition, loaded.scenario);
  scene::Session session = scene::make_session(loaded.scenario);

  std::unique_ptr<devices::Recorder> recorder;
  if (options.output) {
    devices::TrialHeader header = loaded.trial.header;
    header.scenario = scene::to_toml(loaded.scenario);
    header.body_names = scene::body_names(session);
    recorder = std::make_unique<devices::Recorder>(
        *options.output, header,
        devices::Recorder::Options{.overwrite = options.force, .inputs = {options.trial}});
    for (const devices::Event& event : loaded.trial.events) {
      if (event.tick < 0) recorder->write(event);  // what was found before any simulation
    }
  }
  std::optional<Verifier> verifier;
  if (options.verify) verifier.emplace(loaded.trial, session);
  watch_stop_signals();

  Progress progress("ticks", tick_count(loaded.trial, loaded.scenario));
  devices::TickState state;
  std::chrono::steady_clock::duration spent{};  // in the simulation alone
  auto start = std::chrono::steady_clock::now();
  simulate(session, loaded.trial, [&](const scene::Session& s) {
    spent += std::chrono::steady_clock::now() - start;
    if (recorder || verifier) scene::tick_state(s, state);
    if (recorder) {
      for (const devices::Sample& sample : s.samples) recorder->write(sample);
      for (const devices::Event& event : s.events) recorder->write(event);
      recorder->write(state);
    }
    if (verifier) verifier->compare(state);
    progress.show(s.world.tick);
    check_stop();
    start = std::chrono::steady_clock::now();
  });
  if (recorder) {
    recorder->write(devices::Event{.time = session.now(),
                                   .tick = session.world.tick,
                                   .kind = "ledger",
                                   .bodies = {},
                                   .detail = ledger(session.world).dump()});
    recorder->close();
  }

  nlohmann::json result = summary(session, std::chrono::duration<double>(spent).count());
  if (verifier) result["verified_ticks"] = verifier->compared();
  if (options.json) {
    print_json(result);
  } else {
    print(result);
    if (verifier)
      fmt::print("{:<18}{} ticks equal the recording\n", "verified", verifier->compared());
    if (recorder) fmt::print("{:<18}{}\n", "written", *options.output);
  }
}

}  // namespace

void add_replay(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("replay", "Simulate a trial again from its device samples");
  command->add_option("trial", options->trial, "a trial (.lcmlog)")->required();
  add_output(*command, "-o,--output", options->output,
             "write the new trial, states and events in it; - is standard output");
  command->add_flag("--verify", options->verify, "compare every tick with the trial's own states");
  add_force(*command, options->force);
  add_json(*command, options->json);
  add_condition_options(*command, options->condition);
  command->footer(
      "Example:\n  headpin replay assets/trials/demo.lcmlog -o smooth.lcmlog --friction 0 "
      "--elasticity 1");
  command->callback([options] { run(*options); });
}

}  // namespace headpin::apps
