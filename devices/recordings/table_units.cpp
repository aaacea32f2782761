#include "devices/recordings/table_units.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "devices/recordings/column_names.h"
#include "devices/recordings/table_time.h"

namespace headpin::devices {
namespace {

std::optional<double> metres_of(std::string_view unit) {
  if (is_one_of(unit, {"m", "meter", "meters", "metre", "metres"})) return 1.0;
  if (is_one_of(unit, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"}))
    return 0.01;
  if (is_one_of(unit, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"}))
    return 0.001;
  if (is_one_of(unit, {"in", "inch", "inches"})) return 0.0254;
  if (is_one_of(unit, {"ft", "foot", "feet"})) return 0.3048;
  return std::nullopt;
}

using SaidUnits = std::array<std::optional<double>, 3>;  ///< of x, y and z

SaidUnits said_units(const AnyTable& table, const PartColumns& part) {
  SaidUnits said;
  for (std::size_t i = 0; i < 3; ++i) {
    if (part.position[i]) said[i] = metres_of(unit_of(table.columns[*part.position[i]]));
  }
  return said;
}

/// The first unit that the columns of a part say.
std::optional<double> first_of(const SaidUnits& said) {
  const auto first = std::ranges::find_if(said, [](const auto& one) { return one.has_value(); });
  return first == said.end() ? std::nullopt : *first;
}

}  // namespace

std::array<Vec3, 3> position_units(const AnyTable& table, const MotionColumns& columns,
                                   double usual_m, Reading& reading) {
  const double of_table = metres_of(table.fact("length units")).value_or(usual_m);
  std::array<SaidUnits, 3> said;
  std::optional<double> first;
  for (std::size_t part = 0; part < 3; ++part) {
    said[part] = said_units(table, columns.parts[part]);
    if (!first) first = first_of(said[part]);
  }
  reading.unit_m = first.value_or(of_table);
  std::array<Vec3, 3> units;
  std::vector<double>& others = reading.other_units_m;
  const auto may_be = [&](double unit_m) {
    if (unit_m != reading.unit_m && std::ranges::find(others, unit_m) == others.end())
      others.push_back(unit_m);
  };
  may_be(of_table);
  for (std::size_t part = 0; part < 3; ++part) {
    const std::optional<double> its = first_of(said[part]);
    if (its) may_be(*its);
    reading.without_unit[part] = columns.parts[part].tracked() && !its;
    for (std::size_t i = 0; i < 3; ++i) {
      const double unit_m = said[part][i].value_or(its.value_or(reading.unit_m));
      units[part][static_cast<Eigen::Index>(i)] = unit_m;
      reading.own_units = reading.own_units || unit_m != reading.unit_m;
    }
  }
  // Where no part says a unit, or all units are one, nothing is unclear.
  if (others.empty()) reading.without_unit = {};
  return units;
}

}  // namespace headpin::devices
