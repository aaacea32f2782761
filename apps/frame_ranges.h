#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"

namespace headpin::apps {

/// Which frames of a sequence are wanted: `10-20,35` by their numbers, `3.9s-4.1s` by their times, both ends
/// included; none given means all.
class FrameRanges {
 public:
  FrameRanges() = default;
  /// @throws UsageError  for text that is not a list of numbers and rising ranges, of numbers or of seconds
  explicit FrameRanges(const std::string& text);

  bool contains(std::int64_t frame, Time time) const;
  /// The first frame that is named by its number and not among these, which rise.
  std::optional<std::int64_t> first_not_in(std::span<const std::int64_t> frames) const;

 private:
  struct Range {
    std::int64_t first, last;
  };
  struct Span {
    Time first, last;
  };
  std::vector<Range> ranges_;
  std::vector<Span> spans_;
};

}  // namespace headpin::apps
