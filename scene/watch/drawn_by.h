#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "devices/trial/trial.h"
#include "render/fingerprint.h"

/// Who drew a session's frames, as its trial tells it.
namespace headpin::scene {

nlohmann::json to_json(const render::Fingerprint& fingerprint);

/// An event of the kind drawn_by.
devices::Event drawn_by_event(const render::Fingerprint& fingerprint);

/// Of the first such event; nothing where there is none that can be read, as in trials from before.
std::optional<render::Fingerprint> drawn_by(const std::vector<devices::Event>& events);

}  // namespace headpin::scene
