#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace headpin::apps {

/// Which frames of a sequence are wanted: `10-20,35`, both ends included; none given means all.
class FrameRanges {
 public:
  FrameRanges() = default;
  /// @throws UsageError  for text that is not a list of numbers and rising ranges
  explicit FrameRanges(const std::string& text);

  bool contains(std::int64_t frame) const;
  /// How many of the frames 0 .. count - 1 are wanted.
  std::int64_t count_below(std::int64_t count) const;

 private:
  struct Range {
    std::int64_t first, last;
  };
  std::vector<Range> ranges_;
};

}  // namespace headpin::apps
