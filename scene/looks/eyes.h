#pragma once

#include <array>
#include <string_view>

#include "render/eyes.h"
#include "scene/looks/glimpse.h"

/// The participant's eyes: what a session looks like to whoever is in it.
namespace headpin::scene {

struct Eyes {
  render::Renderer renderer;
  Looks looks;
  render::Optics optics;
  render::Quality look;
};

/// Eyes that draw as the stage's scenario wants it, or in another look.
/// @throws std::runtime_error  when nothing can be drawn on this machine; says why
Eyes open_eyes(const Stage& stage);
/// @param gl  as render::open_context
Eyes open_eyes(const Stage& stage, const render::Quality& look, std::string_view gl = {});

/// Cameras for people who want to see who throws: behind and beside, and straight above the room,
/// the lane to the right, all of it in the picture.
Pose third_person_camera(const Scenario& scenario);
Pose top_camera(const Scenario& scenario);

/// Draws both eyes, left first.
///
/// @return  the views drawn, X_WE of each eye in them
std::array<render::View, 2> see(Eyes& eyes, const Glimpse& glimpse,
                                std::array<render::Image, 2>& out);

/// What the same pixels' centres see, and how far it is: truth for segmentation and depth.
std::array<render::Labels, 2> see_labels(Eyes& eyes, const Glimpse& glimpse);

}  // namespace headpin::scene
