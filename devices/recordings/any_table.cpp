#include "devices/recordings/any_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/recordings/motion_recording.h"
#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

using Cells = std::vector<std::string_view>;

struct Line {
  std::size_t number;
  std::string_view text;
  bool comment = false;
};

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  for (const char quote : {'"', '\''}) {
    if (cell.size() >= 2 && cell.front() == quote && cell.back() == quote) {
      return trimmed(cell.substr(1, cell.size() - 2));
    }
  }
  return cell;
}

/// The cells of a line; a separator between double quotes separates nothing.
Cells split(std::string_view line, char separator) {
  Cells cells;
  std::size_t begin = 0;
  bool quoted = false;
  const auto is_between = [&](char c) {
    return separator == ' ' ? c == ' ' || c == '\t' : c == separator;
  };
  if (separator == ' ') line = trimmed(line);
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || !is_between(line[i]))) continue;
    if (separator != ' ' || i > begin) cells.push_back(unquoted(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  return cells;
}

std::optional<double> number_of(std::string_view cell, bool decimal_comma) {
  std::array<char, 64> copy{};
  if (cell.starts_with('+')) cell.remove_prefix(1);
  if (cell.empty() || cell.size() > copy.size()) return std::nullopt;
  std::ranges::copy(cell, copy.begin());
  if (decimal_comma) std::ranges::replace(copy, ',', '.');
  double number = 0.0;
  const char* const end = copy.data() + cell.size();
  const auto read = std::from_chars(copy.data(), end, number);
  if (read.ec != std::errc{} || read.ptr != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

bool is_blank(std::string_view cell) {
  const std::string text = small_letters(cell);
  return text.empty() || text == "n/a" || text == "na" || text == "nan" || text == "null" ||
         text == "none";
}

/// Lines that have text, without line ends.
std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view line = text.substr(0, end);
    const bool pair = end != std::string_view::npos && text.substr(end).starts_with("\r\n");
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + (pair ? 2 : 1));
    const std::string_view words = trimmed(line);
    if (words.empty()) continue;
    const bool comment =
        words.starts_with('#') || words.starts_with('%') || words.starts_with("//");
    lines.push_back({number, line, comment});
  }
  return lines;
}

/// How a table is written: cells between separators, numbers with a point or a comma.
struct Style {
  char separator = ',';
  bool decimal_comma = false;
};

std::size_t numbers_in(const Cells& cells, bool decimal_comma) {
  return static_cast<std::size_t>(std::ranges::count_if(
      cells, [&](std::string_view cell) { return number_of(cell, decimal_comma).has_value(); }));
}

/// The first of the lines with numbers: most of its cells are no words, and most of those of the line after it.
std::size_t first_row(const std::vector<Line>& lines, const Style& style) {
  const auto looks_like_numbers = [&](const Cells& cells) {
    const std::size_t numbers = numbers_in(cells, style.decimal_comma);
    const auto blank = static_cast<std::size_t>(std::ranges::count_if(cells, is_blank));
    return cells.size() >= 4 && numbers >= 2 && 2 * (numbers + blank) >= cells.size();
  };
  const auto cells_of = [&](std::size_t i) { return split(lines[i].text, style.separator); };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].comment || !looks_like_numbers(cells_of(i))) continue;
    std::size_t next = i + 1;
    while (next < lines.size() && lines[next].comment) ++next;
    if (next == lines.size() || looks_like_numbers(cells_of(next))) {
      return i;
    }
  }
  return lines.size();
}

/// The most usual number of cells of a line, from the first of the numbers.
std::size_t usual_count(const std::vector<Line>& lines, std::size_t from, char separator) {
  std::map<std::size_t, std::size_t> counts;
  for (std::size_t i = from; i < lines.size() && i < from + 200; ++i) {
    if (!lines[i].comment) ++counts[split(lines[i].text, separator).size()];
  }
  return std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; })
      ->first;
}

/// A cell behind the separator at the end of a line is none.
void drop_open_end(Cells& cells, std::size_t columns) {
  if (cells.size() == columns + 1 && cells.back().empty()) cells.pop_back();
}

