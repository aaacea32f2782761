#include "engine/kept_plane.h"

#include <limits>
#include <type_traits>

namespace headpin::engine {
namespace {

// Value of the support function, n . support(n).
double reach_along(const Ellipsoid& s, const Vec3& n) {
  return s.radii.cwiseProduct(n).norm();
}
double reach_along(const Cylinder& s, const Vec3& n) {
  return s.radius * std::sqrt(n.x() * n.x() + n.y() * n.y()) + s.half_height * std::abs(n.z());
}
double reach_along(const Cone& s, const Vec3& n) {
  const double rim = s.radius * std::sqrt(n.x() * n.x() + n.y() * n.y());
  return std::max(0.5 * s.height * n.z(), rim - 0.5 * s.height * n.z());
}
double reach_along(const Polyhedron& s, const Vec3& n) {
  return n.dot(support(s, n));
}

bool is_plane(const KeptNormal& kept) {
  return kept.of == KeptNormal::apart && std::abs(kept.n_AB.squaredNorm() - 1.0) < 1e-9;
}

/// Gap between the support planes across n. The normal is given in both frames; `apart` is the
/// distance of the origins along n.
double gap(const Shape& a, const Vec3& n_A, const Shape& b, const Vec3& n_B, double apart) {
  return visit_both(a, b, [&](const auto& sa, const auto& sb) {
    if constexpr (std::is_same_v<std::decay_t<decltype(sa)>, HalfSpace> ||
                  std::is_same_v<std::decay_t<decltype(sb)>, HalfSpace>) {
      return -std::numeric_limits<double>::infinity();  // no proof: the closed form is as fast
    } else {
      return apart - reach_along(sa, n_A) - reach_along(sb, n_B);
    }
  });
}

}  // namespace

bool still_apart(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                 const KeptNormal& kept, double margin) {
  if (!is_plane(kept)) return false;
  const Vec3 n_W = X_WA.q * kept.n_AB, n_B = X_WB.q.conjugate() * -n_W;
  return gap(a, kept.n_AB, b, n_B, n_W.dot(X_WB.p - X_WA.p)) > margin;
}

bool still_apart(const Shape& a, const Shape& b, const Mat3& R_AB, const Vec3& p_AB,
                 const KeptNormal& kept, double margin) {
  if (!is_plane(kept)) return false;
  const Vec3 n_B = R_AB.transpose() * -kept.n_AB;
  return gap(a, kept.n_AB, b, n_B, kept.n_AB.dot(p_AB)) > margin;
}

}  // namespace headpin::engine
