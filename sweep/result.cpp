#include "sweep/result.h"

#include <cmath>

#include <fmt/format.h>

#include "scene/play/game_hash.h"
#include "scene/play/session.h"

namespace headpin::sweep {

const std::vector<ResultColumn>& result_columns() {
  static const std::vector<ResultColumn> columns = {
      {"skittles_down", "", "felled by balls; of games, what their sheets count"},
      {"felled_by_hand", "", "skittles that the hand felled, or what it carried"},
      {"release_speed_mps", "m/s", "of the first ball as it left the hand"},
      {"impact_speed_mps", "m/s", "of the same ball just before its first skittle"},
      {"entry_angle_deg", "degrees", "of its level velocity then, to the right of straight on"},
      {"ball_speed_mps", "m/s", "of the same ball at the end"},
      {"energy_lost_j", "J",
       "that contacts took away: hand_j of the ledger less the energy at the end"},
      {"rest_s", "s", "when the last body came to rest; empty where one moves at the end"},
      {"apart_arcmin", "arcmin",
       "largest angle in view between a body and its place under the recorded condition"},
      {"simulated_s", "s", "how long the session was"},
      {"impacts", "", "impulses given"},
      {"capped_queries", "", "detection queries that reached their cap"},
      {"unfinished_impacts", "", "steps in which a body had more impacts than it may have"},
      {"pulling_impulses", "", "impulses that would have pulled, and were replaced"},
      {"unsolved_islands", "", "groups of contacts stopped by their number of passes"},
      {"largest_residual_mps", "m/s", "change of a velocity in a last pass"},
      {"deepest_overlap_m", "m", "of two bodies"},
      {"state_hash", "", "of all bodies at the end"},
      {"error", "", "why the row could not be simulated; then all others are empty"},
  };
  return columns;
}

void Result::tick(const scene::Session& session) {
  for (const scene::Event& event : session.events) score_.add(event, session.scenario());
  if (session.world.statistics.awake > 0) last_awake_ = session.tick;
  const Frames::value_type* recorded = recorded_now(session);
  const auto apart = recorded ? arcmin_in_view(session, *recorded) : std::nullopt;
  if (apart) apart_arcmin_ = std::max(apart_arcmin_.value_or(0.0), *apart);
}

const Frames::value_type* Result::recorded_now(const scene::Session& session) const {
  const std::int64_t there = session.tick * rates_.physics_hz;
  const std::int64_t rate = session.scenario().rates.physics_hz;
  // No tick of the recorded condition is at this time.
  if (!recorded_ || there % rate != 0) return nullptr;
  const std::optional<std::int64_t> frame = frame_of(there / rate, rates_);
  if (!frame || *frame >= std::ssize(*recorded_)) return nullptr;
  return &(*recorded_)[static_cast<std::size_t>(*frame)];
}

std::vector<std::string> Result::cells(const scene::Session& session) const {
  const auto maybe = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
  };
  const auto& statistics = session.statistics;
  const auto& ledger = session.world.ledger;
  // With `gravity`: what a resting body gains there, `sustained` takes away again.
  const double lost = ledger.hand.energy - ledger.sum().energy;
  std::optional<double> angle, ball_speed, rest;
  if (!score_.throws.empty()) {
    const scene::ThrowRow& first = score_.throws.front();
    angle = first.entry_angle_deg;
    const std::vector<std::string> names = scene::body_names(*session.stage);
    for (std::size_t body = 0; body < names.size(); ++body) {
      if (names[body] == first.body) ball_speed = session.world.states[body].v_WB.norm();
    }
  }
  if (last_awake_ < session.tick) {
    rest = nearest_seconds(tick_time(last_awake_, session.scenario().rates.physics_hz));
  }
  return {fmt::format("{}", score_.skittles_down),
          fmt::format("{}", score_.felled_by_hand),
          maybe(score_.release_speed),
          maybe(score_.impact_speed),
          maybe(angle),
          maybe(ball_speed),
          fmt::format("{}", lost),
          maybe(rest),
          maybe(apart_arcmin_),
          fmt::format("{}", nearest_seconds(session.now())),
          fmt::format("{}", statistics.impacts),
          fmt::format("{}", statistics.queries.capped),
          fmt::format("{}", statistics.unfinished_impacts),
          fmt::format("{}", statistics.pulls),
          fmt::format("{}", statistics.unsolved),
          fmt::format("{}", statistics.residual),
          fmt::format("{}", statistics.deepest_overlap),
          scene::in_hex(engine::state_hash(session.world)),
          ""};
}

std::vector<std::string> failed_cells(const std::string& reason) {
  std::vector<std::string> cells(result_columns().size());
  cells.back() = reason;
  return cells;
}

}  // namespace headpin::sweep
