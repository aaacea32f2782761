#include "apps/frame_ranges.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "apps/command.h"

namespace headpin::apps {

namespace {

/// What is written between two commas, and the whole text, for messages.
struct Item {
  std::string_view text;
  const std::string& all;

  [[noreturn]] void refuse() const {
    throw UsageError(
        fmt::format("--frames {}: expected numbers and ranges such as 10-20,35, or times such as "
                    "3.9s-4.1s, found '{}'",
                    all, text));
  }
};

template <typename T>
T number_in(std::string_view text, const Item& item) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= T{})) item.refuse();
  return value;
}

Time time_in(std::string_view text, const Item& item) {
  if (text.ends_with('s')) text.remove_suffix(1);
  const auto value = number_in<double>(text, item);
  if (!(value < 1e9)) item.refuse();
  return microseconds(value);
}

}  // namespace

FrameRanges::FrameRanges(const std::string& text) {
  std::string_view rest = text;
  for (;;) {
    const std::size_t comma = rest.find(',');
    const Item item{rest.substr(0, comma), text};
    const std::size_t dash = item.text.find('-');
    const std::string_view from = item.text.substr(0, dash);
    const std::string_view to = dash == std::string_view::npos ? from : item.text.substr(dash + 1);
    bool rises = true;
    if (to.ends_with('s') && dash != std::string_view::npos) {
      spans_.push_back({time_in(from, item), time_in(to, item)});
      rises = spans_.back().first <= spans_.back().last;
    } else {
      ranges_.push_back({number_in<std::int64_t>(from, item), number_in<std::int64_t>(to, item)});
      rises = ranges_.back().first <= ranges_.back().last;
    }
    if (!rises) {
      throw UsageError(fmt::format("--frames {}: '{}' ends before it begins", text, item.text));
    }
    if (comma == std::string_view::npos) return;
    rest = rest.substr(comma + 1);
  }
}

bool FrameRanges::contains(std::int64_t frame, Time time) const {
  if (ranges_.empty() && spans_.empty()) return true;
  const auto has = [](const auto& range, auto value) {
    return range.first <= value && value <= range.last;
  };
  return std::ranges::any_of(ranges_, [&](const Range& r) { return has(r, frame); }) ||
         std::ranges::any_of(spans_, [&](const Span& s) { return has(s, time); });
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
