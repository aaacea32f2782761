#include "scene/totals.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "devices/version.h"

namespace headpin::scene {

namespace {

/// Caps, counts and residuals of all steps.
nlohmann::json to_json(const engine::Statistics& s) {
  return {{"pairs", s.pairs},
          {"contacts", s.contacts},
          {"queries", s.queries.queries},
          {"query_iterations", s.queries.iterations},
          {"capped_queries", s.queries.capped},
          {"impacts", s.impacts},
          {"unfinished_impacts", s.unfinished_impacts},
          {"pulling_impulses", s.pulls},
          {"solver_iterations", s.solver_iterations},
          {"unsolved_islands", s.unsolved},
          {"largest_residual_mps", s.residual},
          {"deepest_overlap_m", s.deepest_overlap}};
}

nlohmann::json number(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

void Totals::tick(const Session& session) {
  for (const devices::Event& event : session.events) score_.add(event);
}

nlohmann::json per_object(const Materials& m, double Coefficients::*coefficient) {
  return {{"skittle", m.skittle.*coefficient},
          {"ball", m.ball.*coefficient},
          {"lane", m.lane.*coefficient},
          {"wall", m.wall.*coefficient}};
}

nlohmann::json in_short(const nlohmann::json& each) {
  const nlohmann::json& first = *each.begin();
  if (std::ranges::all_of(each, [&](const auto& value) { return value == first; })) return first;
  std::string all;
  for (const auto& [object, value] : each.items()) {
    all += fmt::format("{}{} {}", all.empty() ? "" : ", ", object, value.dump());
  }
  return all;
}

nlohmann::json to_json(const engine::Ledger& l) {
  return {{"gravity_j", l.gravity.energy},
          {"hand_j", l.hand.energy},
          {"impact_j", l.impact.energy},
          {"sustained_j", l.sustained.energy},
          {"correction_j", l.correction.energy}};
}

nlohmann::json to_json(const std::vector<Sheet>& games) {
  nlohmann::json all = nlohmann::json::array();
  for (const Sheet& game : games) {
    std::vector<Frame> frames = game.frames;
    std::erase_if(frames, [](const Frame& frame) { return frame.empty(); });  // begun, no more
    all.push_back({{"name", game.version},
                   {"rules", game.rules},
                   {"rolls", frames},
                   {"points", points(game)},
                   {"over", game.over},
                   {"sheet", in_words(game)}});
  }
  return all;
}

nlohmann::json summary(const Session& s, const Score& score) {
  const Scenario& scenario = s.scenario();
  return {{"version", devices::software_version()},
          {"elasticity", per_object(scenario.material, &Coefficients::elasticity)},
          {"friction", per_object(scenario.material, &Coefficients::friction)},
          {"shape", scenario.collision.shape},
          {"response", scenario.collision.response},
          {"detection", scenario.collision.detection},
          {"skittles", s.stage->skittles.size()},
          {"skittles_down", score.skittles_down},
          {"games", to_json(score.games)},
          {"release_speed_mps", number(score.release_speed)},
          {"impact_speed_mps", number(score.impact_speed)},
          {"simulated_s", seconds(s.now())},
          {"ticks", s.tick},
          {"ledger", to_json(s.world.ledger)},
          {"statistics", to_json(s.statistics)},
          {"state_hash", fmt::format("{:016x}", engine::state_hash(s.world))}};
}

}  // namespace headpin::scene
