#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/compound.h"

/// Which moving bodies may meet: their bounds do.
namespace headpin::engine {

/// Two bodies by index, first < second.
struct Pair {
  std::uint32_t first = 0, second = 0;
  friend bool operator==(const Pair&, const Pair&) = default;
  friend auto operator<=>(const Pair&, const Pair&) = default;  // NOLINT(modernize-use-nullptr)
};

/// Distance between the surfaces of two capsules, negative when they overlap [m].
double distance(const Capsule& a, const Capsule& b);

/// Finds the pairs of capsules that meet, in time proportional to their number.
///
/// Boxes round the capsules go into a grid whose cell is about the size of a body (bodies many
/// cells large, a whole wall say, are kept aside and tested against everything), then the capsules
/// of neighbours are compared. The static world is not in here: test it against moving bodies
/// directly. All memory is kept from call to call.
class BroadPhase {
 public:
  /// @param bounds_W  capsule of each body in the world; finite
  /// @param moving    1 for bodies that move, 0 for those at rest; empty: all move. A pair of two
  ///   bodies at rest is not reported.
  /// @param margin    report also those closer than this [m]
  /// @return          pairs by first, then second index; good until the next call
  const std::vector<Pair>& find_pairs(std::span<const Capsule> bounds_W,
                                      std::span<const std::uint8_t> moving = {},
                                      double margin = 0.0);

  /// Those of the last call whose boxes, as they were then, meet the box round a capsule.
  ///
  /// @param out  gets their numbers, rising, each once
  void find_near(const Capsule& bounds_W, std::vector<std::uint32_t>& out) const;

 private:
  struct Box {
    Vec3 low, high;
    bool meets(const Box& other) const {
      for (int k = 0; k < 3; ++k) {  // most pairs differ in the first
        if (!(low[k] <= other.high[k] && other.low[k] <= high[k])) return false;
      }
      return true;
    }
  };
  struct Cells {
    std::int32_t low[3], high[3];
  };
  struct Entry {
    std::uint32_t body, slot;
  };
  // The grid of the last call; no slots when bodies were compared directly.
  double cells_per_metre_ = 0.0;
  std::uint32_t bits_[3] = {};

  std::vector<Box> boxes_;
  std::vector<Cells> cells_;
  std::vector<std::uint32_t> large_;
  std::vector<Entry> unsorted_;
  std::vector<std::uint32_t> slots_, entries_;
  std::vector<Pair> pairs_, found_;
  std::vector<std::uint32_t> count_;
};

}  // namespace headpin::engine
