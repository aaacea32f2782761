#pragma once

#include <span>
#include <vector>

#include "render/mesh.h"

/// What skittles and balls look like.
namespace headpin::scene {

/// Half the outline of a turned body, dense enough to be joined by straight lines:
/// (height [m], radius [m]) from the bottom to the top, where the radius is 0.
using Outline = std::vector<Vec2>;

/// A smooth outline through measured points: round from the last but one to a last radius of 0,
/// flat on top of any other.
///
/// Centripetal Catmull-Rom spline (Yuksel et al. 2011): it does not swing out between points.
///
/// @param profile  (height above the base, radius) [m], 3 points or more, heights increasing
/// @throws std::invalid_argument  with fewer points or where a height does not increase
Outline smooth_outline(std::span<const Vec2> profile);

/// Outline of an ellipsoid of revolution that stands on height 0.
Outline ellipsoid_outline(double height, double radius);

/// A white skittle with two red stripes around its neck, turned from its outline.
///
/// @param origin  height of the mesh origin above the outline's height 0 [m]
/// @param rings   about how many circles it is made of
/// @param sides   faces around
render::Mesh skittle_mesh(const Outline& outline, double origin, int rings, int sides);

/// A marbled ball with three finger holes: one sees it roll.
///
/// @param holes_towards  unit, where the holes are
render::Mesh ball_mesh(double radius, const Vec3& holes_towards);

}  // namespace headpin::scene
