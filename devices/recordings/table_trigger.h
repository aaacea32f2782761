#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/math.h"
#include "devices/recordings/any_table.h"

/// The trigger of a hand: a column of a table, with numbers or words.
namespace headpin::devices {

using TimedRows = std::vector<std::pair<Time, const AnyTable::Row*>>;

/// Adds a note that is not there yet: both hands may have one trigger.
void tell_once(std::vector<std::string>& notes, std::string note);

/// The changes of a trigger: a press is above half of its largest value. A cell that says nothing keeps
/// the value before; in a column that never says "not pressed" it is not pressed.
///
/// @param rows   in order of time
/// @param notes  say which cells say nothing, and that a trigger is never pressed and let go
std::vector<Stamped<bool>> presses(const AnyTable& table, std::size_t column, const TimedRows& rows,
                                   std::vector<std::string>& notes);

/// The one of two columns that is the trigger: the one that is pressed and let go; of two such ones, or
/// of none, the one that is called trigger; else the first.
std::size_t better_trigger(const AnyTable& table, std::size_t first, std::size_t second);

}  // namespace headpin::devices
