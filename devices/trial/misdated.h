#pragma once

#include <cstdint>
#include <vector>

#include "devices/trial/trial_messages.h"

namespace headpin::devices {

/// Messages whose time, or a state's tick, jumps away from those around it while the log's own
/// stamps go on; in their order.
std::vector<std::int64_t> find_misdated(Messages messages);

}  // namespace headpin::devices
