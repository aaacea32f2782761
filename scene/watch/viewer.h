#pragma once

#include <vector>

#include "devices/lcm/viewer_messages.h"
#include "scene/play/session.h"

/// Messages for Drake's viewer.
namespace headpin::scene {

/// Collision shapes of lane, kick-backs, ball and skittles; walls are left out, so that the inside
/// is visible.
std::vector<devices::ViewerLink> viewer_links(const Session& session);

/// Their current poses, with those of head display and hand.
std::vector<devices::ViewerPose> viewer_poses(const Session& session);

}  // namespace headpin::scene
