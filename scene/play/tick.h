#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include "engine/world.h"
#include "scene/record/trial.h"
#include "scene/stage/stage.h"

namespace headpin::scene {

/// When a tick is.
struct Moment {
  Time time{};
  std::int64_t tick = 0;
};

/// A tick of a session: what its parts read and change.
struct Tick {
  const Stage& stage;
  engine::World& world;
  Moment moment;
  std::vector<Event>& events;  ///< of this tick so far; new ones are appended
};

/// An event of this tick between bodies of its world.
Event event(const Tick& tick, std::string_view kind, std::initializer_list<engine::BodyId> bodies);

}  // namespace headpin::scene
