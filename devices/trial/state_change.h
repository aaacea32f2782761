#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "devices/trial/trial.h"

/// States told by what is new in them: most bodies rest most of the time, the others go on much as
/// before.
namespace headpin::devices {

/// Position, quaternion (w, x, y, z), velocity, angular velocity; the bits of each.
using BodyNumbers = std::array<std::uint64_t, 13>;

/// A body that is not as it was a tick before.
struct BodyChange {
  std::int32_t body = 0;
  bool asleep = false;
  BodyNumbers beyond{};  ///< of each number what its bits are beyond going on as it did, mod 2^64
};

/// A TickState told by the one of the tick before.
struct StateChange {
  Time time{};
  std::int64_t tick = 0;
  std::uint64_t hash = 0;
  std::int32_t contacts = 0;
  std::vector<BodyChange> bodies;  ///< in ascending order
};

/// The last two states, as far as they are known: the next one is told by them, and found again.
class StateHistory {
 public:
  void begin(const TickState& whole);
  void forget() { last_.reset(); }

  /// What is new in the state of the next tick, which is the last one from now on.
  /// @return  nothing where it can only be told whole: another tick, or other bodies
  std::optional<StateChange> change_to(const TickState& next);

  /// The other way round.
  /// @return  nothing where the state of the tick before is not known, or lacks a body
  const TickState* go_on(const StateChange& change);

  /// The tick whose state may be told by what is new in it.
  std::optional<std::int64_t> next_tick() const;

 private:
  /// What the numbers of a body are, going on as they did.
  BodyNumbers expected(std::size_t body) const;

  std::optional<TickState> last_;
  std::vector<BodyNumbers> now_, before_;  // of last_, and of the state before that
};

}  // namespace headpin::devices
