#include "engine/contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <type_traits>

#include "engine/faces.h"
#include "engine/footing.h"
#include "engine/inlining.h"
#include "engine/kept_plane.h"
#include "engine/patch.h"

namespace headpin::engine {
namespace {

using namespace patches;
using footing::Ground;
using footing::Rim;
using footing::Side;

Rim rim_of(const Query& query) {
  return query.faces ? Rim::four : Rim::three;
}

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
  SharedPoint all[2 * kMaxCorners + 2];
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
    const SharedPoint& x = all[chosen[i]];
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
    Ground ground(side, X_WP, margin, rim_of(query), out);
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
HEADPIN_FLATTEN Pose pose_of(const Pose& X_WB, const Compound& c, std::size_t part) {
  const Pose& X_BG = c.parts[part].X_BG;
  return c.part_turned[part] ? X_WB * X_BG : Pose{X_WB.q, X_WB * X_BG.p};
}

/// The numbers of the pairs that a compound's parts are in: first, first + step, ...
struct PairNumbers {
  std::uint32_t first = 0, step = 1;
};

/// Adds the contacts of a compound A with a plane.
HEADPIN_FLATTEN void stand_on(Ground ground, const Compound& a, const Pose& X_WA,
                              PairNumbers numbers, QueryCounts& counts) {
  std::vector<ContactPoint>& out = ground.out;
  const Mat3 R_WA = X_WA.q.toRotationMatrix();
  const Vec3 up_A = R_WA.transpose() * ground.up_W;
  const double level = ground.height(X_WA.p);
  const double low = level + std::min(up_A.dot(a.bounds.a), up_A.dot(a.bounds.b));
  if (std::isfinite(a.bounding_radius) && low > a.bounds.radius + ground.margin) return;
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
    const std::uint32_t pair = numbers.first + i * numbers.step;
    for (std::size_t k = first; k < out.size(); ++k) out[k].feature |= pair << 16;
  }
}

bool is_half_space(const Compound& c) {
  return c.parts.size() == 1 && std::holds_alternative<HalfSpace>(c.parts[0].shape);
}

bool is_turned(const Quat& q) {
  return !q.vec().isZero(0.0);
}

/// A compound M over a polyhedron G: contacts that need no search.
struct Over {
  Side side;  // of G
  Faces faces;
  const Pose X_WG;
  const bool turned = is_turned(X_WG.q);
  const Compound& m;
  const Pose& X_WM;
  const Mat3& R_WM;
  const double margin;
  QueryCounts& counts;
  std::vector<ContactPoint>& out;

  /// Adds those of all parts of M. @return whether none of them needs a search
  HEADPIN_FLATTEN bool carries(PairNumbers numbers) {
    const Crossed found = faces.crossed(relative(X_WG, X_WM) * m.bounds);
    if (found.what == Crossed::one_face) {
      stand_on(Ground(side, *found.face, X_WG, margin, out), m, X_WM, numbers, counts);
    }
    return found.what != Crossed::more;
  }

  /// Adds those of a part of M. @return whether it needs no search
  HEADPIN_FLATTEN bool carries(std::size_t part, std::uint32_t pair) const {
    const Pose& X_MP = m.parts[part].X_BG;
    const Vec3 p_WP = X_WM * X_MP.p, p_GP_W = p_WP - X_WG.p;
    const Vec3 p_GP = turned ? X_WG.q.conjugate() * p_GP_W : p_GP_W;
    const Crossed found = faces.crossed(p_GP, m.part_radius[part]);
    if (found.what == Crossed::one_face) {
      ++counts.queries;
      ++counts.iterations;
      const std::size_t first = out.size();
      Ground ground(side, *found.face, X_WG, margin, out);
      const Mat3 R_WP = m.part_turned[part] ? (X_WM.q * X_MP.q).toRotationMatrix() : R_WM;
      ground.carry(m.parts[part].shape, R_WP, p_WP, ground.height(p_WP));
      for (std::size_t k = first; k < out.size(); ++k) out[k].feature |= pair << 16;
    }
    return found.what != Crossed::more;
  }
};

/// Whether A or B is the one whose faces may carry the other: of two compounds of polyhedra the larger.
std::optional<Side> faceted_side(const Compound& a, const Compound& b, const Query& query) {
  if (!query.faces || query.mode == Query::paper) return std::nullopt;
  if (a.faceted && std::isfinite(b.bounding_radius) &&
      !(b.faceted && b.bounding_radius >= a.bounding_radius)) {
    return Side::a;
  }
  if (b.faceted && std::isfinite(a.bounding_radius)) return Side::b;
  return std::nullopt;
}

/// Distance of a point from the segment of a capsule, squared.
double distance2(const Vec3& p, const Capsule& c) {
  const Vec3 along = c.b - c.a, from_a = p - c.a;
  const double length2 = along.squaredNorm(), way = from_a.dot(along);
  if (way <= 0.0) return from_a.squaredNorm();
  if (way >= length2) return (p - c.b).squaredNorm();
  return from_a.squaredNorm() - way * way / length2;
}

/// The first 64 parts of a compound that may meet a body, a bit each, and all others.
class NearParts {
 public:
  NearParts() = default;  // all
  /// @param bounds  of the body, in the frame of the compound
  NearParts(const Compound& c, const Capsule& bounds, double margin) : bits_(0) {
    for (std::size_t i = 0; i < std::min<std::size_t>(c.parts.size(), 64); ++i) {
      const double reach = c.part_radius[i] + bounds.radius + margin;
      const bool near = distance2(c.parts[i].X_BG.p, bounds) <= reach * reach;
      bits_ |= static_cast<std::uint64_t>(near) << i;
    }
  }
  bool has(std::size_t part) const { return part >= 64 || (bits_ >> part & 1) != 0; }

