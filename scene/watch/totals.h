#pragma once

#include <chrono>

#include <nlohmann/json_fwd.hpp>

#include "scene/play/run.h"
#include "scene/play/score.h"

namespace headpin::scene {

/// What a session comes to, summed up as it runs.
class Totals : public Observer {
 public:
  void tick(const Session& session) override;

  const Score& score() const { return score_; }

 private:
  Score score_;
};

/// Times the simulation alone: as the pace it starts with each tick, as the first observer it
/// stops.
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

/// The same for people: the number that all share, else each with its object's name.
nlohmann::json in_short(const nlohmann::json& per_object);

/// Energy that each phase of the steps has added [J]; together the change of the whole.
nlohmann::json to_json(const engine::Ledger& ledger);

/// Score sheets.
nlohmann::json to_json(const std::vector<Sheet>& games);

/// Elasticity, friction and shape that a session ran under. Where it has versions, each one's stands
/// in "versions", and what they do not share is null.
nlohmann::json conditions(const Scenario& scenario);

/// The keys whose values differ, and both values.
nlohmann::json to_json(const std::vector<KeyDifference>& differences);

/// A row each.
nlohmann::json to_json(const std::vector<devices::ThrowRow>& throws);

/// What a session came to, as every command's `--json` tells it.
nlohmann::json summary(const Session& session, const Score& score);

}  // namespace headpin::scene
