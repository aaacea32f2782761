#include "apps/frame_ranges.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "apps/command.h"

namespace headpin::apps {

namespace {

/// @param item  of the whole text, for messages
std::int64_t frame_number(std::string_view text, std::string_view item, const std::string& all) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) {
    throw UsageError(fmt::format(
        "--frames {}: expected numbers and ranges such as 10-20,35, found '{}'", all, item));
  }
  return value;
}

}  // namespace

FrameRanges::FrameRanges(const std::string& text) {
  std::string_view rest = text;
  for (;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const std::size_t dash = item.find('-');
    const std::int64_t first = frame_number(item.substr(0, dash), item, text);
    const std::int64_t last =
        dash == std::string_view::npos ? first : frame_number(item.substr(dash + 1), item, text);
    if (last < first)
      throw UsageError(fmt::format("--frames {}: '{}' ends before it begins", text, item));
    ranges_.push_back({first, last});
    if (comma == std::string_view::npos) return;
    rest = rest.substr(comma + 1);
  }
}

bool FrameRanges::contains(std::int64_t frame) const {
  if (ranges_.empty()) return true;
  for (const Range& r : ranges_) {
    if (r.first <= frame && frame <= r.last) return true;
  }
  return false;
}

std::optional<std::int64_t> FrameRanges::first_not_in(std::span<const std::int64_t> frames) const {
  for (const Range& r : ranges_) {
    for (std::int64_t frame = r.first; frame <= r.last; ++frame) {
      if (!std::ranges::binary_search(frames, frame)) return frame;
    }
  }
  return std::nullopt;
}

}  // namespace headpin::apps
