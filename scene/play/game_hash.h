#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scene/record/file.h"

namespace headpin::scene {

/// A hash of a whole session: of the state hash of every tick so far and of the version in that
/// tick.
///
/// The state hash of the last tick does not distinguish games: a new version starts a new world,
/// and the rules put all bodies back.
class GameHash {
 public:
  GameHash() = default;
  /// One that continues from an earlier value.
  explicit GameHash(std::uint64_t value) : value_(value) {}

  /// Adds a tick.
  ///
  /// @param state_hash  hash of the world after the tick
  /// @param version     0: none (yet), 1: red, 2: blue
  void add(std::uint64_t state_hash, std::uint64_t version);

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;  ///< FNV-1a, 64 bit
};

/// The hash as text, 16 digits.
std::string in_hex(std::uint64_t hash);

/// The game hash in a trial's last events, and its tick.
struct SaidGameHash {
  std::int64_t tick = 0;
  std::string hash;
};
/// @return  nothing for a trial that is older than the game hash, or incomplete
std::optional<SaidGameHash> said_game_hash(const TrialSummary& trial);

/// Computes the game hash from the states of a trial.
///
/// @return  nothing if a state is missing
std::optional<std::uint64_t> game_hash_of_states(const TrialFile& trial);

}  // namespace headpin::scene
