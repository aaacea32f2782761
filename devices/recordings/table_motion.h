#pragma once

#include <string_view>

#include "devices/recordings/motion_files.h"

namespace headpin::devices {

/// Any text table with a time and poses. Axes are RSP unless told, units metres unless the file says them.
///
/// @throws UnclearColumns         no time, no head or no hand
/// @throws std::invalid_argument  naming file and line: no table
MotionTracks parse_motion_table(std::string_view text, std::string_view where,
                                const MotionOptions& options);

/// What is understood of a text table.
/// @throws std::invalid_argument  no table, or told columns that are not there
TableFindings inspect_table(std::string_view text, std::string_view where,
                            const MotionOptions& options);

/// The same of a table that was read.
MotionTracks tracks_in(const AnyTable& table, std::string_view where, const MotionOptions& options);
TableFindings findings_in(const AnyTable& table, std::string_view where,
                          const MotionOptions& options);

}  // namespace headpin::devices
