#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "devices/base/sample.h"
#include "devices/fastrak/motion.h"

/// The motion of a recording for an emulated Fastrak.
namespace headpin::devices {

/// The motion of a recording: interpolated poses, constant before the first and after the last
/// sample.
///
/// Letters are those of the sample before; a press of the trigger of the 3D mouse, or of any
/// station's switch, is a press of the unit's one switch. Stations that were not recorded rest as
/// in `still_motion`. A measurement that is not later than the one before of its station counts for nothing,
/// nor does an earlier state of the mouse.
FastrakMotion recorded_motion(const std::vector<Sample>& samples);

/// The recorded place of the transmitter, if all receivers stay ahead of it (the default
/// hemisphere) and in range; else a place behind all receivers, in the middle of their vertical and
/// sideways ranges.
FastrakPlace place_for(const std::vector<Sample>& samples);

/// The earliest measurement of a recording; a default one if there is none.
TrackerSample first_measurement(const std::vector<Sample>& samples);

/// Time of a recording's last sample.
Time last_time(const std::vector<Sample>& samples);

/// A recording that is not kept in memory.
struct RecordingOnDisk {
  /// Begins to read it: each call of the result returns the next sample, nothing at the end.
  std::function<std::function<std::optional<Sample>()>()> read;
  std::map<Device, Time> last;  ///< time of the last sample of each device
};

/// The same of a recording on disk.
struct RecordedUnit {
  /// Reads the recording forward with the requested times, and from its start again if they go back by
  /// more than a second. The part in memory is as long as the longest time without a sample of one
  /// of its receivers.
  FastrakMotion motion;
  FastrakPlace place;
  TrackerSample first;
  Time length{};
  std::vector<MouseSample> buttons;  ///< of the 3D mouse, where they change
};
RecordedUnit recorded_unit(RecordingOnDisk recording);

}  // namespace headpin::devices
