#pragma once

#include <cstdint>
#include <optional>
#include <span>
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
  /// The first frame that is named and not among these, which rise.
  std::optional<std::int64_t> first_not_in(std::span<const std::int64_t> frames) const;

 private:
  struct Range {
    std::int64_t first, last;
  };
  std::vector<Range> ranges_;
};

}  // namespace headpin::apps
