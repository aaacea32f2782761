#include "devices/recordings/marker_file.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/any_table.h"
#include "devices/recordings/column_names.h"
#include "devices/recordings/table_time.h"
#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

/// A line that is neither blank nor a remark.
struct EventLine {
  std::string_view text;
  std::size_t number;
  std::vector<std::string_view> cells;
};

std::vector<EventLine> event_lines(std::string_view text) {
  std::vector<EventLine> lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = trimmed(take_front(text, '\n'));
    if (!line.empty() && line.front() != '#') lines.push_back({line, number, split_cells(line)});
  }
  return lines;
}

/// The column of the times, from a header; none without one.
std::optional<std::size_t> time_column(const std::vector<std::string_view>& header) {
  for (std::size_t c = 0; c < header.size(); ++c) {
    const std::string name = small_letters(header[c]);
    if (name == "onset" || name == "t" || name.starts_with("time")) return c;
  }
  return std::nullopt;
}

/// How the cells of a file tell times. Those of a column that a header names are read together: without a header
/// it is not known which cells are of one kind.
struct EventTimes {
  double unit_s;
  std::optional<std::size_t> column;
  std::size_t colon_decimals = 0;  // of that column

  EventTimes(const std::vector<EventLine>& lines, double unit) : unit_s(unit) {
    if (!lines.empty()) column = time_column(lines.front().cells);
    if (!column) return;
    std::vector<std::string_view> cells;
    for (const EventLine& line : lines) {
      if (*column < line.cells.size()) cells.push_back(line.cells[*column]);
    }
    colon_decimals = devices::colon_decimals(cells);
  }

  std::optional<double> of(const EventLine& line, std::size_t c) const {
    return column == c ? time_of(line.cells[c], unit_s, colon_decimals)
                       : time_of(line.cells[c], unit_s);
  }
};

/// A grab or a release as a line says it.
struct Marker {
  Stamped<bool> pressed;
  std::size_t line;
  std::string_view time;
};

/// Another word of a line.
struct OtherWord {
  std::string_view word;
  std::size_t line;
};

/// What a file of markers says.
struct MarkerLines {
  std::vector<Marker> markers;
  std::vector<OtherWord> others;
};

/// The first cell that is a word and no time; empty if there is none.
std::string_view word_in(const EventLine& line, const EventTimes& times) {
  for (std::size_t c = 0; c < line.cells.size(); ++c) {
    const std::string_view cell = line.cells[c];
    if (cell != "n/a" && !words_of(cell).empty() && !times.of(line, c)) return cell;
  }
  return {};
}

/// What a line says: that of its first cell with such a word, as a cell behind it may be a remark.
std::optional<bool> pressed_in(const EventLine& line) {
  if (line.text.find_first_of(";\t,") == std::string_view::npos)
    return pressed_by(words_of(line.text));
  for (const std::string_view cell : line.cells) {
    if (const auto pressed = pressed_by(words_of(cell))) return pressed;
  }
  return std::nullopt;
}

MarkerLines read_lines(std::string_view text, std::string_view where, double unit_s,
                       std::optional<Time> near) {
  const std::vector<EventLine> lines = event_lines(text);
  const EventTimes times(lines, unit_s);
  MarkerLines read;
  for (std::size_t i = times.column ? 1 : 0; i < lines.size(); ++i) {
    const EventLine& line = lines[i];
    const std::optional<bool> pressed = pressed_in(line);
    if (!pressed) {
      const std::string_view word = word_in(line, times);
      if (!word.empty()) read.others.push_back({word, line.number});
      continue;
    }
    std::optional<double> time_s;
    std::size_t at = 0;
    for (std::size_t c = 0; c < line.cells.size() && !time_s; ++c) {
      if (!times.column || *times.column == c) time_s = times.of(line, at = c);
    }
    if (!time_s || std::abs(*time_s) > 1e11) {
      throw std::invalid_argument(fmt::format("{}:{}: expected a time beside '{}'", where,
                                              line.number, line.text.substr(0, 60)));
    }
    if (near && is_time_of_day(line.cells[at])) *time_s = on_nearest_day(*time_s, seconds(*near));
    read.markers.push_back({{microseconds(*time_s), *pressed}, line.number, line.cells[at]});
  }
  return read;
}

/// Refuses a file without a grab and a release after it, and says what is nearest to them.
[[noreturn]] void refuse_lines(const MarkerLines& read, std::string_view where) {
  const auto first = [&](bool pressed) {
    return std::ranges::find_if(
        read.markers, [&](const Marker& marker) { return marker.pressed.value == pressed; });
  };
  const auto grab = first(true), release = first(false);
  if (grab != read.markers.end() && release != read.markers.end()) {
    throw std::invalid_argument(fmt::format(
        "{}:{}: the release ({}) is {} the grab ({}); expected a later time", where, release->line,
        release->time, release->pressed.time < grab->pressed.time ? "before" : "not after",
        grab->time));
  }
  constexpr std::size_t kLongest = 40;
  if (read.others.size() == 1) {
    const auto& [word, line] = read.others.front();
    throw std::invalid_argument(fmt::format("{}:{}: unknown word '{}'; expected grab or release",
                                            where, line, word.substr(0, kLongest)));
  }
  std::vector<std::string> found;
  const auto add = [&](std::string_view word) {
    std::string name(word.substr(0, kLongest));
    if (found.size() < 4 && std::ranges::find(found, name) == found.end())
      found.push_back(std::move(name));
  };
  if (!read.markers.empty()) add(grab != read.markers.end() ? "grab" : "release");
  for (const OtherWord& other : read.others) add(other.word);
  throw std::invalid_argument(fmt::format(
      "{}: expected a line with a time and grab, and one with a later time and release; "
      "found {}",
      where, found.empty() ? "none" : fmt::format("{}", fmt::join(found, ", "))));
}

}  // namespace

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
  if (is("not")) {  // "not pressed"
    std::vector<std::string> others = words;
    std::erase(others, "not");
    const std::optional<bool> pressed = pressed_by(others);
    return pressed ? std::optional(!*pressed) : std::nullopt;
  }
  if (any({"pick"})) return true;  // up, too
  if (any({"unpress", "notpress", "release", "throw", "drop", "letgo"}) || is("let") || is("up"))
    return false;
  if (any({"grab", "grasp", "press", "take", "hold"}) || is("down")) return true;
  return std::nullopt;
}

std::vector<Stamped<bool>> parse_markers(std::string_view text, std::string_view where,
                                         double unit_s, std::optional<Time> near) {
  const MarkerLines read = read_lines(text, where, unit_s, near);
  std::vector<Stamped<bool>> markers;
  for (const Marker& marker : read.markers) markers.push_back(marker.pressed);
  std::ranges::stable_sort(markers, {}, &Stamped<bool>::time);
  const auto same = [](const Stamped<bool>& a, const Stamped<bool>& b) {
    return a.value == b.value;
  };
  markers.erase(std::unique(markers.begin(), markers.end(), same), markers.end());
  if (!markers.empty() && !markers.front().value) markers.erase(markers.begin());
  if (markers.size() < 2) refuse_lines(read, where);
  return markers;
}

}  // namespace headpin::devices
