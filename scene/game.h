#pragma once

#include "engine/math.h"

/// Score as a function of what fell; no physics.
namespace headpin::scene {

/// Whether a skittle that stood upright has fallen: its axis leans by more than 20 degrees, twice
/// what any skittle comes back from.
bool has_fallen(const Pose& X_WB);

}  // namespace headpin::scene
