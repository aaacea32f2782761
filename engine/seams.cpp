#include "engine/seams.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/broad_phase.h"
#include "engine/rules.h"

namespace headpin::engine::detail {
namespace {

constexpr double kFlush = 1e-5;     // step or gap between faces that still join [m]
constexpr double kParallel = 1e-3;  // angle between such faces [rad]
constexpr double kDeep = 1e-3;      // how deep below a face its edge is still met [m]
constexpr double kBeside = 1e-4;    // how far inside an edge a point still belongs to it [m]
constexpr double kLean = 1e-3;      // sine of the angle between a normal and that of the face
/// What is farther away may yet land on the part: its path is followed until it is near [m].
constexpr double kNear = 1e-3;
constexpr std::uint32_t kMostPairs = 1u << 16;  // of parts, whose numbers a feature holds

/// A convex part of a fixed body that has faces.
struct Tile {
  BodyId body;
  std::uint32_t part;
  const Polyhedron* shape;
  Pose X_WG;
};

/// A plane that something fixed fills up to: of a half-space, everywhere; of a face, within its edges.
struct Ground {
  Vec3 up_W;
  double height;
  std::vector<Vec3> corners_W;  // counterclockwise from above; none of a half-space
};

struct Interval {
  double low, high;  // along an edge [m]
};

Ground ground_of(const Tile& tile, const Polyhedron::Face& face) {
  const Vec3 up = tile.X_WG.q * face.normal;
  Ground ground{up, up.dot(tile.X_WG.p) + face.offset, {}};
  for (const std::uint32_t i : tile.shape->corners(face)) {
    ground.corners_W.push_back(tile.X_WG * tile.shape->vertices()[i]);
  }
  return ground;
}

bool is_parallel(const Vec3& a, const Vec3& b) {
  return a.dot(b) > 0.0 && a.cross(b).squaredNorm() < kParallel * kParallel;
}

/// The part of the line from p along unit `along` that is over a ground, and no higher or lower than it.
Interval part_over(const Ground& ground, const Vec3& p, const Vec3& along, double length) {
  constexpr Interval none{0.0, -1.0};
  Interval in{0.0, length};
  for (std::size_t i = 0; i < ground.corners_W.size(); ++i) {
    const Vec3& from = ground.corners_W[i];
    const Vec3& to = ground.corners_W[(i + 1) % ground.corners_W.size()];
    const Vec3 out = (to - from).cross(ground.up_W).normalized();
    const double beyond = out.dot(p - from) - 0.5 * kFlush, slope = out.dot(along);
    if (std::abs(slope) < 1e-9) {
      if (beyond > 0.0) return none;
    } else if (slope > 0.0) {
      in.high = std::min(in.high, -beyond / slope);
    } else {
      in.low = std::max(in.low, -beyond / slope);
    }
  }
  for (const double t : {in.low, in.high}) {
    if (std::abs(ground.up_W.dot(p + t * along) - ground.height) > kFlush) return none;
  }
  return in;
}

/// Joins what overlaps or nearly touches.
std::vector<Interval> joined(std::vector<Interval> parts) {
  std::ranges::sort(parts, {}, &Interval::low);
  std::vector<Interval> out;
  for (const Interval& part : parts) {
    if (!out.empty() && part.low <= out.back().high + kFlush) {
      out.back().high = std::max(out.back().high, part.high);
    } else {
      out.push_back(part);
    }
  }
  return out;
}

/// Adds the seams of a tile's face with the grounds in whose planes it lies.
void add_seams(const Tile& tile, const Ground& face, const std::vector<const Ground*>& others,
               std::vector<Seam>& seams) {
  for (std::size_t i = 0; i < face.corners_W.size(); ++i) {
    const Vec3& from = face.corners_W[i];
    const Vec3 edge = face.corners_W[(i + 1) % face.corners_W.size()] - from;
    const double length = edge.norm();
    const Vec3 along = edge / length, out = along.cross(face.up_W);
    std::vector<Interval> over;
    for (const Ground* other : others) {
      const Interval part = part_over(*other, from + kFlush * out, along, length);
      if (part.high > part.low) over.push_back(part);
    }
    for (const Interval& part : joined(std::move(over))) {
      seams.push_back({tile.body, tile.part, face.up_W, face.height, out, out.dot(from), along,
                       along.dot(from) + part.low, along.dot(from) + part.high});
    }
  }
}

struct Fixed {
  std::vector<Tile> tiles;
  std::vector<Capsule> bounds_W;  // of the tiles
  std::vector<Box> boxes_W;
  std::vector<Ground> planes;  // half-spaces
};

Fixed fixed_parts(const World& world) {
  Fixed fixed;
  for (BodyId i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (body.kind != Kind::fixed) continue;
    for (std::uint32_t k = 0; k < body.shape->parts.size(); ++k) {
      const Part& part = body.shape->parts[k];
      const Pose X_WG = world.states[i].X_WB * part.X_BG;
      if (std::holds_alternative<HalfSpace>(part.shape)) {
        const Vec3 up = z_axis(X_WG.q);
        fixed.planes.push_back({up, up.dot(X_WG.p), {}});
      } else if (const auto* shape = std::get_if<Polyhedron>(&part.shape)) {
        Box box{X_WG.p, X_WG.p};
        for (const Vec3& v : shape->vertices()) {
          box.low = box.low.cwiseMin(X_WG * v);
          box.high = box.high.cwiseMax(X_WG * v);
        }
        fixed.tiles.push_back({i, k, shape, X_WG});
        fixed.bounds_W.push_back({X_WG.p, X_WG.p, bounding_radius(part.shape)});
        fixed.boxes_W.push_back(
            {box.low - Vec3::Constant(kFlush), box.high + Vec3::Constant(kFlush)});
      }
    }
  }
  return fixed;
}

/// By tile, the tiles that it may touch.
std::vector<std::vector<std::uint32_t>> neighbours_of(const Fixed& fixed) {
  std::vector<std::vector<std::uint32_t>> neighbours(fixed.tiles.size());
  BroadPhase broad_phase;
  for (const Pair& pair : broad_phase.find_pairs(fixed.bounds_W, {}, kFlush, fixed.boxes_W)) {
    neighbours[pair.first].push_back(pair.second);
    neighbours[pair.second].push_back(pair.first);
  }
  return neighbours;
}

std::vector<Seam> find_seams(const World& world) {
  const Fixed fixed = fixed_parts(world);
  std::vector<Seam> seams;
  if (fixed.tiles.size() + fixed.planes.size() < 2) return seams;
  std::vector<std::vector<Ground>> faces(fixed.tiles.size());
  for (std::size_t t = 0; t < fixed.tiles.size(); ++t) {
    for (const Polyhedron::Face& face : fixed.tiles[t].shape->faces()) {
      faces[t].push_back(ground_of(fixed.tiles[t], face));
    }
  }
  const std::vector<std::vector<std::uint32_t>> neighbours = neighbours_of(fixed);
  for (std::size_t t = 0; t < fixed.tiles.size(); ++t) {
    for (const Ground& face : faces[t]) {
      std::vector<const Ground*> others;
      const auto add = [&](const Ground& other) {
        if (is_parallel(face.up_W, other.up_W)) others.push_back(&other);
      };
      for (const Ground& plane : fixed.planes) add(plane);
      for (const std::uint32_t n : neighbours[t]) {
        for (const Ground& other : faces[n]) add(other);
      }
      add_seams(fixed.tiles[t], face, others, seams);
    }
  }
  return seams;  // by body and part, as the tiles are
}

bool comes_before(const Seam& seam, const std::pair<BodyId, std::uint32_t>& of) {
  return std::pair(seam.body, seam.part) < of;
}

/// Whether a surface point of a fixed part lies at the seam, with a normal that leans over it.
bool leans_over(const Seam& seam, const Vec3& p_W, const Vec3& n_W) {
  if (n_W.dot(seam.out_W) < kLean) return false;
  const double along = seam.along_W.dot(p_W);
  return along > seam.from - kBeside && along < seam.to + kBeside &&
         seam.out_W.dot(p_W) > seam.side - kBeside && seam.up_W.dot(p_W) > seam.height - kDeep;
}

/// The seam of a part at which a point lies; null if there is none.
///
/// @param p_W, n_W  on the surface of the part, and its normal, outward
const Seam* seam_at(const std::vector<Seam>& seams, BodyId body, std::uint32_t part,
                    const Vec3& p_W, const Vec3& n_W) {
  const std::pair of{body, part};
  for (auto seam = std::lower_bound(seams.begin(), seams.end(), of, comes_before);
       seam != seams.end() && std::pair(seam->body, seam->part) == of; ++seam) {
    if (leans_over(*seam, p_W, n_W)) return &*seam;
  }
  return nullptr;
}

/// The point of a part that is lowest over a seam's face.
Vec3 lowest_point(const Part& part, const Pose& X_WB, const Seam& seam) {
  const Pose X_WG = X_WB * part.X_BG;
  return X_WG * support(part.shape, X_WG.q.conjugate() * -seam.up_W);
}

}  // namespace

void know_seams(World& world) {
  if (world.seams.made) return;
  world.seams.all.clear();
  if (joins_faces(world.parameters)) world.seams.all = find_seams(world);
  world.seams.made = true;
}

void mend_at_seams(const World& world, const Placed& a, const Placed& b, std::size_t first,
                   std::vector<ContactPoint>& points) {
  const Compound &of_a = *world.bodies[a.body].shape, &of_b = *world.bodies[b.body].shape;
  const bool a_fixed = world.bodies[a.body].kind == Kind::fixed;
  const Placed &fixed = a_fixed ? a : b, &other = a_fixed ? b : a;
  if (world.bodies[fixed.body].kind != Kind::fixed ||
      of_a.parts.size() * of_b.parts.size() > kMostPairs) {
    return;
  }
  const double sign = a_fixed ? 1.0 : -1.0;
  const auto is_left_out = [&](ContactPoint& p) {
    if (p.depth < -kNear) return false;
    const std::size_t pair = p.feature >> 16;
    const std::size_t i = pair / of_b.parts.size(), j = pair % of_b.parts.size();
    const Vec3 n_W = sign * p.n_AB_W;
    const Seam* seam =
        seam_at(world.seams.all, fixed.body, static_cast<std::uint32_t>(a_fixed ? i : j),
                p.p_W + 0.5 * p.depth * n_W, n_W);
    if (seam == nullptr) return false;
    const Vec3 lowest = lowest_point(a_fixed ? of_b.parts[j] : of_a.parts[i], other.X_WB, *seam);
    const double depth = seam->height - seam->up_W.dot(lowest);
    if (depth > kDeep) return false;                        // it hangs down beside the part
    if (seam->out_W.dot(lowest) > seam->side) return true;  // it is over the next part
    p.depth = depth;
    p.p_W = lowest + 0.5 * p.depth * seam->up_W;
    p.n_AB_W = sign * seam->up_W;
    return false;
  };
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
  points.erase(std::remove_if(begin, points.end(), is_left_out), points.end());
}

}  // namespace headpin::engine::detail
