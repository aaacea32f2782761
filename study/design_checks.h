#pragma once

#include <string>

#include "study/design.h"
#include "study/questionnaire.h"

namespace headpin::study {

/// Checks that a questionnaire has every item that a design uses, and none that tables cannot have.
///
/// @param where  file of the design, for messages
/// @throws std::invalid_argument  naming file, line, key, what was expected and what was found
void check_items(const Design& design, const Questionnaire& questions, const std::string& where);

}  // namespace headpin::study
