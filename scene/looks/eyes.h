#pragma once

#include <array>
#include <string_view>

#include "render/eyes.h"
#include "scene/looks/looks.h"

/// The pictures that the participant's eyes see.
namespace headpin::scene {

struct Eyes {
  render::Renderer renderer;
  Looks looks;
  render::Optics optics;
};

/// Makes eyes with the rendering quality of the stage's scenario, or with another one.
/// @throws std::runtime_error  when no OpenGL context works, with the reasons
Eyes open_eyes(const Stage& stage);
/// @param gl  as render::open_context
Eyes open_eyes(const Stage& stage, const render::Quality& look, std::string_view gl = {});

/// A camera or head at a place that looks at another place, level.
Pose looking_at(const Vec3& p_WC, const Vec3& target_W);

/// Cameras that show the thrower: from behind and beside; from above or from the side with the whole
/// room, the lane to the right.
Pose third_person_camera(const Scenario& scenario);
Pose top_camera(const Scenario& scenario);
Pose side_camera(const Scenario& scenario);

/// The views of both eyes, or of a camera in their place, left first.
std::array<render::View, 2> views_of(const Eyes& eyes, const Glimpse& glimpse);

/// All that is drawn.
render::DrawList list_of(const Eyes& eyes, const Glimpse& glimpse);

/// Draws both eyes, left first.
///
/// @return  the views, with X_WE of each eye
std::array<render::View, 2> see(Eyes& eyes, const Glimpse& glimpse,
                                std::array<render::Image, 2>& out);

/// The object and the depth at the centre of each pixel: ground truth for segmentation and depth.
std::array<render::Labels, 2> see_labels(Eyes& eyes, const Glimpse& glimpse);

}  // namespace headpin::scene
