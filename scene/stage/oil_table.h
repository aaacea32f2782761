#pragma once

#include "engine/friction_table.h"
#include "scene/stage/room.h"

namespace headpin::scene {

/// The friction of an oiled lane before the skittles, board by board and foot by foot: board 39 is
/// the first column. A row ends at every foot from the foul line, and where a zone begins or ends.
engine::FrictionTable oil_table(const RoomMeasures& room);

}  // namespace headpin::scene
