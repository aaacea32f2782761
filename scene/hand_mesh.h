#pragma once

#include "render/mesh.h"

namespace headpin::scene {

/// A right hand, open and flat: fingers along -z, its back up (+y), origin in the palm.
///
/// @param cell  size of its triangles [m]; fingers need 0.006, a mirror image is content with twice that
render::Mesh open_hand_mesh(double cell = 0.006);

/// The same hand around a ball: palm behind it, fingers over its top, thumb on its left.
///
/// @param p_HB    centre of the ball in the hand [m]; the palm lies where the ball is nearest
/// @param radius  of the ball [m]
/// @param cell    size of its triangles [m]
render::Mesh gripping_hand_mesh(const Vec3& p_HB, double radius, double cell = 0.006);

}  // namespace headpin::scene
