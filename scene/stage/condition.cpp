#include "scene/stage/condition.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "render/data/quality.h"
#include "scene/scenario/toml_text.h"
#include "scene/stage/condition_fields.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {

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

/// Applies values that the assignments set for all objects to every version, because a version has
/// one elasticity and one friction for all objects.
///
/// @throws std::invalid_argument  if they set it for some objects only, which no version can have
void pass_on_materials(const std::vector<std::string>& assignments, Scenario& scenario) {
  std::map<std::string, std::set<std::string>> said;  // of what, about which objects
  for (const std::string& assignment : assignments) {
    const std::string key = key_of(assignment);
    if (!is_in(key, "material")) continue;
    const std::size_t last = key.rfind('.');
    if (std::count(key.begin(), key.end(), '.') != 2) {
      throw std::invalid_argument(
          fmt::format("{}: expected one value a time where the scenario has versions, such as "
                      "material.ball.friction=0.5",
                      key));
    }
    said[key.substr(last + 1)].insert(key.substr(0, last));
  }
  const auto pass_on = [&](const std::string& what, double Coefficients::*of, auto set_everywhere) {
    if (!said.contains(what)) return;
    const Materials& m = scenario.material;
    const bool alike =
        m.skittle.*of == m.ball.*of && m.ball.*of == m.lane.*of && m.lane.*of == m.wall.*of;
    if (said[what].size() < 4 || !alike) {
      throw std::invalid_argument(fmt::format(
          "{0}.{1}: the red and the blue version each have one {1} for all objects; say "
          "version.red.{1} and version.blue.{1}, or {1} for both",
          *said[what].begin(), what));
    }
    set_everywhere(scenario, m.ball.*of);
  };
  pass_on("elasticity", &Coefficients::elasticity,
          [](Scenario& s, double value) { set_elasticity(s, value); });
  pass_on("friction", &Coefficients::friction,
          [](Scenario& s, double value) { set_friction(s, value); });
}

/// Sets the values whose keys are wanted.
template <typename Wanted>
void set_under(const Condition& condition, Scenario& scenario, Wanted&& is_wanted) {
  std::vector<Assignment> wanted;
  for (const std::string& one : condition.set) {
    if (!is_wanted(one)) continue;
    wanted.push_back(
        {one, condition.where.empty() ? condition.option + brief(one) : condition.where});
  }
  set(scenario, wanted);
}

/// Versions have their own materials, shape and perhaps detection. Values for the scenario go to
/// each version; values for one version stay with it.
void pass_on_to_versions(const Condition& condition, Scenario& scenario) {
  if (!scenario.version.buttons) return;
  if (condition.elasticity) set_elasticity(scenario, *condition.elasticity);
  if (condition.friction) set_friction(scenario, *condition.friction);
  if (condition.shape) set_shape(scenario, *condition.shape);
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
    set_under(condition, scenario, [&](const std::string& one) { return one == assignment; });
    set_shape(scenario, scenario.collision.shape);
  }
  for (Version* version : {&scenario.version.red, &scenario.version.blue}) {
    if (detection) version->detection.reset();
    if (iterations) version->iterations = 0;
  }
  pass_on_materials(condition.set, scenario);
  set_under(condition, scenario,
            [](const std::string& one) { return is_in(key_of(one), "version"); });
}

struct ValueChecker {
  template <typename T, typename Allowed>
  void field(std::string_view name, const std::optional<T>& value, const Allowed& allowed,
             const std::string& /*meaning*/) {
    // What is a choice or a yes or no cannot be out of range.
    if constexpr (!Choice<T> && !std::is_same_v<T, bool>) {
      if (value) expect_value(name, *value, allowed);
    }
  }
};

}  // namespace

void apply(const Condition& condition, Scenario& scenario) {
  ValueChecker checker;
  visit_values(checker, condition);
  if (condition.elasticity) set_elasticity(scenario.material, *condition.elasticity);
  if (condition.friction) set_friction(scenario.material, *condition.friction);
  if (condition.shape) scenario.collision.shape = *condition.shape;
  if (condition.response) scenario.collision.response = *condition.response;
  if (condition.detection) scenario.collision.detection = *condition.detection;
  if (condition.iterations) scenario.collision.iterations = *condition.iterations;
  if (condition.warm) scenario.collision.warm = *condition.warm;
  for (const render::Look& look : render::looks()) {
    if (condition.look == look.name) scenario.look = look.quality;
  }
  set_under(condition, scenario, [](const std::string&) { return true; });
  pass_on_to_versions(condition, scenario);
}

bool has_paper_detection(const Scenario& scenario) {
  const Versions& versions = scenario.version;
  return scenario.collision.detection == Detection::paper ||
         versions.red.detection == Detection::paper || versions.blue.detection == Detection::paper;
}

}  // namespace headpin::scene
