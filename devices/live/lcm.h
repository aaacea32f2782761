#pragma once

#include "devices/live/source.h"

namespace headpin::devices {

/// TRACKER and MOUSE3D at an LCM URL; a file:// plays at its own pace and ends.
OpenSource live_lcm(const std::string& name, const std::string& url, Clocks& clocks,
                    const SourceOptions& options);

}  // namespace headpin::devices
