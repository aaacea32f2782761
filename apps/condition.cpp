#include "apps/condition.h"

#include <initializer_list>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/options.h"
#include "engine/response.h"

namespace headpin::apps {

namespace {

using scene::Detection;
using scene::SkittleShape;

/// Adds an option for one of these values, by its name.
template <scene::Choice T>
CLI::Option* add_choice(CLI::App& command, const std::string& option, std::optional<T>& value,
                        std::initializer_list<T> values, const std::string& text) {
  std::vector<std::string> names;
  for (const T one : values) names.emplace_back(scene::name_of(one));
  const auto take = [&value](const std::string& name) { value = scene::value_named<T>(name); };
  return command.add_option_function<std::string>(option, take, text)->check(one_of(names));
}

}  // namespace

CLI::Option* add_look(CLI::App& command, std::optional<std::string>& value) {
  std::string looks = "rendering quality of the pictures:";
  std::vector<std::string> names;
  for (const render::Look& look : render::looks()) {
    looks += fmt::format("\n{}: {}", look.name, look.meaning);
    names.emplace_back(look.name);
  }
  return command.add_option("--look", value, looks)->check(one_of(names));
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
  add_choice(command, "--shape", condition.shape, {SkittleShape::ellipsoid, SkittleShape::parts},
             "collision shape of the skittles: ellipsoid or true")
      ->group(group);
  std::string laws = "collision response; what each one conserves:";
  std::vector<std::string> names;
  for (const engine::Response& response : engine::responses()) {
    laws += fmt::format("\n{}: {}", response.name, response.keeps);
    names.emplace_back(response.name);
  }
  command.add_option("--response", condition.response, laws)->check(one_of(names))->group(group);
  add_choice(command, "--detection", condition.detection, {Detection::converged, Detection::paper},
             "collision detection: converged, or with the paper's cap on iterations")
      ->group(group);
  command
      .add_option("--iterations", condition.iterations,
                  "cap on the iterations of a detection query, 5 to 20")
      ->check(whole_number_from(5, 20))
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

void apply_condition(Condition condition, scene::Scenario& scenario) {
  condition.option = "--set ";
  try {
    scene::apply(condition, scenario);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace headpin::apps
