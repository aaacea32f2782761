#pragma once

#include <cstdint>
#include <vector>

#include "scene/record/trial_messages.h"

namespace headpin::scene {

/// The messages that equal an earlier one to the byte, as when a trial is in a log twice; in order.
///
/// Its memory grows with the log.
std::vector<std::int64_t> find_doubled(Messages messages);

}  // namespace headpin::scene
