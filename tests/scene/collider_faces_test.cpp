#include <vector>

#include <gtest/gtest.h>

#include "scene/looks/looks.h"

namespace headpin::scene {
namespace {

// The first corners of top and bottom are in a line; those of the top are off it by a rounding.
TEST(Looks, ShowFacesWhoseFirstCornersAreInALine) {
  Scenario scenario;
  scenario.skittle.seen = SeenSkittle::collider;
  SkittlePart block{.shape = PartShape::polyhedron, .radius = 0.05, .low = 0.0, .high = 0.3};
  for (const double z : {0.0, 0.3}) {
    for (const Vec2& p : {Vec2(-0.05, -0.05), {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}}) {
      block.corners.emplace_back(p.x(), p.y(), z);
    }
  }
  block.corners.emplace_back(0.0, -0.05, 0.3 + 1e-12);
  block.corners.emplace_back(0.0, -0.05, 0.0);
  block.faces = {{4, 8, 5, 6, 7}, {1, 9, 0, 3, 2}, {0, 9, 8, 4}, {9, 1, 5, 8},
                 {1, 2, 6, 5},    {2, 3, 7, 6},    {3, 0, 4, 7}};
  scenario.skittle.parts = {block};
  std::vector<render::Mesh> meshes;
  const MeshKeeper keeper{[&](const render::Mesh& mesh) {
    meshes.push_back(mesh);
    return static_cast<int>(meshes.size()) - 1;
  }};
  const Looks looks(keeper, make_stage(scenario));
  const render::Mesh& seen = meshes[static_cast<std::size_t>(looks.true_skittle.mesh)];
  ASSERT_EQ(seen.vertices.size(), 30u);
  const Vec3 middle(0.0, 0.0, 0.15 - looks.centres.true_skittle);
  for (const render::Vertex& v : seen.vertices) {
    const Vec3 n = v.n.cast<double>();
    EXPECT_NEAR(n.cwiseAbs().maxCoeff(), 1.0, 1e-6) << n.transpose();
    EXPECT_GT(n.dot(v.p.cast<double>() - middle), 0.04) << n.transpose();
  }
}

}  // namespace
}  // namespace headpin::scene
