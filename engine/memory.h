#pragma once

#include <cstdint>
#include <vector>

#include "engine/ledger.h"
#include "engine/non_colliding.h"
#include "engine/response.h"

/// Data that the next step needs from the last one, besides the states.
namespace headpin::engine {

using BodyId = std::uint32_t;

/// Sort key of a pair: pairs with a half-space first; then by the smaller and the larger number.
inline std::uint64_t key_of(bool both_bounded, BodyId a, BodyId b) {
  return std::uint64_t{both_bounded} << 63 | std::uint64_t{a} << 32 | b;
}

/// Whether a body is one of the two.
inline bool concerns(std::uint64_t key, BodyId body) {
  return (key >> 32 & 0x7fff'ffffu) == body || (key & 0xffff'ffffu) == body;
}

/// The body that stands first in a key.
inline BodyId first_of(std::uint64_t key) {
  return static_cast<BodyId>(key >> 32 & 0x7fff'ffffu);
}

/// The impulse of a contact point, for the warm start [kg m/s].
struct Load {
  double impulse = 0.0;
  std::uint32_t feature = 0;
};

/// Data of a touch for the same touch in the next step.
struct PastTouch {
  std::uint64_t key = 0;   ///< they are in the order of their keys and parts
  std::uint32_t part = 0;  ///< of a fixed body, where its parts are touched each on its own
  bool met = false, struck = false;
  std::uint32_t first_load = 0, loads = 0;  ///< in `Memory::loads`
  double friction = 0.0;
  Sliding sliding;                                        ///< for that friction
  Vec3 friction_W = Vec3::Zero(), roll_W = Vec3::Zero();  ///< impulses, see `side_of`
  double twist = 0.0;
};

/// Two bodies whose bounds overlap, and the place of the normals of their pairs of parts.
struct Candidate {
  std::uint64_t key = 0;  ///< they are in the order of their keys
  BodyId a = 0, b = 0;
  std::uint32_t first_normal = 0, normals = 0;  ///< in `Memory::normals`
};

struct BodyMemory {
  bool supported = false;  ///< contacts carry at least half of its weight, and it does not rise
  std::int32_t still = 0;  ///< number of steps since it is at rest
  BodyId sleeps_with = 0;  ///< next body in the ring of an island that sleeps
};

/// A world without it continues similarly, but with other bits.
struct Memory {
  std::vector<PastTouch> touches;
  std::vector<Load> loads;
  std::vector<Candidate> candidates;
  std::vector<KeptNormal> normals;
  std::vector<BodyMemory> bodies;  ///< by their numbers
  std::vector<std::uint64_t> met;  ///< sorted pairs that have met
  Balance balance;                 ///< at the end of the last step, if the ledger is kept
};

}  // namespace headpin::engine
