#include "apps/condition.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "apps/options.h"
#include "engine/response.h"
#include "scene/stage/read_scenario.h"

namespace headpin::apps {

CLI::Option* add_look(CLI::App& command, std::optional<std::string>& value) {
  std::string looks = "rendering quality of the pictures:";
  std::vector<std::string> names;
  for (const render::Look& look : render::looks()) {
    looks += fmt::format("\n{}: {}", look.name, look.meaning);
    names.emplace_back(look.name);
  }
  return command.add_option("--look", value, looks)->check(CLI::IsMember(names));
}

void add_condition_options(CLI::App& command, Condition& condition) {
  const std::string group =
      "Condition (applies to every version of the game; options that are not given keep the values "
      "of the trial)";
  command
      .add_option("--elasticity", condition.elasticity,
                  "coefficient of restitution of every object (the paper: elasticity); two objects "
                  "in contact: the product")
      ->check(number_from(0, 1))
      ->group(group);
  command
      .add_option("--friction", condition.friction,
                  "friction of every object; two objects in contact: the product")
      ->check(number_from(0, 1))
      ->group(group);
  command
      .add_option("--shape", condition.shape, "collision shape of the skittles: ellipsoid or true")
      ->check(CLI::IsMember({"ellipsoid", "true"}))
      ->group(group);
  std::string laws = "collision response; what each one conserves:";
  std::vector<std::string> names;
  for (const engine::Response& response : engine::responses()) {
    laws += fmt::format("\n{}: {}", response.name, response.keeps);
    names.emplace_back(response.name);
  }
  command.add_option("--response", condition.response, laws)
      ->check(CLI::IsMember(names))
      ->group(group);
  command
      .add_option("--detection", condition.detection,
                  "collision detection: converged, or with the paper's cap on iterations")
      ->check(CLI::IsMember({"converged", "paper"}))
      ->group(group);
  command
      .add_option("--iterations", condition.iterations,
                  "cap on the iterations of a detection query, 5 to 20")
      ->check(CLI::Range(5, 20))
      ->group(group);
  command
      .add_flag("--warm", condition.warm,
                "warm start: each query of paper detection starts from the last normal (not in the "
                "paper)")
      ->group(group);
  add_look(command, condition.look)->group(group);
  command
      .add_option("--set", condition.set,
                  "set any value of the scenario, KEY=VALUE; may be repeated")
      ->allow_extra_args(false)
      ->group(group);
}

namespace {

/// "material.ball.friction" of "material.ball.friction = 0.5".
std::string key_of(const std::string& assignment) {
  std::string key = assignment.substr(0, assignment.find('='));
  std::erase(key, ' ');
  return key;
}

bool is_in(const std::string& key, const std::string& section) {
  return key == section || key.starts_with(section + ".");
}

void set_value(scene::Scenario& scenario, const std::string& assignment) {
  try {
    scene::set(scenario, assignment);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

/// What the assignments say of all objects goes to every version, as each of them has one
/// elasticity and one friction for all.
///
/// @throws UsageError  where they say it of some objects alone, which no version can have
void pass_on_materials(const std::vector<std::string>& assignments, scene::Scenario& scenario) {
  std::map<std::string, std::set<std::string>> said;  // of what, about which objects
  for (const std::string& assignment : assignments) {
    const std::string key = key_of(assignment);
    if (!is_in(key, "material")) continue;
    const std::size_t last = key.rfind('.');
    if (std::ranges::count(key, '.') != 2) {
      throw UsageError(fmt::format(
          "--set {}: expected one value a time where the scenario has versions, such as "
          "material.ball.friction=0.5",
          key));
    }
    said[key.substr(last + 1)].insert(key.substr(0, last));
  }
  const auto pass_on = [&](const std::string& what, double scene::Coefficients::*of,
                           auto set_everywhere) {
    if (!said.contains(what)) return;
    const scene::Materials& m = scenario.material;
    const bool alike =
        m.skittle.*of == m.ball.*of && m.ball.*of == m.lane.*of && m.lane.*of == m.wall.*of;
    if (said[what].size() < 4 || !alike) {
      throw UsageError(fmt::format(
          "--set {0}.{1}: the red and the blue version each have one {1} for all objects; say "
          "version.red.{1} and version.blue.{1}, or --{1} for both",
          *said[what].begin(), what));
    }
    set_everywhere(scenario, m.ball.*of);
  };
  using scene::Scenario;
  pass_on("elasticity", &scene::Coefficients::elasticity,
          [](Scenario& s, double value) { scene::set_elasticity(s, value); });
  pass_on("friction", &scene::Coefficients::friction,
          [](Scenario& s, double value) { scene::set_friction(s, value); });
}

/// Versions have materials, a shape and perhaps a detection of their own: what is said of the scenario's goes to each of
/// them, and what is said of a version stays that version's.
void pass_on_to_versions(const Condition& condition, scene::Scenario& scenario) {
  if (!scenario.version.buttons) return;
  if (condition.elasticity) scene::set_elasticity(scenario, *condition.elasticity);
  if (condition.friction) scene::set_friction(scenario, *condition.friction);
  if (condition.shape) scene::set_shape(scenario, *condition.shape);
  const auto is_of = [](const std::string& assignment, const std::string& what) {
    const std::string key = key_of(assignment);
    const bool whole_table = key == "collision" && assignment.find(what) != std::string::npos;
    return key == "collision." + what || whole_table;
  };
  bool detection = condition.detection.has_value(), iterations = condition.iterations.has_value();
  for (const std::string& assignment : condition.set) {
    detection |= is_of(assignment, "detection");
    iterations |= is_of(assignment, "iterations");
    if (!is_of(assignment, "shape")) continue;
    set_value(scenario, assignment);
    scene::set_shape(scenario, scenario.collision.shape);
  }
  for (scene::Version* version : {&scenario.version.red, &scenario.version.blue}) {
    if (detection) version->detection = "collision";
    if (iterations) version->iterations = 0;
  }
  pass_on_materials(condition.set, scenario);
  for (const std::string& assignment : condition.set) {
    if (is_in(key_of(assignment), "version")) set_value(scenario, assignment);
  }
}

}  // namespace

void apply(const Condition& condition, scene::Scenario& scenario) {
  if (condition.elasticity) scene::set_elasticity(scenario.material, *condition.elasticity);
  if (condition.friction) scene::set_friction(scenario.material, *condition.friction);
  if (condition.shape) scenario.collision.shape = *condition.shape;
  if (condition.response) scenario.collision.response = *condition.response;
  if (condition.detection) scenario.collision.detection = *condition.detection;
  if (condition.iterations) scenario.collision.iterations = *condition.iterations;
  if (condition.warm) scenario.collision.warm = *condition.warm;
  for (const render::Look& look : render::looks()) {
    if (condition.look == look.name) scenario.look = look.quality;
  }
  for (const std::string& assignment : condition.set) set_value(scenario, assignment);
  pass_on_to_versions(condition, scenario);
}

}  // namespace headpin::apps
