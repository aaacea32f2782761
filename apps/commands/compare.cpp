#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/options.h"
#include "apps/recorded_world.h"
#include "apps/streams.h"
#include "apps/wrap.h"
#include "scene/play/game_hash.h"
#include "scene/play/score.h"
#include "scene/record/file.h"
#include "scene/record/first_difference.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/totals.h"

namespace headpin::apps {

namespace {

struct CompareOptions {
  std::string a, b;
  bool json = false;
};

/// One of the compared trials.
struct Side {
  std::string path;
  scene::TrialFile file;
  scene::Scenario scenario;
};

Side load(const std::string& path) {
  scene::TrialFile file(path);
  file.require_trial(Time::max());
  scene::Scenario scenario = scene::scenario_of_trial(file.summary().header.scenario, path);
  if (file.summary().state_count == 0) {
    throw std::runtime_error(path + ": expected states to compare, found none; `headpin replay " +
                             path + " -o OUT.lcmlog` writes them");
  }
  return {path, std::move(file), std::move(scenario)};
}

/// @param other  the trial in which the throws of `side` are searched
nlohmann::json describe(const Side& side, const Side& other) {
  const scene::TrialSummary& trial = side.file.summary();
  const scene::Score score = scene::score(trial.events, side.scenario);
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  RecordedWorld world(side.scenario);
  std::int64_t contacts = 0;
  double highest = 0.0, last = 0.0;
  scene::TrialItems items(side.file);
  while (const std::optional<scene::TickState> state = items.next_state()) {
    contacts += state->contacts;
    last = world.energy(*state).all;
    highest = std::max(highest, last);
  }
  nlohmann::json all = scene::conditions(side.scenario);
  const std::optional<std::uint64_t> hash = scene::game_hash_of_states(side.file);
  all.update({{"trial", side.path},
              {"response", side.scenario.collision.response},
              {"ticks", trial.state_count},
              {"contacts", contacts},
              {"touches", score.touches},
              {"skittles_down", score.skittles_down},
              {"games", scene::to_json(score.games)},
              {"release_speed_mps", number(score.release_speed)},
              {"impact_speed_mps", number(score.impact_speed)},
              {"highest_energy_j", highest},
              {"final_energy_j", last},
              {"game_hash", hash ? nlohmann::json(scene::in_hex(*hash)) : nlohmann::json()},
              {"throw_count", scene::thrown(trial.events).size()},
              {"throws_without_counterpart", scene::to_json(scene::without_counterpart(
                                                 trial.events, other.file.summary().events))}});
  return all;
}

std::string cell(const nlohmann::json& value) {
  if (value.is_null()) return "-";
  if (value.is_object()) return cell(scene::in_short(value));
  if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// The same with every digit: of what was chosen, the last one may be the difference.
std::string whole_cell(const nlohmann::json& value) {
  if (value.is_object()) return whole_cell(scene::in_short(value));
  return value.is_number_float() ? fmt::format("{}", value.get<double>()) : cell(value);
}

/// One line of the comparison.
struct ComparedRow {
  std::string label, a, b;
};

/// Score sheets of both, game by game; empty if there was no game.
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

/// Elasticity, friction and shape of both; for each version if one of them has versions.
std::vector<ComparedRow> compared_conditions(const nlohmann::json& a, const nlohmann::json& b) {
  std::vector<ComparedRow> rows;
  const auto add = [&](const std::string& name, const nlohmann::json& of_a,
                       const nlohmann::json& of_b) {
    for (const char* key : {"elasticity", "friction", "shape"}) {
      rows.push_back({name + key, whole_cell(of_a[key]), whole_cell(of_b[key])});
    }
  };
  if (a["versions"].is_null() && b["versions"].is_null()) {
    add("", a, b);
    return rows;
  }
  for (const std::string name : {"red", "blue"}) {
    const auto version = [&](const nlohmann::json& side) {
      return side["versions"].is_null() ? side : side["versions"][name];
    };
    add(name + " ", version(a), version(b));
  }
  return rows;
}

/// Whether a key of the scenario is already in the rows of compared_conditions or of the response.
bool is_a_row_already(const std::string& key, bool versions) {
  if (key == "collision.response") return true;
  if (!versions) return key == "collision.shape" || key.starts_with("material.");
  for (const std::string version : {"version.red.", "version.blue."}) {
    for (const char* told : {"elasticity", "friction", "shape"}) {
      if (key == version + told) return true;
    }
  }
  return false;
}

/// Prints the throws of one side that the other side does not have.
void print_unpaired(const std::string& side, const nlohmann::json& result) {
  constexpr std::size_t kMost = 20;
  const nlohmann::json& unpaired = result["throws_without_counterpart"];
  if (unpaired.empty()) return;
  fmt::print("\n{} of {} throws of {} have no counterpart in the other:\n", unpaired.size(),
             result["throw_count"].dump(), side);
  for (std::size_t i = 0; i < std::min(kMost, unpaired.size()); ++i) {
    fmt::print("  {}\n", scene::unpaired_in_words(unpaired[i]));
  }
  if (unpaired.size() > kMost) fmt::print("  and {} more\n", unpaired.size() - kMost);
}

void print_differences(const nlohmann::json& result) {
  const nlohmann::json &only_in_a = result["bodies_only_in_a"],
                       &only_in_b = result["bodies_only_in_b"];
  for (const auto& [side, names] : {std::pair("a", &only_in_a), {"b", &only_in_b}}) {
    if (names->empty()) continue;
    fmt::print("other bodies      only {} has: {}\n", side,
               fmt::join(names->get<std::vector<std::string>>(), ", "));
  }
  if (result["first_difference_tick"].is_null()) {
    if (!only_in_a.empty() || !only_in_b.empty()) fmt::print("of the bodies that both have: ");
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
                                                      {"response", "response"},
                                                      {"ticks", "ticks"},
                                                      {"contact points", "contacts"},
                                                      {"pairs that touched", "touches"},
                                                      {"skittles down", "skittles_down"},
                                                      {"release [m/s]", "release_speed_mps"},
                                                      {"first skittle [m/s]", "impact_speed_mps"},
                                                      {"highest energy [J]", "highest_energy_j"},
                                                      {"final energy [J]", "final_energy_j"},
                                                      {"game hash", "game_hash"},
                                                      {"throws", "throw_count"}};
  const bool versions = !result["a"]["versions"].is_null() || !result["b"]["versions"].is_null();
  std::vector<ComparedRow> lines;
  for (const auto& [label, key] : rows) {
    lines.push_back({label, cell(result["a"][key]), cell(result["b"][key])});
    if (*label == '\0') {
      for (ComparedRow& row : compared_conditions(result["a"], result["b"])) {
        lines.push_back(std::move(row));
      }
    }
  }
  for (const nlohmann::json& key : result["scenario_differences"]) {
    if (is_a_row_already(key["key"], versions)) continue;
    lines.push_back({key["key"], in_a_line(key["a"]), in_a_line(key["b"])});
  }
  for (ComparedRow& row : compared_sheets(result["a"]["games"], result["b"]["games"])) {
    lines.push_back(std::move(row));
  }
  std::size_t wide = 26, wide_label = 18;
  for (const ComparedRow& row : lines) {
    wide = std::max(wide, row.a.size());
    wide_label = std::max(wide_label, row.label.size());
  }
  for (const ComparedRow& row : lines) {
    fmt::print("{:<{}}{:<{}}{}\n", row.label, wide_label + 2, row.a, wide + 2, row.b);
  }
  for (const char* side : {"a", "b"}) print_unpaired(side, result[side]);
}

void compare(const CompareOptions& options) {
  const Side a = load(options.a), b = load(options.b);
  for (const Side* side : {&a, &b}) {
    say_what_is_missing("compare", side->path, side->file.summary());
  }
  if (a.scenario.rates.physics_hz != b.scenario.rates.physics_hz) {
    say("headpin compare: ticks of one number are not of one time: {} has {} a second, {} has {}\n",
        printable(a.path), a.scenario.rates.physics_hz, printable(b.path),
        b.scenario.rates.physics_hz);
  }
  const scene::SharedBodies shared =
      scene::shared_bodies(a.file.summary().header.body_names, b.file.summary().header.body_names);
  nlohmann::json result = {
      {"a", describe(a, b)},
      {"b", describe(b, a)},
      {"scenario_differences", scene::to_json(scene::differences(a.scenario, b.scenario))},
      {"bodies_only_in_a", shared.only_in_a},
      {"bodies_only_in_b", shared.only_in_b},
      {"first_difference_tick", nullptr},
      {"first_difference_s", nullptr},
      {"first_difference_body", nullptr},
      {"first_difference_lacking", nullptr}};
  scene::TrialItems of_a(a.file), of_b(b.file);
  const auto difference =
      scene::compare([&] { return of_a.next_state(); }, [&] { return of_b.next_state(); }, shared);
  if (difference) {
    using Lacks = scene::FirstDifference::Lacks;
    result["first_difference_tick"] = difference->tick;
    result["first_difference_s"] = seconds(difference->time);
    result["first_difference_body"] = difference->body;
    if (difference->lacks == Lacks::a) result["first_difference_lacking"] = a.path;
    if (difference->lacks == Lacks::b) result["first_difference_lacking"] = b.path;
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
  CLI::App* command = app.add_subcommand("compare", "Compare two replayed trials tick by tick");
  command->add_option("TRIAL", options->a, "a trial with states (.lcmlog); - is standard input")
      ->required();
  command->add_option("OTHER", options->b, "the trial to compare it with")->required();
  add_json(*command, options->json);
  command->footer("Example:\n  headpin compare rough.lcmlog smooth.lcmlog");
  command->callback([options] { compare(*options); });
}

}  // namespace headpin::apps
