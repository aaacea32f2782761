#pragma once

#include <string_view>

#include "render/image.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// A scenario before the first throw, in one picture with square pixels: the room from above and
/// from the side (above), and what both eyes see of a person at the foul line who looks at the head
/// pin (below).
///
/// @param gl  as render::open_context
/// @throws std::invalid_argument  if the values of the scenario are not possible
/// @throws std::runtime_error     when no OpenGL context works, with the reasons
render::Image picture_of(const Scenario& scenario, std::string_view gl);

}  // namespace headpin::scene
