#pragma once

#include "devices/live/source.h"

namespace headpin::devices {

/// A Fastrak at the end of a line; see open_line. With a clock, a thread reads the line.
OpenSource live_fastrak(const std::string& name, const std::string& line, Clocks& clocks,
                        const SourceOptions& options);

}  // namespace headpin::devices
