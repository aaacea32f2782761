#include "engine/contacts.h"

#include <algorithm>
#include <cassert>
#include <type_traits>

#include "engine/inlining.h"
#include "engine/kept_plane.h"

namespace headpin::engine {
namespace {

constexpr double kSin120 = 0.86602540378443864676;

/// Normals from the other of the two.
void turn(std::span<ContactPoint> points) {
  for (ContactPoint& p : points) p.n_AB_W = -p.n_AB_W;
}

/// The plane of a half-space, and contact points of shapes that stand on it.
struct Ground {
  Ground(const Pose& X_WP, double most, std::vector<ContactPoint>& points)
      : up_W(z_axis(X_WP.q)),
        along_W(X_WP.q * Vec3::UnitY()),
        level(up_W.dot(X_WP.p)),
        margin(most),
        out(points) {}

  double height(const Vec3& p_W) const { return up_W.dot(p_W) - level; }

  /// Adds the points of a shape that are no higher than the margin; their normal is up.
  ///
  /// @param origin  of the shape's frame G: height over the ground [m]
  void carry(const Shape& shape, const Mat3& R_WG, const Vec3& p_WG, double origin);

  const Vec3 up_W, along_W;  // normal, and a direction in the plane
  const double level, margin;
  std::vector<ContactPoint>& out;
};

/// A shape over the ground.
struct Footprint {
  const Ground& ground;
  const Mat3& R_WG;
  const Vec3& p_WG;
  Vec3 down;     // in G
  double level;  // height of G's origin

