// Shadows, held against rays: from a point of the floor to the light, past the ball or through it.

#include <random>

#include <gtest/gtest.h>

#include "render/osmesa_context.h"
#include "scene/looks/looks.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/room.h"

namespace headpin::scene {
namespace {

constexpr int kPixels = 200;

/// Straight down on a square of the floor, one metre and a half wide.
render::View above(const Vec2& middle) {
  constexpr double kUp = 30.0, kHalf = 0.75;
  const double edge = kHalf / kUp;
  return {{Quat::Identity(), Vec3(middle.x(), middle.y(), kUp)},
          {-edge, edge, -edge, edge, 20.0, 40.0},
          kPixels,
          kPixels};
}

/// Where a pixel of above() lies on the floor.
Vec2 floor_at(const Vec2& middle, int x, int y) {
  constexpr double kPixel = 1.5 / kPixels;
  return middle + kPixel * Vec2(x + 0.5 - 0.5 * kPixels, 0.5 * kPixels - y - 0.5);
}

/// From a ball's centre to the ray that a point of the floor sends to the light.
double past(const Vec2& floor, const Vec3& n_W, const Vec3& p_WB) {
  const Vec3 d = p_WB - Vec3(floor.x(), floor.y(), 0.0);
  return (d - d.dot(n_W) * n_W).norm();
}

struct Counted {
  int shaded = 0, lit = 0, wrong = 0;
};

/// Pixels of the floor that a ball shades or does not, and those where the picture says otherwise.
Counted counted(render::Renderer& renderer, const Looks& looks, const Vec3& p_WB) {
  render::DrawList list = draw_list(looks, {.X_WB_balls = {Pose{Quat::Identity(), p_WB}}});
  for (render::DrawItem& item : list.items) item.casts_shadow = item.id == kFirstBallId;
  const Vec3 n_W = looks.room.shadow.n_W;
  const Vec3 foot = p_WB - p_WB.z() / n_W.z() * n_W;
  const Vec2 middle = foot.head<2>();
  const render::View view = above(middle);
  std::array<render::Image, 2> images;  // with the ball's shadow, and without
  for (render::Image& image : images) {
    renderer.draw(list, {&view, 1}, {&image, 1});
    list.shadow.depth = 1e-9;  // drawn in the same order of parts, but not seen
  }
  const render::Labels labels = renderer.labels(list, view);
  Counted found;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const auto i = static_cast<std::size_t>(y * kPixels + x);
      const bool floor = labels.id[i] == kRoomId && std::abs(labels.depth[i] - 30.0F) < 0.002F;
      if (!floor) continue;
      const double d = past(floor_at(middle, x, y), n_W, p_WB);
      if (std::abs(d - looks.ball_radius) < 0.03) continue;  // texels are 8 to 12 mm
      const bool shaded = d < looks.ball_radius;
      int darker = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        darker = std::max(darker, images[1].rgb[3 * i + c] - images[0].rgb[3 * i + c]);
      }
      ++(shaded ? found.shaded : found.lit);
      if (shaded != (darker > 3)) ++found.wrong;
    }
  }
  return found;
}

/// A room, and balls anywhere in it that are whole inside.
void expect_shadows_all_over(const std::string& name, int balls) {
  const Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/" + name + ".toml");
  const Stage stage = make_stage(scenario);
  render::Renderer renderer{render::osmesa_context(), {.contact = false, .mirror = false}};
  const Looks looks{renderer, stage};
  const RoomMeasures room = room_measures(scenario);
  const double r = scenario.ball.radius;
  std::mt19937 random(7);
  const auto between = [&](double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(random()) / 4294967296.0;
  };
  int seen = 0;
  for (int i = 0; i < balls; ++i) {
    const Vec3 p_WB(between(-0.5 * room.width + r, 0.5 * room.width - r),
                    between(-room.behind + r, room.portal() - 0.5), between(r, room.height - r));
    const Counted found = counted(renderer, looks, p_WB);
    EXPECT_EQ(found.wrong, 0) << name << ": ball at " << p_WB.transpose() << ", " << found.shaded
                              << " pixels in shadow, " << found.lit << " not";
    seen += found.shaded;
  }
  EXPECT_GT(seen, 200 * balls) << name;
}

TEST(Shadows, FallWhereTheBallIsBetweenFloorAndLightAnywhereInTheRoom) {
  expect_shadows_all_over("paper-experiment", 40);
  expect_shadows_all_over("regulation-ten-pin", 20);
}

}  // namespace
}  // namespace headpin::scene
