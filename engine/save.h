#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/world.h"

/// A world as bytes, from which it goes on to the bit.
///
///     const std::vector<std::uint8_t> bytes = save(world);
///     World later = restore(made_as_before(), bytes);  // in another process, on another machine
namespace headpin::engine {

/// All that changes as a world goes on: tick, states, kinds, sleep, ledger and memory. Little-endian,
/// with a version and a checksum. Bodies and parameters are not in it, but a number of theirs is.
/// Nor are events and statistics, which the next step makes anew.
std::vector<std::uint8_t> save(const World& world);

/// @param made  a world with the same bodies and parameters as the saved one, whatever they do in it
/// @throws std::invalid_argument  when it has others, and for bytes that are not those of a world,
///   cut off or changed
World restore(World made, std::span<const std::uint8_t> bytes);

}  // namespace headpin::engine
