#include "scene/stage/convex_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "scene/stage/convex_hull.h"
#include "scene/stage/merged_pieces.h"
#include "scene/stage/overlap.h"

namespace headpin::scene {

namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Directed = std::pair<std::uint32_t, std::uint32_t>;

[[noreturn]] void refuse_surface(const std::string& what) {
  throw std::invalid_argument("mesh: " + what);
}

/// Six times the volume of a tetrahedron, positive where a, b, c are counterclockwise from outside.
double six_volume(const Vec3& apex, const Vec3& a, const Vec3& b, const Vec3& c) {
  return (a - apex).dot((b - apex).cross(c - apex));
}

/// The triangle on the left of each directed edge. Refuses a surface that is not closed.
std::map<Directed, std::uint32_t> sides_of(const Surface& surface) {
  std::map<Directed, std::uint32_t> sides;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& corners = surface.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Directed edge{corners[k], corners[(k + 1) % 3]};
      if (sides.emplace(edge, t).second) continue;
      const Vec3 &a = surface.points[edge.first], &b = surface.points[edge.second];
      refuse_surface(fmt::format(
          "the edge from {:.4g}, {:.4g}, {:.4g} to {:.4g}, {:.4g}, {:.4g} m belongs to two "
          "triangles that are both on its left side; expected one on each side: two parts of the "
          "mesh share this edge, or a face is there twice or turned round",
          a.x(), a.y(), a.z(), b.x(), b.y(), b.z()));
    }
  }
  std::size_t alone = 0;
  Vec3 first = Vec3::Zero();
  for (const auto& [edge, triangle] : sides) {
    if (sides.contains({edge.second, edge.first})) continue;
    if (alone++ == 0) first = surface.points[edge.first];
  }
  if (alone > 0) {
    refuse_surface(
        fmt::format("not closed: {} edges belong to one triangle alone; the first is at {:.4g}, "
                    "{:.4g}, {:.4g} m",
                    alone, first.x(), first.y(), first.z()));
  }
  return sides;
}

/// The ends of edges at which the surface bends inwards.
std::vector<Vec3> bends_of(const Surface& surface, const std::map<Directed, std::uint32_t>& sides,
                           double slack) {
  std::vector<Vec3> bends;
  const auto point = [&](std::uint32_t i) -> const Vec3& { return surface.points[i]; };
  for (const auto& [edge, triangle] : sides) {
    const auto [i, j] = edge;
    if (i > j) continue;
    const Triangle& here = surface.triangles[triangle];
    const Vec3 n = (point(here[1]) - point(here[0])).cross(point(here[2]) - point(here[0]));
    for (const std::uint32_t k : surface.triangles[sides.at({j, i})]) {
      if (k == i || k == j || !(n.dot(point(k) - point(i)) > slack * n.norm())) continue;
      bends.insert(bends.end(), {point(i), point(j)});
    }
  }
  return bends;
}

/// Whether a point is inside a surface, by the solid angle of the surface seen from it (van Oosterom and
/// Strackee 1983): 4 pi from inside, 0 from outside.
bool is_inside(const Surface& surface, const Vec3& p) {
  double angle = 0.0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]] - p, b = surface.points[t[1]] - p,
               c = surface.points[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * std::numbers::pi;
}

/// The parts of a surface whose triangles share no edges: each is closed by itself.
std::vector<Surface> shells_of(const Surface& surface,
                               const std::map<Directed, std::uint32_t>& sides) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> shell_of(surface.triangles.size(), kNone), open;
  std::uint32_t count = 0;
  for (std::uint32_t first = 0; first < surface.triangles.size(); ++first) {
    if (shell_of[first] != kNone) continue;
    open = {first};
    shell_of[first] = count;
    while (!open.empty()) {
      const Triangle& corners = surface.triangles[open.back()];
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t beside = sides.at({corners[(k + 1) % 3], corners[k]});
        if (shell_of[beside] != kNone) continue;
        shell_of[beside] = count;
        open.push_back(beside);
      }
    }
    ++count;
  }
  if (count == 1) return {surface};
  std::vector<Surface> shells(count);
  std::vector<std::map<std::uint32_t, std::uint32_t>> number(count);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Surface& shell = shells[shell_of[t]];
    Triangle& corners = shell.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t point = surface.triangles[t][k];
      const auto [known, is_new] =
          number[shell_of[t]].try_emplace(point, static_cast<std::uint32_t>(shell.points.size()));
      if (is_new) shell.points.push_back(surface.points[point]);
      corners[k] = known->second;
    }
  }
  return shells;
}

