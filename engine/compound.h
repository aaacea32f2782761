#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/shape.h"

/// Compounds of posed parts: bounds and mass properties.
namespace headpin::engine {

/// All points within `radius` of the segment from `a` to `b`; a sphere when a = b.
struct Capsule {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double radius = 0.0;  ///< [m]
};

inline Capsule operator*(const Pose& X, const Capsule& c) {
  return {X * c.a, X * c.b, c.radius};
}

/// All points between two corners, along the axes of its frame; unlimited as it comes.
struct Box {
  Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());
  bool meets(const Box& other) const {
    for (int k = 0; k < 3; ++k) {  // most pairs differ in the first
      if (!(low[k] <= other.high[k] && other.low[k] <= high[k])) return false;
    }
    return true;
  }
};

/// The box in W around a box in B.
Box operator*(const Pose& X_WB, const Box& box);

/// The box around all points within `margin` of a capsule [m].
inline Box box_around(const Capsule& c, double margin) {
  const Vec3 r = Vec3::Constant(c.radius + margin);
  return {c.a.cwiseMin(c.b) - r, c.a.cwiseMax(c.b) + r};
}

struct Part {
  Shape shape;
  Pose X_BG;  ///< pose of the shape's frame G in the frame B of the compound
};

/// A solid made of convex parts, which may overlap. Made by `make_compound`.
struct Compound {
  std::vector<Part> parts;
  double bounding_radius = 0.0;  ///< sphere about the origin of B [m]; infinite with a half-space
  Capsule bounds;                ///< tight round long bodies, in B; meaningless with a half-space
  std::vector<double> part_radius;        ///< sphere about the origin of each part's G [m]
  std::vector<std::uint8_t> part_turned;  ///< 1 if G has another orientation than B
  bool faceted = false;                   ///< every part is a polyhedron
  std::vector<Box> part_box;              ///< in B; of a faceted one
  Box box;                                ///< around all of these
};

/// @throws std::invalid_argument  without parts, if a size of a part is not finite and positive, or if
/// a pose is not finite or its quaternion not unit
Compound make_compound(std::vector<Part> parts);

struct MassProperties {
  double mass = 0.0;            ///< [kg]
  Vec3 centre = Vec3::Zero();   ///< of mass, in the frame of the shape or compound [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre, along the axes of that frame [kg m2]
};

/// Closed form for every shape.
///
/// @param density  [kg/m3]
/// @throws std::invalid_argument  for a half-space
MassProperties mass_properties(const Shape& shape, double density);

/// What is known of parts before they are weighed. Parts that touch count as parts that overlap, unless
/// they are known not to.
enum class Overlaps { maybe, none };

/// Where the rods are that parts are cut into: between the places where the outline of a part begins, bends or
/// ends; or, as in trials under rules 1 to 13, evenly, so that thin parts weighed up to a fifth too much or too little.
enum class Rods { between_bends, even };

/// Mass properties of the union of the parts: matter where parts overlap counts once.
///
/// A single part, and parts that are apart or known not to overlap, are summed in closed form. Parts that
/// share the axis z as bodies of revolution are cut into discs (relative error below 1e-6), others
/// into rods along z, each of whose overlaps with the parts is exact. Boxes along the axes are exact but for
/// rounding, others below 1e-3. Where dozens of turned parts cross that are a thousand times as long as they are
/// thick, the error was 1.2e-3 at most.
///
/// @param density  [kg/m3]
/// @throws std::invalid_argument  with a half-space among the parts
MassProperties mass_properties(const Compound& compound, double density,
                               Overlaps overlaps = Overlaps::maybe,
                               Rods rods = Rods::between_bends);

/// Whether every part is a body of revolution about the z axis of B.
bool is_revolution(const Compound& compound);

/// A compound in the frame for dynamics: origin at the centre of mass, principal axes.
struct Centred {
  Compound compound;            ///< the parts in the principal frame C
  Pose X_BC;                    ///< C in the old frame B
  double mass = 0.0;            ///< [kg]
  Vec3 inertia = Vec3::Zero();  ///< principal moments, along x, y, z of C [kg m2]
  bool revolution = false;      ///< about z of C; then inertia.x() == inertia.y()
};

/// A body of revolution about z keeps its axes (and its x and y moments are made equal), another
/// one is turned to its principal axes, ordered so that C is the frame least turned from B.
Centred about_centre(const Compound& compound, const MassProperties& mass);

}  // namespace headpin::engine
