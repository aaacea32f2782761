#pragma once

#include "engine/non_colliding.h"

/// The plane that was found between two shapes, asked again.
namespace headpin::engine {

/// Whether the plane across a kept normal still proves two shapes apart. It is the first thing to
/// ask of a pair seen before: neither shape is posed for it, nor seen from the other.
///
/// @param kept    what `closest_points` left for the pair. A normal of a pair that was closer than
///   its margin (or none at all) proves nothing, and costs nothing.
/// @param margin  by how much they must be apart [m]
/// @return        true: closest_points would find them separated by more than the margin
bool still_apart(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                 const KeptNormal& kept, double margin = 0.0);

/// The same where B is known in A's frame.
bool still_apart(const Shape& a, const Shape& b, const Mat3& R_AB, const Vec3& p_AB,
                 const KeptNormal& kept, double margin);

}  // namespace headpin::engine
