#include "engine/contacts.h"

#include <algorithm>
#include <cassert>
#include <type_traits>

#include "engine/footing.h"
#include "engine/inlining.h"
#include "engine/kept_plane.h"
#include "engine/patch.h"

namespace headpin::engine {
namespace {

using namespace patches;
using footing::Ground;
using footing::Side;

/// Adds all points of a contact, given its deepest point. Works in A's frame.
int add_points(const Shape& a, const Shape& b, const Pose& X_WA, const Pose& X_AB, const Closest& c,
               const Query& query, std::vector<ContactPoint>& out) {
  const Vec3 n_AB_W = X_WA.q * c.n_AB;
  const Vec3 middle = 0.5 * (c.p_A + c.p_B);
  const Vec3 n_B = X_AB.q.conjugate() * -c.n_AB;
  const auto facing = [](const Shape& s, const Vec3& n) {
    return std::visit([&](const auto& shape) { return patch(shape, n); }, s);
  };
  const auto one = [&] {
    out.push_back({X_WA * middle, n_AB_W, -c.distance, 0});
    return 1;
  };
  if (std::holds_alternative<Ellipsoid>(a) || std::holds_alternative<Ellipsoid>(b)) return one();
  const Patch patch_a = facing(a, c.n_AB);
  if (patch_a.count < 2) return one();
  Patch patch_b = facing(b, n_B);
  if (patch_b.count < 2) return one();
  for (int i = 0; i < patch_b.count; ++i) patch_b.corner[i] = X_AB * patch_b.corner[i];

  Frame frame{middle, c.n_AB.unitOrthogonal(), Vec3::Zero(), c.n_AB};
  frame.v = frame.n.cross(frame.u);
  Candidate all[2 * kMaxCorners + 2];
  int count = shared(patch_a, patch_b, lay(patch_a, frame), lay(patch_b, frame), all);
  if (count == 0) return one();
  // A rim pivots about its deepest point, however little it leans.
  const bool steady = query.steady && count > kMaxPoints && !patch_a.round && !patch_b.round;
  int first = deepest(all, count, frame, steady);
  // Adds the deepest point itself if no corner is nearly as deep.
  double extent = 0.0;
  for (int i = 0; i < count; ++i) extent = std::max(extent, all[i].x.norm());
  if (all[first].depth < -c.distance - 1e-3 * extent) {
    all[count] = {Vec2::Zero(), 0.0, -c.distance, kInside};
    first = count++;
  }
  int chosen[kMaxPoints];
  const int points = spread(all, count, first, chosen);
  int added = 0;
  for (int i = 0; i < points; ++i) {
    const Candidate& x = all[chosen[i]];
    if (x.depth < -query.margin) continue;
    const Vec3 p_A = frame.origin + x.x.x() * frame.u + x.x.y() * frame.v + x.height * frame.n;
    const auto feature = query.steady ? x.feature : static_cast<std::uint32_t>(i);
    out.push_back({X_WA * p_A, n_AB_W, std::min(x.depth, -c.distance), feature});
    ++added;
  }
  return added > 0 ? added : one();
}

/// Adds the contacts of two bounded shapes, with B in A's frame. The pose of A in the world is
/// computed only if they meet.
template <typename PoseOfA>
int meet(const Shape& a, PoseOfA&& pose_of_a, const Shape& b, const Pose& X_AB, double margin,
         KeptNormal& kept, const Query& query, QueryCounts& counts,
         std::vector<ContactPoint>& out) {
  ++counts.queries;
  Query near = query;
  near.margin = margin;
  const Closest c = closest_points(a, b, X_AB, kept, near);
  counts.iterations += c.iterations;
  counts.capped += c.capped ? 1 : 0;
  if (c.distance > margin || (c.separated && query.mode == Query::paper)) return 0;
  const Pose X_WA = pose_of_a();
  if (query.mode == Query::paper) {  // one point, as in equation (1)
    out.push_back({X_WA * (0.5 * (c.p_A + c.p_B)), X_WA.q * c.n_AB, -c.distance, 0, c.capped});
    return 1;
  }
  return add_points(a, b, X_WA, X_AB, c, near, out);
}

}  // namespace

int find_contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                  KeptNormal& kept, const Query& query, QueryCounts& counts,
                  std::vector<ContactPoint>& out) {
  const auto stand = [&](Side side, const Pose& X_WP, const Shape& shape, const Pose& X_WG) {
    const std::size_t first = out.size();
    ++counts.queries;
    ++counts.iterations;
    Ground ground(side, X_WP, margin, out);
    ground.carry(shape, X_WG.q.toRotationMatrix(), X_WG.p, ground.height(X_WG.p));
    return static_cast<int>(out.size() - first);
  };
  if (std::holds_alternative<HalfSpace>(a)) return stand(Side::a, X_WA, b, X_WB);
  if (std::holds_alternative<HalfSpace>(b)) return stand(Side::b, X_WB, a, X_WA);
  if (starts_warm(query) && still_apart(a, X_WA, b, X_WB, kept, margin)) {
    ++counts.queries;
    ++counts.iterations;
    return 0;
  }
  return meet(
      a, [&] { return X_WA; }, b, relative(X_WA, X_WB), margin, kept, query, counts, out);
}

