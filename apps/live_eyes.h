#pragma once

#include <memory>
#include <string>

#include "scene/live/frames_beside.h"

/// What draws the pictures of a live session.
namespace headpin::apps {

/// Draws both eyes in a separate process.
///
/// @param how        raw or png, on HEADPIN_EYES at the URL; none: drawn, and shown to nobody
/// @param gl         as render::open_context
/// @param gives_way  to everything else the machine does
std::unique_ptr<scene::FramesBeside> open_live_eyes(const scene::Stage& stage,
                                                    const std::string& how, const std::string& url,
                                                    const std::string& gl, bool gives_way);

/// Prints why another OpenGL context than the first one draws.
void say_instead_of(const char* command, const scene::Eyes& eyes);

/// Prints which parts of the scenario's mesh files are not drawn.
void say_not_drawn(const char* command, const scene::Scenario& scenario);

}  // namespace headpin::apps