/// The text of a line of the header, of a comment what is behind its sign.
std::string_view header_text(const Line& line) {
  if (!line.comment) return line.text;
  std::string_view text = trimmed(line.text);
  text.remove_prefix(std::min(text.find_first_not_of("#%/ \t"), text.size()));
  return text;
}

std::size_t filled_in(const Cells& cells) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cells, [](std::string_view cell) { return !cell.empty(); }));
}

/// Whether each tab begins a column, so that empty cells are those of columns: most rows have equally many
/// cells, and a line above them has a name for each. Else several tabs may be one separator.
bool each_tab_begins_a_column(const std::vector<Line>& lines, const Style& style) {
  const std::size_t begin = first_row(lines, style);
  if (begin == lines.size()) return false;
  const std::size_t columns = usual_count(lines, begin, style.separator);
  std::size_t rows = 0, usual = 0, least_filled = columns, most_filled = 0;
  bool open = true;  // a tab ends each row
  for (std::size_t i = begin; i < lines.size(); ++i) {
    if (lines[i].comment) continue;
    Cells cells = split(lines[i].text, style.separator);
    drop_open_end(cells, columns);
    const std::size_t filled = filled_in(cells);
    if (cells.size() > columns && filled <= columns) return false;  // some of its tabs only align
    ++rows;
    if (cells.size() != columns) continue;
    ++usual;
    least_filled = std::min(least_filled, filled);
    most_filled = std::max(most_filled, filled);
    open = open && cells.back().empty();
  }
  if (10 * usual < 9 * rows) return false;
  const auto names_each = [&](const Line& line) {
    Cells cells = split(header_text(line), style.separator);
    drop_open_end(cells, columns);
    if (cells.size() != columns && !(open && cells.size() + 1 == columns)) return false;
    const std::size_t names = filled_in(cells);
    if (names <= least_filled || numbers_in(cells, style.decimal_comma) > 0) return false;
    // One may have no name, unless blanks part rows into as many cells as there are names.
    return names == columns || (names + 1 == columns && (open || names != most_filled));
  };
  return std::any_of(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(begin), names_each);
}

/// The style in which most cells of the last lines are numbers.
Style style_of(const std::vector<Line>& lines) {
  constexpr std::size_t kLooked = 50;
  Style best;
  double most = 0.0;
  const std::size_t first = lines.size() - std::min(lines.size(), kLooked);
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    for (const bool decimal_comma : {false, true}) {
      if (separator == ',' && decimal_comma) continue;
      const Style style{separator, decimal_comma};
      std::size_t words = 0, empty = 0, numbers = 0;
      for (std::size_t i = first; i < lines.size(); ++i) {
        if (lines[i].comment) continue;
        const Cells cells = split(lines[i].text, separator);
        words += filled_in(cells);
        empty += cells.size() - filled_in(cells);
        numbers += numbers_in(cells, decimal_comma);
      }
      if (numbers == 0) continue;
      if (separator == '\t' && empty > 0 && !each_tab_begins_a_column(lines, style)) words += empty;
      // Many numbers, and few words beside them.
      const double score =
          static_cast<double>(numbers) * static_cast<double>(numbers) / static_cast<double>(words);
      if (score > most) most = score, best = style;
    }
  }
  return best;
}

/// The unit in brackets at the end of a header's cell, which loses it: "x [mm]".
std::string take_unit(std::string& name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const std::size_t begin = name.rfind(open);
    if (begin == std::string::npos || name.back() != close) continue;
    const std::string unit =
        small_letters(trimmed(std::string_view(name).substr(begin + 1, name.size() - begin - 2)));
    name = trimmed(std::string_view(name).substr(0, begin));
    return unit;
  }
  return "";
}

/// "ms" of "[ms]" and "(ms)".
std::string_view without_brackets(std::string_view cell) {
  const bool in_brackets = cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                               (cell.front() == '(' && cell.back() == ')'));
  return in_brackets ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

