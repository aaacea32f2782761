#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "scene/record/trial.h"

/// States stored as changes: most bodies rest most of the time, and the others continue almost
/// uniformly.
namespace headpin::scene {

/// Position, quaternion (w, x, y, z), velocity, angular velocity; the bits of each.
using BodyNumbers = std::array<std::uint64_t, 13>;

/// A body that changed in a tick.
struct BodyChange {
  std::int32_t body = 0;
  bool asleep = false;
  /// For each number, the difference of its bits from the prediction, mod 2^64.
  BodyNumbers beyond{};
};

/// A TickState as changes against the tick before.
struct StateChange {
  Time time{};
  std::int64_t tick = 0;
  std::uint64_t hash = 0;
  std::int32_t contacts = 0;
  std::vector<BodyChange> bodies;  ///< in ascending order
};

/// The last two states, as far as they are known; they predict the next one.
class StateHistory {
 public:
  void begin(const TickState& whole);
  void forget() { last_.reset(); }

  /// Encodes the state of the next tick, which becomes the last one.
  /// @return  nothing if it must be stored whole: another tick, or other bodies
  std::optional<StateChange> change_to(const TickState& next);

  /// Decodes a state.
  /// @return  nothing if the state of the tick before is unknown, or lacks a body
  const TickState* go_on(const StateChange& change);

  /// The tick whose state can be stored as changes.
  std::optional<std::int64_t> next_tick() const;

 private:
  /// The predicted numbers of a body.
  BodyNumbers expected(std::size_t body) const;

  std::optional<TickState> last_;
  std::vector<BodyNumbers> now_, before_;  // of last_, and of the state before that
};

}  // namespace headpin::scene
