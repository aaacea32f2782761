// What stands around the skittles, looked at from nearby.

#include <numbers>

#include <gtest/gtest.h>

#include "render/osmesa_context.h"
#include "scene/looks/looks.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/room.h"

namespace headpin::scene {
namespace {

// The panel hangs before the kick-backs' tops, which are of light wood: of these nothing is seen under
// it, however near one looks. Both are of the same dark blue there.
TEST(Front, ShowsNoWoodBetweenPanelAndKickBacks) {
  const Scenario scenario =
      load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/regulation-ten-pin.toml");
  render::Renderer renderer{render::osmesa_context(),
                            {.samples = 1, .contact = false, .shadow = false, .mirror = false}};
  const Looks looks{renderer, make_stage(scenario)};
  const RoomMeasures room = room_measures(scenario);
  ASSERT_TRUE(room.kick_backs && room.masking_panel);
  for (const double side : {-1.0, 1.0}) {
    // 5 mm across, from half a metre before and 0.2 m above.
    const Vec3 seam(side * (room.kick_back_side() + 0.04), room.portal(), room.masking_low);
    const double down = std::atan2(0.2, 0.5), away = std::hypot(0.2, 0.5);
    const double edge = 0.0025 / away;
    const render::View view{
        {rotation(Vec3(0.5 * std::numbers::pi - down, 0.0, 0.0)), seam + Vec3(0.0, -0.5, 0.2)},
        {-edge, edge, -edge, edge},
        200,
        200};
    render::Image image;
    renderer.draw(draw_list(looks, {}), {&view, 1}, {&image, 1});
    int wood = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) wood += image.rgb[i] > image.rgb[i + 2];
    EXPECT_EQ(wood, 0) << side;
  }
}

}  // namespace
}  // namespace headpin::scene
