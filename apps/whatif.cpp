#include "apps/whatif.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/damage.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "scene/play/score.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

namespace {

constexpr std::size_t kMostReleases = 1'000'000;

/// "-4:4:17": 17 values at equal distances; "0": one value.
std::vector<double> axis_of(const char* option, const std::string& text, double least,
                            double most) {
  const auto refuse = [&] {
    throw UsageError(fmt::format(
        "{}: expected FROM:TO:STEPS or one number, from {} to {} and 1 to 1000 steps, found '{}'",
        option, least, most, text));
  };
  const auto number = [&](const std::string& part) {
    double value = 0.0;
    const char* const end = part.data() + part.size();
    if (std::from_chars(part.data(), end, value).ptr != end || part.empty()) refuse();
    if (!(value >= least && value <= most)) refuse();
    return value;
  };
  const std::size_t first = text.find(':');
  if (first == std::string::npos) return {number(text)};
  const std::size_t second = text.find(':', first + 1);
  if (second == std::string::npos) refuse();
  const double from = number(text.substr(0, first));
  const double to = number(text.substr(first + 1, second - first - 1));
  int steps = 0;
  const char* const end = text.data() + text.size();
  const bool whole = std::from_chars(text.data() + second + 1, end, steps).ptr == end;
  if (!whole || steps < 1 || steps > 1000 || from > to || (steps > 1 && from == to)) refuse();
  return sweep::evenly(from, to, steps);
}

sweep::ReleaseGrid grid_of(const WhatIfQuestion& question) {
  sweep::ReleaseGrid grid;
  grid.speed = axis_of("--speed", question.speed, 0.1, 10.0);
  grid.direction_deg = axis_of("--direction", question.direction, -180.0, 180.0);
  grid.height = axis_of("--height", question.height, -2.0, 2.0);
  grid.spin = axis_of("--spin", question.spin.value_or(WhatIfQuestion::kSpin), -1000.0, 1000.0);
  grid.boards = axis_of("--board", question.board, -scene::kBoards, scene::kBoards);
  grid.revs = axis_of("--revs", question.revs, 0.0, 100.0);
  grid.rotation_deg = axis_of("--rotation", question.rotation, -180.0, 180.0);
  if (grid.size() > kMostReleases) {
    throw UsageError(
        fmt::format("--speed, --direction, --height, --spin, --board, --revs, --rotation: expected "
                    "at most {} releases, found {}",
                    kMostReleases, grid.size()));
  }
  return grid;
}

/// The throws of a trial, replayed under a scenario.
std::vector<sweep::Situation> throws_under(const scene::Scenario& scenario,
                                           const scene::Recorded& recorded,
                                           const WhatIfQuestion& question) {
  scene::Session session = scene::make_session(scenario);
  session.hashes = false;
  const std::int64_t ticks = recorded.ticks(scenario.rates.physics_hz);
  sweep::Situations situations(microseconds(1e-3 * question.within_ms));
  ProgressLine progress("ticks", ticks);
  const std::vector<scene::Observer*> observers = {&situations, &progress};
  scene::TrialPlayer source(recorded.file);
  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  return situations.all();
}

/// A throw of a trial under the condition.
struct NumberedThrow {
  int number = 0;  ///< among the recorded throws, from 1
  sweep::Situation situation;
};

struct ThrowsOfTrial {
  std::size_t recorded = 0;        ///< their number
  std::vector<NumberedThrow> all;  ///< those that are also thrown under the condition
};

/// The throws of a trial under the condition. Some may be lost, because no ball is within reach then.
/// The trigger tells which is which.
ThrowsOfTrial throws_of(const std::string& path, const WhatIfQuestion& question,
                        std::string_view command) {
  const scene::Recorded recorded = scene::load_trial(path, microseconds(question.longest_gap));
  if (!command.empty()) say_what_is_missing(command, path, recorded.file.summary());
  std::vector<sweep::Situation> own = throws_under(recorded.scenario, recorded, question);
  ThrowsOfTrial throws{.recorded = own.size(), .all = {}};
  if (question.condition == Condition{}) {
    for (sweep::Situation& one : own) {
      throws.all.push_back({static_cast<int>(throws.all.size()) + 1, std::move(one)});
    }
    return throws;
  }
  scene::Scenario other = recorded.scenario;
  apply_condition(question.condition, other);
  for (sweep::Situation& one : throws_under(other, recorded, question)) {
    const auto same = std::ranges::find(own, one.trigger, &sweep::Situation::trigger);
    if (same == own.end()) continue;
    throws.all.push_back({static_cast<int>(same - own.begin()) + 1, std::move(one)});
  }
  return throws;
}

/// The throw that the question is about.
const sweep::Situation& asked_throw(const ThrowsOfTrial& throws, const WhatIfQuestion& question) {
  const std::string& trial = question.trials.front();
  if (throws.all.empty()) {
    throw std::runtime_error(trial +
                             ": has no throw; expected a trial in which a ball is released");
  }
  if (question.number < 1 || question.number > static_cast<int>(throws.recorded)) {
    throw UsageError(fmt::format("{}: expected a throw of {} from 1 to {}, found {}",
                                 question.option, trial, throws.recorded, question.number));
  }
  const auto found = std::ranges::find(throws.all, question.number, &NumberedThrow::number);
  if (found != throws.all.end()) return found->situation;
  throw std::runtime_error(
      fmt::format("{}: throw {} is lost under this condition: no ball is in the hand when it opens",
                  trial, question.number));
}

/// The added spin is about the direction of the throw, and a ball at rest has none.
void require_direction(const WhatIfQuestion& question, const sweep::Situation& situation,
                       sweep::ReleaseGrid& grid) {
  if (situation.before->stage->scenario.release.speed > 0.0) return;
  if (question.spin && std::ranges::any_of(grid.spin, [](double spin) { return spin != 0.0; })) {
    throw UsageError(
        fmt::format("--spin: expected 0 with release.speed 0, because a ball at rest has no "
                    "direction to spin about; found {}",
                    *question.spin));
  }
  grid.spin = {0.0};
}

/// Simulates with all jobs and shows the progress.
sweep::Simulate simulation_of(const sweep::Situation& situation, int jobs) {
  return [&situation, jobs](std::span<const sweep::Release> releases) {
    Progress progress("releases", static_cast<std::int64_t>(releases.size()));
    return sweep::throw_again(situation, releases, jobs, [&](std::int64_t done) {
      check_stop();
      progress.show(done);
    });
  };
}

/// The throws that have a velocity, by their place in `own`.
///
/// @throws UsageError  for fewer than two throws, because then there are no costs
std::vector<std::size_t> throws_with_velocity(const sweep::WhatIf& whatif) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < whatif.own.size(); ++i) {
    if (whatif.own[i].execution) found.push_back(i);
  }
  if (found.size() < 2) {
    throw UsageError(fmt::format("--costs: expected two throws or more with a velocity, found {}",
                                 found.size()));
  }
  return found;
}

