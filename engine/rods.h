#pragma once

#include "engine/moments.h"

/// Solids cut into rods along z. Private to the engine.
namespace headpin::engine {

/// Moments of the union of parts that may overlap; none of them a half-space.
Moments bundled_rods(const std::vector<Part>& parts, Rods rods);

}  // namespace headpin::engine
