#pragma once

#include "engine/non_colliding.h"

/// Tests whether the separating plane of the last query still separates two shapes.
namespace headpin::engine {

/// Whether the plane across a kept normal still separates two shapes. This is the first test of a
/// known pair: it is cheap, because it does not pose the shapes.
///
/// @param kept    as `closest_points` set it for the pair. If the pair was closer than its margin,
///   or there is no normal, the answer is false at once.
/// @param margin  by how much they must be apart [m]
/// @return        true: closest_points would find them separated by more than the margin
bool still_apart(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                 const KeptNormal& kept, double margin = 0.0);

/// The same where B is known in A's frame.
bool still_apart(const Shape& a, const Shape& b, const Mat3& R_AB, const Vec3& p_AB,
                 const KeptNormal& kept, double margin);

}  // namespace headpin::engine
