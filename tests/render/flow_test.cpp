#include "render/flow.h"

#include <gtest/gtest.h>

#include "render/camera.h"
#include "tests/render/drawn_scenes.h"

namespace headpin::render::test {
namespace {

/// Two balls at a distance, left and right of the axis, before nothing.
struct TwoBalls {
  Renderer renderer = plain_renderer();
  DrawList list;
  View view;

  TwoBalls() {
    view = {looking_ahead(Vec3(0.0, 0.0, 1.0)), {-0.5, 0.5, -0.4, 0.4}, 60, 48};
    const int mesh = renderer.add(glowing_ball(0.3, Vec3::Ones()));
    for (const double x : {-0.5, 0.5}) {
      DrawItem item;
      item.mesh = mesh;
      item.X_WG.p = Vec3(x, 3.0, 1.0);
      item.id = x < 0.0 ? 7 : 8;
      list.items.push_back(item);
    }
  }
};

TEST(Flow, IsExactlyZeroWhereNothingMovesAndUnknownWhereNothingIsSeen) {
  TwoBalls two;
  two.view.X_WE = {rotation(Vec3(1.5, 0.1, 0.02)), Vec3(0.1, 0.2, 1.0)};
  const Labels seen = two.renderer.labels(two.list, two.view);
  const auto moved = flow({two.view, two.list.items}, seen, {two.view, two.list.items});
  int at_rest = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const float expected = seen.id[i] == 0 ? kUnknownFlow : 0.0F;
    EXPECT_EQ(moved[i], (std::array{expected, expected})) << i;
    at_rest += seen.id[i] != 0;
  }
  EXPECT_GT(at_rest, 100);
}

// A camera that moves by t sees what is Z ahead move by -f t / Z; a ball that moves with it rests. A
// ball whose mesh changes has no flow.
TEST(Flow, IsTheParallaxOfWhatDoesNotMoveWithTheCamera) {
  TwoBalls two;
  const Labels seen = two.renderer.labels(two.list, two.view);
  const Vec3 by(0.05, 0.0, 0.0);
  View later = two.view;
  later.X_WE.p += by;
  std::vector<DrawItem> items = two.list.items;
  items[1].X_WG.p += by;
  const double fx = Camera(two.view).fx;
  const auto moved = flow({two.view, two.list.items}, seen, {later, items});
  items[1].mesh = 99;
  const auto other_mesh = flow({two.view, two.list.items}, seen, {later, items});
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (seen.id[i] == 0) continue;
    const double parallax = -fx * by.x() / static_cast<double>(seen.depth[i]);
    EXPECT_NEAR(moved[i][0], seen.id[i] == 7 ? parallax : 0.0, 1e-5) << i;
    EXPECT_NEAR(moved[i][1], 0.0, 1e-5) << i;
    EXPECT_EQ(other_mesh[i][0] == kUnknownFlow, seen.id[i] == 8) << i;
  }
}

// The middle of a ball that turns by a about the line of sight rests; a point r from it moves by the
// chord 2 r sin(a / 2).
TEST(Flow, TurnsWithItsBody) {
  TwoBalls two;
  const Labels seen = two.renderer.labels(two.list, two.view);
  constexpr double kTurn = 0.2;
  std::vector<DrawItem> items = two.list.items;
  items[0].X_WG.q = rotation(Vec3(0.0, kTurn, 0.0));
  const auto moved = flow({two.view, two.list.items}, seen, {two.view, items});
  const Camera camera(two.view);
  const Vec3 middle = camera.X_CW * items[0].X_WG.p;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (seen.id[i] != 7) continue;
    const double depth = static_cast<double>(seen.depth[i]);
    const Vec3 p = camera.point(static_cast<double>(i % 60), static_cast<double>(i / 60), depth);
    const double from_axis = (p - middle).head<2>().norm();
    const Vec2 by(moved[i][0] / camera.fx * depth, moved[i][1] / camera.fy * depth);
    EXPECT_NEAR(by.norm(), 2.0 * from_axis * std::sin(0.5 * kTurn), 1e-5) << i;
  }
}

TEST(Flow, IsUnknownWhereTheObjectIsThenBehindTheCamera) {
  TwoBalls two;
  const Labels seen = two.renderer.labels(two.list, two.view);
  View later = two.view;
  later.X_WE.p.y() = 5.0;
  for (const auto& [u, v] : flow({two.view, two.list.items}, seen, {later, two.list.items})) {
    EXPECT_EQ(u, kUnknownFlow);
    EXPECT_EQ(v, kUnknownFlow);
  }
}

}  // namespace
}  // namespace headpin::render::test
