#pragma once

#include <string>

namespace headpin::sweep {

/// Viridis (van der Walt and Smith 2015): even steps to the eye, also to colour-blind people.
///
/// @param part  0 to 1; values beyond are clamped
/// @return  "#rrggbb"
std::string colour(double part);

}  // namespace headpin::sweep
