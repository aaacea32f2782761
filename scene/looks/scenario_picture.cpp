#include "scene/looks/scenario_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "scene/looks/eyes.h"
#include "scene/play/session.h"

namespace headpin::scene {

namespace {

constexpr int kWidth = 720;     // of each view [pixels]
constexpr int kTallest = 1800;  // likewise, so that OpenGL can draw it with all samples
constexpr int kNarrowest = 90;
constexpr double kEyeHeight = 1.6;  // [m]

/// The field of view of a display, without its lenses and with square pixels. A very tall one is
/// narrower; its pixels are not square where it would be less than kNarrowest wide.
render::Optics square(render::Optics optics) {
  const render::Frustum f = render::eyes({}, optics)[0].frustum;
  const double tall = (f.top - f.bottom) / (f.right - f.left);
  const auto pixels = [](double size, int least, int most) {
    return static_cast<int>(std::lround(std::clamp<double>(size, least, most)));
  };
  optics.width = pixels(kTallest / tall, kNarrowest, kWidth);
  optics.height = pixels(kWidth * tall, 1, kTallest);
  optics.relay_width = optics.relay_height = 0;
  optics.lens_k1 = optics.lens_k2 = 0.0;
  return optics;
}

/// A head at the foul line that looks at the head pin.
Pose at_foul_line(const Scenario& scenario) {
  return looking_at(Vec3(0.0, 0.0, kEyeHeight),
                    Vec3(0.0, scenario.lane.head_pin, 0.5 * scenario.skittle.height));
}

/// One picture above another of the same width.
render::Image above(render::Image upper, const render::Image& lower) {
  upper.height += lower.height;
  upper.rgb.insert(upper.rgb.end(), lower.rgb.begin(), lower.rgb.end());
  return upper;
}

}  // namespace

render::Image picture_of(const Scenario& scenario, std::string_view gl) {
  const Session session = make_session(scenario);
  Eyes eyes = open_eyes(*session.stage, scenario.look, gl);
  eyes.optics = square(eyes.optics);
  Glimpse at_start = glimpse(session, at_foul_line(scenario));
  std::array<render::Image, 2> seen, top, side;
  see(eyes, at_start, seen);
  at_start.X_WC = top_camera(scenario);
  see(eyes, at_start, top);
  at_start.X_WC = side_camera(scenario);
  see(eyes, at_start, side);
  return above(render::side_by_side(top[0], side[0]), render::side_by_side(seen[0], seen[1]));
}

}  // namespace headpin::scene
