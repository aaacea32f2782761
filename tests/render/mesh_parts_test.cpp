#include "render/mesh_parts.h"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

namespace headpin::render {
namespace {

using Corners = std::array<std::uint32_t, 3>;

std::vector<Corners> triangles_of(const std::vector<std::uint32_t>& indices) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  }
  std::ranges::sort(triangles);
  return triangles;
}

TEST(MeshParts, HoldAllTrianglesEachInItsBox) {
  const Mesh mesh = ellipsoid(3.0, 2.0, 40, 30, [](double) { return Vec3::Ones(); });
  const MeshParts parted = part_by_place(mesh);
  EXPECT_GT(parted.parts.size(), 8u);
  EXPECT_EQ(triangles_of(parted.indices), triangles_of(mesh.indices));
  std::size_t next = 0;
  for (const MeshPart& part : parted.parts) {
    EXPECT_EQ(part.first, next);
    next += part.count;
    EXPECT_TRUE(parted.box.contains(part.box));
    EXPECT_LT(part.box.sizes().maxCoeff(), 1.5 + 2.0);  // a cell, and a triangle each way
    for (std::size_t i = part.first; i < next; ++i) {
      EXPECT_TRUE(part.box.contains(mesh.vertices[parted.indices[i]].p.cast<double>()));
    }
  }
  EXPECT_EQ(next, mesh.indices.size());
}

TEST(MeshParts, OfASmallMeshAreOne) {
  const MeshParts parted = part_by_place(box({9.0, 9.0, 9.0}, Vec3::Ones()));
  EXPECT_EQ(parted.parts.size(), 1u);
  EXPECT_EQ(parted.parts[0].count, 36u);
}

TEST(MeshParts, ABoxThatIsSeenIsNeverOutside) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int outside = 0, seen = 0;
  for (int i = 0; i < 4000; ++i) {
    View view = eyes({rotation(Vec3(unit(random), 3.0 * unit(random), unit(random))),
                      Vec3(unit(random), unit(random), unit(random))},
                     {})[0];
    const Mat4 clip = world_to_clip(view);
    const Vec3 middle = 6.0 * Vec3(unit(random), unit(random), unit(random));
    const Vec3 half =
        0.05 * Vec3::Ones() + 2.0 * Vec3(unit(random), unit(random), unit(random)).cwiseAbs();
    const Eigen::AlignedBox3d box(middle - half, middle + half);
    bool any = false;
    for (int k = 0; k < 100; ++k) {
      const Vec3 p = middle + half.cwiseProduct(Vec3(unit(random), unit(random), unit(random)));
      const Eigen::Vector4d q = clip * p.homogeneous();
      any =
          any || (std::abs(q.x()) <= q.w() && std::abs(q.y()) <= q.w() && std::abs(q.z()) <= q.w());
    }
    const bool left_out = is_outside(box, clip);
    EXPECT_FALSE(any && left_out) << i;
    outside += left_out ? 1 : 0;
    seen += any ? 1 : 0;
  }
  EXPECT_GT(outside, 2000);  // most are behind or beside
  EXPECT_GT(seen, 500);
}

}  // namespace
}  // namespace headpin::render
