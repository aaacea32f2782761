#include "devices/recordings/table_time.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/base/median_step.h"
#include "devices/recordings/column_names.h"

namespace headpin::devices {
namespace {

std::optional<double> seconds_of(std::string_view unit) {
  if (is_one_of(unit, {"s", "sec", "secs", "second", "seconds"})) return 1.0;
  if (is_one_of(unit, {"ms", "msec", "millis", "milliseconds"})) return 1e-3;
  if (is_one_of(unit, {"us", "usec", "micros", "microseconds"})) return 1e-6;
  if (is_one_of(unit, {"ns", "nsec", "nanos", "nanoseconds"})) return 1e-9;
  return std::nullopt;
}

/// Takes a whole number of up to `most` digits from the front.
std::optional<int> take_digits(std::string_view& text, std::size_t most) {
  std::size_t n = 0;
  int number = 0;
  while (n < most && n < text.size() && text[n] >= '0' && text[n] <= '9')
    number = 10 * number + (text[n++] - '0');
  text.remove_prefix(n);
  if (n == 0) return std::nullopt;
  return number;
}

/// The digits behind the third colon of a time: "7" of "12:00:01:7"; empty where there is no such colon.
std::string_view behind_third_colon(std::string_view text) {
  std::size_t colon = text.find(':');
  for (int further = 0; further < 2; ++further) {
    if (colon == std::string_view::npos) return {};
    const std::size_t next = text.find(':', colon + 1);
    if (next != std::string_view::npos && next - colon > 3)
      return {};  // a zone's: "12:00:00+02:00"
    colon = next;
  }
  if (colon == std::string_view::npos) return {};
  text.remove_prefix(colon + 1);
  return text.substr(0, text.find_first_not_of("0123456789"));
}

/// The fraction of a second behind a point, a comma, or a colon.
///
/// @param colon_decimals  of a whole number behind a colon; 0 where it is none
double take_fraction(std::string_view& text, std::size_t colon_decimals) {
  if (text.empty() || std::string_view(".,:").find(text[0]) == std::string_view::npos) return 0.0;
  const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
  double fraction = 0.0, unit = 0.1;
  if (text[0] == ':') {
    const std::size_t digits = end - 1;
    if (digits == 0 || digits > colon_decimals) return 0.0;
    for (std::size_t i = digits; i < colon_decimals; ++i) unit *= 0.1;
  }
  for (std::size_t i = 1; i < end; ++i, unit *= 0.1) fraction += unit * (text[i] - '0');
  text.remove_prefix(end);
  return fraction;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Takes blanks, also U+00A0, U+2009 and U+202F, which do not break a line, and what is written in their place
/// where only ASCII or Latin-1 can be.
void take_blanks(std::string_view& text) {
  constexpr std::array<std::string_view, 6> kBlanks = {
      " ", "\xc2\xa0", "\xe2\x80\x89", "\xe2\x80\xaf", "\xa0", "?"};
  const auto is_next = [&](std::string_view blank) { return text.starts_with(blank); };
  for (auto blank = std::ranges::find_if(kBlanks, is_next); blank != kBlanks.end();
       blank = std::ranges::find_if(kBlanks, is_next)) {
    text.remove_prefix(blank->size());
  }
}

/// 'a' for "AM", "a.m." and "a. m.", 'p' for "PM"; none for other words, such as "AMT".
std::optional<char> half_of_day(std::string_view text) {
  const bool before_noon = take(text, "aA");
  if (!before_noon && !take(text, "pP")) return std::nullopt;
  take(text, ".");
  take_blanks(text);
  if (!take(text, "mM") || (!text.empty() && is_letter(text.front()))) return std::nullopt;
  return before_noon ? 'a' : 'p';
}

/// What the text behind a time of day adds to it [s]: "+02:00", "+0200" and "+02" -7200; "PM" half a day, but
/// nothing to 12 o'clock; "AM" takes half a day from 12 o'clock. "Z", names of zones and other words add nothing.
///
/// @return  none for a zone or an hour that cannot be, and for more numbers
std::optional<double> after_clock(std::string_view text, int hour) {
  take_blanks(text);
  if (const std::optional<char> half = half_of_day(text)) {
    if (hour < 1 || hour > 12) return std::nullopt;
    return 43200.0 * ((half == 'p' ? 1 : 0) - (hour == 12 ? 1 : 0));
  }
  if (text.empty()) return 0.0;
  constexpr std::string_view kOfNumbers = "0123456789:.,;";
  const bool east = text.starts_with('+');
  if (!take(text, "+-")) {
    if (kOfNumbers.find(text.front()) != std::string_view::npos) return std::nullopt;
    return 0.0;
  }
  const auto hours = take_digits(text, 2);
  take(text, ":");
  const int minutes = take_digits(text, 2).value_or(0);
  if (!hours || *hours > 15 || minutes > 59) return std::nullopt;
  const double ahead = 3600.0 * *hours + 60.0 * minutes;
  return east ? -ahead : ahead;
}

constexpr double kDay_s = 86400.0;

bool begins_with_date(std::string_view text) {
  return text.size() > 10 && text[4] == '-';
}

/// "2026-11-25T13:57:27.123+01:00", or "13:57:27.123" alone: seconds since 1970, or since midnight. If
/// the text has an offset, in UTC.
///
/// @param colon_decimals  of a whole number behind a third colon; 0 where there is none
std::optional<double> date_seconds(std::string_view text, std::size_t colon_decimals) {
  double days = 0.0;
  std::string_view clock = text;
  if (begins_with_date(text)) {
    const auto year = take_digits(text, 4);
    const bool first = take(text, "-");
    const auto month = take_digits(text, 2);
    const bool second = take(text, "-");
    const auto day = take_digits(text, 2);
    if (!year || !month || !day || !first || !second || !take(text, "T ")) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year{*year},
                                           std::chrono::month{static_cast<unsigned>(*month)},
                                           std::chrono::day{static_cast<unsigned>(*day)}};
    if (!date.ok()) return std::nullopt;
    days = static_cast<double>(std::chrono::sys_days{date}.time_since_epoch().count());
    clock = text;
  }
  const auto hour = take_digits(clock, 2);
  const bool first = take(clock, ":");
  const auto minute = take_digits(clock, 2);
  const bool second = take(clock, ":");
  const auto whole = take_digits(clock, 2);
  if (!hour || !minute || !whole || !first || !second || *hour > 24 || *minute > 59 || *whole > 60)
    return std::nullopt;
  const double fraction = take_fraction(clock, colon_decimals);
  const std::optional<double> rest = after_clock(clock, *hour);
  if (!rest) return std::nullopt;
  return kDay_s * days + 3600.0 * *hour + 60.0 * *minute + *whole + fraction + *rest;
}

std::vector<std::string_view> column_cells(const AnyTable& table, std::size_t column) {
  std::vector<std::string_view> cells;
  for (const AnyTable::Row& row : table.rows) cells.push_back(row.cells[column]);
  return cells;
}

class TimeReader {
 public:
  TimeReader(const AnyTable& table, std::size_t column, std::optional<double> told_s,
             std::string_view where, std::vector<std::string>& notes)
      : table_(table),
        column_(table.columns[column]),
        index_(column),
        colon_decimals_(colon_decimals(column_cells(table, column))),
        told_s_(told_s),
        where_(where),
        notes_(notes) {}