 private:
  std::uint64_t bits_ = ~std::uint64_t{0};
};

/// Two posed compounds, and what is asked of them.
struct Posed {
  const Compound& a;
  const Pose& X_WA;
  const Compound& b;
  const Pose& X_WB;
  const double margin;
  const std::span<KeptNormal> kept;
  const Query& query;
  QueryCounts& counts;
  std::vector<ContactPoint>& out;
};

/// The same, part by part.
struct PartSearch : Posed {
  explicit PartSearch(const Posed& posed) : Posed(posed) {}

  const Pose X_AB = relative(X_WA, X_WB);
  const Mat3 R_AB = X_AB.q.toRotationMatrix();
  const bool warm = starts_warm(query);

  Vec3 place_of_b(std::size_t j) const { return R_AB * b.parts[j].X_BG.p + X_AB.p; }

  void meet_parts(std::size_t i, std::size_t j, const Vec3& p_AGb) const {
    const Part &pa = a.parts[i], &pb = b.parts[j];
    const Vec3 p_GaGb_A = p_AGb - pa.X_BG.p;
    const double reach = a.part_radius[i] + b.part_radius[j] + margin;
    if (p_GaGb_A.squaredNorm() > reach * reach) return;
    const std::size_t start = out.size();
    const std::size_t pair = i * b.parts.size() + j;
    const auto pose_of_a = [&] { return X_WA * pa.X_BG; };
    if (std::isfinite(reach)) {
      KeptNormal& mine = kept[pair];
      if (warm && !a.part_turned[i] && !b.part_turned[j] &&
          still_apart(pa.shape, pb.shape, R_AB, p_GaGb_A, mine, margin)) {
        ++counts.queries;
        ++counts.iterations;
        return;
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

  /// For each part of B, in order, all parts of A.
  void meet_all() const {
    NearParts near_a, near_b;
    const bool bounded = std::isfinite(a.bounding_radius) && std::isfinite(b.bounding_radius);
    if (query.faces && warm && bounded && a.parts.size() > 1 && b.parts.size() > 1) {
      near_a = NearParts(a, X_AB * b.bounds, margin);
      near_b = NearParts(b, X_AB.inverse() * a.bounds, margin);
    }
    for (std::size_t j = 0; j < b.parts.size(); ++j) {
      if (!near_b.has(j)) continue;
      const Vec3 p_AGb = place_of_b(j);
      for (std::size_t i = 0; i < a.parts.size(); ++i) {
        if (near_a.has(i)) meet_parts(i, j, p_AGb);
      }
    }
  }
};

/// For each part of the polyhedra of one of them, all parts of the other one that need a search.
void meet_faces(const Posed& of, Side faceted) {
  const bool of_a = faceted == Side::a;
  const Compound &f = of_a ? of.a : of.b, &m = of_a ? of.b : of.a;
  const Pose &X_WF = of_a ? of.X_WA : of.X_WB, &X_WM = of_a ? of.X_WB : of.X_WA;
  const auto of_b = static_cast<std::uint32_t>(of.b.parts.size());
  std::optional<PartSearch> search;  // most bodies need none
  Box around_m;                      // in the frame of F
  if (of.query.boxes) around_m = box_around(relative(X_WF, X_WM) * m.bounds, of.margin);
  const Mat3 R_WM = X_WM.q.toRotationMatrix();
  for (std::uint32_t k = 0; k < f.parts.size(); ++k) {
    if (!around_m.meets(f.part_box[k])) continue;
    Over over{.side = faceted,
              .faces = Faces(std::get<Polyhedron>(f.parts[k].shape), of.margin),
              .X_WG = pose_of(X_WF, f, k),
              .m = m,
              .X_WM = X_WM,
              .R_WM = R_WM,
              .margin = of.margin,
              .counts = of.counts,
              .out = of.out};
    if (over.carries(of_a ? PairNumbers{k * of_b, 1} : PairNumbers{k, of_b})) continue;
    if (!search) search.emplace(of);
    for (std::uint32_t l = 0; l < m.parts.size(); ++l) {
      const std::uint32_t i = of_a ? k : l, j = of_a ? l : k;
      if (!over.carries(l, i * of_b + j)) search->meet_parts(i, j, search->place_of_b(j));
    }
  }
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
    stand_on(Ground(Side::b, pose_of(X_WB, b, 0), margin, rim_of(query), out), a, X_WA, {}, counts);
  } else if (is_half_space(a)) {
    stand_on(Ground(Side::a, pose_of(X_WA, a, 0), margin, rim_of(query), out), b, X_WB, {}, counts);
  } else {
    const Posed posed{a, X_WA, b, X_WB, margin, kept, query, counts, out};
    const std::optional<Side> faceted = faceted_side(a, b, query);
    faceted ? meet_faces(posed, *faceted) : PartSearch(posed).meet_all();
  }
  return static_cast<int>(out.size() - first);
}

}  // namespace headpin::engine
