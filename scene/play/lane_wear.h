#pragma once

#include <cstdint>
#include <vector>

#include "scene/stage/stage.h"

/// How balls wear the oil on a lane: they thin it where they touch it, and carry some of it to dry
/// boards.
///
/// A lane has wear if its scenario says so (`lane.oil.wear`): then its stage has the table of its
/// friction when it is fresh. A throw changes the table of the world when the ball's way is over.
namespace headpin::scene {

/// Cells of a lane's table that a ball has touched: in this order, each once.
using TouchedCells = std::vector<std::uint32_t>;

/// Adds the cells that a ball touches on its way from one place of the lane to the next one.
void add_way(TouchedCells& touched, const engine::FrictionTable& lane, const Vec2& from,
             const Vec2& to);

/// The lane after a ball has passed.
///
/// @param before  the throw
/// @param fresh   as the oil pattern says
/// @param oil     how much a pass wears it, and the friction of dry boards
engine::FrictionTable worn(engine::FrictionTable before, const engine::FrictionTable& fresh,
                           const TouchedCells& touched, const Oil& oil);

/// The lane of a world as it is now.
///
/// @param stage  has wear
const engine::FrictionTable& lane_of(const engine::World& world, const Stage& stage);

/// Wears the lane of a world; nothing on a stage without wear.
void wear_lane(engine::World& world, const Stage& stage, const TouchedCells& touched);

/// Gives a world the worn lane of another one, if both stages have wear and the same oil pattern.
///
/// @param from  of the stage `before`
void take_over_wear(engine::World& world, const Stage& stage, const engine::World& from,
                    const Stage& before);

}  // namespace headpin::scene