bool is_unit(std::string_view cell) {
  constexpr std::array kUnits = {"m",       "cm",     "mm",     "in",      "ft",  "s",
                                 "ms",      "us",     "ns",     "deg",     "rad", "degrees",
                                 "radians", "meters", "metres", "seconds", "1",   "-",
                                 "quat",    "%",      "v",      "bool",    "0/1", "\u00b0"};
  return std::ranges::find(kUnits, small_letters(without_brackets(cell))) != kUnits.end();
}

/// Whether most words of a line are units: a row of units. A word beside them may be one that is not
/// known here.
bool are_units(const Cells& cells) {
  const auto words = std::ranges::count_if(cells, [](auto cell) { return !cell.empty(); });
  const auto units = std::ranges::count_if(cells, is_unit);
  return units == words || (units >= 2 && 2 * units > words);
}

/// The lines above the numbers, as rows of cells.
class Header {
 public:
  /// How many names a comment may have, to be one of names.
  struct Names {
    std::size_t fewest;
    std::size_t most;
  };

  Header(const Style& style, std::size_t columns, const Names& of_comment)
      : style_(style), columns_(columns), of_comment_(of_comment) {}

  void take(const Line& line, bool last, AnyTable& table) {
    if (line.comment && !last) return;
    Cells cells = split(header_text(line), style_.separator);
    drop_open_end(cells, columns_);
    const bool names_columns =
        cells.size() >= of_comment_.fewest && cells.size() <= of_comment_.most;
    if (line.comment && !names_columns) return;
    if (take_facts(cells, table)) return;
    if (are_units(cells)) {
      units_ = cells;
      return;
    }
    // "Laboratory 3;P07;throw 2" says nothing of the columns.
    const bool whole = std::ranges::none_of(cells, &std::string_view::empty);
    if (!last && whole && 2 * cells.size() <= columns_) return;
    rows_.push_back(std::move(cells));
  }

  std::vector<FoundColumn> columns() {
    fill();
    std::vector<FoundColumn> all(columns_);
    for (std::size_t c = 0; c < columns_; ++c) {
      FoundColumn& column = all[c];
      for (const Cells& row : rows_) {
        if (c >= row.size() || row[c].empty()) continue;
        std::string name(row[c]);
        const std::string unit = take_unit(name);
        if (!unit.empty()) column.unit = unit;
        if (name.empty()) continue;
        column.written = row[c];
        column.last = name;
        column.name += (column.name.empty() ? "" : " ") + name;
      }
      if (column.name.empty()) column.name = column.last = fmt::format("#{}", c + 1);
      if (c < units_.size() && is_unit(units_[c])) {
        column.unit = small_letters(without_brackets(units_[c]));
      }
    }
    return all;
  }

 private:
  /// Motive's first line and Vicon's first two say what follows.
  bool take_facts(const Cells& cells, AnyTable& table) {
    if (cells.front() == "Format Version") {
      table.kind = "Motive";
      for (std::size_t i = 0; i + 1 < cells.size(); i += 2) {
        table.facts.emplace_back(small_letters(cells[i]), small_letters(cells[i + 1]));
      }
      return true;
    }
    if (filled_in(cells) != 1 || cells.front().empty() || columns_ < 4) return false;
    const std::string only = small_letters(cells.front());
    if (only == "segments" || only == "objects") table.kind = "Vicon";
    if (number_of(only, style_.decimal_comma)) table.facts.emplace_back("rate", only);
    return true;  // a title
  }

  /// A name above several columns stands over the first of them.
  void fill() {
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
      std::string_view above;
      rows_[i].resize(std::max(rows_[i].size(), columns_));
      for (std::string_view& cell : rows_[i]) {
        if (cell.empty()) cell = above;
        above = cell;
      }
    }
  }

  Style style_;
  std::size_t columns_;
  Names of_comment_;
  std::vector<Cells> rows_;
  Cells units_;
};

}  // namespace

