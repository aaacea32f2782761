#pragma once

#include <optional>

#include "scene/play/session.h"

/// What a virtual participant aims at and looks at.
namespace headpin::scene {

/// The skittle to aim at: the one with the most others beside it; of several, the nearest. Nothing
/// if all are down. In the world [m].
std::optional<Vec3> worth_aiming_at(const Session& session);

/// The position of the fastest skittle, if one moves.
std::optional<Vec3> liveliest_skittle(const Session& session);

/// The middle of all skittles as they are set up.
Vec3 rack_middle(const Session& session);

}  // namespace headpin::scene
