#pragma once

#include <string>
#include <vector>

#include "study/design.h"

namespace headpin::study {

/// The analysis of a design as a program of R's, for anybody to run and to change: the binomial model
/// of its terms, what it comes to without each of them, separation and bias-reduced estimates.
///
/// @throws std::invalid_argument  for a design without terms
std::string r_script(const Design& design);

/// The files that it writes.
std::vector<std::string> r_outputs();

}  // namespace headpin::study