  void point(const Vec3& p_G, std::uint32_t feature) {
    const double height = level - down.dot(p_G);
    if (height > ground.margin) return;
    ground.out.push_back(
        {R_WG * p_G + p_WG - 0.5 * height * ground.up_W, ground.up_W, -height, feature});
  }
};

/// Horizontal direction of steepest descent in the shape's frame. A round shape that stands upright
/// has none of its own: then one of the ground's, so that its yaw does not matter.
Vec2 downhill(const Footprint& foot, const Vec3& down) {
  Vec2 u(down.x(), down.y());
  if (u.squaredNorm() < 1e-8) u = (foot.R_WG.transpose() * foot.ground.along_W).head<2>();
  return u / u.norm();
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
  const Vec2 u = downhill(foot, down);
  const double z = down.z() < 0.0 ? -s.half_height : s.half_height;
  rim(foot, s.radius, z, u, down.z() < 0.0 ? 0 : 4);
  foot.point({s.radius * u.x(), s.radius * u.y(), -z}, down.z() < 0.0 ? 4 : 0);
}

void stand(Footprint& foot, const Cone& s, const Vec3& down, double) {
  rim(foot, s.radius, -0.5 * s.height, downhill(foot, down), 0);
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

/// Faces and generators within this angle of facing each other give more than one point [rad].
constexpr double kFacing = 0.1;
constexpr int kMaxCorners = 64;

/// The flat or straight part of a surface that faces a direction: a polygon, a segment or a point.
struct Patch {
  Vec3 corner[kMaxCorners];
  int count = 0;        // 1 point, 2 segment, 3.. polygon
  double radius = 0.0;  // of the surface across a segment

  void add(const Vec3& p) {
    if (count < kMaxCorners) corner[count++] = p;
  }
};

Patch patch(const Ellipsoid&, const Vec3&) {
  return {};
}
Patch patch(const HalfSpace&, const Vec3&) {
  return {};
}

// A disc becomes a polygon with corners on its rim, one of them furthest along n.
void add_disc(Patch& out, double radius, double z, const Vec3& n) {
  constexpr int kRim = 16;
  constexpr double kCos = 0.92387953251128675613, kSin = 0.38268343236508977173;  // of 2 pi / 16
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  Vec2 u = rho > 1e-9 ? Vec2(n.x() / rho, n.y() / rho) : Vec2(Vec2::UnitX());
  for (int i = 0; i < kRim; ++i) {
    out.add({radius * u.x(), radius * u.y(), z});
    u = {kCos * u.x() - kSin * u.y(), kSin * u.x() + kCos * u.y()};
  }
}

Patch patch(const Cylinder& s, const Vec3& n) {
  Patch out;
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  if (rho < kFacing) {
    add_disc(out, s.radius, n.z() < 0.0 ? -s.half_height : s.half_height, n);
  } else if (std::abs(n.z()) < kFacing) {
    const double k = s.radius / rho;
    out.add({k * n.x(), k * n.y(), -s.half_height});
    out.add({k * n.x(), k * n.y(), s.half_height});
    out.radius = s.radius;
  }
  return out;
}

Patch patch(const Cone& s, const Vec3& n) {
  Patch out;
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  if (rho < kFacing && n.z() < 0.0) {
    add_disc(out, s.radius, -0.5 * s.height, n);
  } else if (std::abs(s.height * n.z() - s.radius * rho) < kFacing * slant) {
    const double k = s.radius / rho;
    out.add({0.0, 0.0, 0.5 * s.height});
    out.add({k * n.x(), k * n.y(), -0.5 * s.height});
    out.radius = 0.5 * s.radius * slant / s.height;  // half-way up
  }
  return out;
}

Patch patch(const Polyhedron& s, const Vec3& n) {
  Patch out;
  const std::uint32_t v = s.furthest(n);
  const Polyhedron::Face* facing = nullptr;
  double most = 1.0 - 0.5 * kFacing * kFacing;
  for (const std::uint32_t f : s.faces_at(v)) {
    const double cosine = n.dot(s.faces()[f].normal);
    if (cosine > most) {
      most = cosine;
      facing = &s.faces()[f];
    }
  }
  if (facing != nullptr) {
    const auto corners = s.corners(*facing);
    const std::size_t step = (corners.size() + kMaxCorners - 1) / kMaxCorners;
    for (std::size_t i = 0; i < corners.size(); i += step) out.add(s.vertices()[corners[i]]);
    return out;
  }
  double least = kFacing;
  std::uint32_t other = v;
  for (const std::uint32_t w : s.neighbours(v)) {
    const Vec3 along = s.vertices()[w] - s.vertices()[v];
    const double sine = std::abs(n.dot(along)) / along.norm();
    if (sine < least) {
      least = sine;
      other = w;
    }
  }
  if (other != v) {
    out.add(s.vertices()[v]);
    out.add(s.vertices()[other]);
  }
  return out;
}

/// The plane across the contact normal; heights along it.
struct Frame {
  Vec3 origin, u, v, n;

  Vec2 flat(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
  double height(const Vec3& p) const { return n.dot(p - origin); }
};

/// A patch in the contact plane, with its height there: height(x) = level + slope . x.
struct Sheet {
  Vec2 corner[2 * kMaxCorners];
  int count = 0;
  double level = 0.0;
  Vec2 slope = Vec2::Zero();

  double height(const Vec2& x) const { return level + slope.dot(x); }
  Vec2 edge(int i) const { return corner[(i + 1) % count] - corner[i]; }
};

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Sheet lay(const Patch& patch, const Frame& frame) {
  Sheet s;
  s.count = patch.count;
  for (int i = 0; i < patch.count; ++i) s.corner[i] = frame.flat(patch.corner[i]);
  if (patch.count == 2) {
    const Vec2 d = s.corner[1] - s.corner[0];
    const double rise = frame.height(patch.corner[1]) - frame.height(patch.corner[0]);
    s.slope = rise / std::max(d.squaredNorm(), 1e-300) * d;
  } else {
    // Three corners far apart span the plane.
    const int j = patch.count / 3, k = 2 * patch.count / 3;
    const Vec3 m = (patch.corner[j] - patch.corner[0]).cross(patch.corner[k] - patch.corner[0]);
    const double up = m.dot(frame.n);
    if (up != 0.0) s.slope = Vec2(m.dot(frame.u), m.dot(frame.v)) / -up;
    if (up < 0.0) std::reverse(s.corner, s.corner + s.count);
  }
  s.level = frame.height(patch.corner[0]) - s.slope.dot(frame.flat(patch.corner[0]));
  return s;
}

/// The part of a convex polygon or segment to the left of the line through p along d.
void cut(Sheet& s, const Vec2& p, const Vec2& d) {
  Vec2 kept[2 * kMaxCorners];
  int count = 0;
  const int edges = s.count == 2 ? 1 : s.count;
  const auto keep = [&](const Vec2& x) {
    if (count < 2 * kMaxCorners) kept[count++] = x;
  };
  for (int i = 0; i < s.count; ++i) {
    const Vec2 &a = s.corner[i], &b = s.corner[(i + 1) % s.count];
    const double side_a = cross(d, a - p), side_b = cross(d, b - p);
    if (side_a >= 0.0) keep(a);
    if (i < edges && (side_a >= 0.0) != (side_b >= 0.0)) {
      keep(a + side_a / (side_a - side_b) * (b - a));
    }
  }
  s.count = count;
  std::copy(kept, kept + count, s.corner);
}

struct Candidate {
  Vec2 x;
  double height = 0.0, depth = 0.0;
};

/// What two patches share, as corners in the contact plane. Returns how many.
int shared(const Patch& of_a, const Patch& of_b, const Sheet& a, const Sheet& b, Candidate* out) {
  int count = 0;
  if (of_a.count == 2 && of_b.count == 2) {
    // Side on side: the stretch that both cover, if they are nearly parallel.
    const Vec2 da = a.corner[1] - a.corner[0], db = b.corner[1] - b.corner[0];
    const double length = da.norm(), turn = cross(da, db) / (length * db.norm());
    if (!(std::abs(turn) < kFacing)) return 0;
    const Vec2 t = da / length;
    const double b0 = t.dot(b.corner[0] - a.corner[0]), b1 = t.dot(b.corner[1] - a.corner[0]);
    const double low = std::max(0.0, std::min(b0, b1)), high = std::min(length, std::max(b0, b1));
    if (!(low < high)) return 0;
    for (const double s : {low, high}) {
      const Vec2 xa = a.corner[0] + s * t;
      const Vec2 xb = b.corner[0] + (s - b0) / (b1 - b0) * db;
      // Round sides that part sideways by e are further apart than their lines by e^2 / 2 r.
      const double e2 = (xa - xb).squaredNorm();
      const double ha = a.height(xa), hb = b.height(xb);
      const double lost = e2 / (2.0 * (of_a.radius + of_b.radius) + std::sqrt(e2) + 1e-300);
      out[count++] = {0.5 * (xa + xb), 0.5 * (ha + hb), ha - hb - lost};
    }
    return count;
  }
  const bool a_first = of_a.count == 2 || of_b.count != 2;  // a segment is cut by the polygon
  Sheet s = a_first ? a : b;
  const Sheet& knife = a_first ? b : a;
  for (int i = 0; i < knife.count && s.count > 0; ++i) cut(s, knife.corner[i], knife.edge(i));
  for (int i = 0; i < s.count; ++i) {
    const double ha = a.height(s.corner[i]), hb = b.height(s.corner[i]);
    out[count++] = {s.corner[i], 0.5 * (ha + hb), ha - hb};
  }
  return count;
}

/// Up to four that reach furthest: the first, the furthest from it, and the furthest to both sides.
int spread(const Candidate* all, int count, int first, int* chosen) {
  chosen[0] = first;
  int far = first;
  for (int i = 0; i < count; ++i) {
    if ((all[i].x - all[first].x).squaredNorm() > (all[far].x - all[first].x).squaredNorm())
      far = i;
  }
  const Vec2 d = all[far].x - all[first].x;
  const double least = 1e-6 * d.squaredNorm();
  if (!(least > 0.0)) return 1;
  chosen[1] = far;
  int left = first, right = first;
  double leftmost = least, rightmost = -least;
  for (int i = 0; i < count; ++i) {
    const double side = cross(d, all[i].x - all[first].x);
    if (side > leftmost) {
      leftmost = side;
      left = i;
    }
    if (side < rightmost) {
      rightmost = side;
      right = i;
    }
  }
  int n = 2;
  if (left != first) chosen[n++] = left;
  if (right != first) chosen[n++] = right;
  return n;
}

/// All points of a contact whose deepest is known. Works in A's frame.
int add_points(const Shape& a, const Shape& b, const Pose& X_WA, const Pose& X_AB, const Closest& c,
               double margin, std::vector<ContactPoint>& out) {
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
  int first = 0;
  for (int i = 1; i < count; ++i) {
    if (all[i].depth > all[first].depth) first = i;
  }
  // The deepest point itself, where no corner comes close to it.
  double extent = 0.0;
  for (int i = 0; i < count; ++i) extent = std::max(extent, all[i].x.norm());
  if (all[first].depth < -c.distance - 1e-3 * extent) {
    all[count] = {Vec2::Zero(), 0.0, -c.distance};
    first = count++;
  }
  int chosen[kMaxPoints];
  const int points = spread(all, count, first, chosen);
  int added = 0;
  for (int i = 0; i < points; ++i) {
    const Candidate& x = all[chosen[i]];
    if (x.depth < -margin) continue;
    const Vec3 p_A = frame.origin + x.x.x() * frame.u + x.x.y() * frame.v + x.height * frame.n;
    out.push_back(
        {X_WA * p_A, n_AB_W, std::min(x.depth, -c.distance), static_cast<std::uint32_t>(i)});
    ++added;
  }
  return added > 0 ? added : one();
}

void Ground::carry(const Shape& shape, const Mat3& R_WG, const Vec3& p_WG, double origin) {
  Footprint foot{*this, R_WG, p_WG, -(R_WG.transpose() * up_W), origin};
  std::visit(
      [&](const auto& s) {
        // Points p with down . p >= above are within the margin.
        if constexpr (!std::is_same_v<std::decay_t<decltype(s)>, HalfSpace>) {
          stand(foot, s, foot.down, foot.level - margin);
        }
      },
      shape);
}

/// Of two bounded shapes, B seen from A; where A is in the world is asked for when they meet.
template <typename PoseOfA>
int meet(const Shape& a, PoseOfA&& pose_of_a, const Shape& b, const Pose& X_AB, double margin,
         Vec3& n_AB_cache, const Query& query, QueryCounts& counts,
         std::vector<ContactPoint>& out) {
  ++counts.queries;
  Query near = query;
  near.margin = margin;
  const Closest c = closest_points(a, b, X_AB, n_AB_cache, near);
  counts.iterations += c.iterations;
  counts.capped += c.capped ? 1 : 0;
  if (c.distance > margin || (c.separated && query.mode == Query::paper)) return 0;
  const Pose X_WA = pose_of_a();
  if (query.mode == Query::paper) {  // one point, as equation (1) has it
    out.push_back({X_WA * (0.5 * (c.p_A + c.p_B)), X_WA.q * c.n_AB, -c.distance, 0, c.capped});
    return 1;
  }
  return add_points(a, b, X_WA, X_AB, c, margin, out);
}

}  // namespace

int find_contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                  Vec3& n_AB_cache, const Query& query, QueryCounts& counts,
                  std::vector<ContactPoint>& out) {
  const std::size_t first = out.size();
  if (std::holds_alternative<HalfSpace>(a)) {
    ++counts.queries;
    ++counts.iterations;
    Ground ground(X_WA, margin, out);
    ground.carry(b, X_WB.q.toRotationMatrix(), X_WB.p, ground.height(X_WB.p));
    return static_cast<int>(out.size() - first);
  }
  if (std::holds_alternative<HalfSpace>(b)) {
    const int count = find_contacts(b, X_WB, a, X_WA, margin, n_AB_cache, query, counts, out);
    turn(std::span(out).subspan(first));
    return count;
  }
  if (starts_warm(query) && still_apart(a, X_WA, b, X_WB, n_AB_cache, margin)) {
    ++counts.queries;
    ++counts.iterations;
    return 0;
  }
  return meet(
      a, [&] { return X_WA; }, b, relative(X_WA, X_WB), margin, n_AB_cache, query, counts, out);
}

namespace {

bool is_turned(const Part& part) {
  return !part.X_BG.q.vec().isZero(0.0);
}

/// Of a compound over a half-space; their normals are up.
HEADPIN_FLATTEN void stand_on(const Pose& X_WP, const Compound& a, const Pose& X_WA, double margin,
                              QueryCounts& counts, std::vector<ContactPoint>& out) {
  Ground ground(X_WP, margin, out);
  const Mat3 R_WA = X_WA.q.toRotationMatrix();
  const Vec3 up_A = R_WA.transpose() * ground.up_W;
  const double level = ground.height(X_WA.p);
  for (std::uint32_t i = 0; i < a.parts.size(); ++i) {
    const Part& part = a.parts[i];
    const double origin = level + up_A.dot(part.X_BG.p);
    if (origin > a.part_radius[i] + margin) continue;
    ++counts.queries;
    ++counts.iterations;
    const std::size_t first = out.size();
    const Vec3 p_WG = R_WA * part.X_BG.p + X_WA.p;
    if (is_turned(part)) {
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

std::size_t cache_size(const Compound& a, const Compound& b) {
  return is_half_space(a) || is_half_space(b) ? 0 : a.parts.size() * b.parts.size();
}

int find_contacts(const Compound& a, const Pose& X_WA, const Compound& b, const Pose& X_WB,
                  double margin, std::span<Vec3> n_AB_caches, const Query& query,
                  QueryCounts& counts, std::vector<ContactPoint>& out) {
  assert(n_AB_caches.size() == cache_size(a, b));
  const std::size_t first = out.size();
  if (is_half_space(b)) {
    stand_on(X_WB * b.parts[0].X_BG, a, X_WA, margin, counts, out);
    turn(std::span(out).subspan(first));
    return static_cast<int>(out.size() - first);
  }
  if (is_half_space(a)) {
    stand_on(X_WA * a.parts[0].X_BG, b, X_WB, margin, counts, out);
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
        Vec3& kept = n_AB_caches[pair];
        if (warm && !is_turned(pa) && !is_turned(pb) &&
            still_apart(pa.shape, pb.shape, R_AB, p_GaGb_A, kept, margin)) {
          ++counts.queries;
          ++counts.iterations;
          continue;
        }
        Pose X_GaGb{is_turned(pb) ? X_AB.q * pb.X_BG.q : X_AB.q, p_GaGb_A};
        if (is_turned(pa)) X_GaGb = Pose{pa.X_BG.q.conjugate(), Vec3::Zero()} * X_GaGb;
        meet(pa.shape, pose_of_a, pb.shape, X_GaGb, margin, kept, query, counts, out);
      } else {  // a half-space among them
        find_contacts(pa.shape, pose_of_a(), pb.shape, X_WB * pb.X_BG, margin, n_AB_caches[pair],
                      query, counts, out);
      }
      for (std::size_t k = start; k < out.size(); ++k) {
        out[k].feature |= static_cast<std::uint32_t>(pair) << 16;
      }
    }
  }
  return static_cast<int>(out.size() - first);
}

}  // namespace headpin::engine