sweep::Costs costs_of(const sweep::WhatIf& whatif, const sweep::Simulate& simulate) {
  const std::optional<sweep::Execution> recorded = sweep::execution_of(whatif.real.thrown);
  if (!recorded || recorded->speed <= 0.0) {
    throw UsageError(fmt::format("--costs: throw {} has no speed", whatif.number));
  }
  std::vector<sweep::Execution> executions;
  for (const std::size_t i : whatif.in_costs) executions.push_back(*whatif.own[i].execution);
  return sweep::costs_of(executions, *recorded, whatif.grid, simulate);
}

double share_of_success(const sweep::WhatIf& whatif) {
  const auto good = std::ranges::count_if(whatif.of_grid, [&](const sweep::Outcome& outcome) {
    return outcome.released && outcome.down >= whatif.success;
  });
  return static_cast<double>(good) / static_cast<double>(whatif.of_grid.size());
}

double milliseconds(Time time) {
  return 1e3 * seconds(time);
}

nlohmann::ordered_json to_json(const std::optional<sweep::MissRoom>& room) {
  if (!room) return nullptr;
  return {{"boards", room->boards()},
          {"from_boards", room->from},
          {"to_boards", room->to},
          {"turned_deg", room->direction_deg},
          {"cut", room->cut}};
}

