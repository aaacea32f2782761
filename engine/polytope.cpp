#include "engine/polytope.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace headpin::engine {

Polytope::Polytope(Furthest furthest, void* pair, const Vec3& n, const Vec3& s)
    : furthest_(furthest), pair_(pair), n_(n) {
  // Where an edge of A crosses an edge of B, they form a face of A - B. Two directions about n give
  // opposite corners of it, and two directions across the line between those give the other
  // corners. The tilt is 7 degrees: on rims, planes through chords deviate by up to 0.7 times that,
  // which has a cosine over 0.99.
  constexpr double kTilt = 0.13;
  const Vec3 u = n.unitOrthogonal();
  points_[0] = s;
  points_[1] = furthest(pair, n + kTilt * u);
  points_[3] = furthest(pair, n - kTilt * u);
  const Vec3 v = n.cross(points_[1] - points_[3]);
  const double length = v.norm();
  const Vec3 tilt = length > 0.0 ? Vec3(kTilt / length * v) : Vec3(kTilt * n.cross(u));
  points_[2] = furthest(pair, n + tilt);
  points_[4] = furthest(pair, n - tilt);
  points_[5] = furthest(pair, -n);
  count_ = 6;
}

// Whether the octahedron of the first six points contains the ball. If the origin is behind all its
// triangles, they enclose it, convex or not. This test ends most searches.
bool Polytope::holds_ball(double radius) const {
  for (int k = 0; k < 4; ++k) {
    const Vec3 &p = points_[1 + k], &q = points_[1 + (k + 1) % 4];
    for (const Vec3& m : {Vec3((p - points_[0]).cross(q - points_[0])),
                          Vec3((q - points_[5]).cross(p - points_[5]))}) {
      const double offset = m.dot(p);
      if (!(offset > 0.0 && offset * offset >= radius * radius * m.squaredNorm())) return false;
    }
  }
  return true;
}

void Polytope::add_face(int i, int j, int k) {
  const Vec3& p = points_[i];
  const Vec3 m = (points_[j] - p).cross(points_[k] - p);
  const double area = m.norm();
  Face& f = faces_[face_count_++];
  f.corner[0] = static_cast<std::uint16_t>(i);
  f.corner[1] = static_cast<std::uint16_t>(j);
  f.corner[2] = static_cast<std::uint16_t>(k);
  f.normal = area > 0.0 ? Vec3(m / area) : Vec3::Zero();
  f.offset = area > 0.0 ? f.normal.dot(p) : std::numeric_limits<double>::infinity();
}

// Makes a tetrahedron of four of the points, as large as a greedy choice gives, and inserts the
// others.
void Polytope::start() {
  const auto choose = [&](int place, auto&& measure) {
    int best = place;
    for (int i = place; i < count_; ++i) {
      if (measure(points_[i]) > measure(points_[best])) best = i;
    }
    std::swap(points_[place], points_[best]);
    return measure(points_[place]);
  };
  double up = 0.0;
  face_count_ = 0;
  for (int attempt = 0;; ++attempt) {
    const Vec3 p = points_[0];
    const double length = choose(1, [&](const Vec3& x) { return (x - p).norm(); });
    const Vec3 e = points_[1] - p;
    const double area = choose(2, [&](const Vec3& x) { return e.cross(x - p).norm(); });
    const Vec3 m = e.cross(points_[2] - p);
    const double volume = choose(3, [&](const Vec3& x) { return std::abs(m.dot(x - p)); });
    up = m.dot(points_[3] - p);
    if (volume > 1e-3 * area * length || attempt == 2 || count_ + 4 > kPoints) break;
    // Many directions had the same support point. Directions across the points so far give others.
    const bool flat = area > 1e-3 * length * length;
    const Vec3 along = length > 0.0 ? Vec3(e / length) : n_, across = along.unitOrthogonal();
    for (const Vec3& n : {flat ? Vec3(m / area) : across, Vec3(along.cross(across))}) {
      points_[count_++] = furthest_(pair_, n);
      points_[count_++] = furthest_(pair_, -n);
    }
  }
  for (int i = 0; i < count_; ++i) rounding_ = std::max(rounding_, 1e-14 * points_[i].norm());
  const int j = up > 0.0 ? 2 : 1, k = up > 0.0 ? 1 : 2;
  add_face(0, j, k);
  add_face(0, k, 3);
  add_face(k, j, 3);
  add_face(j, 0, 3);
  // Two points at the same place would make triangles with meaningless normals.
  const double near = 10.0 * rounding_;
  int kept = 4;
  for (int i = 4; i < count_; ++i) {
    const Vec3 s = points_[i];
    const auto is_there = [&](const Vec3& p) { return (p - s).squaredNorm() <= near * near; };
    if (std::none_of(points_, points_ + kept, is_there)) points_[kept++] = s;
  }
  count_ = kept;
  for (int i = 4; i < count_ && insert(i);) ++i;
}

// Replaces the faces that are visible from the point by a fan from the point to their rim. A face
// whose plane contains the point counts as visible. Otherwise the point could be in line with an
// edge of the rim, and both together would form no face.
bool Polytope::insert(int point) {
  const Vec3& s = points_[point];
  Edge rim[3 * kFaces];
  int edges = 0, kept = 0;
  for (int k = 0; k < face_count_; ++k) {
    const Face& f = faces_[k];
    if (f.normal.dot(s - points_[f.corner[0]]) <= -rounding_) {
      faces_[kept++] = f;
      continue;
    }
    for (int c = 0; c < 3; ++c) {
      const std::uint16_t from = f.corner[c], to = f.corner[(c + 1) % 3];
      Edge* const back = std::find(rim, rim + edges, Edge{to, from});
      if (back != rim + edges) {
        *back = rim[--edges];
      } else {
        rim[edges++] = {from, to};
      }
    }
  }
  face_count_ = kept;
  if (kept == 0 || kept + edges > kFaces) return false;
  for (int k = 0; k < edges; ++k) add_face(rim[k].from, rim[k].to, point);
  return true;
}

bool Polytope::find_shorter(double depth, Vec3& n) {
  if (face_count_ == 0) {
    if (holds_ball(depth)) return false;
    start();
  }
  while (face_count_ > 0) {
    Face* nearest = faces_;
    for (int k = 1; k < face_count_; ++k) {
      if (faces_[k].offset < nearest->offset) nearest = faces_ + k;
    }
    if (nearest->offset >= depth) return false;
    const Vec3 s = furthest_(pair_, nearest->normal);
    const double h = nearest->normal.dot(s);
    if (h < depth) {
      n = nearest->normal;
      return true;
    }
    if (h - nearest->offset <= 10.0 * rounding_) {  // a part of the surface
      nearest->offset = std::numeric_limits<double>::infinity();
      continue;
    }
    if (count_ == kPoints) break;
    points_[count_] = s;
    if (!insert(count_++)) {  // rounding has broken it: start again, in another order
      if (made_anew_) break;
      made_anew_ = true;
      start();
    }
  }
  gave_up_ = true;
  const auto nearest =
      std::min_element(faces_, faces_ + face_count_,
                       [](const Face& f, const Face& g) { return f.offset < g.offset; });
  n = nearest != faces_ + face_count_ ? nearest->normal : n_;
  return false;
}

}  // namespace headpin::engine
