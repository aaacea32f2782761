#pragma once

#include "engine/sustained_rows.h"
#include "engine/touching.h"

/// Bodies and their contacts at the end of the step. Private to the engine.
namespace headpin::engine::detail {

/// Takes a body to the end of the step by its present velocity.
/// @param s  its state now; gets that at the end
void to_end(const World& world, const Flight& flight, const Solved& solved, BodyId i, State& s);

/// Pose of a body at the end of the step, predicted from its present velocity.
Pose pose_at_end(const World& world, const Flight& flight, const Solved& solved, BodyId i);

/// Contact points of a touch with its bodies at their poses at the end of the step. Normals point
/// away from A of the touch. The points are valid until the next call with this `end`. The kept normals
/// in `touches` do not change.
std::span<const ContactPoint> points_at_end(const World& world, const Touches& touches,
                                            const Touch& touch, const Pose& X_WA, const Pose& X_WB,
                                            AtEnd& end);

/// Row for an impulse along the normal of a point, with centres of mass at p_WA and p_WB.
NormalRow row_at(const Flight& flight, const Touch& touch, const ContactPoint& point,
                 const Vec3& p_WA, const Vec3& p_WB);

}  // namespace headpin::engine::detail