std::string in_words(const sweep::MissRoom& room) {
  return fmt::format("{:g} {} ({:+g} to {:+g}{})", room.boards(),
                     room.boards() == 1.0 ? "board" : "boards", room.from, room.to,
                     room.cut ? ", and perhaps beyond" : "");
}

std::string in_words(const sweep::MissRooms& rooms) {
  std::string words = rooms.in_grid ? "none" : "not in the grid";
  if (rooms.own) words = in_words(*rooms.own) + " in the direction of the throw";
  if (!rooms.widest || rooms.widest == rooms.own) return words;
  const double turned = rooms.widest->direction_deg;
  return words + fmt::format("; widest {}{}", in_words(*rooms.widest),
                             turned == 0.0
                                 ? ""
                                 : fmt::format(" at {:g} degrees further to the {}",
                                               std::abs(turned), turned < 0.0 ? "left" : "right"));
}

/// The names of the trials: of their files, or as they are given where files have one name.
std::vector<std::string> names_of(const std::vector<std::string>& trials) {
  const auto file = [](const std::string& path) {
    return std::filesystem::path(path).filename().string();
  };
  std::vector<std::string> names;
  for (const std::string& trial : trials) {
    const auto same = std::ranges::count(trials, file(trial), file);
    names.push_back(same == 1 ? file(trial) : trial);
  }
  return names;
}

/// Throws of a trial that is given twice, as with `s.lcmlog *.lcmlog`, would count twice.
void require_different(const std::vector<std::string>& trials) {
  for (std::size_t i = 0; i < trials.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code none;  // what cannot be read is told later
      if (trials[i] != trials[j] && !std::filesystem::equivalent(trials[i], trials[j], none))
        continue;
      throw UsageError(fmt::format("TRIALS: expected each trial once, found {} twice", trials[i]));
    }
  }
}

}  // namespace

sweep::WhatIf ask_what_if(const WhatIfQuestion& question, std::string_view command) {
  sweep::WhatIf whatif;
  whatif.grid = grid_of(question);
  require_different(question.trials);
  ThrowsOfTrial throws;
  const std::vector<std::string> names = names_of(question.trials);
  for (std::size_t t = 0; t < question.trials.size(); ++t) {
    ThrowsOfTrial of_trial = throws_of(question.trials[t], question, command);
    for (const auto& [number, situation] : of_trial.all) {
      const scene::ThrowRow& thrown = situation.thrown;
      whatif.own.push_back({names[t], number, thrown, sweep::execution_of(thrown)});
    }
    if (t == 0) throws = std::move(of_trial);
  }
  const sweep::Situation& situation = asked_throw(throws, question);
  require_direction(question, situation, whatif.grid);
  if (question.costs) whatif.in_costs = throws_with_velocity(whatif);
  whatif.trial = whatif.own.front().trial;
  whatif.number = question.number;
  whatif.thrown = situation.thrown;
  whatif.real = sweep::throw_again(situation, {});
  whatif.rack = std::ssize(situation.before->stage->skittles);
  whatif.success = question.success.value_or(std::max<std::int64_t>(1, whatif.real.down));
  whatif.moments = sweep::moments(microseconds(1e-3 * question.within_ms),
                                  microseconds(1e-3 * question.step_ms));
  const sweep::Simulate simulate = simulation_of(situation, question.jobs);
  whatif.of_moments = simulate(whatif.moments);
  whatif.window = sweep::window_of_success(whatif.moments, whatif.of_moments, whatif.success);
  whatif.of_grid = simulate(sweep::releases_of(whatif.grid));
  if (whatif.grid.boards.size() > 1) {
    whatif.miss = sweep::miss_rooms(whatif.grid, whatif.of_grid, whatif.success);
  }
  if (question.costs) whatif.costs = costs_of(whatif, simulate);
  return whatif;
}

