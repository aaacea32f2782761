#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/play/run.h"
#include "scene/play/score.h"

namespace headpin::scene {

/// Sums over a session while it runs.
class Totals : public Observer {
 public:
  void tick(const Session& session) override;
  /// Adds an event of a part of the session that is not simulated.
  void add(const Event& event, const Scenario& scenario);

  const Score& score() const { return score_; }
  /// With the way of a ball that is on it at the session's end.
  Score score_at_end(const Session& session) const;
  /// See scene/play/outcome.h; by what has happened until now.
  std::string why_nothing_fell() const;

 private:
  Score score_;
  bool fell_ = false;
  std::vector<Event> before_;  ///< what may explain why nothing fell
};

/// Measures the computing time of the simulation: as the pace it starts with each tick, as the
/// first observer it stops.
class Stopwatch : public NoPace, public Observer {
 public:
  void wait_for(Time) override { start_ = std::chrono::steady_clock::now(); }
  void tick(const Session&) override { spent_ += std::chrono::steady_clock::now() - start_; }

  double spent_s() const { return std::chrono::duration<double>(spent_).count(); }

 private:
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::duration spent_{};
};

/// Elasticity or friction, per object.
nlohmann::json per_object(const Materials& materials, double Coefficients::*coefficient);

/// The same as text: the common number, or else each number with its object's name.
nlohmann::json in_short(const nlohmann::json& per_object);

/// Energy that each phase of the steps has added; the sum is the total change.
PhaseEnergies energies_of(const engine::Ledger& ledger);

/// Score sheets.
nlohmann::json to_json(const std::vector<Sheet>& games);

/// Elasticity, friction, shape, detection and iterations of a session. With versions, "versions" has
/// those of each, and values that differ are null.
///
/// @param scenario  of the whole trial, not of one of its versions
nlohmann::json conditions(const Scenario& scenario);

/// The keys whose values differ, and both values.
nlohmann::json to_json(const std::vector<KeyDifference>& differences);

/// One object per throw.
nlohmann::json to_json(const std::vector<ThrowRow>& throws);

/// The result of a session, as in `--json` of every command. The hashes are null where it makes none.
nlohmann::json summary(const Session& session, const Score& score);

}  // namespace headpin::scene
