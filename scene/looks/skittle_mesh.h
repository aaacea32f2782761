#pragma once

#include <span>

#include "render/data/mesh.h"
#include "scene/stage/outline.h"

/// Meshes of skittles and balls.
namespace headpin::scene {

/// A white skittle with two red stripes around its neck, a body of revolution from its outline.
///
/// @param origin  height of the mesh origin above the outline's height 0 [m]
/// @param rings   about how many circles it is made of
/// @param sides   faces around
render::Mesh skittle_mesh(const Outline& outline, double origin, int rings, int sides);

/// The same with a circle at every bend of an outline that has edges, as colliders have.
///
/// @param off  how far the surface may be from the outline [m]
render::Mesh edged_skittle_mesh(const Outline& outline, double origin, double off, int sides);

/// A marbled ball with three finger holes, so that its rolling is visible.
///
/// @param holes  unit, where the holes are
/// @param sides  faces around
/// @param rings  and from pole to pole
render::Mesh ball_mesh(double radius, std::span<const Vec3> holes, int sides = 32, int rings = 20);

/// A ring of oil about the z axis, to be scaled: its radius is 1, its height that of a real one.
render::Mesh oil_ring_mesh();

}  // namespace headpin::scene
