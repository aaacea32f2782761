#include "devices/recordings/marker_file.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/recordings/any_table.h"
#include "devices/recordings/column_names.h"
#include "devices/recordings/table_time.h"
#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

/// Whether words say a grab (true) or a release (false).
std::optional<bool> pressed_by(const std::vector<std::string>& words) {
  const auto any = [&](std::initializer_list<std::string_view> beginnings) {
    return std::ranges::any_of(words, [&](const std::string& word) {
      return std::ranges::any_of(beginnings,
                                 [&](std::string_view one) { return word.starts_with(one); });
    });
  };
  const auto is = [&](std::string_view word) {
    return std::ranges::find(words, word) != words.end();
  };
  if (any({"pick"})) return true;  // up, too
  if (any({"release", "throw", "drop", "letgo"}) || is("let") || is("up")) return false;
  if (any({"grab", "grasp", "press", "take", "hold"}) || is("down")) return true;
  return std::nullopt;
}

/// The column of the times, from a header; none without one.
std::optional<std::size_t> time_column(const std::vector<std::string_view>& header) {
  for (std::size_t c = 0; c < header.size(); ++c) {
    const std::string name = small_letters(header[c]);
    if (name == "onset" || name == "t" || name.starts_with("time")) return c;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Stamped<bool>> parse_markers(std::string_view text, std::string_view where,
                                         double unit_s) {
  std::vector<Stamped<bool>> markers;
  std::optional<std::size_t> column;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::string_view line = trimmed(take_front(text, '\n'));
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string_view> cells = split_cells(line);
    if (number == 1) column = time_column(cells);
    const std::optional<bool> pressed = pressed_by(words_of(line));
    if (!pressed || (number == 1 && column)) continue;
    std::optional<double> time_s;
    for (std::size_t c = 0; c < cells.size() && !time_s; ++c) {
      if (!column || *column == c) time_s = time_of(cells[c], unit_s);
    }
    if (!time_s || std::abs(*time_s) > 1e11) {
      throw std::invalid_argument(
          fmt::format("{}:{}: expected a time beside '{}'", where, number, line.substr(0, 60)));
    }
    markers.push_back({microseconds(*time_s), *pressed});
  }
  std::ranges::stable_sort(markers, {}, &Stamped<bool>::time);
  const auto same = [](const Stamped<bool>& a, const Stamped<bool>& b) {
    return a.value == b.value;
  };
  markers.erase(std::unique(markers.begin(), markers.end(), same), markers.end());
  if (!markers.empty() && !markers.front().value) markers.erase(markers.begin());
  if (markers.size() < 2) {
    throw std::invalid_argument(
        fmt::format("{}: expected lines with a time and a word such as grab, and then release; "
                    "found {} of them in {} lines",
                    where, markers.size(), number));
  }
  return markers;
}

}  // namespace headpin::devices