namespace {

/// Pose of a part. Most parts are not turned and need no product of rotations.
Pose pose_of(const Pose& X_WB, const Compound& c, std::size_t part) {
  const Pose& X_BG = c.parts[part].X_BG;
  return c.part_turned[part] ? X_WB * X_BG : Pose{X_WB.q, X_WB * X_BG.p};
}

/// Adds the contacts of a compound A with a half-space.
HEADPIN_FLATTEN void stand_on(Ground ground, const Compound& a, const Pose& X_WA,
                              QueryCounts& counts) {
  std::vector<ContactPoint>& out = ground.out;
  const Mat3 R_WA = X_WA.q.toRotationMatrix();
  const Vec3 up_A = R_WA.transpose() * ground.up_W;
  const double level = ground.height(X_WA.p);
  for (std::uint32_t i = 0; i < a.parts.size(); ++i) {
    const Part& part = a.parts[i];
    const double origin = level + up_A.dot(part.X_BG.p);
    if (origin > a.part_radius[i] + ground.margin) continue;
    ++counts.queries;
    ++counts.iterations;
    const std::size_t first = out.size();
    const Vec3 p_WG = R_WA * part.X_BG.p + X_WA.p;
    if (a.part_turned[i]) {
      ground.carry(part.shape, (X_WA.q * part.X_BG.q).toRotationMatrix(), p_WG, origin);
    } else {
      ground.carry(part.shape, R_WA, p_WG, origin);
    }
    for (std::size_t k = first; k < out.size(); ++k) out[k].feature |= i << 16;
  }
}

bool is_half_space(const Compound& c) {
  return c.parts.size() == 1 && std::holds_alternative<HalfSpace>(c.parts[0].shape);
}

}  // namespace

std::size_t kept_normals(const Compound& a, const Compound& b) {
  return is_half_space(a) || is_half_space(b) ? 0 : a.parts.size() * b.parts.size();
}

int find_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  double margin, std::span<KeptNormal> kept, const Query& query,
                  QueryCounts& counts, std::vector<ContactPoint>& out) {
  assert(kept.size() == kept_normals(a, b));
  const std::size_t first = out.size();
  if (is_half_space(b)) {
    stand_on(Ground(Side::b, pose_of(X_WB, b, 0), margin, out), a, X_WA, counts);
    return static_cast<int>(out.size() - first);
  }
  if (is_half_space(a)) {
    stand_on(Ground(Side::a, pose_of(X_WA, a, 0), margin, out), b, X_WB, counts);
    return static_cast<int>(out.size() - first);
  }
  const Pose X_AB = relative(X_WA, X_WB);
  const Mat3 R_AB = X_AB.q.toRotationMatrix();
  const bool warm = starts_warm(query);
  for (std::size_t j = 0; j < b.parts.size(); ++j) {
    const Part& pb = b.parts[j];
    const Vec3 p_AGb = R_AB * pb.X_BG.p + X_AB.p;
    for (std::size_t i = 0; i < a.parts.size(); ++i) {
      const Part& pa = a.parts[i];
      const Vec3 p_GaGb_A = p_AGb - pa.X_BG.p;
      const double reach = a.part_radius[i] + b.part_radius[j] + margin;
      if (p_GaGb_A.squaredNorm() > reach * reach) continue;
      const std::size_t start = out.size();
      const std::size_t pair = i * b.parts.size() + j;
      const auto pose_of_a = [&] { return X_WA * pa.X_BG; };
      if (std::isfinite(reach)) {
        KeptNormal& mine = kept[pair];
        if (warm && !a.part_turned[i] && !b.part_turned[j] &&
            still_apart(pa.shape, pb.shape, R_AB, p_GaGb_A, mine, margin)) {
          ++counts.queries;
          ++counts.iterations;
          continue;
        }
        Pose X_GaGb{b.part_turned[j] ? X_AB.q * pb.X_BG.q : X_AB.q, p_GaGb_A};
        if (a.part_turned[i]) X_GaGb = Pose{pa.X_BG.q.conjugate(), Vec3::Zero()} * X_GaGb;
        meet(pa.shape, pose_of_a, pb.shape, X_GaGb, margin, mine, query, counts, out);
      } else {  // one of them is a half-space
        find_contacts(pa.shape, pose_of_a(), pb.shape, X_WB * pb.X_BG, margin, kept[pair], query,
                      counts, out);
      }
      for (std::size_t k = start; k < out.size(); ++k) {
        out[k].feature |= static_cast<std::uint32_t>(pair) << 16;
      }
    }
  }
  return static_cast<int>(out.size() - first);
}

}  // namespace headpin::engine
