#include "tests/support/random_shapes.h"

#include <algorithm>
#include <array>
#include <set>

namespace headpin {

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double r2 = v.squaredNorm();
    if (r2 > 1e-4 && r2 <= 1.0) return v / std::sqrt(r2);
  }
}

Quat any_rotation(Random& random) {
  for (;;) {
    const Eigen::Vector4d v(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                            random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double r2 = v.squaredNorm();
    if (r2 > 1e-4 && r2 <= 1.0) return Quat(Eigen::Vector4d(v / std::sqrt(r2)));
  }
}

}  // namespace headpin

namespace headpin::engine::test {

Polyhedron random_hull(Random& random, int count) {
  // Braces: in order, whoever compiles it.
  const Vec3 radii{random.uniform(0.3, 0.6), random.uniform(0.3, 0.6), random.uniform(0.3, 0.6)};
  std::vector<Vec3> points;
  while (points.size() < static_cast<std::size_t>(count)) {
    const Vec3 p = radii.cwiseProduct(direction(random));
    const bool close = std::any_of(points.begin(), points.end(),
                                   [&](const Vec3& q) { return (p - q).norm() < 0.02; });
    if (!close) points.push_back(p);
  }
  // Grow a tetrahedron point by point: the faces a point sees are replaced by a fan to their rim.
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<Triangle> faces;
  const auto outside = [&](const Triangle& t, const Vec3& p) {
    const Vec3 n = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    return n.dot(p - points[t[0]]) > 0.0;
  };
  for (const Triangle& t : {Triangle{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}) {
    const std::uint32_t other = 6 - t[0] - t[1] - t[2];
    faces.push_back(outside(t, points[other]) ? Triangle{t[0], t[2], t[1]} : t);
  }
  for (std::uint32_t i = 4; i < points.size(); ++i) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> rim;
    std::vector<Triangle> kept;
    for (const Triangle& t : faces) {
      if (!outside(t, points[i])) {
        kept.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t u = t[k], v = t[(k + 1) % 3];
        if (rim.erase({v, u}) == 0) rim.insert({u, v});
      }
    }
    for (const auto& [u, v] : rim) kept.push_back({u, v, i});
    faces = std::move(kept);
  }
  std::vector<std::vector<std::uint32_t>> lists;
  for (const Triangle& t : faces) lists.push_back({t[0], t[1], t[2]});
  return Polyhedron(points, lists);
}

Polyhedron box(const Vec3& half) {
  std::vector<Vec3> v;
  for (int i = 0; i < 8; ++i) {
    v.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return Polyhedron(
      v, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

Shape random_shape(Random& random, ShapeKind kind) {
  const auto length = [&] { return random.uniform(0.3, 0.6); };
  switch (kind) {
    case ShapeKind::ellipsoid:
      return Ellipsoid{{length(), length(), length()}};
    case ShapeKind::cylinder:
      return Cylinder{length(), length()};
    case ShapeKind::cone:
      return Cone{length(), 2.0 * length()};
    case ShapeKind::hull:
      break;
  }
  return random_hull(random, 64);
}

namespace {

Polyhedron remade(const Polyhedron& p, const Vec3& factors) {
  std::vector<Vec3> vertices;
  for (const Vec3& v : p.vertices()) vertices.push_back(v.cwiseProduct(factors));
  std::vector<std::vector<std::uint32_t>> faces;
  for (const Polyhedron::Face& f : p.faces()) {
    const auto c = p.corners(f);
    faces.emplace_back(c.begin(), c.end());
    if (factors.prod() < 0.0) std::reverse(faces.back().begin(), faces.back().end());
  }
  return Polyhedron(std::move(vertices), faces);
}

}  // namespace

Vec3 special_normal(Random& random, const Shape& shape) {
  if (const auto* h = std::get_if<Polyhedron>(&shape)) {
    return h
        ->faces()[static_cast<std::size_t>(
            index_below(random, static_cast<int>(h->faces().size())))]
        .normal;
  }
  Vec3 level = direction(random);
  level.z() = 0.0;
  level.normalize();
  if (const auto* c = std::get_if<Cone>(&shape); c && index_below(random, 2)) {
    const double slant = std::sqrt(c->radius * c->radius + c->height * c->height);
    return c->height / slant * level + c->radius / slant * Vec3::UnitZ();
  }
  if (index_below(random, 2)) return index_below(random, 2) ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
  return level;
}

Shape scaled(const Shape& shape, double k) {
  if (const auto* e = std::get_if<Ellipsoid>(&shape)) return Ellipsoid{k * e->radii};
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return Cylinder{k * c->radius, k * c->half_height};
  }
  if (const auto* c = std::get_if<Cone>(&shape)) return Cone{k * c->radius, k * c->height};
  if (const auto* p = std::get_if<Polyhedron>(&shape)) return remade(*p, Vec3::Constant(k));
  return shape;
}

Polyhedron stretched(const Polyhedron& shape, const Vec3& factors) {
  return remade(shape, factors);
}

Shape mirrored(const Shape& shape) {
  if (const auto* p = std::get_if<Polyhedron>(&shape)) return remade(*p, {-1.0, 1.0, 1.0});
  return shape;
}

}  // namespace headpin::engine::test
