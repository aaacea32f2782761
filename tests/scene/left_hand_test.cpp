// What a left-handed player sees: a left hand, and a ball whose holes are for it.

#include <gtest/gtest.h>

#include "devices/base/sample.h"
#include "scene/looks/hand_mesh.h"
#include "scene/looks/looks.h"
#include "scene/page/play_page.h"

namespace headpin::scene {
namespace {

/// Volume by the divergence theorem; negative inside out [m3].
double signed_volume(const render::Mesh& mesh) {
  double sum = 0.0;
  const auto corner = [&](std::size_t i) -> Vec3 {
    return mesh.vertices[mesh.indices[i]].p.cast<double>();
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    sum += corner(i).dot(corner(i + 1).cross(corner(i + 2))) / 6.0;
  }
  return sum;
}

TEST(LeftHand, IsTheMirrorImageOfARightOneAndSoAreItsHoles) {
  constexpr double kBallRadius = 0.1085;  // [m]
  const Vec3 grip(0.01, -0.05, -0.10), left_grip(-0.01, -0.05, -0.10);
  const Vec3 mirror(-1.0, 1.0, 1.0);
  const render::Mesh right = hand_mesh(grip, kBallRadius, 0.5);
  const render::Mesh left = hand_mesh(left_grip, kBallRadius, 0.5, true);
  ASSERT_EQ(left.vertices.size(), right.vertices.size());
  for (std::size_t i = 0; i < left.vertices.size(); ++i) {
    const Eigen::Vector3f m = mirror.cast<float>();
    EXPECT_EQ(left.vertices[i].p, Eigen::Vector3f(right.vertices[i].p.cwiseProduct(m)));
    EXPECT_EQ(left.vertices[i].n, Eigen::Vector3f(right.vertices[i].n.cwiseProduct(m)));
  }
  EXPECT_GT(signed_volume(right), 0.0);
  EXPECT_NEAR(signed_volume(left), signed_volume(right), 1e-9);
  const auto holes = ball_holes(grip, kBallRadius);
  const auto left_holes = ball_holes(left_grip, kBallRadius, true);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    EXPECT_EQ(left_holes[i], Vec3(holes[i].cwiseProduct(mirror)));
  }
}

/// Where the tip of the open thumb is: the vertex of the hand that is farthest to a side, of the
/// meshes that the looks of a scenario have [m].
double farthest_aside(const Scenario& scenario) {
  std::vector<render::Mesh> meshes;
  const Looks looks(MeshKeeper{[&](const render::Mesh& mesh) {
                      meshes.push_back(mesh);
                      return static_cast<int>(meshes.size()) - 1;
                    }},
                    make_stage(scenario));
  double farthest = 0.0;
  for (const render::Vertex& v : meshes[static_cast<std::size_t>(looks.hands.front())].vertices) {
    if (std::abs(v.p.x()) > std::abs(farthest)) farthest = v.p.x();
  }
  return farthest;
}

TEST(LeftHand, IsDrawnWhereTheLeftHandIsTracked) {
  Scenario scenario;
  const double right = farthest_aside(scenario);
  EXPECT_LT(right, -0.05) << "the thumb of a right hand whose back is up is on the left";
  scenario.rig.hand_station = devices::kLeftHandStation;
  EXPECT_EQ(farthest_aside(scenario), -right);
  scenario.collision.rules = 9;
  EXPECT_EQ(farthest_aside(scenario), right) << "who played an older trial saw a right one";
}

TEST(LeftHand, IsMadeByThePageFromARightOneExceptThatOfAFile) {
  Scenario scenario;
  const PageData right = play_page(scenario);
  EXPECT_EQ(right.json["left_handed"]["mirrors_hand"], true);
  EXPECT_EQ(right.json["left_handed"]["mirrors_ball"], true);
  scenario.rig.hand_station = devices::kLeftHandStation;
  EXPECT_EQ(play_page(scenario).floats, right.floats);
  scenario.hand.mesh.file = "a file that is not there";
  EXPECT_EQ(play_page(scenario).json["left_handed"]["mirrors_hand"], false);
}

}  // namespace
}  // namespace headpin::scene