std::vector<std::string_view> split_cells(std::string_view line) {
  for (const char separator : {';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return split(line, separator);
  }
  // "1,2 grab": the comma is in a number.
  const Cells words = split(line, ' ');
  const std::size_t comma = line.find(',');
  const bool decimal = words.size() > 1 && !words[0].ends_with(',') && number_of(words[0], true);
  return comma == std::string_view::npos || decimal ? words : split(line, ',');
}

std::string small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

std::optional<double> AnyTable::number(std::string_view cell) const {
  return number_of(cell, decimal_comma);
}

std::string AnyTable::fact(std::string_view name) const {
  const auto found = std::ranges::find(facts, name, &std::pair<std::string, std::string>::first);
  return found == facts.end() ? "" : found->second;
}

std::string names_in(const AnyTable& table) {
  constexpr std::size_t kMost = 120;
  std::string names;
  for (const FoundColumn& column : table.columns) {
    const bool first = names.empty();
    if (names.size() + column.name.size() > kMost) {
      names += first ? "..." : ", ...";
      break;
    }
    names += (first ? "" : ", ") + column.name;
  }
  return fmt::format("the {} columns are {}", table.columns.size(), names);
}

void require_rows(std::string_view text, std::string_view where) {
  constexpr std::size_t kLongestHeading = 4;  // lines: names, parts of names, units
  const std::vector<Line> lines = lines_of(text);
  const auto has_names_alone = [](const Line& line) {
    return std::ranges::any_of(std::string_view(",;\t|"), [&](char separator) {
      const Cells cells = split(line.text, separator);
      return cells.size() >= 4 && numbers_in(cells, false) == 0;
    });
  };
  if (lines.empty() || lines.size() > kLongestHeading) return;
  if (!std::ranges::all_of(lines, has_names_alone)) return;
  throw std::invalid_argument(fmt::format(
      "{}: has column names but no rows; expected at least {} samples", where, kFewestSamples));
}

AnyTable read_any_table(std::string_view text, std::string_view where) {
  const std::vector<Line> lines = lines_of(text);
  constexpr std::size_t kLongestLine = 1'000'000, kMostColumns = 4'000;
  for (const Line& line : lines) {
    if (line.text.size() <= kLongestLine) continue;
    throw std::invalid_argument(
        fmt::format("{}:{}: expected a line of a table, found one of {} bytes", where, line.number,
                    line.text.size()));
  }
  const Style style = style_of(lines);
  const std::size_t begin = first_row(lines, style);
  if (begin == lines.size()) {
    require_rows(text, where);
    throw std::invalid_argument(
        fmt::format("{}: expected a table: lines with at least four cells, most of them numbers; "
                    "found none in {} lines",
                    where, lines.size()));
  }
  AnyTable table;
  table.separator = style.separator;
  table.decimal_comma = style.decimal_comma;
  std::size_t columns = usual_count(lines, begin, style.separator);
  if (columns > kMostColumns) {
    throw std::invalid_argument(fmt::format("{}:{}: expected at most {} columns, found {}", where,
                                            lines[begin].number, kMostColumns, columns));
  }
  // Some programs end each line with a separator.
  const std::size_t usual = columns;
  bool open = style.separator != ' ' && columns > 4, odd_ones = false;
  for (std::size_t i = begin; open && i < lines.size(); ++i) {
    if (lines[i].comment) continue;
    const Cells cells = split(lines[i].text, style.separator);
    if (cells.size() == usual) open = cells.back().empty();
    odd_ones = odd_ones || cells.size() != usual;
  }
  if (open && !odd_ones) --columns;

  Header header(style, columns, {.fewest = open ? usual - 1 : usual, .most = usual});
  for (std::size_t i = 0; i < begin; ++i) header.take(lines[i], i + 1 == begin, table);
  table.columns = header.columns();
  std::size_t odd = 0, first_odd = 0;
  for (std::size_t i = begin; i < lines.size(); ++i) {
    if (lines[i].comment) continue;
    Cells cells = split(lines[i].text, style.separator);
    drop_open_end(cells, columns);
    if (cells.size() != columns) {
      if (odd++ == 0) first_odd = lines[i].number;
      continue;
    }
    table.rows.push_back({lines[i].number, std::move(cells)});
  }
  if (odd > 0) {
    table.notes.push_back(fmt::format(
        "{} of {} lines have another number of cells than {}, the first is line {}: ignored", odd,
        odd + table.rows.size(), columns, first_odd));
  }
  return table;
}

}  // namespace headpin::devices
