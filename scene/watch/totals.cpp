#include "scene/watch/totals.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "devices/base/version.h"
#include "scene/play/outcome.h"
#include "scene/record/details.h"
#include "scene/record/events.h"

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

constexpr std::size_t kMostTouches = 1000;  // of the ball, that are kept

/// Whether scene::why_nothing_fell looks for such events.
bool explains(const Event& event) {
  for (const std::string_view one :
       {kind::grab, kind::missed_grab, kind::release, kind::first_contact, kind::ball_touch}) {
    if (event.kind == one) return true;
  }
  return false;
}

}  // namespace

void Totals::tick(const Session& session) {
  for (const Event& event : session.events) add(event, session.scenario());
}

void Totals::add(const Event& event, const Scenario& scenario) {
  score_.add(event, scenario);
  fell_ |= says_that_some_fell(event);
  const bool kept = event.kind != kind::ball_touch || before_.size() < kMostTouches;
  if (!fell_ && kept && explains(event)) before_.push_back(event);
}

Score Totals::score_at_end(const Session& session) const {
  Score score = score_;
  if (const auto path = last_ball_path(session)) score.add(*path, session.scenario());
  return score;
}

std::string Totals::why_nothing_fell() const {
  return fell_ ? "" : scene::why_nothing_fell(before_);
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

PhaseEnergies energies_of(const engine::Ledger& ledger) {
  return {.gravity_j = ledger.gravity.energy,
          .hand_j = ledger.hand.energy,
          .impact_j = ledger.impact.energy,
          .sustained_j = ledger.sustained.energy,
          .correction_j = ledger.correction.energy};
}

nlohmann::json to_json(const std::vector<Sheet>& games) {
  nlohmann::json all = nlohmann::json::array();
  for (const Sheet& game : games) {
    std::vector<Frame> frames = game.frames;
    std::erase_if(frames, [](const Frame& frame) { return frame.empty(); });  // no ball yet
    all.push_back({{"name", game.version},
                   {"rules", name_of(game.rules)},
                   {"rolls", frames},
                   {"points", points(game)},
                   {"over", game.over},
                   {"marks", game.marks},
                   {"sheet", in_words(game)}});
  }
  return all;
}

nlohmann::json conditions(const Scenario& scenario) {
  const auto of = [](const Scenario& one) -> nlohmann::json {
    return {{"elasticity", per_object(one.material, &Coefficients::elasticity)},
            {"friction", per_object(one.material, &Coefficients::friction)},
            {"shape", name_of(one.collision.shape)},
            {"detection", name_of(one.collision.detection)},
            {"iterations", one.collision.iterations}};
  };
  const Versions& versions = scenario.version;
  nlohmann::json all = of(versions.buttons ? under(scenario, versions.red) : scenario);
  all["versions"] = nullptr;
  if (!versions.buttons) return all;
  const nlohmann::json red = all, blue = of(under(scenario, versions.blue));
  for (const auto& [key, value] : blue.items()) {
    if (all[key] != value) all[key] = nullptr;
  }
  all["versions"] = {{"red", red}, {"blue", blue}};
  all["versions"]["red"].erase("versions");
  return all;
}

nlohmann::json to_json(const std::vector<KeyDifference>& differences) {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [key, a, b] : differences) all.push_back({{"key", key}, {"a", a}, {"b", b}});
  return all;
}

/// Of a number or a text.
nlohmann::json to_json(const TableValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return {};
}

nlohmann::json to_json(const std::vector<ThrowRow>& throws) {
  nlohmann::json all = nlohmann::json::array();
  const auto whole = [](int n) { return n > 0 ? nlohmann::json(n) : nlohmann::json(); };
  const auto maybe = [](const auto& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  const auto numbers = [](const std::optional<Vec3>& v) {
    return v ? nlohmann::json{v->x(), v->y(), v->z()} : nlohmann::json();
  };
  for (const ThrowRow& row : throws) {
    all.push_back(
        {{"name", row.version},
         {"frame", whole(row.frame)},
         {"ball", whole(row.ball)},
         {"body", row.body},
         {"release_s", nearest_seconds(row.release)},
         {"trigger_s", maybe(row.trigger_s)},
         {"position_m", numbers(row.p_WB)},
         {"velocity_mps", numbers(row.v_WB)},
         {"spin_radps", numbers(row.w_WB)},
         {"release_speed_mps", row.speed},
         {"known", row.known},
         {"extrapolated_s", maybe(row.extrapolated_s)},
         {"samples_left_out", maybe(row.left_out)},
         {"entry_s", row.entry ? nlohmann::json(nearest_seconds(*row.entry)) : nlohmann::json()},
         {"impact_speed_mps", maybe(row.entry_speed)},
         {"entry_angle_deg", maybe(row.entry_angle_deg)},
         {"felled_by_ball", maybe(row.felled_by_ball)},
         {"felled_by_hand", maybe(row.felled_by_hand)},
         {"counted", maybe(row.counted)},
         {"foul", maybe(row.foul)}});
    for (const auto& [name, value] : lane_values(row)) all.back()[name] = to_json(value);
  }
  return all;
}

nlohmann::json summary(const Session& s, const Score& score) {
  const auto hash = [&](std::uint64_t value) {
    return s.hashes ? nlohmann::json(in_hex(value)) : nlohmann::json();
  };
  nlohmann::json all = conditions(s.trial_scenario());
  all.update({{"version", devices::software_version()},
              {"response", s.world.parameters.response},
              {"skittles", s.stage->skittles.size()},
              {"skittles_down", score.skittles_down},
              {"felled_by_hand", score.felled_by_hand},
              {"games", to_json(score.games)},
              {"throws", to_json(score.throws)},
              {"release_speed_mps", number(score.release_speed)},
              {"impact_speed_mps", number(score.impact_speed)},
              {"simulated_s", nearest_seconds(s.now())},
              {"ticks", s.tick},
              {"ledger", to_json(energies_of(s.world.ledger))},
              {"statistics", to_json(s.statistics)},
              {"state_hash", hash(s.state_hash)},
              {"game_hash", hash(s.game_hash.value())}});
  return all;
}

}  // namespace headpin::scene
