#include "render/data/mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numbers>

namespace headpin::render {

namespace {

std::uint32_t size_of(const Mesh& mesh) {
  return static_cast<std::uint32_t>(mesh.vertices.size());
}

void append_triangles(Mesh& mesh, std::initializer_list<std::uint32_t> corners) {
  mesh.indices.insert(mesh.indices.end(), corners);
}

}  // namespace

Vec3 srgb(std::uint32_t rgb) {
  const auto code = [&](int shift) { return static_cast<double>(rgb >> shift & 0xff) / 255.0; };
  return light_of({code(16), code(8), code(0)});
}

Vec3 light_of(const Vec3& code) {
  return code.unaryExpr(
      [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); });
}

Vec3 srgb_of(const Vec3& light) {
  return light.unaryExpr(
      [](double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; });
}

void append(Mesh& mesh, const Mesh& part, const Pose& X_GP) {
  const std::uint32_t first = size_of(mesh);
  for (const Vertex& v : part.vertices) {
    const Vec3 p = X_GP * v.p.cast<double>();
    const Vec3 n = X_GP.q * v.n.cast<double>();
    mesh.vertices.push_back({p.cast<float>(), n.cast<float>(), v.colour});
  }
  for (const std::uint32_t i : part.indices) mesh.indices.push_back(first + i);
}

double reach_of(const Mesh& mesh) {
  double reach = 0.0;
  for (const Vertex& vertex : mesh.vertices) {
    reach = std::max(reach, vertex.p.cast<double>().norm());
  }
  return reach;
}

void append_face(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                 const Vec3& colour) {
  const std::uint32_t i = size_of(mesh);
  const Vec3 n = (c - a).cross(d - b).normalized();
  for (const Vec3& p : {a, b, c, d}) {
    mesh.vertices.push_back({p.cast<float>(), n.cast<float>(), colour.cast<float>()});
  }
  append_triangles(mesh, {i, i + 1, i + 2, i, i + 2, i + 3});
}

Mesh box(const Vec3& size, const Vec3& colour) {
  Mesh mesh;
  const Vec3 h = 0.5 * size;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 n = Vec3::Zero(), u = Vec3::Zero(), v = Vec3::Zero();
      n[axis] = side * h[axis];
      u[(axis + 1) % 3] = side * h[(axis + 1) % 3];
      v[(axis + 2) % 3] = h[(axis + 2) % 3];
      append_face(mesh, n - u - v, n + u - v, n + u + v, n - u + v, colour);
    }
  }
  return mesh;
}

Mesh turned(std::span<const Ring> rings, int sides) {
  assert(sides >= 3);
  Mesh mesh;
  const auto around = static_cast<std::uint32_t>(sides);
  for (const Ring& ring : rings) {
    const Vec2 n = ring.n.normalized();
    for (std::uint32_t i = 0; i <= around; ++i) {
      // The last column has the same bits as the first.
      const SinCos turn = sin_cos(2.0 * std::numbers::pi * (i % around) / sides);
      const Vec3 out(turn.cos, turn.sin, 0.0);
      mesh.vertices.push_back({Vec3(ring.r * out + ring.z * Vec3::UnitZ()).cast<float>(),
                               Vec3(n.x() * out + n.y() * Vec3::UnitZ()).cast<float>(),
                               ring.colour.cast<float>()});
    }
  }
  for (std::uint32_t k = 0; k + 1 < rings.size(); ++k) {
    const Ring& low = rings[k];
    const Ring& high = rings[k + 1];
    if (low.r == high.r && low.z == high.z) continue;  // an edge
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = k * (around + 1) + i, b = a + 1, c = b + around + 1, d = c - 1;
      if (low.r > 0.0) append_triangles(mesh, {a, b, c});
      if (high.r > 0.0) append_triangles(mesh, {a, c, d});
    }
  }
  return mesh;
}

Mesh ellipsoid(double a, double c, int sides, int rings,
               const std::function<Vec3(double z)>& colour) {
  std::vector<Ring> list;
  for (int i = 0; i <= rings; ++i) {
    const SinCos up = sin_cos(std::numbers::pi * (static_cast<double>(i) / rings - 0.5));
    const double r = i == 0 || i == rings ? 0.0 : a * up.cos;
    list.push_back({c * up.sin, r, {c * up.cos, a * up.sin}, colour(c * up.sin)});
  }
  return turned(list, sides);
}

