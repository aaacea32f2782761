#pragma once

#include <cstdint>
#include <vector>

#include "scene/record/trial_messages.h"

namespace headpin::scene {

/// The messages whose time (or a state's tick) disagrees with their neighbours while the log's own
/// time stamps advance; in order.
std::vector<std::int64_t> find_misdated(Messages messages);

}  // namespace headpin::scene
