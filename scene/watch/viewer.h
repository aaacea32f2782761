#pragma once

#include <vector>

#include "devices/lcm/viewer_messages.h"
#include "scene/play/session.h"

/// A session as Drake's viewer shows it.
namespace headpin::scene {

/// Lane, kick-backs, ball and skittles as the collisions see them; walls are left out, so that one
/// can look in.
std::vector<devices::ViewerLink> viewer_links(const Session& session);

/// Where they are now; the head display and the hand too.
std::vector<devices::ViewerPose> viewer_poses(const Session& session);

}  // namespace headpin::scene
