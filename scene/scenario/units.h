#pragma once

#include <optional>
#include <string_view>

/// Units of a scenario's numbers: for people who write them beside a number.
namespace headpin::scene {

/// The unit that a key's name or its meaning says: kg of `mass`, s of `delay_s`, m/s2 of a meaning
/// that ends in [m/s2]. Empty where neither says one, as for lengths and shares.
std::string_view unit_of(std::string_view key, std::string_view meaning);

/// "3.0 kg": a number and what stands behind it.
struct QuotedNumber {
  std::string_view number, unit;
};

/// The number that a text is, with a unit or without; nothing for any other text.
std::optional<QuotedNumber> quoted_number(std::string_view text);

/// Whether a number in that unit is the value itself.
/// @param found  as people write it, such as "deg" or "m/s^2"; empty for none
/// @param unit   of the key; empty for one of the units without a name, metres and what follows from them
bool is_unit(std::string_view found, std::string_view unit);

}  // namespace headpin::scene
