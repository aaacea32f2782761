#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/play/session.h"

/// Saves a session between two ticks as bytes and restores it; it then continues with the same bits.
///
///     const std::vector<std::uint8_t> bytes = save(session);
///     Session later = restore(make_session(scenario), bytes);  // in another process, on another machine
namespace headpin::scene {

/// Everything that changes during a session: its world, player, game and hashes. Little-endian, with
/// a version and a checksum. The scenario is not included, nor are samples and events of the last
/// tick, and a change of releases.
///
/// @throws std::logic_error  for a session without hashes: its response is not one of ours
std::vector<std::uint8_t> save(const Session& session);

/// @param made  a new session of the same scenario
/// @throws std::invalid_argument  for another scenario, and for bytes that are not a complete and
///   unchanged saved session
Session restore(Session made, std::span<const std::uint8_t> bytes);

}  // namespace headpin::scene
