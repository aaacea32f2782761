#pragma once

#include <span>
#include <string>

#include "apps/command.h"
#include "scene/people/coach.h"

/// Numbers with units and a scatter on the command line: "17.9mph", "416+-20", "0.3m+-5cm". A scatter
/// without a unit has that of its number.
namespace headpin::apps {

struct Unit {
  const char* name;
  double size;  ///< in the unit of the result
};

/// What an option takes.
struct Quantity {
  std::span<const Unit> units;  ///< the first is that of the result, and need not be written
  double least, most;
};

/// @param option  its name, for messages
/// @throws UsageError  naming the option, what it takes and what it found
scene::Wanted wanted(const std::string& option, const std::string& typed, const Quantity& quantity);

}  // namespace headpin::apps
