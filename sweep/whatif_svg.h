#pragma once

#include <string>

#include "sweep/whatif_report.h"

namespace headpin::sweep {

/// SVG documents: skittles, speed and direction over the moment of the release; skittles over
/// direction and speed, a map for each height and spin, with the participant's own throws; and over
/// direction and board, a map for each speed and each number of revolutions.
std::string moments_svg(const WhatIf& whatif);
std::string map_svg(const WhatIf& whatif);
std::string boards_svg(const WhatIf& whatif);

}  // namespace headpin::sweep