/// The bodies that a surface encloses: its shells, each with the shells of the holes in it. Those without
/// volume are none.
std::vector<Surface> bodies_of(const Surface& surface,
                               const std::map<Directed, std::uint32_t>& sides, double nothing) {
  std::vector<Surface> shells = shells_of(surface, sides);
  if (shells.size() == 1) return shells;
  std::vector<Surface> bodies, holes;
  for (Surface& shell : shells) {
    const double volume = volume_of(shell);
    if (std::abs(volume) <= nothing) continue;
    (volume > 0.0 ? bodies : holes).push_back(std::move(shell));
  }
  const std::vector<Surface> whole = bodies;
  for (const Surface& hole : holes) {
    std::optional<std::size_t> around;  // the smallest
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (!is_inside(whole[i], hole.points[0])) continue;
      if (!around || volume_of(whole[i]) < volume_of(whole[*around])) around = i;
    }
    if (!around) {
      const Vec3& p = hole.points[0];
      refuse_surface(
          fmt::format("a part of it is turned inside out, at {:.4g}, {:.4g}, {:.4g} m: its "
                      "faces are clockwise from outside; flip its normals",
                      p.x(), p.y(), p.z()));
    }
    append(bodies[*around], hole);
  }
  for (const Surface& body : bodies) {
    if (volume_of(body) > nothing) continue;
    const Vec3& p = body.points[0];
    refuse_surface(fmt::format(
        "holes take all of a part of it, at {:.4g}, {:.4g}, {:.4g} m; expected holes that do not overlap",
        p.x(), p.y(), p.z()));
  }
  return bodies;
}

/// Part of a convex polygon on one side of a plane across an axis.
/// @param keep  +1: what is below `at`; -1: what is above it
void clip(std::vector<Vec3>& polygon, std::vector<Vec3>& buffer, int axis, double at, double keep) {
  buffer.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = keep * (at - a[axis]), to = keep * (at - b[axis]);
    if (from >= 0.0) buffer.push_back(a);
    if ((from < 0.0) == (to < 0.0) || from == 0.0 || to == 0.0) continue;
    Vec3 cut = a + from / (from - to) * (b - a);
    cut[axis] = at;
    buffer.push_back(cut);
  }
  polygon.swap(buffer);
}

/// The surface, with the buffers of its clipping.
class Clipper {
 public:
  explicit Clipper(const Surface& surface) : surface_(surface) {
    low_ = high_ = surface.points.at(0);
    for (const Vec3& p : surface.points) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
  }
  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }

  /// The enclosed volume in a box [m^3], from those of the octants below the box's corners.
  double volume_in(const Vec3& low, const Vec3& high) {
    double volume = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 at;
      double sign = 1.0;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (corner >> axis & 1) != 0;
        at[axis] = upper ? high[axis] : low[axis];
        if (!upper) sign = -sign;
      }
      volume += sign * volume_below(at);
    }
    return volume;
  }

  /// Points whose hull is that of the body in a box: the surface in it, and its corners inside the
  /// body.
  std::vector<Vec3> points_in(const Vec3& low, const Vec3& high) {
    std::vector<Vec3> points;
    for (const Triangle& t : surface_.triangles) {
      if (is_beside(t, low, high)) continue;
      begin(t);
      for (int axis = 0; axis < 3; ++axis) {
        clip(polygon_, buffer_, axis, high[axis], 1.0);
        clip(polygon_, buffer_, axis, low[axis], -1.0);
      }
      if (!touches_only(low, high)) points.insert(points.end(), polygon_.begin(), polygon_.end());
    }
    constexpr double kJustInside = 1e-6;
    const Vec3 middle = 0.5 * (low + high);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 at;
      for (int axis = 0; axis < 3; ++axis)
        at[axis] = (corner >> axis & 1) != 0 ? high[axis] : low[axis];
      if (is_inside(surface_, at + kJustInside * (middle - at))) points.push_back(at);
    }
    return points;
  }

 private:
  void begin(const Triangle& t) {
    polygon_.assign({surface_.points[t[0]], surface_.points[t[1]], surface_.points[t[2]]});
  }

  /// Whether a triangle is on the outer side of one of a box's faces.
  bool is_beside(const Triangle& t, const Vec3& low, const Vec3& high) const {
    const Vec3 &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
    return (a.cwiseMin(b).cwiseMin(c).array() > high.array()).any() ||
           (a.cwiseMax(b).cwiseMax(c).array() < low.array()).any();
  }

  /// Whether the clipped polygon lies in a face of the box. It may then belong to the body beyond that
  /// face; what of the body is in the box has other triangles there.
  bool touches_only(const Vec3& low, const Vec3& high) const {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double at : {low[axis], high[axis]}) {
        const auto is_on = [&](const Vec3& p) { return p[axis] == at; };
        if (std::all_of(polygon_.begin(), polygon_.end(), is_on)) return true;
      }
    }
    return false;
  }

  /// The volume with all coordinates below those of a point. What closes the cut surface lies in planes
  /// through that point, so that tetrahedra with their apex there need no closing.
  double volume_below(const Vec3& at) {
    if ((at.array() <= low_.array()).any()) return 0.0;
    double six = 0.0;
    for (const Triangle& t : surface_.triangles) {
      begin(t);
      for (int axis = 0; axis < 3; ++axis) clip(polygon_, buffer_, axis, at[axis], 1.0);
      for (std::size_t k = 1; k + 1 < polygon_.size(); ++k) {
        six += six_volume(at, polygon_[0], polygon_[k], polygon_[k + 1]);
      }
    }
    return six / 6.0;
  }

  const Surface& surface_;
  Vec3 low_, high_;
  std::vector<Vec3> polygon_, buffer_;
};

