#pragma once

#include <cstdint>
#include <vector>

#include "devices/trial/trial_messages.h"

namespace headpin::devices {

/// The messages whose time (or a state's tick) disagrees with their neighbours while the log's own
/// time stamps advance; in order.
std::vector<std::int64_t> find_misdated(Messages messages);

}  // namespace headpin::devices