  TableTimes read() const {
    TableTimes times;
    const bool dates = has_dates();
    std::vector<double> numbers;
    for (const AnyTable::Row& row : table_.rows) {
      std::optional<double> time = dates ? cell_date(row) : cell_number(row);
      // A time of day without its date is of the day on which it is nearest to the one before.
      if (dates && time && !numbers.empty() && is_time_of_day(row.cells[index_]))
        *time = on_nearest_day(*time, numbers.back());
      times.of_row.push_back(time);
      if (time) numbers.push_back(*time);
    }
    if (numbers.empty()) refuse_cells();
    times.unit_s = dates ? 1.0 : unit(numbers);
    return times;
  }

 private:
  /// Whether the first cell that says a time says it as a date or a time of day.
  bool has_dates() const {
    for (const AnyTable::Row& row : table_.rows) {
      if (cell_number(row)) return false;
      if (cell_date(row)) return true;
    }
    return false;
  }

  std::optional<double> cell_number(const AnyTable::Row& row) const {
    return table_.number(row.cells[index_]);
  }

  std::optional<double> cell_date(const AnyTable::Row& row) const {
    return date_seconds(row.cells[index_], colon_decimals_);
  }

  [[noreturn]] void refuse_cells() const {
    for (const AnyTable::Row& row : table_.rows) {
      const std::string_view cell = row.cells[index_];
      if (cell.empty()) continue;
      throw std::invalid_argument(fmt::format("{}:{}: {}: '{}' is no time", where_, row.line,
                                              column_.name, cell.substr(0, 40)));
    }
    throw std::invalid_argument(fmt::format("{}: {}: no row has a time", where_, column_.name));
  }

  double unit(const std::vector<double>& numbers) const {
    if (told_s_) return *told_s_;
    if (const auto said = seconds_of(unit_of(column_))) return *said;
    const double step = median_step(numbers);
    if (const auto rate = table_.number(table_.fact("rate")); rate && step == 1.0)
      return 1.0 / *rate;
    constexpr std::array<std::pair<double, const char*>, 5> kUnits = {
        {{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}, {1e-7, "ticks of 100 ns"}}};
    for (const auto& [unit_s, name] : kUnits) {
      const double seconds = step * unit_s;
      if (seconds < 0.0025 || seconds > 0.05) continue;
      notes_.push_back(fmt::format(
          "the time has no unit; read in {}, as it advances by {:.4g} a row", name, step));
      return unit_s;
    }
    throw std::invalid_argument(
        fmt::format("{}: {}: expected a unit of the time, as it advances by {:.4g} a row: s, ms, "
                    "us, ns, or a rate such as 90Hz where it counts frames",
                    where_, column_.name, step));
  }

