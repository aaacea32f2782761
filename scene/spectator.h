#pragma once

#include <array>

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
Spectator make_spectator(const Scenario& scenario);

/// Draws both eyes, left first.
///
/// @param X_WD  head display in the world
/// @return      the views drawn, X_WE of each eye in them
std::array<render::View, 2> see(Spectator& spectator, const Session& session, const Pose& X_WD,
                                std::array<render::Image, 2>& out);

}  // namespace headpin::scene
