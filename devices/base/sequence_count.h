#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "base/math.h"

namespace headpin::devices {

/// Counts lost samples of one station by their sequence numbers.
class SequenceCount {
 public:
  /// @return  increase of the number of missing samples; -1 if this one was counted as missing
  std::int64_t take(std::int64_t number, Time measured);

  /// Whether a number is later than all before.
  bool advances(std::int64_t number) const { return last_ && number > *last_; }

  /// Another sender continues with its own numbers.
  void begin_anew() { last_.reset(); }

  std::int64_t lost() const { return lost_; }          ///< missing up to now
  std::int64_t repeated() const { return repeated_; }  ///< samples that had come before

 private:
  bool fill(std::int64_t number);

  static constexpr std::size_t kMostHoles = 64;  ///< that are searched for a late sample

  std::optional<std::int64_t> last_;
  Time measured_{};
  std::deque<std::pair<std::int64_t, std::int64_t>>
      holes_;  ///< first and last number, oldest first
  std::int64_t lost_ = 0, repeated_ = 0;
};

}  // namespace headpin::devices
