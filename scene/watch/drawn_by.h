#pragma once

#include <optional>
#include <vector>

#include "render/data/fingerprint.h"
#include "scene/record/trial.h"

/// What drew a session's frames, as stored in its trial.
namespace headpin::scene {

/// An event of the kind drawn_by.
Event drawn_by_event(const render::Fingerprint& fingerprint);

/// The content of the first such event; nothing if there is no readable one, as in older trials.
std::optional<render::Fingerprint> drawn_by(const std::vector<Event>& events);

}  // namespace headpin::scene
