#include "engine/polyhedra.h"

#include <algorithm>

namespace headpin::engine {
namespace {

bool vertex_inside(const Polyhedron& hull, const Vec3& p, EarlyOut early_out) {
  bool inside = true;
  for (const Polyhedron::Face& f : hull.faces()) {
    if (f.normal.dot(p) - f.offset > 0.0) {
      if (early_out == EarlyOut::yes) return false;
      inside = false;
    }
  }
  return inside;
}

// Clips p + t (q - p), t in [0, 1], by every face: something is left when the edge passes through.
bool edge_inside(const Polyhedron& hull, const Vec3& p, const Vec3& q, EarlyOut early_out) {
  double low = 0.0, high = 1.0;
  for (const Polyhedron::Face& f : hull.faces()) {
    const double at_p = f.normal.dot(p) - f.offset, at_q = f.normal.dot(q) - f.offset;
    if (at_p > 0.0 && at_q > 0.0) {
      low = 2.0;
    } else if (at_p > 0.0) {
      low = std::max(low, at_p / (at_p - at_q));
    } else if (at_q > 0.0) {
      high = std::min(high, at_p / (at_p - at_q));
    }
    if (early_out == EarlyOut::yes && low > high) return false;
  }
  return low <= high;
}

/// Vertices and edges of `guest` against the inside of `host`.
bool enters(const Polyhedron& host, const Polyhedron& guest, const Pose& X_HG, EarlyOut early_out) {
  const Mat3 R = X_HG.q.toRotationMatrix();
  const auto seen = [&](std::uint32_t i) { return Vec3(R * guest.vertices()[i] + X_HG.p); };
  bool found = false;
  for (std::uint32_t i = 0; i < guest.vertices().size(); ++i) {
    found = vertex_inside(host, seen(i), early_out) || found;
    if (found && early_out == EarlyOut::yes) return true;
  }
  for (const Polyhedron::Edge& e : guest.edges()) {
    found = edge_inside(host, seen(e.from), seen(e.to), early_out) || found;
    if (found && early_out == EarlyOut::yes) return true;
  }
  return found;
}

}  // namespace

bool intersect_by_features(const Polyhedron& a, const Polyhedron& b, const Pose& X_AB,
                           EarlyOut early_out) {
  const bool b_in_a = enters(a, b, X_AB, early_out);
  if (b_in_a && early_out == EarlyOut::yes) return true;
  return enters(b, a, X_AB.inverse(), early_out) || b_in_a;
}

}  // namespace headpin::engine
