#pragma once

#include <initializer_list>
#include <string_view>

#include "engine/world.h"
#include "scene/record/trial.h"

namespace headpin::scene {

/// The current tick.
struct Moment {
  Time time{};
  std::int64_t tick = 0;
};

/// An event of this tick between the named bodies of a world.
Event event(const Moment& moment, std::string_view kind, const engine::World& world,
            std::initializer_list<engine::BodyId> bodies);

}  // namespace headpin::scene
