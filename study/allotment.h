#pragma once

#include <cstdint>

#include "study/design.h"

/// Who gets which conditions, at random and balanced.
namespace headpin::study {

/// The conditions of a place in the plan.
struct Allotted {
  std::size_t row = 0;         ///< of the design
  bool changed_first = false;  ///< the version with the changed value is played first
  /// The base version is behind the red button; else behind the blue one.
  bool base_is_red = false;

  bool operator==(const Allotted&) const = default;
};

/// The conditions of one place, from 0 on.
///
/// Places are grouped into blocks. A block has every row of the design as often as its `people`
/// say, in random order. Within a block and a changed parameter, both orders of the versions are
/// equally frequent, and so are both colours (up to one if the number is odd). In every four
/// blocks, each place of a row has each of the four combinations once.
///
/// It depends only on its arguments: more places do not change earlier ones.
Allotted allot(const Design& design, std::uint64_t seed, std::int64_t place);

}  // namespace headpin::study
