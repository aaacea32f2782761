#include "engine/contacts.h"

#include <algorithm>
#include <cassert>
#include <type_traits>

namespace headpin::engine {
namespace {

constexpr double kSin120 = 0.86602540378443864676;

/// A point of B found against the plane of half-space A; kept when no higher than the margin.
class Footprint {
 public:
  /// @param X_AB  shape B in the frame of the half-space
  Footprint(const Pose& X_WA, const Pose& X_AB, double margin, std::vector<ContactPoint>& out)
      : X_WA_(X_WA), n_AB_W_(X_WA.q * Vec3::UnitZ()), X_AB_(X_AB), margin_(margin), out_(out) {}

  void point(const Vec3& p_B, std::uint32_t feature) {
    Vec3 p_A = X_AB_ * p_B;
    const double depth = -p_A.z();
    if (depth < -margin_) return;
    p_A.z() *= 0.5;
    out_.push_back({X_WA_ * p_A, n_AB_W_, depth, feature});
    ++count;
  }

  int count = 0;

 private:
  const Pose& X_WA_;
  Vec3 n_AB_W_;
  const Pose& X_AB_;
  double margin_;
  std::vector<ContactPoint>& out_;
};

/// Horizontal direction of steepest descent in the shape's frame; its x axis when it stands
/// upright.
Vec2 downhill(const Vec3& down) {
  const double rho = std::sqrt(down.x() * down.x() + down.y() * down.y());
  if (rho < 1e-4) return Vec2::UnitX();
  return Vec2(down.x(), down.y()) / rho;
}

// Lowest point of a rim and two more, 120 degrees to each side.
void rim(Footprint& foot, double radius, double z, const Vec2& u, std::uint32_t feature) {
  const Vec2 v(-u.y(), u.x());
  const Vec2 left = -0.5 * u + kSin120 * v, right = -0.5 * u - kSin120 * v;
  foot.point({radius * u.x(), radius * u.y(), z}, feature);
  foot.point({radius * left.x(), radius * left.y(), z}, feature + 1);
  foot.point({radius * right.x(), radius * right.y(), z}, feature + 2);
}

void stand(Footprint& foot, const Ellipsoid& s, const Vec3& down, double) {
  foot.point(support(s, down), 0);
}

void stand(Footprint& foot, const Cylinder& s, const Vec3& down, double) {
  const Vec2 u = downhill(down);
  const double z = down.z() < 0.0 ? -s.half_height : s.half_height;
  rim(foot, s.radius, z, u, down.z() < 0.0 ? 0 : 4);
  foot.point({s.radius * u.x(), s.radius * u.y(), -z}, down.z() < 0.0 ? 4 : 0);
}

void stand(Footprint& foot, const Cone& s, const Vec3& down, double) {
  rim(foot, s.radius, -0.5 * s.height, downhill(down), 0);
  foot.point({0.0, 0.0, 0.5 * s.height}, 4);
}

// Lowest corner, the one furthest from it, and the two furthest to the sides of their line.
void stand(Footprint& foot, const Polyhedron& s, const Vec3& down, double above) {
  const std::span<const Vec3> v = s.vertices();
  const std::uint32_t lowest = s.furthest(down);
  const Vec3 p0 = v[lowest];
  if (down.dot(p0) < above) return;
  const auto along_plane = [&](std::size_t i) {
    const Vec3 d = v[i] - p0;
    return Vec3(d - d.dot(down) * down);
  };
  std::uint32_t furthest = lowest;
  double most = 0.0;
  for (std::uint32_t i = 0; i < v.size(); ++i) {
    if (down.dot(v[i]) < above) continue;
    const double r2 = along_plane(i).squaredNorm();
    if (r2 > most) {
      most = r2;
      furthest = i;
    }
  }
  foot.point(p0, lowest);
  if (furthest == lowest) return;
  foot.point(v[furthest], furthest);
  const Vec3 across = down.cross(along_plane(furthest));
  std::uint32_t left = lowest, right = lowest;
  double leftmost = 1e-9 * most, rightmost = -1e-9 * most;
  for (std::uint32_t i = 0; i < v.size(); ++i) {
    if (down.dot(v[i]) < above) continue;
    const double side = across.dot(along_plane(i));
    if (side > leftmost) {
      leftmost = side;
      left = i;
    }
    if (side < rightmost) {
      rightmost = side;
      right = i;
    }
  }
  if (left != lowest) foot.point(v[left], left);
  if (right != lowest) foot.point(v[right], right);
}

}  // namespace

int find_contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                  Vec3& n_AB_cache, const Query& query, QueryCounts& counts,
                  std::vector<ContactPoint>& out) {
  ++counts.queries;
  if (std::holds_alternative<HalfSpace>(b)) {  // the other way round, then turned back
    if (std::holds_alternative<HalfSpace>(a)) return 0;
    --counts.queries;
    const std::size_t first = out.size();
    const int count = find_contacts(b, X_WB, a, X_WA, margin, n_AB_cache, query, counts, out);
    for (std::size_t i = first; i < out.size(); ++i) out[i].n_AB_W = -out[i].n_AB_W;
    return count;
  }
  const Pose X_AB = X_WA.inverse() * X_WB;
  if (std::holds_alternative<HalfSpace>(a)) {
    ++counts.iterations;
    Footprint foot(X_WA, X_AB, margin, out);
    const Vec3 down = X_AB.q.conjugate() * Vec3(0.0, 0.0, -1.0);
    std::visit(
        [&](const auto& s) {
          // Points p of B with down . p >= above are within the margin.
          if constexpr (!std::is_same_v<std::decay_t<decltype(s)>, HalfSpace>) {
            stand(foot, s, down, X_AB.p.z() - margin);
          }
        },
        b);
    return foot.count;
  }
  Query near = query;
  near.margin = margin;
  const Closest c = closest_points(a, b, X_AB, n_AB_cache, near);
  counts.iterations += c.iterations;
  counts.capped += c.capped ? 1 : 0;
  if (c.distance > margin) return 0;
  out.push_back({X_WA * (0.5 * (c.p_A + c.p_B)), X_WA.q * c.n_AB, -c.distance, 0});
  return 1;
}

int find_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  double margin, std::span<Vec3> n_AB_caches, const Query& query,
                  QueryCounts& counts, std::vector<ContactPoint>& out) {
  assert(n_AB_caches.size() == a.parts.size() * b.parts.size());
  int total = 0;
  std::uint32_t pair = 0;
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    const Part& pa = a.parts[i];
    const Pose X_WGa = X_WA * pa.X_BG;
    for (std::size_t j = 0; j < b.parts.size(); ++j, ++pair) {
      const Part& pb = b.parts[j];
      const Pose X_WGb = X_WB * pb.X_BG;
      const double reach = a.part_radius[i] + b.part_radius[j] + margin;
      if ((X_WGb.p - X_WGa.p).squaredNorm() > reach * reach) continue;
      const std::size_t first = out.size();
      total += find_contacts(pa.shape, X_WGa, pb.shape, X_WGb, margin, n_AB_caches[pair], query,
                             counts, out);
      for (std::size_t k = first; k < out.size(); ++k) out[k].feature |= pair << 16;
    }
  }
  return total;
}

}  // namespace headpin::engine
