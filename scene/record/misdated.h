#pragma once

#include <cstdint>
#include <vector>

#include "scene/record/trial_messages.h"

namespace headpin::scene {

/// What the times of a log's messages show.
struct Misdated {
  /// The messages whose time (or a state's tick) disagrees with their neighbours while the log's own
  /// time stamps advance; in order.
  std::vector<std::int64_t> messages;
  bool goes_back = false;  ///< a device's time or the tick is not later than an earlier one
};

Misdated find_misdated(Messages messages);

}  // namespace headpin::scene
