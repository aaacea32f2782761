#pragma once

#include <span>
#include <string>

#include "devices/trial/trial.h"

namespace headpin::scene {

/// Why the ball felled no skittle, as far as the events of a session tell: the ball not taken, not let go,
/// gone elsewhere, or too slow. One sentence; empty where one fell.
std::string why_nothing_fell(std::span<const devices::Event> events);

}  // namespace headpin::scene
