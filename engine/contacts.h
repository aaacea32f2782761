#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compound.h"
#include "engine/non_colliding.h"

/// Contact manifolds: from the closest points to all points that two surfaces stand on.
namespace headpin::engine {

struct ContactPoint {
  Vec3 p_W = Vec3::Zero();      ///< half-way between the two surfaces [m]
  Vec3 n_AB_W = Vec3::UnitZ();  ///< unit, from A to B
  double depth = 0.0;           ///< [m]; negative: a gap
  /// The number of its corner, rim or pair of parts. It is the same in each step, and unique within
  /// the two bodies.
  std::uint32_t feature = 0;
  bool guessed = false;  ///< the depth is an estimate: paper detection stopped at its cap
};

/// The cost of the queries of a step, for statistics.
struct QueryCounts {
  std::int64_t queries = 0;     ///< pairs of parts examined (bounding spheres meet)
  std::int64_t iterations = 0;  ///< evaluations of the support functions
  std::int64_t capped = 0;      ///< queries that reached the cap

  QueryCounts& operator+=(const QueryCounts& other) {
    queries += other.queries;
    iterations += other.iterations;
    capped += other.capped;
    return *this;
  }
};

/// Maximum number of points between two shapes.
inline constexpr int kMaxPoints = 4;

/// Appends the contact points of two posed shapes.
///
/// Between a half-space and a primitive, the points have a closed form: the lowest point of an
/// ellipsoid; the lowest points of the rims of a cylinder or cone and three more to stand on; the
/// apex; the corners of a polyhedron. Otherwise these are the closest points and, between two flat
/// faces or two sides, the corners of their common area.
///
/// @param margin  points with a gap up to this are included, with negative depth [m]
/// @param kept    normal of the last query of these two, see `closest_points`
/// @return  number of points appended, at most kMaxPoints
int find_contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                  KeptNormal& kept, const Query& query, QueryCounts& counts,
                  std::vector<ContactPoint>& out);

/// Number of normals that two compounds keep: one per pair of parts, none with a half-space.
std::size_t kept_normals(const Compound& a, const Compound& b);

/// The same for two compounds: for each part of b, in order, all parts of a.
///
/// @param kept  `kept_normals(a, b)` normals; the number of b's part changes fastest
int find_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  double margin, std::span<KeptNormal> kept, const Query& query,
                  QueryCounts& counts, std::vector<ContactPoint>& out);

}  // namespace headpin::engine
