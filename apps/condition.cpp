#include "apps/condition.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/options.h"
#include "scene/stage/condition_fields.h"

namespace headpin::apps {

namespace {

/// A flag is given alone; "=true" and "=false" say the same in words.
const CLI::Validator kNoValue(
    [](const std::string& given) {
      const bool known = given == "true" || given == "false";
      return known ? std::string() : "expected no value, found " + given;
    },
    "");

/// Adds an option for each value.
struct ValueOptions {
  CLI::App& command;
  std::string group;

  void field(const std::string& name, std::optional<double>& value, const scene::Range& allowed,
             const std::string& meaning) {
    add(command.add_option("--" + name, value, meaning), number_from(allowed.low, allowed.high));
  }
  void field(const std::string& name, std::optional<std::int64_t>& value,
             const scene::Range& allowed, const std::string& meaning) {
    add(command.add_option("--" + name, value, meaning),
        whole_number_from(std::llround(allowed.low), std::llround(allowed.high)));
  }
  void field(const std::string& name, std::optional<bool>& value, const scene::Range& /*any*/,
             const std::string& meaning) {
    // CLI11's flag of an optional is false, not nothing, when it is not given.
    const auto take = [&value](std::int64_t given) { value = given > 0; };
    command.add_flag_function("--" + name, take, meaning)->check(kNoValue)->group(group);
  }
  void field(const std::string& name, std::optional<std::string>& value,
             const scene::NameList& allowed, const std::string& meaning) {
    add(command.add_option("--" + name, value, meaning), one_of({allowed.begin(), allowed.end()}));
  }
  template <scene::Choice T>
  void field(const std::string& name, std::optional<T>& value, const scene::NameList& allowed,
             const std::string& meaning) {
    const auto take = [&value](const std::string& typed) { value = scene::value_named<T>(typed); };
    add(command.add_option_function<std::string>("--" + name, take, meaning),
        one_of({allowed.begin(), allowed.end()}));
  }

 private:
  void add(CLI::Option* option, const CLI::Validator& check) { option->check(check)->group(group); }
};

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
  ValueOptions options{command, group};
  scene::visit_values(options, condition);
  add_look(command, condition.look)->group(group);
  command
      .add_option("--set", condition.set,
                  "set any value of the scenario, KEY=VALUE; may be repeated")
      ->allow_extra_args(false)
      ->group(group);
}

namespace {

/// Refuses options of the paper's detection where none of it is used.
void expect_paper_detection(const Condition& condition, const scene::Scenario& scenario) {
  if (scene::has_paper_detection(scenario)) return;
  for (const auto& [given, option] : {std::pair{condition.iterations.has_value(), "--iterations"},
                                      {condition.warm.has_value(), "--warm"}}) {
    if (!given) continue;
    throw UsageError(fmt::format(
        "{}: expected --detection paper beside it; converged detection has no cap and no start",
        option));
  }
}

}  // namespace

void apply_condition(Condition condition, scene::Scenario& scenario) {
  condition.option = "--set ";
  try {
    scene::apply(condition, scenario);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  expect_paper_detection(condition, scenario);
}

}  // namespace headpin::apps
