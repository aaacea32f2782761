#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/renderer.h"
#include "scene/looks.h"
#include "scene/session.h"

/// The participant's eyes: what a session looks like from the head display.
namespace headpin::scene {

/// Display and lenses of a scenario's HMD.
render::Optics optics(const Hmd& hmd);

struct Spectator {
  render::Renderer renderer;
  Looks looks;
  render::Optics optics;
};

/// @throws std::runtime_error  when nothing can be drawn on this machine; says why
Spectator make_spectator(const Scenario& scenario, const render::Quality& quality = {});

/// All that is needed to draw one moment of a session, so that it can be drawn later or elsewhere.
struct Glimpse {
  Pose X_WD;  ///< head display
  std::vector<Pose> X_WB_skittles;
  bool ellipsoids = false;
  Pose X_WB_ball;
  std::optional<Pose> X_WH;
  bool grips = false;
};

Glimpse glimpse(const Session& session, const Pose& X_WD);

/// Draws both eyes, left first.
///
/// @return  the views drawn, X_WE of each eye in them
std::array<render::View, 2> see(Spectator& spectator, const Glimpse& glimpse,
                                std::array<render::Image, 2>& out);

}  // namespace headpin::scene