/// A cell of the box, and the hull of what it contains.
struct Piece {
  Vec3 low, high;
  double volume = 0.0;                     // of the body in it
  std::optional<engine::Polyhedron> hull;  // none where the body has no volume in it
  double added = 0.0;                      // by the hull to the volume
  bool done = false;                       // no cut makes it better
  std::size_t body = 0;                    // that it is of
};

using Halves = std::pair<Piece, Piece>;

class Cutter {
 public:
  Cutter(Clipper clipper, std::vector<Vec3> bends, double volume)
      : clipper_(std::move(clipper)), bends_(std::move(bends)), volume_(volume) {}

  Piece whole() { return piece(clipper_.low(), clipper_.high()); }

  /// The two halves of a piece that add least; none where no cut makes them add less than the piece.
  /// Where one cut gains little, as through a ring, those are taken whose halves add least after
  /// another one.
  std::optional<Halves> cut(const Piece& piece) {
    constexpr double kLittle = 0.95;
    const auto itself = [](const Piece& half) { return half.added; };
    std::optional<Halves> best = best_cut(piece, 7, itself);
    if (best && best->first.added + best->second.added < kLittle * piece.added) return best;
    const auto after_another = [&](const Piece& half) {
      const std::optional<Halves> further = best_cut(half, 3, itself);
      return further ? further->first.added + further->second.added : half.added;
    };
    return best_cut(piece, 3, after_another);
  }

 private:
  Piece piece(const Vec3& low, const Vec3& high) {
    constexpr double kNothing = 1e-6;  // of the whole volume
    Piece one{.low = low, .high = high, .volume = clipper_.volume_in(low, high), .hull = {}};
    if (!(one.volume > kNothing * volume_)) return one;
    one.hull = convex_hull(clipper_.points_in(low, high));
    one.added = std::max(0.0, scene::volume_of(*one.hull) - one.volume);
    return one;
  }

  /// The cut of least cost, if that is less than the piece adds.
  /// @param most  planes across each axis
  template <typename Cost>
  std::optional<Halves> best_cut(const Piece& piece, std::size_t most, const Cost& cost) {
    constexpr double kNoise = 1e-9;
    std::optional<Halves> best;
    double least = (1.0 - kNoise) * piece.added;
    for (const int axis : {2, 1, 0}) {  // z first: skittles are turned about it
      for (const double at : planes(piece, axis, most)) {
        Halves halves = cut_at(piece, axis, at);
        const double costs = cost(halves.first) + cost(halves.second);
        if (!(costs < least)) continue;
        least = costs;
        best = std::move(halves);
      }
    }
    return best;
  }

  Halves cut_at(const Piece& from, int axis, double at) {
    Vec3 middle_low = from.low, middle_high = from.high;
    middle_low[axis] = middle_high[axis] = at;
    return {piece(from.low, middle_high), piece(middle_low, from.high)};
  }

