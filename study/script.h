#pragma once

#include <string>
#include <vector>

#include "study/design.h"

namespace headpin::study {

/// The analysis of a design as an R program that everyone can run and change: the binomial model
/// with its terms, the models without each term, separation and bias-reduced estimates.
///
/// @throws std::invalid_argument  for a design without terms
std::string r_script(const Design& design);

/// Whether a text is a script as some version of r_script() wrote it, for any design: its last line is
/// the hash of the lines above. Versions before this line wrote scripts that cannot be told from edited ones.
bool is_unedited_script(const std::string& text);

/// The files that it writes.
std::vector<std::string> r_outputs();

}  // namespace headpin::study
