// What is drawn of a skittle changes with its distance (render/meshes.h); what is seen of it may
// not.

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "render/image.h"
#include "render/osmesa_context.h"
#include "scene/looks/looks.h"

namespace headpin::scene {
namespace {

double all_light(const render::Image& image) {
  double sum = 0.0;
  for (const std::uint8_t code : image.rgb) sum += render::light_of_codes()[code];
  return sum;
}

/// The light of a lone skittle, times its distance squared: the same wherever it is, but for the
/// lamps around it, if it is always drawn alike. The mean of places fractions of a pixel apart, turned about its axis.
///
/// @param size  of it, as the renderer measures it [pixels]
double light_at(render::Renderer& renderer, const Looks& looks, const Scenario& scenario,
                double centre, double size) {
  const double height = scenario.skittle.height, widest = 2.0 * 0.0605;
  const double diagonal = std::sqrt(height * height + 2.0 * widest * widest);
  const double edge = std::tan(20.0 * std::numbers::pi / 180.0);
  const double away = diagonal * 240.0 / (2.0 * edge) / size;
  const Vec3 p_WB(0.0, scenario.lane.head_pin, centre);
  double sum = 0.0;
  constexpr int kPlaces = 16;
  for (int i = 0; i < kPlaces; ++i) {
    const double turn = 0.002 + 0.00021 * i;
    const render::View view{
        {rotation(Vec3(0.5 * std::numbers::pi + turn, 0.0, 0.0)) * rotation(Vec3(0.0, turn, 0.0)),
         p_WB - Vec3(0.0, away, 0.0)},
        {-edge, edge, -edge, edge},
        240,
        240};
    Glimpse glimpse{.skittle_centre = centre};
    std::array<render::Image, 2> images;  // with it, without
    renderer.draw(draw_list(looks, glimpse), {&view, 1}, {&images[1], 1});
    glimpse.X_WB_skittles = {Pose{rotation(Vec3(0.0, 0.0, 2.4 * i)), p_WB}};
    renderer.draw(draw_list(looks, glimpse), {&view, 1}, {&images[0], 1});
    sum += all_light(images[0]) - all_light(images[1]);
  }
  return sum / kPlaces * away * away;
}

TEST(FarSkittle, HasTheLightOfANearOneWhereverItsMeshChanges) {
  for (const render::Look& look : render::looks()) {
    render::Quality quality = look.quality;
    quality.contact = quality.shadow = quality.mirror = false;  // of it alone
    Scenario scenario;
    const Stage stage = make_stage(scenario);
    render::Renderer renderer{render::osmesa_context(), quality};
    Looks looks{renderer, stage};
    looks.room.items.clear();
    looks.room.background = Vec3::Zero();
    for (const double size : {48.0, 16.0}) {
      const double near = light_at(renderer, looks, scenario, stage.skittle_centre, 1.01 * size);
      const double far = light_at(renderer, looks, scenario, stage.skittle_centre, 0.99 * size);
      EXPECT_NEAR(far / near, 1.0, 0.01) << look.name << " at " << size << " pixels";
    }
  }
}

}  // namespace
}  // namespace headpin::scene
