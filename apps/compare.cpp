#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/recorded_world.h"
#include "apps/streams.h"
#include "devices/trial_file.h"
#include "scene/score.h"
#include "scene/totals.h"
#include "scene/verifier.h"

namespace headpin::apps {

namespace {

struct CompareOptions {
  std::string a, b;
  bool json = false;
};

/// One trial as the comparison sees it.
struct Side {
  std::string path;
  devices::TrialFile file;
  scene::Scenario scenario;
};

Side load(const std::string& path) {
  devices::TrialFile file(path);
  file.require_trial(Time::max());
  scene::Scenario scenario = scene::scenario_of_trial(file.summary().header.scenario, path);
  if (file.summary().state_count == 0) {
    throw std::runtime_error(path + ": expected states to compare, found none; `headpin replay " +
                             path + " -o OUT.lcmlog` writes them");
  }
  return {path, std::move(file), std::move(scenario)};
}

struct FirstDifference {
  std::int64_t tick;
  double time_s;
  std::string body;
  std::string lacks;  ///< the trial that has no state of that tick, empty where both have one
};

/// The first tick whose bits differ, or that only one of the two has.
std::optional<FirstDifference> first_difference(const Side& a, const Side& b) {
  devices::TrialItems of_a(a.file), of_b(b.file);
  std::optional<devices::TickState> sa = of_a.next_state(), sb = of_b.next_state();
  while (sa && sb && sa->tick == sb->tick) {
    const auto body = scene::first_different_body(*sa, *sb, a.file.summary().header.body_names);
    if (body) return FirstDifference{sa->tick, seconds(sa->time), *body, ""};
    sa = of_a.next_state();
    sb = of_b.next_state();
  }
  if (!sa && !sb) return std::nullopt;
  const bool only_in_a = !sb || (sa && sa->tick < sb->tick);
  const devices::TickState& extra = only_in_a ? *sa : *sb;
  return FirstDifference{extra.tick, seconds(extra.time), "", only_in_a ? b.path : a.path};
}

nlohmann::json describe(const Side& side) {
  const devices::TrialSummary& trial = side.file.summary();
  const scene::Score score = scene::score(trial.events);
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  RecordedWorld world(side.scenario);
  std::int64_t contacts = 0;
  double highest = 0.0, last = 0.0;
  devices::TrialItems items(side.file);
  while (const std::optional<devices::TickState> state = items.next_state()) {
    contacts += state->contacts;
    last = world.energy(*state).all;
    highest = std::max(highest, last);
  }
  return {
      {"trial", side.path},
      {"elasticity", scene::per_object(side.scenario.material, &scene::Coefficients::elasticity)},
      {"friction", scene::per_object(side.scenario.material, &scene::Coefficients::friction)},
      {"shape", side.scenario.collision.shape},
      {"response", side.scenario.collision.response},
      {"ticks", trial.state_count},
      {"contacts", contacts},
      {"touches", score.touches},
      {"skittles_down", score.skittles_down},
      {"games", scene::to_json(score.games)},
      {"release_speed_mps", number(score.release_speed)},
      {"impact_speed_mps", number(score.impact_speed)},
      {"highest_energy_j", highest},
      {"final_energy_j", last}};
}

std::string cell(const nlohmann::json& value) {
  if (value.is_null()) return "-";
  if (value.is_object()) return cell(scene::in_short(value));
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// One line of the comparison.
struct ComparedRow {
  std::string label, a, b;
};

/// Score sheets of both, game by game; none where neither played one.
std::vector<ComparedRow> compared_sheets(const nlohmann::json& a, const nlohmann::json& b) {
  std::vector<ComparedRow> rows;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const auto sheet = [&](const nlohmann::json& games) {
      return i < games.size() ? games[i]["sheet"].get<std::string>() : std::string("-");
    };
    rows.push_back({fmt::format("score sheet {}", i + 1), sheet(a), sheet(b)});
  }
  return rows;
}

void print_differences(const nlohmann::json& result) {
  if (result["first_difference_tick"].is_null()) {
    fmt::print("equal to the bit, {} ticks\n\n", result["a"]["ticks"].dump());
  } else {
    const std::string body = cell(result["first_difference_body"]);
    const nlohmann::json& lacks = result["first_difference_lacking"];
    fmt::print("first difference  tick {} ({} s){}\n\n", result["first_difference_tick"].dump(),
               cell(result["first_difference_s"]),
               !lacks.is_null() ? ", which " + printable(cell(lacks)) + " has not"
               : body.empty()   ? ""
                                : ", " + body);
  }
  const std::pair<const char*, const char*> rows[] = {{"", "trial"},
                                                      {"elasticity", "elasticity"},
                                                      {"friction", "friction"},
                                                      {"shape", "shape"},
                                                      {"response", "response"},
                                                      {"ticks", "ticks"},
                                                      {"contact points", "contacts"},
                                                      {"pairs that touched", "touches"},
                                                      {"skittles down", "skittles_down"},
                                                      {"release [m/s]", "release_speed_mps"},
                                                      {"first skittle [m/s]", "impact_speed_mps"},
                                                      {"highest energy [J]", "highest_energy_j"},
                                                      {"final energy [J]", "final_energy_j"}};
  std::vector<ComparedRow> lines;
  for (const auto& [label, key] : rows) {
    lines.push_back({label, cell(result["a"][key]), cell(result["b"][key])});
  }
  for (ComparedRow& row : compared_sheets(result["a"]["games"], result["b"]["games"])) {
    lines.push_back(std::move(row));
  }
  std::size_t wide = 26;
  for (const ComparedRow& row : lines) wide = std::max(wide, row.a.size());
  for (const ComparedRow& row : lines) {
    fmt::print("{:<20}{:<{}}{}\n", row.label, row.a, wide + 2, row.b);
  }
}

void compare(const CompareOptions& options) {
  const Side a = load(options.a), b = load(options.b);
  for (const Side* side : {&a, &b}) {
    say_what_is_missing("compare", side->path, side->file.summary());
  }
  nlohmann::json result = {{"a", describe(a)},
                           {"b", describe(b)},
                           {"first_difference_tick", nullptr},
                           {"first_difference_s", nullptr},
                           {"first_difference_body", nullptr},
                           {"first_difference_lacking", nullptr}};
  if (const auto difference = first_difference(a, b)) {
    result["first_difference_tick"] = difference->tick;
    result["first_difference_s"] = difference->time_s;
    result["first_difference_body"] = difference->body;
    if (!difference->lacks.empty()) result["first_difference_lacking"] = difference->lacks;
  }
  if (options.json) {
    print_json(result);
  } else {
    print_differences(result);
  }
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare", "Hold two replayed trials against each other, tick by tick");
  command->add_option("a", options->a, "a trial with states")->required();
  command->add_option("b", options->b, "another")->required();
  add_json(*command, options->json);
  command->footer("Example:\n  headpin compare rough.lcmlog smooth.lcmlog");
  command->callback([options] { compare(*options); });
}

}  // namespace headpin::apps