  const AnyTable& table_;
  const FoundColumn& column_;
  std::size_t index_;
  std::size_t colon_decimals_;
  std::optional<double> told_s_;
  std::string_view where_;
  std::vector<std::string>& notes_;
};

using TimeNames = std::array<std::string_view, 4>;

/// The best names first.
constexpr std::array<TimeNames, 3> kTimeNames = {{{"time", "timestamp", "t", "elapsed"},
                                                  {"timestamps", "seconds", "sec", "utc"},
                                                  {"frame", "sample", "frames", "index"}}};

bool counts_frames(const TimeNames& names) {
  return names.front() == "frame";
}

/// The columns that have one of the names.
std::vector<std::size_t> named_times(const AnyTable& table, const TimeNames& names) {
  std::vector<std::size_t> found;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::vector<std::string> words = words_of(table.columns[c].last);
    const bool named = std::ranges::any_of(words, [&](const std::string& word) {
      return std::ranges::find(names, word) != names.end();
    });
    // "time_frame" is a number of frames.
    const bool frames = !counts_frames(names) && std::ranges::find(words, "frame") != words.end();
    if (named && !frames && component_of(table.columns[c].name).quantity == Quantity::none)
      found.push_back(c);
  }
  return found;
}

/// The share of rows in which a column's time advances, less those in which it goes back. It is about 0
/// for the time since the row before.
double advance(const AnyTable& table, std::size_t column) {
  std::ptrdiff_t ahead = 0, rows = 0;
  std::optional<double> before;
  for (const AnyTable::Row& row : table.rows) {
    const std::string_view cell = row.cells[column];
    const std::optional<double> number = table.number(cell);
    const std::optional<double> time = number ? number : time_of(cell, 1.0);
    if (!time) continue;
    ++rows;
    if (before) ahead += *time > *before ? 1 : *time < *before ? -1 : 0;
    before = time;
  }
  return rows == 0 ? 0.0 : static_cast<double>(ahead) / static_cast<double>(rows);
}

/// The first of several columns that advances at least half as often as any of them.
std::optional<std::size_t> most_advancing(const AnyTable& table,
                                          const std::vector<std::size_t>& columns) {
  if (columns.empty()) return std::nullopt;
  if (columns.size() == 1) return columns.front();
  std::vector<double> advances;
  for (const std::size_t column : columns) advances.push_back(advance(table, column));
  const double half = 0.5 * std::max(0.0, std::ranges::max(advances));
  const auto first = std::ranges::find_if(advances, [&](double each) { return each >= half; });
  if (first == advances.end()) return columns.front();
  return columns[static_cast<std::size_t>(first - advances.begin())];
}

}  // namespace

std::string unit_of(const FoundColumn& column) {
  if (!column.unit.empty()) return column.unit;
  const std::vector<std::string> words = words_of(column.last);
  return words.size() < 2 ? "" : words.back();
}

std::size_t colon_decimals(const std::vector<std::string_view>& times) {
  std::size_t least = std::string_view::npos, most = 0;
  for (const std::string_view time : times) {
    const std::size_t digits = behind_third_colon(time).size();
    if (digits > 0) least = std::min(least, digits), most = std::max(most, digits);
  }
  if (most != 3 && most != 6 && most != 9) return 0;
  const auto is_late = [&](std::string_view time) {
    const std::string_view digits = behind_third_colon(time);
    return digits.size() == most && digits.front() >= '5';
  };
  return least == most || std::ranges::any_of(times, is_late) ? most : 0;
}

std::optional<double> time_of(std::string_view cell, double unit_s) {
  return time_of(cell, unit_s, colon_decimals({cell}));
}

std::optional<double> time_of(std::string_view cell, double unit_s, std::size_t colon_decimals) {
  AnyTable plain;
  if (const auto number = plain.number(cell)) return unit_s * *number;
  plain.decimal_comma = true;
  if (const auto number = plain.number(cell)) return unit_s * *number;
  return date_seconds(cell, colon_decimals);
}

bool is_time_of_day(std::string_view time) {
  return time.find(':') != std::string_view::npos && !begins_with_date(time);
}

double on_nearest_day(double time_s, double other_s) {
  return time_s + kDay_s * std::round((other_s - time_s) / kDay_s);
}

std::optional<std::size_t> find_time(const AnyTable& table) {
  for (const TimeNames& names : kTimeNames) {
    if (const auto best = most_advancing(table, named_times(table, names))) return best;
  }
  return std::nullopt;
}

std::vector<std::size_t> other_times(const AnyTable& table, std::size_t column) {
  const double half = 0.5 * advance(table, column);
  std::vector<std::size_t> others;
  for (const TimeNames& names : kTimeNames) {
    if (counts_frames(names)) continue;
    for (const std::size_t other : named_times(table, names)) {
      if (other == column || std::ranges::find(others, other) != others.end()) continue;
      if (const double its = advance(table, other); its > 0.0 && its >= half)
        others.push_back(other);
    }
  }
  return others;
}

TableTimes read_times(const AnyTable& table, std::size_t column, std::optional<double> told_unit_s,
                      std::string_view where, std::vector<std::string>& notes) {
  return TimeReader(table, column, told_unit_s, where, notes).read();
}

}  // namespace headpin::devices
