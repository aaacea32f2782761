#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/compound.h"
#include "scene/scenario/scenario.h"

/// Outlines of bodies of revolution, and their mass properties.
namespace headpin::scene {

/// Half the outline of a body of revolution as a dense polyline: (height [m], radius [m]) from the
/// bottom to the top, where the radius is 0.
using Outline = std::vector<Vec2>;

/// A smooth outline through measured points: round from the last but one to a last radius of 0,
/// flat on top of any other.
///
/// A centripetal Catmull-Rom spline (Yuksel et al. 2011), which does not overshoot between points.
///
/// @param profile  (height above the base, radius) [m], 3 points or more, heights increasing
/// @throws std::invalid_argument  with fewer points or where a height does not increase
Outline smooth_outline(std::span<const Vec2> profile);

/// Outline of an ellipsoid of revolution that stands on height 0.
Outline ellipsoid_outline(double height, double radius);

/// A part of a body of revolution: its lower and upper end, and its radius at a height in between.
struct TurnedPart {
  double low, high;
  std::function<double(double height)> radius;
};

/// Outline of several on one axis: the outermost everywhere, with all their edges. A part that is
/// wide where it ends has a flat end.
///
/// @param parts  1 or more, that leave no gap
Outline outline_of_parts(std::span<const TurnedPart> parts);

/// The profile of a skittle that was given by its parts alone: at 25 heights from the base to the top, the
/// largest distance of a part from the axis.
std::vector<Vec2> profile_of_parts(std::span<const SkittlePart> parts, double height);

/// The mass properties of the solid of revolution about z, with uniform density; exact for the
/// polyline.
///
/// @param mass  of it all [kg]
engine::MassProperties turned_mass(const Outline& outline, double mass);

}  // namespace headpin::scene