  /// Where planes across an axis may cut a piece: at the bends in it, `most` of them, evenly chosen.
  std::vector<double> planes(const Piece& piece, int axis, std::size_t most) const {
    const double margin = 1e-3 * (clipper_.high() - clipper_.low()).norm();
    std::vector<double> all;
    for (const Vec3& p : bends_) {
      const bool inside =
          (p.array() >= piece.low.array()).all() && (p.array() <= piece.high.array()).all();
      const bool between =
          p[axis] > piece.low[axis] + margin && p[axis] < piece.high[axis] - margin;
      if (inside && between) all.push_back(p[axis]);
    }
    std::sort(all.begin(), all.end());
    const auto same = [&](double a, double b) { return b - a < margin; };
    all.erase(std::unique(all.begin(), all.end(), same), all.end());
    if (all.size() <= most) return all;
    std::vector<double> some;
    for (std::size_t k = 0; k < most; ++k)
      some.push_back(all[(2 * k + 1) * all.size() / (2 * most)]);
    return some;
  }

  Clipper clipper_;
  std::vector<Vec3> bends_;
  double volume_;
};

/// Cuts bodies until their hulls add at most `least` [m^3], no cut makes them add less, or there are `most`
/// pieces. These are in the order of their lowest corners.
std::vector<Piece> pieces_of(const std::vector<Surface>& bodies, double slack, double least,
                             std::size_t most) {
  std::vector<Cutter> cutters;
  std::vector<Piece> pieces;
  for (const Surface& body : bodies) {
    cutters.emplace_back(Clipper(body), bends_of(body, sides_of(body), slack), volume_of(body));
    pieces.push_back(cutters.back().whole());
    pieces.back().body = cutters.size() - 1;
  }
  const auto by_added = [](const Piece& a, const Piece& b) {
    return (a.done ? -1.0 : a.added) < (b.done ? -1.0 : b.added);
  };
  while (pieces.size() < most) {
    double all = 0.0;
    for (const Piece& piece : pieces) all += piece.added;
    Piece& worst = *std::max_element(pieces.begin(), pieces.end(), by_added);
    if (all <= least || worst.done) break;
    auto halves = cutters[worst.body].cut(worst);
    worst.done = !halves;
    if (!halves) continue;
    halves->first.body = halves->second.body = worst.body;
    worst = std::move(halves->first);
    pieces.push_back(std::move(halves->second));
    std::erase_if(pieces, [](const Piece& piece) { return !piece.hull; });
  }
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    return std::tie(a.low.z(), a.low.y(), a.low.x()) < std::tie(b.low.z(), b.low.y(), b.low.x());
  });
  return pieces;
}

}  // namespace

double volume_of(const Surface& surface) {
  double six = 0.0;
  for (const Triangle& t : surface.triangles) {
    six += six_volume(surface.points[0], surface.points[t[0]], surface.points[t[1]],
                      surface.points[t[2]]);
  }
  return six / 6.0;
}

double volume_of(const engine::Polyhedron& polyhedron) {
  double six = 0.0;
  const auto vertices = polyhedron.vertices();
  for (const engine::Polyhedron::Face& face : polyhedron.faces()) {
    const auto c = polyhedron.corners(face);
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      six += six_volume(vertices[0], vertices[c[0]], vertices[c[k]], vertices[c[k + 1]]);
    }
  }
  return six / 6.0;
}

std::vector<engine::Polyhedron> convex_pieces(const Surface& surface, std::size_t most,
                                              double added) {
  constexpr double kNoOverlap = 1e-6;  // of the volume: of shells that only touch
  if (surface.triangles.empty()) refuse_surface("no triangles");
  const std::map<Directed, std::uint32_t> sides = sides_of(surface);
  const Bounds box = bounds_of(surface);
  const double size = (box.high - box.low).norm();
  double volume = volume_of(surface);
  if (volume < 0.0)
    refuse_surface("turned inside out: its faces are clockwise from outside; flip its normals");
  if (!(volume > 1e-9 * size * size * size)) refuse_surface("has no volume");
  std::vector<Surface> bodies = bodies_of(surface, sides, 1e-9 * size * size * size);
  if (bodies.empty() || most == 1) bodies = {surface};
  if (bodies.size() > 1) {
    const double twice = overlap_of(surface, box, columns_for(surface));
    if (twice > kNoOverlap * volume) volume -= twice;
  }
  // Of more bodies than pieces, a bent one is cut before those are merged that lose least by it.
  const bool too_many = bodies.size() > most;
  std::vector<Piece> pieces = pieces_of(bodies, engine::Polyhedron::kTolerance * size,
                                        added * volume, too_many ? bodies.size() + most : most);
  std::vector<engine::Polyhedron> hulls;
  for (Piece& piece : pieces) hulls.push_back(std::move(*piece.hull));
  return too_many ? merged_pieces(hulls, most) : hulls;
}

}  // namespace headpin::scene
