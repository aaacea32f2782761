#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/math.h"

namespace headpin::render {

/// A colour in linear light from its usual web notation, 0xRRGGBB in sRGB.
Vec3 srgb(std::uint32_t rgb);

/// Converts an sRGB code to linear light, 0..1 each.
Vec3 light_of(const Vec3& code);

/// Converts linear light to its sRGB code, 0..1 each.
Vec3 srgb_of(const Vec3& light);

/// How a mesh is lit.
enum class Surface {
  lit,    ///< colour is the reflectance; light is computed per pixel
  baked,  ///< colour is the emitted light: walls, lamps
  floor,  ///< baked, with shadows, and with reflections by `gloss`
};

struct Vertex {
  Eigen::Vector3f p;       ///< in the mesh frame G [m]
  Eigen::Vector3f n;       ///< outward, unit
  Eigen::Vector3f colour;  ///< linear light
};

/// Triangles, counter-clockwise seen from outside.
struct Mesh {
  Surface surface = Surface::lit;
  bool fine_light = true;  ///< lit per pixel; per vertex is enough for small meshes
  /// 0 (matt) to 1; for a floor the share of light that it reflects vertically.
  double gloss = 0.0;
  bool takes_shadow = true;  ///< for a floor: shows shadows of items
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three a triangle
};

/// Adds the triangles of `part` at the pose X_GP.
void append(Mesh& mesh, const Mesh& part, const Pose& X_GP = {});

/// The distance of a mesh's farthest point from its origin [m].
double reach_of(const Mesh& mesh);

/// Adds a flat four-sided face: corners counter-clockwise seen from outside.
void append_face(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                 const Vec3& colour);

/// A box with its faces outward, centred at the origin.
Mesh box(const Vec3& size, const Vec3& colour);

/// A circle of a body of revolution. Two rings at one place make a sharp edge of shape or colour.
struct Ring {
  double z;     ///< along the axis [m]
  double r;     ///< [m], 0 closes the body
  Vec2 n;       ///< outward normal (along r, along z); need not be unit
  Vec3 colour;  ///< linear light
};

/// Makes a body of revolution about the z axis from rings, listed from the bottom up.
///
/// @param sides  faces around, 3 or more
Mesh turned(std::span<const Ring> rings, int sides);

/// Semi-axes a (across) and c (along z), centre at the origin.
Mesh ellipsoid(double a, double c, int sides, int rings,
               const std::function<Vec3(double z)>& colour);

/// The surface on which a field is zero. The field is negative inside and about a distance [m].
///
/// Naive surface nets (Gibson 1998), our own code because no dependency has them: one vertex in
/// each cell the surface passes, normals from the field's slope.
///
/// @param lo, hi  corners of the box that is searched; the surface must lie inside
/// @param cell    edge of a cell [m]
Mesh surface_of(const std::function<double(const Vec3&)>& field, const Vec3& lo, const Vec3& hi,
                double cell, const Vec3& colour);

}  // namespace headpin::render
