#pragma once

#include <cstdint>

#include "study/design.h"

/// Who gets which conditions, at random and balanced.
namespace headpin::study {

/// What a place in the plan means.
struct Allotted {
  std::size_t row = 0;         ///< of the design
  bool changed_first = false;  ///< the version with the changed value is played first
  bool base_is_red = false;    ///< else it is behind the blue button

  bool operator==(const Allotted&) const = default;
};

/// The conditions of one place, from 0 on.
///
/// Places come in blocks; a block has every row of the design as often as its `people` say, in an
/// order of its own. Within a block and a changed parameter, either order of the versions comes
/// equally often, and so does either colour (but for one where their number is odd). In every four
/// blocks each place of a row has each of the four combinations once.
///
/// A function of its arguments: more places move none of those before them.
Allotted allot(const Design& design, std::uint64_t seed, std::int64_t place);

}  // namespace headpin::study
