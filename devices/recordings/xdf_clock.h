#pragma once

#include <span>
#include <string>
#include <vector>

#include "devices/recordings/xdf_file.h"

namespace headpin::devices {

/// The times of a stream's samples on the recorder's clock, which all streams share.
///
/// As pyxdf does it: a line is fitted to the measured offsets, from the offsets that stand between two
/// resets of the stream's clock, and its value at each sample is added. Outliers among the measurements
/// have little weight: the loss is Huber's, quadratic up to 0.1 ms and linear above. The sampling rate
/// is not used: times that jitter stay as they are.
///
/// @param notes  gets a sentence for each reset of the clock
std::vector<double> synchronised(std::span<const double> times,
                                 std::span<const XdfClockOffset> offsets,
                                 std::vector<std::string>& notes);

}  // namespace headpin::devices