nlohmann::ordered_json to_json(const sweep::WhatIf& whatif) {
  nlohmann::ordered_json json = {{"trial", whatif.trial},
                                 {"throw", whatif.number},
                                 {"name", whatif.thrown.version},
                                 {"release_speed_mps", whatif.real.thrown.speed},
                                 {"skittles_down", whatif.real.down},
                                 {"success_from", whatif.success},
                                 {"moments", whatif.moments.size()},
                                 {"window", nullptr},
                                 {"grid_releases", whatif.of_grid.size()},
                                 {"success_share", share_of_success(whatif)},
                                 {"miss_room", nullptr},
                                 {"widest_miss_room", nullptr},
                                 {"costs", nullptr}};
  if (whatif.window) {
    json["window"] = {{"from_ms", milliseconds(whatif.window->from)},
                      {"to_ms", milliseconds(whatif.window->to)},
                      {"cut", whatif.window->cut}};
  }
  if (whatif.miss) {
    json["miss_room"] = to_json(whatif.miss->own);
    json["widest_miss_room"] = to_json(whatif.miss->widest);
  }
  if (whatif.costs) {
    json["costs"] = {{"of_throws", whatif.in_costs.size()},
                     {"mean_down", whatif.costs->mean},
                     {"tolerance", whatif.costs->tolerance},
                     {"noise", whatif.costs->noise},
                     {"covariation", whatif.costs->covariation}};
  }
  return json;
}

std::vector<std::pair<std::string, std::string>> in_lines(const sweep::WhatIf& whatif) {
  std::vector<std::pair<std::string, std::string>> lines;
  const std::optional<sweep::Execution> real = sweep::execution_of(whatif.real.thrown);
  lines.emplace_back(
      "throw",
      fmt::format("{} of {}: {:.2f} m/s{}, {} down", whatif.number, whatif.trial,
                  whatif.real.thrown.speed,
                  real ? fmt::format(", {:.1f} degrees {}", std::abs(real->direction_deg),
                                     real->direction_deg < 0.0 ? "to the left" : "to the right")
                       : "",
                  whatif.real.down));
  lines.emplace_back("moments", fmt::format("{} from {:+g} to {:+g} ms", whatif.moments.size(),
                                            milliseconds(whatif.moments.front().shift),
                                            milliseconds(whatif.moments.back().shift)));
  std::string window =
      fmt::format("none: the throw felled {}, expected {}", whatif.real.down, whatif.success);
  if (whatif.window) {
    window = fmt::format("{:+g} to {:+g} ms with at least {} down{}",
                         milliseconds(whatif.window->from), milliseconds(whatif.window->to),
                         whatif.success, whatif.window->cut ? ", and perhaps beyond" : "");
  }
  lines.emplace_back("window of success", window);
  std::string axes = "speed, direction, height and spin";
  for (const auto& [axis, name] : {std::pair(&whatif.grid.boards, ", and of the board"),
                                   {&whatif.grid.revs, ", and of the revs"},
                                   {&whatif.grid.rotation_deg, ", and of the axis rotation"}}) {
    if (axis->size() > 1) axes += name;
  }
  lines.emplace_back("releases", fmt::format("{} of {}; {:.0f} % of them with at least {} down",
                                             whatif.of_grid.size(), axes,
                                             100.0 * share_of_success(whatif), whatif.success));
  if (whatif.miss) lines.emplace_back("miss room", in_words(*whatif.miss));
  if (const auto& costs = whatif.costs) {
    lines.emplace_back("throws", fmt::format("{}, {:.2f} down on average in this situation",
                                             whatif.in_costs.size(), costs->mean));
    lines.emplace_back("costs",
                       fmt::format("tolerance {:.2f}, noise {:.2f}, covariation {:.2f} skittles",
                                   costs->tolerance, costs->noise, costs->covariation));
  }
  return lines;
}

}  // namespace headpin::apps
