#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "devices/trial/file.h"

namespace headpin::scene {

/// A hash of all that a session went through: of the state hash of every tick so far, and of the
/// version that was played in it.
///
/// The state hash of the last tick does not tell games apart: a version that begins sets up a new
/// world, and the rules put all bodies back.
class GameHash {
 public:
  /// One tick more.
  ///
  /// @param state_hash  of the world after it
  /// @param version     0 before any began and where there are none, 1 red, 2 blue
  void add(std::uint64_t state_hash, std::uint64_t version);

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;  ///< FNV-1a, 64 bit
};

/// As it is written: 16 digits.
std::string in_hex(std::uint64_t hash);

/// The game hash that a trial's last events say, and the tick that it is of.
struct SaidGameHash {
  std::int64_t tick = 0;
  std::string hash;
};
/// @return  nothing for a trial from before there was one, or one that has no end
std::optional<SaidGameHash> said_game_hash(const devices::TrialSummary& trial);

/// The game hash that the states of a trial come to, whether it says one or not.
///
/// @return  nothing where a state is missing
std::optional<std::uint64_t> game_hash_of_states(const devices::TrialFile& trial);

}  // namespace headpin::scene
