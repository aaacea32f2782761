#pragma once

#include "engine/sustained_rows.h"
#include "engine/touching.h"

/// Bodies and their contacts at the end of the step. Private to the engine.
namespace headpin::engine::detail {

/// Where a body will be at the end of the step, as it moves now.
Pose pose_at_end(const World& world, const Flight& flight, const Solved& solved, BodyId i);

/// Contact points of a touch, from its A, where its bodies are at the end of the step: valid until
/// asked for again. The next step starts from the normals of now all the same.
std::span<const ContactPoint> points_at_end(World& world, const Touches& touches,
                                            const Touch& touch, const Pose& X_WA, const Pose& X_WB,
                                            Workspace& w);

/// What an impulse at a point does, the centres of mass being there.
NormalRow row_at(const Flight& flight, const Touch& touch, const ContactPoint& point,
                 const Vec3& p_WA, const Vec3& p_WB);

}  // namespace headpin::engine::detail
