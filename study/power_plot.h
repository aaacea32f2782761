#pragma once

#include <string>
#include <vector>

#include "study/power.h"

namespace headpin::study {

/// A plot of the shares over the number of people, as SVG. Charts stay our own code: they are few
/// lines of SVG, and no plotting library is a dependency.
/// @param all  of the same design, the fewest people first
std::string power_svg(const std::vector<Power>& all);

}  // namespace headpin::study
