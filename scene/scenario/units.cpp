#include "scene/scenario/units.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace headpin::scene {
namespace {

bool is_digit_at(std::string_view text, std::size_t at) {
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

/// The end of the digits that begin at `at`.
std::size_t after_digits(std::string_view text, std::size_t at) {
  while (is_digit_at(text, at)) ++at;
  return at;
}

/// How many bytes of the text are a number at its beginning.
std::size_t number_size(std::string_view text) {
  std::size_t at = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  if (!is_digit_at(text, at)) return 0;
  at = after_digits(text, at);
  if (at < text.size() && text[at] == '.' && is_digit_at(text, at + 1)) {
    at = after_digits(text, at + 1);
  }
  if (at >= text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  const bool sign = at + 1 < text.size() && (text[at + 1] == '-' || text[at + 1] == '+');
  const std::size_t power = at + (sign ? 2 : 1);
  return is_digit_at(text, power) ? after_digits(text, power) : at;
}

}  // namespace

std::string_view unit_of(std::string_view key, std::string_view meaning) {
  if (key == "mass") return "kg";
  if (key.ends_with("_s")) return "s";
  if (key.ends_with("_hz")) return "Hz";
  if (key.ends_with("_deg")) return "degrees";
  const std::size_t open = meaning.rfind('[');
  if (!meaning.ends_with(']') || open == std::string_view::npos) return {};
  return meaning.substr(open + 1, meaning.size() - open - 2);
}

std::optional<QuotedNumber> quoted_number(std::string_view text) {
  constexpr std::size_t kLongest = 12;  // of a unit
  const std::size_t size = number_size(text);
  if (size == 0) return std::nullopt;
  QuotedNumber found{text.substr(0, size), text.substr(size)};
  while (found.unit.starts_with(' ')) found.unit.remove_prefix(1);
  while (found.unit.ends_with(' ')) found.unit.remove_suffix(1);
  const bool letters = std::ranges::all_of(found.unit, [](unsigned char c) {
    return std::isalpha(c) != 0 || c == '/' || c == '^' || c == '2' || c == '%' || c >= 0x80;
  });
  if (!letters || found.unit.size() > kLongest) return std::nullopt;
  return found;
}

bool is_unit(std::string_view found, std::string_view unit) {
  using Names = std::pair<std::string_view, std::string_view>;
  if (found.empty() || found == unit) return true;
  if (unit.empty()) {
    for (const std::string_view one : {"m", "m/s", "m/s2", "m/s^2"}) {
      if (found == one) return true;
    }
  }
  for (const auto& [other, usual] :
       {Names{"sec", "s"}, Names{"seconds", "s"}, Names{"hz", "Hz"}, Names{"deg", "degrees"},
        Names{"\u00b0", "degrees"}, Names{"m/s^2", "m/s2"}}) {
    if (found == other && unit == usual) return true;
  }
  return false;
}

}  // namespace headpin::scene
