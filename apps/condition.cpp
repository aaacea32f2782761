#include "apps/condition.h"

#include <fmt/format.h>

#include "apps/options.h"
#include "engine/response.h"

namespace headpin::apps {

CLI::Option* add_look(CLI::App& command, std::optional<std::string>& value) {
  std::string looks = "what is spent on a picture:";
  std::vector<std::string> names;
  for (const render::Look& look : render::looks()) {
    looks += fmt::format("\n{}: {}", look.name, look.meaning);
    names.emplace_back(look.name);
  }
  return command.add_option("--look", value, looks)->check(CLI::IsMember(names));
}

void add_condition_options(CLI::App& command, Condition& condition) {
  const std::string group = "Condition (what is not given stays as the trial has it)";
  command.add_option("--elasticity", condition.elasticity, "of every object; pairs multiply")
      ->check(number_from(0, 1))
      ->group(group);
  command.add_option("--friction", condition.friction, "of every object; pairs multiply")
      ->check(number_from(0, 1))
      ->group(group);
  command.add_option("--shape", condition.shape, "what skittles collide as: ellipsoid or true")
      ->check(CLI::IsMember({"ellipsoid", "true"}))
      ->group(group);
  std::string laws = "impulses of a collision; what is kept:";
  std::vector<std::string> names;
  for (const engine::Response& response : engine::responses()) {
    laws += fmt::format("\n{}: {}", response.name, response.keeps);
    names.emplace_back(response.name);
  }
  command.add_option("--response", condition.response, laws)
      ->check(CLI::IsMember(names))
      ->group(group);
  command.add_option("--detection", condition.detection, "converged or paper")
      ->check(CLI::IsMember({"converged", "paper"}))
      ->group(group);
  command.add_option("--iterations", condition.iterations, "cap of a detection query, 5 to 20")
      ->check(CLI::Range(5, 20))
      ->group(group);
  command
      .add_flag("--warm", condition.warm,
                "paper detection starts from the last normal (ours; in 1997 it did not)")
      ->group(group);
  add_look(command, condition.look)->group(group);
  command
      .add_option("--set", condition.set, "any value of the scenario, KEY=VALUE; may be repeated")
      ->allow_extra_args(false)
      ->group(group);
}

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
  for (const std::string& assignment : condition.set) {
    try {
      scene::set(scenario, assignment);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }
}

}  // namespace headpin::apps
