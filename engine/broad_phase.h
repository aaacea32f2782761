#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/compound.h"
#include "engine/crew.h"

/// Broad phase: pairs of bodies whose bounds overlap.
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
/// The boxes around the capsules are sorted into a grid with cells of about the size of a body. Then
/// the capsules of neighbours are compared. Bodies that cover many cells, such as a wall, are tested
/// against all others. Half-spaces are not included: test them directly. The memory is reused in
/// each call.
class BroadPhase {
 public:
  /// @param bounds_W  capsule of each body in the world; finite
  /// @param moving    1 for bodies that move, 0 for those at rest; empty: all move. A pair of two
  ///   bodies at rest is not reported.
  /// @param margin    report also those closer than this [m]
  /// @param limits_W  a box that holds each body, for flat ones, whose capsules are wide; empty: none
  /// @param crew      shares the work; null: nobody does
  /// @return          pairs by first, then second index; good until the next call
  const std::vector<Pair>& find_pairs(std::span<const Capsule> bounds_W,
                                      std::span<const std::uint8_t> moving = {},
                                      double margin = 0.0, std::span<const Box> limits_W = {},
                                      Crew* crew = nullptr);

  /// Bodies of the last call whose boxes at that time overlap the box around a capsule; none if that
  /// call had fewer than two bodies, or none that moves.
  ///
  /// @param out  gets their numbers in ascending order, each once
  void find_near(const Capsule& bounds_W, std::vector<std::uint32_t>& out) const;

 private:
  struct Cells {
    std::int32_t low[3], high[3];
  };
  struct Entry {
    std::uint32_t body, slot;
  };
  /// What find_pairs() was given.
  struct Bodies {
    std::span<const Capsule> bounds_W;
    std::span<const std::uint8_t> moving;
    double margin;
    std::span<const Box> limits_W;
    bool moves(std::uint32_t i) const { return moving.empty() || moving[i] != 0; }
    bool any_moves(std::uint32_t i, std::uint32_t j) const { return moves(i) || moves(j); }
    bool meet(std::uint32_t i, std::uint32_t j) const {
      return distance(bounds_W[i], bounds_W[j]) <= margin;
    }
  };
  // The steps of find_pairs().
  double make_boxes(const Bodies& bodies, Crew& crew);
  void compare_all(const Bodies& bodies);
  void make_grid(double cell, Crew& crew);
  void sort_into_slots();
  void compare_in_slots(const Bodies& bodies, Crew& crew);
  void compare_in_slot(const Bodies& bodies, std::uint32_t slot, std::vector<Pair>& found) const;
  void compare_large(const Bodies& bodies);
  void sort_pairs();

  // The grid of the last call; no slots when bodies were compared directly.
  double cells_per_metre_ = 0.0;
  std::uint32_t bits_[3] = {};

  std::vector<Box> boxes_;
  std::vector<Cells> cells_;
  std::vector<std::uint32_t> large_;
  std::vector<Entry> unsorted_;
  std::vector<std::uint32_t> slots_, entries_;
  std::vector<Pair> pairs_, found_;
  std::vector<std::vector<Pair>> found_in_;  ///< a part of the slots
  std::vector<std::uint32_t> count_;
};

}  // namespace headpin::engine
