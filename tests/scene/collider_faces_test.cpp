#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "scene/looks/looks.h"
#include "scene/play/session.h"

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

/// Heights of the lowest and the highest point that is drawn of the first skittle [m].
Vec2 drawn_from_to(WeighedEllipsoid weighed, std::int64_t rules) {
  Scenario scenario;
  scenario.collision.shape = SkittleShape::ellipsoid;
  scenario.collision.rules = rules;
  scenario.skittle.seen = SeenSkittle::collider;
  scenario.skittle.ellipsoid_weighed = weighed;
  std::vector<render::Mesh> meshes;
  const Session session = make_session(scenario);
  const Looks looks(MeshKeeper{[&](const render::Mesh& mesh) {
                      meshes.push_back(mesh);
                      return static_cast<int>(meshes.size()) - 1;
                    }},
                    *session.stage);
  Vec2 span(1e9, -1e9);
  for (const render::DrawItem& item : draw_list(looks, glimpse(session, {})).items) {
    if (item.id != kFirstSkittleId) continue;
    for (const render::Vertex& v : meshes[static_cast<std::size_t>(item.mesh)].vertices) {
      const double z = (item.X_WG * v.p.cast<double>()).z();
      span = {std::min(span.x(), z), std::max(span.y(), z)};
    }
  }
  return span;
}

// Weighed as a true skittle its centre is lower than its middle. Trials of rules 1 to 12 are drawn as they
// were seen: about the centre, 43 mm too low.
TEST(Looks, ShowAnEllipsoidWhereItCollidesHoweverItIsWeighed) {
  for (const WeighedEllipsoid weighed : {WeighedEllipsoid::itself, WeighedEllipsoid::alike}) {
    const Vec2 span = drawn_from_to(weighed, 13);
    EXPECT_NEAR(span.x(), 0.0, 1e-6);
    EXPECT_NEAR(span.y(), 0.381, 1e-6);
  }
  EXPECT_LT(drawn_from_to(WeighedEllipsoid::alike, 12).x(), -0.04);
}

}  // namespace
}  // namespace headpin::scene
