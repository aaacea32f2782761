#include "apps/quantity.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin::apps {

namespace {

/// A number as it was typed.
struct Typed {
  double value = 0.0;  ///< in the unit of the result
  double unit = 1.0;   ///< size of the unit that was typed, or is meant
};

/// A number with a unit; nothing if it is none.
/// @param meant  size of the unit of a number without one
std::optional<Typed> in_unit(std::string_view typed, std::span<const Unit> units, double meant) {
  double value = 0.0;
  const char* const end = typed.data() + typed.size();
  const auto [rest, error] = std::from_chars(typed.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  std::string_view name(rest, static_cast<std::size_t>(end - rest));
  while (name.starts_with(' ')) name.remove_prefix(1);
  if (name.empty()) return Typed{value * meant, meant};
  for (const Unit& unit : units) {
    if (name == unit.name) return Typed{value * unit.size, unit.size};
  }
  return std::nullopt;
}

/// "m/s, or in mph, km/h"; with a blank before it, where there is a unit.
std::string in_words(std::span<const Unit> units) {
  if (units.empty()) return "";
  std::vector<const char*> others;
  for (const Unit& unit : units.subspan(1)) others.push_back(unit.name);
  return fmt::format(" {}{}", units.front().name,
                     others.empty() ? "" : fmt::format(", or in {}", fmt::join(others, ", ")));
}

}  // namespace

scene::Wanted wanted(const std::string& option, const std::string& typed,
                     const Quantity& quantity) {
  constexpr std::string_view kScatters[] = {"+-", "±"};
  std::string_view mean = typed, scatter;
  for (const std::string_view sign : kScatters) {
    const std::size_t at = typed.find(sign);
    if (at == std::string::npos) continue;
    mean = std::string_view(typed).substr(0, at);
    scatter = std::string_view(typed).substr(at + sign.size());
    break;
  }
  const bool scattered = mean.size() != typed.size();
  while (mean.ends_with(' ')) mean.remove_suffix(1);
  while (scatter.starts_with(' ')) scatter.remove_prefix(1);
  const std::optional<Typed> value = in_unit(mean, quantity.units, 1.0);
  const std::optional<Typed> deviation =
      in_unit(scatter, quantity.units, value ? value->unit : 1.0);
  const bool in_range = value && value->value >= quantity.least && value->value <= quantity.most;
  if (in_range && !scattered) return {value->value, std::nullopt};
  if (in_range && deviation && deviation->value >= 0.0) return {value->value, deviation->value};
  throw UsageError(
      fmt::format("{}: expected a number from {} to {}{}, and perhaps +- and a standard deviation, "
                  "found '{}'",
                  option, quantity.least, quantity.most, in_words(quantity.units), typed));
}

}  // namespace headpin::apps
