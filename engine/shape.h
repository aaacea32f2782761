#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/math.h"

/// Convex shapes: the paper's primitives, vertex data, and the half-space for floors and walls.
///
/// A shape is its sizes plus `support()`: its furthest point along a direction. Every shape is in
/// its own frame G [m]. Each property of shapes is a function with an overload for each shape,
/// chosen by visit: a new shape does not compile until it has all of them.
namespace headpin::engine {

/// Ellipsoid about the origin, semi-axes along x, y, z; a sphere has three equal radii [m].
struct Ellipsoid {
  Vec3 radii = Vec3::Ones();
};

/// Cylinder about the origin, axis z: |z| <= half_height, x^2 + y^2 <= radius^2 [m].
struct Cylinder {
  double radius = 1.0;
  double half_height = 1.0;
};

/// Cone, axis z: base disc at z = -height / 2, apex at z = +height / 2 [m].
struct Cone {
  double radius = 1.0;
  double height = 1.0;
};

/// All points with z <= 0: floors and walls. Its surface is the plane z = 0, outward is +z.
struct HalfSpace {};

/// Convex polyhedron: checked when it is made, immutable afterwards.
class Polyhedron {
 public:
  struct Face {
    std::uint32_t first = 0;  ///< where its corners start in `corners()`
    std::uint32_t count = 0;
    Vec3 normal = Vec3::UnitZ();  ///< unit, outward
    double offset = 0.0;          ///< normal . x = offset on the face [m]
    Vec3 along = Vec3::UnitX();   ///< unit, along its first edge
  };
  struct Edge {
    std::uint32_t from = 0, to = 0;  ///< vertices
  };

  /// Tolerance for rounding in files, as a fraction of the size: distance of a vertex from the
  /// plane of its face, or outside another face.
  static constexpr double kTolerance = 1e-6;

  /// @param vertices  corners [m], each used by at least three faces
  /// @param faces     corners of each face, counterclockwise seen from outside, at least three
  /// @throws std::invalid_argument  naming the face, edge or vertex and what is wrong with it:
  ///   index out of range, number not finite, two vertices in one place, a face without area or not flat,
  ///   an edge not shared by exactly two faces in opposite directions (not closed, or turned inside
  ///   out), several pieces, or a vertex outside a face (not convex)
  Polyhedron(std::vector<Vec3> vertices, const std::vector<std::vector<std::uint32_t>>& faces);

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Face> faces() const { return faces_; }
  std::span<const Edge> edges() const { return edges_; }
  /// Corners of a face, counterclockwise from outside.
  std::span<const std::uint32_t> corners(const Face& face) const {
    return {corners_.data() + face.first, face.count};
  }
  /// Faces that meet in a vertex.
  std::span<const std::uint32_t> faces_at(std::uint32_t vertex) const {
    return {faces_at_.data() + first_neighbour_[vertex],
            first_neighbour_[vertex + 1] - first_neighbour_[vertex]};
  }
  /// Vertices joined to a vertex by an edge.
  std::span<const std::uint32_t> neighbours(std::uint32_t vertex) const {
    return {neighbours_.data() + first_neighbour_[vertex],
            first_neighbour_[vertex + 1] - first_neighbour_[vertex]};
  }
  /// Centre of the volume [m].
  const Vec3& centre() const { return centre_; }

  /// Index of a vertex furthest along `n`. A climb from edge to edge, started from a table of
  /// directions: on a convex polyhedron a vertex that no neighbour beats is the furthest.
  std::uint32_t furthest(const Vec3& n) const { return climb(start_[cell(n)], n); }
  /// The same climb from a vertex of one's own choice, better the nearer it is.
  std::uint32_t climb(std::uint32_t from, const Vec3& n) const {
    double best = n.dot(vertices_[from]);
    for (;;) {
      std::uint32_t next = from;
      for (std::uint32_t k = first_neighbour_[from]; k < first_neighbour_[from + 1]; ++k) {
        const double along = n.dot(vertices_[neighbours_[k]]);
        if (along > best) {
          best = along;
          next = neighbours_[k];
        }
      }
      if (next == from) return from;
      from = next;
    }
  }

