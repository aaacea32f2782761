#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compound.h"
#include "engine/non_colliding.h"

/// From closest points to as many contact points as the surfaces need to stand on.
namespace headpin::engine {

struct ContactPoint {
  Vec3 p_W = Vec3::Zero();      ///< half-way between the two surfaces [m]
  Vec3 n_AB_W = Vec3::UnitZ();  ///< unit, from A to B
  double depth = 0.0;           ///< [m]; negative: a gap
  /// The same corner, rim or pair of parts keeps its number from step to step; unique within the
  /// two bodies.
  std::uint32_t feature = 0;
  bool guessed = false;  ///< the depth is a guess of paper detection, cut off at its cap
};

/// What the queries of a step cost, for statistics.
struct QueryCounts {
  std::int64_t queries = 0;     ///< pairs of parts examined (bounding spheres meet)
  std::int64_t iterations = 0;  ///< evaluations of the support functions
  std::int64_t capped = 0;      ///< queries that reached the cap
};

/// Most points that two shapes get.
inline constexpr int kMaxPoints = 4;

/// Appends the contact points of two posed shapes.
///
/// Half-space against every primitive is a closed form: lowest point of an ellipsoid; cap or side
/// of a cylinder and base of a cone by the lowest points of the rims and two more to stand on;
/// apex; corners of a polyhedron. Otherwise the closest points, and where flat meets flat or side
/// meets side the corners of what they share.
///
/// @param margin  points with a gap of up to this are reported too, with negative depth [m]
/// @param kept    of the last query of these two, see `closest_points`
/// @return  number of points appended, at most kMaxPoints
int find_contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                  KeptNormal& kept, const Query& query, QueryCounts& counts,
                  std::vector<ContactPoint>& out);

/// How many normals two compounds keep: one per pair of parts, none with a half-space.
std::size_t kept_normals(const Compound& a, const Compound& b);

/// The same for two compounds: b's parts in their order, and for each of them a's.
///
/// @param kept  `kept_normals(a, b)` of them, b's part number running faster
int find_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  double margin, std::span<KeptNormal> kept, const Query& query,
                  QueryCounts& counts, std::vector<ContactPoint>& out);

}  // namespace headpin::engine
