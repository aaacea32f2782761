#include "scene/stage/merged_pieces.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "scene/stage/convex_hull.h"
#include "scene/stage/overlap.h"

namespace headpin::scene {

namespace {

constexpr std::size_t kFew = 64;       // pieces that are measured by hulls, not by boxes
constexpr std::size_t kCoarse = 1000;  // lines that measure an overlap

/// Pieces that become one.
struct Group {
  const engine::Polyhedron* alone = nullptr;  // while it is one piece
  std::vector<Vec3> points;                   // whose hull it is
  Bounds box;
  Surface coarse;        // hull of its outermost points
  double volume = 0.0;   // of that hull
  std::size_t best = 0;  // the later group with which it adds least
  double adds = 0.0;     // with that one
};

/// The outermost points in the directions of a cube's faces, edges and corners.
std::vector<Vec3> outermost(const std::vector<Vec3>& points) {
  std::vector<Vec3> some;
  for (int direction = 0; direction < 27; ++direction) {
    const Vec3 n(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
    if (n.isZero()) continue;
    some.push_back(
        *std::max_element(points.begin(), points.end(),
                          [&](const Vec3& a, const Vec3& b) { return n.dot(a) < n.dot(b); }));
  }
  return some;
}

/// The hull of points; without triangles where they have no volume.
Surface hull_surface(const std::vector<Vec3>& points) {
  try {
    return surface_of(convex_hull(points));
  } catch (const std::invalid_argument&) {
    return {};
  }
}

double volume_or_none(const Surface& surface) {
  return surface.triangles.empty() ? 0.0 : volume_of(surface);
}

Bounds around(const Bounds& a, const Bounds& b) {
  return {.low = a.low.cwiseMin(b.low), .high = a.high.cwiseMax(b.high)};
}

Bounds in_both(const Bounds& a, const Bounds& b) {
  return {.low = a.low.cwiseMax(b.low), .high = a.high.cwiseMin(b.high)};
}

double volume_of_box(const Bounds& box) {
  return (box.high - box.low).cwiseMax(0.0).prod();
}

double added_by_boxes(const Group& a, const Group& b) {
  return volume_of_box(around(a.box, b.box)) - volume_of_box(a.box) - volume_of_box(b.box) +
         volume_of_box(in_both(a.box, b.box));
}

double added_by_hulls(const Group& a, const Group& b) {
  std::vector<Vec3> points = a.coarse.points;
  points.insert(points.end(), b.coarse.points.begin(), b.coarse.points.end());
  double added = volume_or_none(hull_surface(points)) - a.volume - b.volume;
  if (volume_of_box(in_both(a.box, b.box)) > 0.0) {
    Surface both = a.coarse;
    append(both, b.coarse);
    added += overlap_of(both, in_both(a.box, b.box), kCoarse);
  }
  return added;
}

void measure_hull(Group& group) {
  group.coarse = hull_surface(outermost(group.points));
  group.volume = volume_or_none(group.coarse);
}

/// Merges until there are `most`.
template <typename Added, typename Measure>
void merge(std::vector<Group>& groups, std::size_t most, const Added& added,
           const Measure& measured) {
  const auto find_best = [&](std::size_t i) {
    groups[i].adds = std::numeric_limits<double>::infinity();
    groups[i].best = i + 1;
    for (std::size_t j = i + 1; j < groups.size(); ++j) {
      const double adds = added(groups[i], groups[j]);
      if (adds < groups[i].adds) std::tie(groups[i].adds, groups[i].best) = std::pair{adds, j};
    }
  };
  if (groups.size() <= most) return;
  for (Group& group : groups) measured(group);
  for (std::size_t i = 0; i < groups.size(); ++i) find_best(i);
  while (groups.size() > most) {
    const auto one =
        std::min_element(groups.begin(), groups.end() - 1,
                         [](const Group& a, const Group& b) { return a.adds < b.adds; });
    const auto at = static_cast<std::size_t>(one - groups.begin()), other = one->best;
    one->points.insert(one->points.end(), groups[other].points.begin(), groups[other].points.end());
    one->alone = nullptr;
    one->box = around(one->box, groups[other].box);
    measured(*one);
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(other));
    for (std::size_t i = 0; i < groups.size(); ++i) {
      std::size_t& best = groups[i].best;
      if (i == at || best == at || best == other) {
        find_best(i);
        continue;
      }
      if (best > other) --best;
      if (i > at) continue;
      const double adds = added(groups[i], groups[at]);
      if (adds < groups[i].adds) std::tie(groups[i].adds, best) = std::pair{adds, at};
    }
  }
}

}  // namespace

std::vector<engine::Polyhedron> merged_pieces(const std::vector<engine::Polyhedron>& pieces,
                                              std::size_t most) {
  std::vector<Group> groups;
  for (const engine::Polyhedron& piece : pieces) {
    Group& group = groups.emplace_back();
    group.alone = &piece;
    group.points.assign(piece.vertices().begin(), piece.vertices().end());
    group.box = bounds_of({.points = group.points, .triangles = {}});
  }
  merge(groups, std::max(most, kFew), added_by_boxes, [](Group&) {});
  merge(groups, most, added_by_hulls, measure_hull);
  std::vector<engine::Polyhedron> merged;
  for (const Group& group : groups) {
    merged.push_back(group.alone != nullptr ? *group.alone : convex_hull(group.points));
  }
  return merged;
}

}  // namespace headpin::scene
