#include "render/mesh_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace headpin::render {

namespace {

struct Triangle {
  std::array<int, 3> cell;
  std::array<std::uint32_t, 3> corners;
};

}  // namespace

MeshParts part_by_place(const Mesh& mesh, double cell, std::size_t whole) {
  const auto vertex = [&](std::uint32_t i) -> Vec3 { return mesh.vertices[i].p.cast<double>(); };
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle t{{}, {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]}};
    const Vec3 middle = (vertex(t.corners[0]) + vertex(t.corners[1]) + vertex(t.corners[2])) / 3.0;
    if (mesh.indices.size() > 3 * whole) {
      for (int axis = 0; axis < 3; ++axis) {
        t.cell[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(middle[axis] / cell));
      }
    }
    triangles.push_back(t);
  }
  std::ranges::stable_sort(triangles, {}, &Triangle::cell);

  MeshParts out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i == 0 || triangles[i].cell != triangles[i - 1].cell) out.parts.push_back({3 * i, 0, {}});
    out.parts.back().count += 3;
    for (const std::uint32_t corner : triangles[i].corners) {
      out.indices.push_back(corner);
      out.parts.back().box.extend(vertex(corner));
    }
    out.box.extend(out.parts.back().box);
  }
  return out;
}

bool is_outside(const Eigen::AlignedBox3d& box, const Mat4& box_to_clip) {
  std::array<int, 6> beyond{};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1) != 0 ? box.max().x() : box.min().x(),
                 (corner & 2) != 0 ? box.max().y() : box.min().y(),
                 (corner & 4) != 0 ? box.max().z() : box.min().z());
    const Eigen::Vector4d q = box_to_clip * p.homogeneous();
    for (int axis = 0; axis < 3; ++axis) {
      if (q[axis] < -q.w()) ++beyond[static_cast<std::size_t>(2 * axis)];
      if (q[axis] > q.w()) ++beyond[static_cast<std::size_t>(2 * axis + 1)];
    }
  }
  return std::ranges::find(beyond, 8) != beyond.end();
}

}  // namespace headpin::render
