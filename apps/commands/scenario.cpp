#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/streams.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/seen_mesh.h"
#include "scene/stage/stage.h"

namespace headpin::apps {
namespace {

struct ScenarioOptions {
  std::string action, scenario;
  bool json = false;
};

/// Measures of a scenario.
struct Measures {
  std::string name;  ///< in the scenario itself
  std::size_t skittles = 0;
  std::size_t primitives = 0;  ///< of a skittle
  double skittle_m = 0.0, skittle_kg = 0.0;
  double ball_m = 0.0, ball_kg = 0.0;  ///< across
  double lane_m = 0.0;                 ///< foul line to head pin
  std::vector<std::string> not_drawn;  ///< of its mesh files
};

/// @throws std::invalid_argument  if its values are not possible
Measures measure(const std::string& name_or_file) {
  const scene::Scenario s = scene::load_scenario(name_or_file);
  const scene::Stage stage = scene::make_stage(s);
  return {.name = s.name,
          .skittles = stage.skittles.size(),
          .primitives = stage.skittle.shape->parts.size(),
          .skittle_m = s.skittle.height,
          .skittle_kg = s.skittle.mass,
          .ball_m = 2.0 * s.ball.radius,
          .ball_kg = s.ball.mass,
          .lane_m = s.lane.head_pin,
          .not_drawn = scene::not_drawn(s)};
}

std::string in_words(const Measures& m) {
  return fmt::format(
      "{} skittles of {} primitive{} ({:.3f} m, {:.3f} kg), ball {:.3f} m across ({:.2f} kg), "
      "{:.2f} m from the foul line",
      m.skittles, m.primitives, m.primitives == 1 ? "" : "s", m.skittle_m, m.skittle_kg, m.ball_m,
      m.ball_kg, m.lane_m);
}

nlohmann::ordered_json in_json(const std::string& file, const Measures& m) {
  return {{"scenario", m.name},          {"file", file},
          {"skittles", m.skittles},      {"primitives", m.primitives},
          {"height_m", m.skittle_m},     {"mass_kg", m.skittle_kg},
          {"ball_diameter_m", m.ball_m}, {"ball_mass_kg", m.ball_kg},
          {"lane_m", m.lane_m},          {"not_drawn", m.not_drawn}};
}

void list(bool json) {
  const std::vector<std::string> names = scene::scenario_names();
  if (names.empty()) {
    throw std::runtime_error("no scenarios in share/headpin/scenarios beside the program");
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& name : names) {
    const Measures m = measure(name);
    if (json) {
      all.push_back(in_json(scene::scenario_path(name), m));
    } else {
      fmt::print("{:<20}{}\n", name, in_words(m));
    }
  }
  if (json) print_json({{"scenarios", all}});
}

void tell_scenarios(const ScenarioOptions& options) {
  if ((options.action == "list") != options.scenario.empty()) {
    throw UsageError(options.action == "list"
                         ? "scenario list: expected no further argument"
                         : fmt::format("scenario {0}: expected a name or file: scenario {0} FILE",
                                       options.action));
  }
  if (options.action == "list") return list(options.json);
  if (options.action == "show") {
    if (options.json) throw UsageError("scenario show: it prints TOML; expected no --json");
    fmt::print("{}", scene::to_toml(scene::load_scenario(options.scenario)));
    return;
  }
  const Measures m = measure(options.scenario);
  if (options.json) return print_json(in_json(scene::scenario_path(options.scenario), m));
  fmt::print("{}: {}\n", m.name, in_words(m));
  for (const std::string& one : m.not_drawn) fmt::print("{}\n", printable(one));
}

}  // namespace

void add_scenario(CLI::App& app) {
  auto options = std::make_shared<ScenarioOptions>();
  CLI::App* command =
      app.add_subcommand("scenario", "List, show and check scenarios: rooms, skittles, rules");
  command
      ->add_option("ACTION", options->action,
                   "list: list the bundled scenarios; show: print all keys of a scenario with "
                   "their meanings; check: check the values of a scenario")
      ->required()
      ->check(one_of({"list", "show", "check"}));
  command->add_option("SCENARIO", options->scenario, "name of a bundled scenario or a TOML file");
  add_json(*command, options->json);
  command->footer(
      "Error messages have the file, the line and the key.\n\n"
      "Examples:\n  headpin scenario list\n  headpin scenario show german-ninepins > own.toml\n"
      "  headpin scenario check own.toml");
  command->callback([options] { tell_scenarios(*options); });
}

}  // namespace headpin::apps
