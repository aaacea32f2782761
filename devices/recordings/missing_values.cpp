#include "devices/recordings/missing_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace headpin::devices {
namespace {

std::optional<double> as_number(std::string_view text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

MissingValues::MissingValues(const std::string& said)
    : said_(said == "n/a" ? "" : said), number_(as_number(said_)) {}

bool MissingValues::is(std::string_view cell) const {
  if (cell == "n/a") return true;
  if (said_.empty()) return false;
  if (cell == said_) return true;
  const std::optional<double> number = number_ ? as_number(cell) : std::nullopt;
  return number && (*number == *number_ || (std::isnan(*number) && std::isnan(*number_)));
}

bool MissingValues::is_but_for_zero(std::string_view cell) const {
  return number_ == 0.0 ? cell == "n/a" : is(cell);
}

bool MissingValues::is_part_of(std::span<const double, 4> numbers) const {
  if (number_ != 0.0 || !std::ranges::count(numbers, 0.0)) return false;
  double square = 0.0;
  for (const double x : numbers) square += x * x;
  return !(std::abs(std::sqrt(square) - 1.0) < kUnitLength);
}

std::string MissingValues::words() const {
  return said_.empty() ? "n/a" : fmt::format("n/a or {}", said_);
}

}  // namespace headpin::devices
