#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/record/trial.h"

/// Finds where two sessions first differ: every bit of the bodies that both have.
namespace headpin::scene {

/// The bodies that two sessions have in common, by name, and those that only one of them has.
struct SharedBodies {
  std::vector<std::string> names;
  std::vector<std::size_t> in_a, in_b;  ///< their numbers, as `names`
  std::vector<std::string> only_in_a, only_in_b;

  bool all() const { return only_in_a.empty() && only_in_b.empty(); }
};
SharedBodies shared_bodies(std::span<const std::string> a, std::span<const std::string> b);

/// The first tick whose states differ, or that only one session has.
struct FirstDifference {
  enum class Lacks { neither, a, b };

  std::int64_t tick = 0;
  Time time{};
  /// The first body that differs; empty if only parts differ that a trial does not store, or if one
  /// session lacks the tick.
  std::string body;
  Lacks lacks = Lacks::neither;  ///< the session without a state of the tick
};

/// Compares two states of the same tick.
///
/// @return  nothing if they are equal
std::optional<FirstDifference> compare(const TickState& a, const TickState& b,
                                       const SharedBodies& shared);

/// The next state of a session; nothing at its end.
using NextState = std::function<std::optional<TickState>()>;

/// Compares two sessions, tick by tick, up to the first difference.
std::optional<FirstDifference> compare(const NextState& a, const NextState& b,
                                       const SharedBodies& shared);

/// As in `--json`, without the session that lacks the tick.
nlohmann::json to_json(const FirstDifference& difference);

}  // namespace headpin::scene
