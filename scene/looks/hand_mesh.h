#pragma once

#include <array>

#include "render/data/mesh.h"

namespace headpin::scene {

/// A mesh of a hand in a sleeve, in its own frame: the back is up (+y), the origin is in the palm. It
/// has less than 1000 triangles. A left hand is the mirror image of a right one.
///
/// @param p_HB    centre of the ball in the hand [m]; the palm lies where the ball is nearest
/// @param radius  of the ball [m]
/// @param closed  0: open and flat, fingers along -z; 1: around the ball, palm behind it, fingers over
///                its top, middle and ring finger and the thumb, a right hand's on its left, in
///                their holes
render::Mesh hand_mesh(const Vec3& p_HB, double radius, double closed, bool left_hand = false);

/// Where the holes of those three fingers are: from the ball's centre, in the frame of a ball that
/// lies on its stand unturned and is taken from there as the model's arm does, or a left arm that is
/// its mirror image.
std::array<Vec3, 3> ball_holes(const Vec3& p_HB, double radius, bool left_hand = false);

}  // namespace headpin::scene
