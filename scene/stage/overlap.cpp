#include "scene/stage/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace headpin::scene {

namespace {

/// Where a vertical line goes through a surface: the height [m], and 1 where it goes in, -1 where out.
using Passage = std::pair<double, int>;

/// Twice the area of p and an edge, by the same sums for either of its directions, so that a line passes
/// between the triangles of no edge, and through no edge twice.
double beside_edge(const Vec3& from, const Vec3& to, const Vec2& p) {
  const bool forward = from.x() != to.x() ? from.x() < to.x() : from.y() < to.y();
  const Vec3 &a = forward ? from : to, &b = forward ? to : from;
  const double area = (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
  return forward ? area : -area;
}

std::optional<Passage> passage_through(const std::array<Vec3, 3>& t, const Vec2& p) {
  const double c = beside_edge(t[0], t[1], p), a = beside_edge(t[1], t[2], p),
               b = beside_edge(t[2], t[0], p);
  const bool up = a > 0.0 && b > 0.0 && c > 0.0, down = a < 0.0 && b < 0.0 && c < 0.0;
  if (!up && !down) return std::nullopt;
  return Passage{(a * t[0].z() + b * t[1].z() + c * t[2].z()) / (a + b + c), up ? -1 : 1};
}

/// The length of a line in the body, times how often it is counted there, less once [m].
double counted_again(std::vector<Passage>& passages) {
  std::sort(passages.begin(), passages.end());
  double length = 0.0;
  int inside = 0;
  for (std::size_t i = 0; i < passages.size(); ++i) {
    if (i > 0) {
      length += (inside - (inside > 0 ? 1 : 0)) * (passages[i].first - passages[i - 1].first);
    }
    inside += passages[i].second;
  }
  return inside == 0 ? length : 0.0;  // otherwise it met an edge
}

struct FromLeft {
  std::array<Vec3, 3> corners;
  double low = 0.0, high = 0.0;                // along x
  double low_across = 0.0, high_across = 0.0;  // along y
};

std::vector<FromLeft> from_left(const Surface& surface) {
  std::vector<FromLeft> triangles;
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 &a = surface.points[i], &b = surface.points[j], &c = surface.points[k];
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    triangles.push_back({{a, b, c}, low.x(), high.x(), low.y(), high.y()});
  }
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const FromLeft& a, const FromLeft& b) { return a.low < b.low; });
  return triangles;
}

}  // namespace

Surface surface_of(const engine::Polyhedron& polyhedron) {
  Surface surface;
  surface.points.assign(polyhedron.vertices().begin(), polyhedron.vertices().end());
  for (const engine::Polyhedron::Face& face : polyhedron.faces()) {
    const auto c = polyhedron.corners(face);
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      surface.triangles.push_back({c[0], c[k], c[k + 1]});
    }
  }
  return surface;
}

void append(Surface& to, const Surface& from) {
  const auto first = static_cast<std::uint32_t>(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  for (const auto& [a, b, c] : from.triangles) {
    to.triangles.push_back({a + first, b + first, c + first});
  }
}

Bounds bounds_of(const Surface& surface) {
  Bounds box{.low = surface.points.at(0), .high = surface.points[0]};
  for (const Vec3& p : surface.points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

std::size_t columns_for(const Surface& surface) {
  constexpr std::size_t kLeast = 1000, kMost = 30'000, kTogether = 60'000'000;
  return std::clamp(kTogether / (surface.triangles.size() + 1), kLeast, kMost);
}

double overlap_of(const Surface& closed, const Bounds& box, std::size_t columns) {
  const std::vector<FromLeft> triangles = from_left(closed);
  const Vec3 size = box.high - box.low;
  auto next = triangles.begin();
  std::vector<const FromLeft*> here;  // that lines at this x may meet
  std::vector<Passage> passages;
  double length = 0.0;
  for (std::size_t i = 0; i < columns; ++i) {
    // Shares of the golden ratio are spread more evenly than a grid, whose rows lie along the edges of boxes.
    const double row = static_cast<double>(i) + 0.5, share = row / std::numbers::phi;
    const Vec2 p(box.low.x() + row / static_cast<double>(columns) * size.x(),
                 box.low.y() + (share - std::floor(share)) * size.y());
    for (; next != triangles.end() && next->low <= p.x(); ++next) here.push_back(&*next);
    std::erase_if(here, [&](const FromLeft* t) { return t->high < p.x(); });
    passages.clear();
    for (const FromLeft* t : here) {
      if (p.y() < t->low_across || p.y() > t->high_across) continue;
      if (const auto passage = passage_through(t->corners, p)) passages.push_back(*passage);
    }
    length += counted_again(passages);
  }
  return length * size.x() * size.y() / static_cast<double>(columns);
}

}  // namespace headpin::scene