namespace {

/// The surface where a field is 0, by surface nets: a vertex in each grid cell that it cuts, and a
/// face across each grid edge that it cuts.
class SurfaceNet {
 public:
  SurfaceNet(const std::function<double(const Vec3&)>& field, const Vec3& lo, const Vec3& hi,
             double cell)
      : field_(field), lo_(lo), cell_(cell) {
    for (int a = 0; a < 3; ++a) {
      n_[static_cast<std::size_t>(a)] = 2 + static_cast<int>((hi[a] - lo[a]) / cell);
    }
    values_.resize(index({0, 0, n_[2]}));
    vertex_in_.resize(values_.size());
    for_each(0, 0, [&](const Point& at) { values_[index(at)] = field_(place(at)); });
  }

  Mesh mesh(const Vec3& colour) {
    Mesh out;
    for_each(0, 1, [&](const Point& cell) { add_vertex(cell, colour, out); });
    for_each(1, 1, [&](const Point& at) {
      for (int axis = 0; axis < 3; ++axis) add_face(at, axis, out);
    });
    return out;
  }

 private:
  using Point = std::array<int, 3>;  ///< of the grid

  /// Calls f for the points from `first` along each axis, without the last `left_out`.
  template <typename F>
  void for_each(int first, int left_out, const F& f) const {
    for (int z = first; z + left_out < n_[2]; ++z) {
      for (int y = first; y + left_out < n_[1]; ++y) {
        for (int x = first; x + left_out < n_[0]; ++x) f(Point{x, y, z});
      }
    }
  }
  std::size_t index(const Point& at) const {
    return static_cast<std::size_t>((std::ptrdiff_t{at[2]} * n_[1] + at[1]) * n_[0] + at[0]);
  }
  Vec3 place(const Point& at) const { return Vec3(lo_ + cell_ * Vec3(at[0], at[1], at[2])); }
  static Point moved(Point at, int axis, int by) {
    at[static_cast<std::size_t>(axis % 3)] += by;
    return at;
  }
  bool inside(const Point& at) const { return values_[index(at)] < 0.0; }

  /// Adds a vertex at the mean of the points where the surface cuts the edges of a cell, if any.
  void add_vertex(const Point& cell, const Vec3& colour, Mesh& out) {
    Vec3 sum = Vec3::Zero();
    int crossings = 0;
    for (int edge = 0; edge < 12; ++edge) {  // from a corner along an axis
      const int axis = edge / 4;
      const Point corner = moved(moved(cell, axis + 1, edge & 1), axis + 2, edge >> 1 & 1);
      const double a = values_[index(corner)], b = values_[index(moved(corner, axis, 1))];
      if ((a < 0.0) == (b < 0.0)) continue;
      sum += place(corner) + a / (a - b) * cell_ * Vec3::Unit(axis);
      ++crossings;
    }
    if (crossings == 0) return;
    const Vec3 p = sum / crossings;
    Vec3 slope;
    for (int a = 0; a < 3; ++a) {
      const Vec3 step = 0.25 * cell_ * Vec3::Unit(a);
      slope[a] = field_(p + step) - field_(p - step);
    }
    vertex_in_[index(cell)] = size_of(out);
    out.vertices.push_back(
        {p.cast<float>(), slope.normalized().cast<float>(), colour.cast<float>()});
  }

  /// Joins the vertices of the four cells around an edge of the grid, if the surface cuts it.
  void add_face(const Point& at, int axis, Mesh& out) const {
    if (inside(at) == inside(moved(at, axis, 1))) return;
    const auto vertex = [&](int u, int v) {
      return vertex_in_[index(moved(moved(at, axis + 1, -u), axis + 2, -v))];
    };
    const std::uint32_t a = vertex(1, 1), b = vertex(0, 1), c = vertex(0, 0), d = vertex(1, 0);
    if (inside(at)) {
      append_triangles(out, {a, b, c, a, c, d});
    } else {
      append_triangles(out, {a, c, b, a, d, c});
    }
  }

  const std::function<double(const Vec3&)>& field_;
  Vec3 lo_;
  double cell_;
  std::array<int, 3> n_{};  ///< grid points along each axis
  std::vector<double> values_;
  std::vector<std::uint32_t> vertex_in_;  ///< of the cell that begins at a point
};

}  // namespace

Mesh surface_of(const std::function<double(const Vec3&)>& field, const Vec3& lo, const Vec3& hi,
                double cell, const Vec3& colour) {
  return SurfaceNet(field, lo, hi, cell).mesh(colour);
}

}  // namespace headpin::render
