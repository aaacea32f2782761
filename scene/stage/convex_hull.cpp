#include "scene/stage/convex_hull.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <libqhull_r/qhull_ra.h>

namespace headpin::scene {

namespace {

/// A run of Qhull. Its own messages go nowhere: the caller says what is wrong, in words of the mesh.
struct Qhull {
  Qhull() : nowhere(std::fopen("/dev/null", "w")) { qh_zero(&state, nowhere); }
  ~Qhull() {
    qh_freeqhull(&state, qh_ALL);
    int pieces = 0, bytes = 0;
    qh_memfreeshort(&state, &pieces, &bytes);
    if (nowhere != nullptr) std::fclose(nowhere);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  std::FILE* nowhere;
  qhT state{};
};

/// The corners of a facet, counterclockwise from outside.
std::vector<std::uint32_t> corners_of(qhT* qh, facetT* facet, const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> corners;
  setT* vertices = qh_facet3vertex(qh, facet);
  vertexT *vertex = nullptr, **vertexp = nullptr;
  FOREACHvertex_(vertices) {
    corners.push_back(static_cast<std::uint32_t>(qh_pointid(qh, vertex->point)));
  }
  qh_settempfree(qh, &vertices);
  Vec3 area = Vec3::Zero();
  const Vec3& first = points[corners.at(0)];
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    area += (points[corners[k]] - first).cross(points[corners[k + 1]] - first);
  }
  if (area.dot(Vec3(facet->normal[0], facet->normal[1], facet->normal[2])) < 0.0) {
    std::reverse(corners.begin(), corners.end());
  }
  return corners;
}

/// The hull, of the points that it needs.
engine::Polyhedron hull_by_qhull(const std::vector<Vec3>& points, std::string command) {
  std::vector<coordT> numbers;
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  Qhull qhull;
  qhT* const qh = &qhull.state;
  const int failed = qh_new_qhull(qh, 3, static_cast<int>(points.size()), numbers.data(), False,
                                  command.data(), nullptr, qhull.nowhere);
  if (failed != 0) throw std::invalid_argument("convex hull: its points have no volume");
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> number(points.size(), kNone);
  std::vector<Vec3> needed;
  std::vector<std::vector<std::uint32_t>> faces;
  facetT* facet = nullptr;
  FORALLfacet_(qh->facet_list) {
    std::vector<std::uint32_t>& face = faces.emplace_back(corners_of(qh, facet, points));
    for (std::uint32_t& corner : face) {
      if (number[corner] == kNone) {
        number[corner] = static_cast<std::uint32_t>(needed.size());
        needed.push_back(points[corner]);
      }
      corner = number[corner];
    }
  }
  return engine::Polyhedron(std::move(needed), faces);
}

}  // namespace

std::vector<std::uint32_t> weld(const std::vector<Vec3>& corners, double apart,
                                std::vector<Vec3>& distinct) {
  std::vector<std::uint32_t> by_x(corners.size());
  for (std::uint32_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t i, std::uint32_t j) {
    return corners[i].x() != corners[j].x() ? corners[i].x() < corners[j].x() : i < j;
  });
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> index(corners.size(), kNone);
  for (std::size_t k = 0; k < by_x.size(); ++k) {
    const std::uint32_t i = by_x[k];
    if (index[i] != kNone) continue;
    index[i] = static_cast<std::uint32_t>(distinct.size());
    distinct.push_back(corners[i]);
    for (std::size_t m = k + 1; m < by_x.size(); ++m) {
      const std::uint32_t j = by_x[m];
      if (corners[j].x() - corners[i].x() > apart) break;
      if (index[j] == kNone && (corners[j] - corners[i]).norm() <= apart) index[j] = index[i];
    }
  }
  return index;
}

engine::Polyhedron convex_hull(const std::vector<Vec3>& points) {
  if (points.empty()) throw std::invalid_argument("convex hull: of no points");
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double size = (high - low).norm();
  std::vector<Vec3> distinct;
  weld(points, kWelded * size, distinct);
  try {  // triangles within a quarter of what engine::Polyhedron calls flat become one face
    return hull_by_qhull(
        distinct, fmt::format("qhull C-{:.17g}", 0.25 * engine::Polyhedron::kTolerance * size));
  } catch (const std::invalid_argument&) {  // or triangles alone: all of them are flat
    return hull_by_qhull(distinct, "qhull Qt");
  }
}

}  // namespace headpin::scene