 private:
  // Which of the 48 chambers of the cube holds n, without a branch: signs, and order of sizes.
  static std::uint32_t cell(const Vec3& n) {
    const double x = std::abs(n.x()), y = std::abs(n.y()), z = std::abs(n.z());
    return static_cast<std::uint32_t>(n.x() < 0.0) | static_cast<std::uint32_t>(n.y() < 0.0) << 1 |
           static_cast<std::uint32_t>(n.z() < 0.0) << 2 | static_cast<std::uint32_t>(x > y) << 3 |
           static_cast<std::uint32_t>(y > z) << 4 | static_cast<std::uint32_t>(x > z) << 5;
  }

  // The steps of the constructor.
  void add_face(const std::vector<std::uint32_t>& corners, double size);
  void check_convex(double slack) const;
  void find_neighbours();
  Vec3 centre_of_volume(double size) const;
  /// One start for each chamber of the cube: signs of x, y, z and the order of their sizes.
  void find_starts();

  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> corners_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_neighbour_, neighbours_, faces_at_;  // as many faces as edges
  std::vector<std::uint32_t> start_;
  Vec3 centre_ = Vec3::Zero();
};

using Shape = std::variant<Ellipsoid, Cylinder, Cone, Polyhedron, HalfSpace>;

/// Visits two shapes at once: a visit inside a visit, which compilers turn into jumps.
template <typename F>
decltype(auto) visit_both(const Shape& a, const Shape& b, F&& f) {
  return std::visit(
      [&](const auto& sa) -> decltype(auto) {
        return std::visit([&](const auto& sb) -> decltype(auto) { return f(sa, sb); }, b);
      },
      a);
}

/// The point of the shape furthest along `n` [m].
///
/// @param n  of any length; a zero or non-finite direction gives some point of the shape. If a
///   whole cap, side or face is furthest, the point is one of its points (caps: the centre).
inline Vec3 support(const Ellipsoid& s, const Vec3& n) {
  const Vec3 q = s.radii.cwiseProduct(s.radii).cwiseProduct(n);
  const double h2 = n.dot(q);
  if (!(h2 > 0.0 && std::isfinite(h2))) return {0.0, 0.0, s.radii.z()};
  return q / std::sqrt(h2);
}

inline Vec3 support(const Cylinder& s, const Vec3& n) {
  const double rho2 = n.x() * n.x() + n.y() * n.y();
  const double k = rho2 > 0.0 && std::isfinite(rho2) ? s.radius / std::sqrt(rho2) : 0.0;
  return {k == 0.0 ? 0.0 : k * n.x(), k == 0.0 ? 0.0 : k * n.y(),
          n.z() < 0.0 ? -s.half_height : s.half_height};
}

inline Vec3 support(const Cone& s, const Vec3& n) {
  const double rho2 = n.x() * n.x() + n.y() * n.y();
  const double rho = std::sqrt(rho2);
  const double z = 0.5 * s.height;
  // The apex is further than the rim when 2 z n_z > r rho.
  if (!(2.0 * z * n.z() <= s.radius * rho)) return {0.0, 0.0, z};
  const double k = rho2 > 0.0 && std::isfinite(rho2) ? s.radius / rho : 0.0;
  return {k == 0.0 ? 0.0 : k * n.x(), k == 0.0 ? 0.0 : k * n.y(), -z};
}

inline Vec3 support(const Polyhedron& s, const Vec3& n) {
  return s.vertices()[s.furthest(n)];
}

/// @throws std::invalid_argument  for a half-space, which has no furthest point
Vec3 support(const Shape& shape, const Vec3& n);

/// A point well inside the shape, for the line of centres of the paper [m]. For the half-space: the
/// origin, on its surface.
inline Vec3 centre(const Ellipsoid&) {
  return Vec3::Zero();
}
inline Vec3 centre(const Cylinder&) {
  return Vec3::Zero();
}
inline Vec3 centre(const Cone&) {
  return Vec3::Zero();
}
inline Vec3 centre(const Polyhedron& s) {
  return s.centre();
}
inline Vec3 centre(const HalfSpace&) {
  return Vec3::Zero();
}

/// Radius of the bounding sphere about the origin of the shape's frame [m]; infinite for a
/// half-space.
double bounding_radius(const Shape& shape);
double bounding_radius(const Ellipsoid& s);
double bounding_radius(const Cylinder& s);
double bounding_radius(const Cone& s);
double bounding_radius(const Polyhedron& s);
double bounding_radius(const HalfSpace& s);

/// Whether the point lies in the shape, or outside by no more than `tolerance` [m] (measured along
/// axes and face normals; near corners up to a few times that).
bool contains(const Shape& shape, const Vec3& p, double tolerance = 0.0);
inline bool contains(const Ellipsoid& s, const Vec3& p, double tolerance = 0.0) {
  const Vec3 r = s.radii + Vec3::Constant(tolerance);
  const double yz = r.y() * r.z(), xz = r.x() * r.z(), xy = r.x() * r.y();
  return Vec3(p.x() * yz, p.y() * xz, p.z() * xy).squaredNorm() <= (xy * r.z()) * (xy * r.z());
}
inline bool contains(const Cylinder& s, const Vec3& p, double tolerance = 0.0) {
  const double r = s.radius + tolerance;
  return p.x() * p.x() + p.y() * p.y() <= r * r && std::abs(p.z()) <= s.half_height + tolerance;
}
inline bool contains(const Cone& s, const Vec3& p, double tolerance = 0.0) {
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  return p.z() >= -0.5 * s.height - tolerance &&
         s.height * rho + s.radius * (p.z() - 0.5 * s.height) <= tolerance * slant;
}
bool contains(const Polyhedron& s, const Vec3& p, double tolerance = 0.0);
bool contains(const HalfSpace& s, const Vec3& p, double tolerance = 0.0);

/// How far inside the shape the point lies: radius of the largest ball about it that the shape
/// holds [m]; negative outside. Of an ellipsoid a lower bound, exact along its shortest axis.
inline double clearance(const Ellipsoid& s, const Vec3& p) {
  return s.radii.minCoeff() * (1.0 - p.cwiseQuotient(s.radii).norm());
}
inline double clearance(const Cylinder& s, const Vec3& p) {
  return std::min(s.radius - std::sqrt(p.x() * p.x() + p.y() * p.y()),
                  s.half_height - std::abs(p.z()));
}
inline double clearance(const Cone& s, const Vec3& p) {
  const double rho = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  return std::min(p.z() + 0.5 * s.height,
                  (s.radius * (0.5 * s.height - p.z()) - s.height * rho) / slant);
}
double clearance(const Polyhedron& s, const Vec3& p);

/// @throws std::invalid_argument  when a measure is not finite or not above zero
void check(const Shape& shape);
void check(const Ellipsoid& s);
void check(const Cylinder& s);
void check(const Cone& s);
inline void check(const Polyhedron&) {}  // checked when it was made
inline void check(const HalfSpace&) {}

/// Name of the shape's kind: "ellipsoid", "cylinder", "cone", "polyhedron", "half-space".
std::string kind(const Shape& shape);
constexpr const char* kind(const Ellipsoid&) {
  return "ellipsoid";
}
constexpr const char* kind(const Cylinder&) {
  return "cylinder";
}
constexpr const char* kind(const Cone&) {
  return "cone";
}
constexpr const char* kind(const Polyhedron&) {
  return "polyhedron";
}
constexpr const char* kind(const HalfSpace&) {
  return "half-space";
}

}  // namespace headpin::engine
