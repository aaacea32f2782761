#include "study/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin::study {

namespace {

[[noreturn]] void fail(const std::string& where, int line, const std::string& what) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", where, line, what));
}

/// Number of bytes of the UTF-8 character at `at`; 0 if there is no valid one.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(at);
  if (first < 0x80) return first == 0 ? 0 : 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  }
  return length;
}

void require_utf8(std::string_view text, const std::string& where) {
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0) {
      fail(where, line, "expected text in UTF-8, found other bytes; save it as CSV in UTF-8");
    }
    const bool alone = text[at] == '\r' && (at + 1 == text.size() || text[at + 1] != '\n');
    if (text[at] == '\n' || alone) ++line;
    at += length;
  }
}

/// The most frequent separator in the line of names, outside quotes.
char separator_of(std::string_view text) {
  constexpr std::string_view kSeparators = ",;\t";
  std::array<int, 3> counts{};
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if ((c == '\n' || c == '\r') && !quoted) break;
    const std::size_t which = kSeparators.find(c);
    if (which != std::string_view::npos && !quoted) ++counts[which];
  }
  return kSeparators[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
}

/// Takes rows from a text, one after the other.
class RowReader {
 public:
  RowReader(std::string_view text, char separator, const std::string& where)
      : text_(text), separator_(separator), where_(where) {}

  bool at_end() const { return at_ >= text_.size(); }

  CsvRow next() {
    CsvRow row{line_, {}};
    do row.cells.push_back(cell(row.line));
    while (take(separator_));
    const bool carriage_return = take('\r');  // alone or before a line feed, it ends a line
    if (!take('\n') && !carriage_return && !at_end()) {
      fail(where_, line_, "expected the end of a cell behind a quote");
    }
    ++line_;
    return row;
  }

 private:
  bool take(char c) {
    if (at_end() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  std::string cell(int line) {
    if (take('"')) return quoted(line);
    const std::size_t begin = at_;
    while (!at_end() && text_[at_] != separator_ && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
    return trimmed(std::string(text_.substr(begin, at_ - begin)));
  }

  std::string quoted(int line) {
    std::string value;
    while (!at_end()) {
      const char c = text_[at_++];
      if (c == '"' && !take('"')) return trimmed(value);
      if (c == '\n' || (c == '\r' && (at_end() || text_[at_] != '\n'))) ++line_;
      value += c;
    }
    fail(where_, line, "expected a quote that closes the one that is opened here, found none");
  }

  std::string_view text_;
  char separator_;
  const std::string& where_;
  std::size_t at_ = 0;
  int line_ = 1;
};

bool is_empty(const CsvRow& row) {
  return std::ranges::all_of(row.cells, [](const std::string& cell) { return cell.empty(); });
}

void check_names(const CsvTable& table, int line) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const std::string& name = table.columns[i];
    if (name.empty()) fail(table.where, line, fmt::format("column {} has no name", i + 1));
    if (std::ranges::count(table.columns, name) > 1) {
      fail(table.where, line, fmt::format("column '{}' occurs twice", shown(name)));
    }
  }
}

}  // namespace

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto found = std::ranges::find(columns, column);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

std::size_t CsvTable::require(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  throw std::invalid_argument(fmt::format("{}:1: expected a column '{}', found {}", where, column,
                                          fmt::join(columns, ", ")));
}

std::string trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

CsvTable parse_csv(std::string_view text, const std::string& where) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  require_utf8(text, where);
  CsvTable table{where, separator_of(text), {}, {}};
  RowReader reader(text, table.separator, where);
  while (!reader.at_end()) {
    CsvRow row = reader.next();
    if (is_empty(row)) continue;
    if (table.columns.empty()) {
      table.columns = row.cells;
      check_names(table, row.line);
    } else if (row.cells.size() != table.columns.size()) {
      fail(where, row.line,
           fmt::format("expected {} cells, found {}", table.columns.size(), row.cells.size()));
    } else {
      table.rows.push_back(std::move(row));
    }
  }
  if (table.columns.empty()) fail(where, 1, "expected a line of column names, found nothing");
  return table;
}

std::optional<double> number_in(const CsvTable& table, const std::string& cell) {
  std::string text = cell;
  if (table.separator != ',') std::ranges::replace(text, ',', '.');
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<int> whole_in(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    if (cells[i].find_first_of(",;\"\r\n\t") == std::string::npos) {
      line += cells[i];
      continue;
    }
    line += '"';
    for (const char c : cells[i]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

std::string shown(std::string_view cell) {
  constexpr std::size_t kMost = 40;
  std::string text;
  for (std::size_t at = 0; at < cell.size();) {
    const std::size_t length = std::max<std::size_t>(1, utf8_length(cell, at));
    if (text.size() + length > kMost) return text + "...";
    const bool plain = static_cast<unsigned char>(cell[at]) >= 0x20 && cell[at] != 0x7f;
    text += plain ? std::string(cell.substr(at, length)) : std::string("?");
    at += length;
  }
  return text;
}

void refuse(const CsvTable& table, const CsvRow& row, const std::string& expected,
            const std::string& found) {
  fail(table.where, row.line, fmt::format("expected {}, found '{}'", expected, shown(found)));
}

void refuse_cell(const CsvTable& table, const CsvRow& row, std::string_view column,
                 const std::string& expected, const std::string& found) {
  const std::string cell = fmt::format("'{}'", shown(table.cell(row, column)));
  fail(table.where, row.line,
       fmt::format("column {}: expected {}, found {}", column, expected,
                   found.empty() ? cell : found));
}

}  // namespace headpin::study
