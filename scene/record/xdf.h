#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "devices/recordings/xdf_file.h"
#include "devices/recordings/xdf_writer.h"
#include "scene/record/file.h"

/// A trial as XDF, and back.
///
/// A stream is a receiver, the 3D mouse, or the events: their kinds as markers, and their bodies, details
/// and numbers as three more streams with the same times. Labels of channels are the columns of docs/tables.md.
/// Times are those of the trial's clock. The header of the file has that of the trial.
namespace headpin::scene {

/// For the headers; nothing where it is unknown.
struct XdfSetting {
  std::optional<Pose> X_WT = {};  ///< pose of the transmitter in the world
  std::optional<Time> end = {};   ///< of the session, which may go on after its last sample
};

/// Writes samples and events in one pass through the trial; states and frames are left out.
///
/// @param put     takes the bytes of the file
/// @return        the streams
std::vector<devices::XdfWriter::Count> write_xdf_trial(
    const TrialFile& trial, const XdfSetting& setting,
    const std::function<void(std::string_view)>& put);

/// What can be made again of such a file.
struct XdfTrial {
  TrialHeader header;
  std::vector<devices::Sample> samples;  ///< in the order of the trial
  std::vector<Event> events;  ///< those outside the simulation: a replay makes the others again
  std::vector<std::string> notes;  ///< what is damaged or missing
  Time end{};                      ///< of the session; 0 if the file does not tell or is cut
  bool complete = true;            ///< false: the trial was not when it was exported
};

/// Whether write_xdf_trial() wrote a file.
bool is_xdf_trial(const devices::XdfBytes& bytes);

/// @throws std::invalid_argument  as read_xdf(); naming a stream that is not as it was written
XdfTrial read_xdf_trial(const devices::XdfBytes& bytes, std::string_view where);

}  // namespace headpin::scene
