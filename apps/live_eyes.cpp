#include "apps/live_eyes.h"

#include <array>
#include <chrono>
#include <numbers>
#include <vector>

#include <sys/resource.h>

#include "apps/command.h"
#include "apps/drawing_process.h"
#include "apps/streams.h"
#include "render/png.h"
#include "scene/live/lcm_views.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/seen_mesh.h"

namespace headpin::apps {

namespace {

/// Lowers the priority of the drawing process, so that it uses only free processor cores.
void give_way() {
  setpriority(PRIO_PROCESS, 0, 10);
}

/// The view of a player at the foul line who looks down the lane.
scene::Glimpse at_the_foul_line(std::shared_ptr<const scene::Stage> stage) {
  const Pose X_WD{rotation(0.5 * std::numbers::pi * Vec3::UnitX()), Vec3(0.0, -0.5, 1.65)};
  return scene::glimpse(scene::make_session(std::move(stage)), X_WD);
}

/// Prints the frame rate that this machine reaches with this look, measured on one frame.
void say_rate(scene::Eyes& eyes, const scene::Glimpse& glimpse, bool png, std::int64_t wanted) {
  using Clock = scene::RealTime::Clock;
  std::array<render::Image, 2> images;
  scene::see(eyes, glimpse, images);  // the first frame compiles the shaders
  const Clock::time_point begin = Clock::now();
  scene::see(eyes, glimpse, images);
  for (const render::Image& image : images) {
    if (png) render::encode_png(image, eyes.optics.pixel_aspect());
  }
  const double rate = 1.0 / std::chrono::duration<double>(Clock::now() - begin).count();
  say("eyes: about {:.0f} frames per second with this rendering quality, {} needed{}\n", rate,
      wanted,
      rate < static_cast<double>(wanted)
          ? "; frames that are not drawn in time are skipped, ticks are not"
          : "");
}

std::unique_ptr<scene::FrameDrawer> make_drawer(const DrawingOrder& order) {
  if (order.gives_way) give_way();
  const auto stage = std::make_shared<const scene::Stage>(
      scene::make_stage(scene::scenario_of_trial(order.scenario, "the session")));
  scene::Eyes eyes = scene::open_eyes(*stage, stage->scenario.look, order.gl);
  if (order.first) {
    say_instead_of("live", eyes);
    say_not_drawn("live", stage->scenario);
    say_rate(eyes, at_the_foul_line(stage), order.eyes == "png", stage->scenario.rates.frame_hz);
  }
  std::unique_ptr<scene::FrameSink> sink;
  if (order.eyes != "none") {
    sink = std::make_unique<scene::LcmEyes>(order.url, order.eyes == "png",
                                            eyes.optics.pixel_aspect());
  }
  return std::make_unique<scene::DrawerHere>(std::move(eyes), std::move(sink));
}

}  // namespace

void add_draw(CLI::App& app) {
  app.add_subcommand("draw", "What `live` has its frames drawn by")
      ->group("")  // internal, not shown in the help
      ->callback([] { serve_frames(make_drawer); });
}

void say_instead_of(const char* command, const scene::Eyes& eyes) {
  const std::string& why = eyes.renderer.instead_of();
  if (why.empty()) return;
  say("headpin {}: drawn by {}; {}\n", command, eyes.renderer.description(), why);
}

void say_not_drawn(const char* command, const scene::Scenario& scenario) {
  for (const std::string& one : scene::not_drawn(scenario)) {
    say("headpin {}: {}\n", command, printable(one));
  }
}

std::unique_ptr<scene::FramesBeside> open_live_eyes(const scene::Stage& stage,
                                                    const std::string& how, const std::string& url,
                                                    const std::string& gl, bool gives_way) {
  const DrawingOrder order{scene::to_toml(stage.scenario), how, url, gl, gives_way};
  return std::make_unique<scene::FramesBeside>([order] { return draw_in_a_process(order); });
}

}  // namespace headpin::apps
