#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/world.h"

/// Saves a world as bytes and restores it; it then continues with the same bits.
///
///     const std::vector<std::uint8_t> bytes = save(world);
///     World later = restore(made_as_before(), bytes);  // in another process, on another machine
namespace headpin::engine {

/// Everything that changes during a simulation: tick, states, kinds, sleep, ledger and memory.
/// Little-endian, with a version and a checksum. Bodies and parameters are not included, only a
/// checksum of them; nor are events and statistics, which the next step makes again. The values of
/// friction tables (`set_friction`) are not included either, nor what a response of one's own does: the
/// restored world has those of `made`.
std::vector<std::uint8_t> save(const World& world);

/// @param made  a world with the same bodies and parameters as the saved one, in any state; with the friction
///   tables of the time when the other one was saved, it continues with the same bits
/// @throws std::invalid_argument  for other bodies or parameters, and for bytes that are not a
///   complete and unchanged saved world
World restore(World made, std::span<const std::uint8_t> bytes);

}  // namespace headpin::engine
