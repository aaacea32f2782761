#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/eyes.h"
#include "scene/looks.h"
#include "scene/session.h"

/// The participant's eyes: what a session looks like to whoever is in it.
namespace headpin::scene {

struct Eyes {
  render::Renderer renderer;
  Looks looks;
  render::Optics optics;
};

/// Eyes that draw as the stage's scenario wants it.
/// @throws std::runtime_error  when nothing can be drawn on this machine; says why
Eyes open_eyes(const Stage& stage);

/// All that is needed to draw one moment of a session, so that it can be drawn later or elsewhere.
struct Glimpse {
  Pose X_WD = {};  ///< head display
  std::vector<Pose> X_WB_skittles = {}, X_WB_balls = {};
  bool ellipsoids = false;
  double skittle_centre = 0.0;
  std::optional<Pose> X_WH = {};
  bool grips = false;
};

Glimpse glimpse(const Session& session, const Pose& X_WD);

/// Draws both eyes, left first.
///
/// @return  the views drawn, X_WE of each eye in them
std::array<render::View, 2> see(Eyes& eyes, const Glimpse& glimpse,
                                std::array<render::Image, 2>& out);

}  // namespace headpin::scene
