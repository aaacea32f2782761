#pragma once

#include <string_view>

#include "devices/log/event_log.h"
#include "devices/recordings/motion_files.h"
#include "devices/recordings/xdf_file.h"

/// Motion in an XDF file: its streams as one table, whose columns are understood like any other's.
namespace headpin::devices {

/// A file that outlives the result.
XdfBytes bytes_of(FileWindow& file);

/// Head and hands of the streams, at times of the recorder's clock.
///
/// A column is called by its stream and by its channel: by object and component where the channel has a
/// type of LSL's meta-data for motion (PositionX, OrientationA), else by its label. Streams of
/// strings are columns of words. A stream without positions and buttons, such as EEG, is a note.
///
/// @throws std::invalid_argument  naming `where`: no XDF, no stream of motion, no head or no hand
MotionTracks parse_xdf_motion(const XdfBytes& bytes, std::string_view where,
                              const MotionOptions& options);

/// What is understood of its streams.
TableFindings inspect_xdf(const XdfBytes& bytes, std::string_view where,
                          const MotionOptions& options);

}  // namespace headpin::devices
