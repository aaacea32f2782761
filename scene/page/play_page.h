#pragma once

#include "scene/page/page_parts.h"

namespace headpin::scene {

/// All that a page needs to draw and play a scenario; page_session.h plays it.
///
/// `json.actors` are in the order of PageSession::see: skittles, balls; then hand and head. Each has
/// its meshes: of a skittle the true one and the ellipsoid, of the hand from open to closed.
///
/// @throws std::runtime_error  as make_stage
PageData play_page(const Scenario& scenario);

}  // namespace headpin::scene
