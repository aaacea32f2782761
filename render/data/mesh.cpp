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
      // The last column stands on the first, bit for bit.
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

Mesh surface_of(const std::function<double(const Vec3&)>& field, const Vec3& lo, const Vec3& hi,
                double cell, const Vec3& colour) {
  std::array<int, 3> n{};  // grid points along each axis
  for (int a = 0; a < 3; ++a)
    n[static_cast<std::size_t>(a)] = 2 + static_cast<int>((hi[a] - lo[a]) / cell);
  const auto index = [&](int x, int y, int z) {
    return static_cast<std::size_t>((std::ptrdiff_t{z} * n[1] + y) * n[0] + x);
  };
  const auto point = [&](int x, int y, int z) { return Vec3(lo + cell * Vec3(x, y, z)); };

  std::vector<double> value(index(0, 0, n[2]));
  for (int z = 0; z < n[2]; ++z) {
    for (int y = 0; y < n[1]; ++y) {
      for (int x = 0; x < n[0]; ++x) value[index(x, y, z)] = field(point(x, y, z));
    }
  }

  Mesh mesh;
  std::vector<std::uint32_t> vertex_in(value.size());
  const auto place_vertex = [&](int x, int y, int z) {
    Vec3 sum = Vec3::Zero();
    int crossings = 0;
    for (int edge = 0; edge < 12; ++edge) {  // from a corner along an axis
      const int axis = edge / 4;
      std::array<int, 3> corner{x, y, z};
      corner[static_cast<std::size_t>((axis + 1) % 3)] += edge & 1;
      corner[static_cast<std::size_t>((axis + 2) % 3)] += edge >> 1 & 1;
      std::array<int, 3> other = corner;
      ++other[static_cast<std::size_t>(axis)];
      const double a = value[index(corner[0], corner[1], corner[2])];
      const double b = value[index(other[0], other[1], other[2])];
      if ((a < 0.0) == (b < 0.0)) continue;
      sum += point(corner[0], corner[1], corner[2]) + a / (a - b) * cell * Vec3::Unit(axis);
      ++crossings;
    }
    if (crossings == 0) return;
    const Vec3 p = sum / crossings;
    Vec3 slope;
    for (int a = 0; a < 3; ++a) {
      const Vec3 step = 0.25 * cell * Vec3::Unit(a);
      slope[a] = field(p + step) - field(p - step);
    }
    vertex_in[index(x, y, z)] = size_of(mesh);
    mesh.vertices.push_back(
        {p.cast<float>(), slope.normalized().cast<float>(), colour.cast<float>()});
  };
  for (int z = 0; z + 1 < n[2]; ++z) {
    for (int y = 0; y + 1 < n[1]; ++y) {
      for (int x = 0; x + 1 < n[0]; ++x) place_vertex(x, y, z);
    }
  }

  // A face across every grid edge the surface cuts, joining the four cells around the edge.
  for (int z = 1; z + 1 < n[2]; ++z) {
    for (int y = 1; y + 1 < n[1]; ++y) {
      for (int x = 1; x + 1 < n[0]; ++x) {
        for (int axis = 0; axis < 3; ++axis) {
          std::array<int, 3> u{}, v{}, along{};
          along[static_cast<std::size_t>(axis)] = 1;
          u[static_cast<std::size_t>((axis + 1) % 3)] = 1;
          v[static_cast<std::size_t>((axis + 2) % 3)] = 1;
          const bool inside = value[index(x, y, z)] < 0.0;
          if (inside == (value[index(x + along[0], y + along[1], z + along[2])] < 0.0)) continue;
          const std::uint32_t a =
              vertex_in[index(x - u[0] - v[0], y - u[1] - v[1], z - u[2] - v[2])];
          const std::uint32_t b = vertex_in[index(x - v[0], y - v[1], z - v[2])];
          const std::uint32_t c = vertex_in[index(x, y, z)];
          const std::uint32_t d = vertex_in[index(x - u[0], y - u[1], z - u[2])];
          if (inside) {
            append_triangles(mesh, {a, b, c, a, c, d});
          } else {
            append_triangles(mesh, {a, c, b, a, d, c});
          }
        }
      }
    }
  }
  return mesh;
}

}  // namespace headpin::render
