#pragma once

#include <optional>
#include <string>

#include "devices/recordings/motion_files.h"

/// What `import` was told of a recording: options, and files that say the same.
namespace headpin::apps {

struct ImportOptions {
  std::optional<std::string> output;
  std::string file, scenario, participant, condition;
  std::string units, time_unit, heading = "release", hand = "auto", names, axes, rotations, columns;
  std::string transmitter, head, events;
  std::optional<int> which;
  bool force = false, json = false, explain = false, no_trigger = false;
};

/// The options of the reader.
/// @throws UsageError             an option that is not understood
/// @throws std::invalid_argument  a file of columns that is not understood, naming its line
/// @throws std::runtime_error     it cannot be read
devices::MotionOptions declared(const ImportOptions& options);

/// devices::read_motion with the options of declared().
/// @throws UsageError  an option that names columns which the file does not have; else as read_motion()
devices::MotionRecording read_declared(const std::string& file,
                                       const devices::MotionOptions& motion);

/// What is understood of the columns of a file whose format has some; throws as read_declared().
devices::TableFindings inspect_declared(const std::string& file,
                                        const devices::MotionOptions& motion);

/// The options that make one reading of another, such as "--units cm --axes RSA".
std::string options_between(const devices::Reading& was, const devices::Reading& is);

/// A file for --columns, to edit: the columns that are used, units, axes and rotations.
/// @param names  of all columns, for a table that is not understood
std::string mapping_text(const std::string& file, const devices::ToldColumns& columns,
                         const std::vector<std::string>& names,
                         const devices::MotionRecording* recording);

}  // namespace headpin::apps
