#include "devices/recordings/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::devices {

std::string_view take_front(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view front = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return front;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

TextTable::TextTable(std::string_view text, std::string_view where, char separator)
    : rest_(text), where_(where), separator_(separator) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool TextTable::next_cells() {
  std::string_view line;
  while (line.empty() && !rest_.empty()) {
    std::string_view whole = take_front(rest_, '\n');
    if (!trimmed(whole).empty()) line = whole;
    ++line_;
  }
  cells_.clear();
  if (line.empty()) return false;
  for (bool more = true; more;) {
    more = line.find(separator_) != std::string_view::npos;
    cells_.push_back(trimmed(take_front(line, separator_)));
  }
  return true;
}

void TextTable::read_names() {
  next_cells();
  if (line_ == 0) line_ = 1;
  names_.assign(cells_.begin(), cells_.end());
  if (names_.size() > 1 && names_.back().empty()) names_.pop_back();
}

bool TextTable::next() {
  if (!next_cells()) return false;
  if (cells_.size() == names_.size() + 1 && cells_.back().empty()) cells_.pop_back();
  if (cells_.size() != names_.size()) {
    fail(fmt::format("expected {} fields, found {}", names_.size(), cells_.size()));
  }
  return true;
}

std::size_t TextTable::column(std::string_view name) const {
  return static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
}

double TextTable::number(std::size_t column) const {
  const std::string_view cell = cells_[column];
  double number = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(number)) {
    fail(fmt::format("{}: expected a finite number, found '{}'", names_[column],
                     cell.substr(0, 40)));
  }
  return number;
}

void TextTable::require_time(std::string_view column, double time) const {
  constexpr double kFurthest = 1e10;
  if (std::abs(time) <= kFurthest) return;
  fail(fmt::format("{}: expected -1e10 to 1e10 s, found {:g}", column, time));
}

void TextTable::fail(const std::string& what) const {
  throw std::invalid_argument(fmt::format("{}:{}: {}", where_, line_, what));
}

}  // namespace headpin::devices
