#pragma once

#include <string>

#include "devices/live/source.h"

namespace headpin::scene {

/// Opens a device, as devices::open_device() does, or a trial by its path, which plays from the
/// session's start, each sample when it was available.
///
/// @param clocks  of the session, which date what devices measure; must outlive the source
/// @throws std::runtime_error  when it cannot be opened or is no trial
/// @throws std::invalid_argument  for a name that no line can have, or a wrong LCM URL
devices::OpenSource open_source(const std::string& name, devices::Clocks& clocks,
                                const devices::SourceOptions& options);

}  // namespace headpin::scene
