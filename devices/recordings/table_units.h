#pragma once

#include <array>

#include "devices/recordings/any_table.h"
#include "devices/recordings/reading.h"
#include "devices/recordings/table_columns.h"

namespace headpin::devices {

/// The units of x, y and z of head, left and right hand [m], and what they come to in the reading: `unit_m`,
/// `own_units`, `without_unit` and `other_units_m`.
///
/// A column that says no unit has that of its part; a part that says none that of the first part that says one,
/// else the table's.
///
/// @param usual_m  of a table that says nothing [m]
std::array<Vec3, 3> position_units(const AnyTable& table, const MotionColumns& columns,
                                   double usual_m, Reading& reading);

}  // namespace headpin::devices
