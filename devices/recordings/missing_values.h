#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace headpin::devices {

/// What stands in a Motion-BIDS table for numbers that are not known: n/a, and what its ..._motion.json says besides.
class MissingValues {
 public:
  /// @param said  "NaN", "-9999", "0"; empty for nothing besides n/a
  explicit MissingValues(const std::string& said);

  /// Whether a cell is not known.
  bool is(std::string_view cell) const;
  /// The same, of a cell of a quaternion or a time: a 0 may be measured there, and is only not known where the
  /// numbers beside it say so.
  bool is_but_for_zero(std::string_view cell) const;

  /// Whether a quaternion is one with zeros in place of numbers that are not known: it is no unit quaternion.
  /// @param numbers  each of them not missing by itself
  bool is_part_of(std::span<const double, 4> numbers) const;

  /// Whether a time is a 0 in place of one that is not known: it does not follow the time before.
  /// @param before  nothing in the first row
  bool is_time(double time, std::optional<double> before) const {
    return number_ == 0.0 && time == 0.0 && before && time <= *before;
  }

  /// "n/a", "n/a or NaN"
  std::string words() const;

 private:
  std::string said_;
  std::optional<double> number_;
};

/// How far the length of a unit quaternion may be from 1.
constexpr double kUnitLength = 1e-3;

}  // namespace headpin::devices
