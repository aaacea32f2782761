#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/import_options.h"
#include "scene/people/throw.h"

/// The throw of a recording that `import` was told to take.
namespace headpin::apps {

/// The recording of a throw, and the throwing hand.
struct Thrown {
  devices::MotionRecording recording;
  scene::Side side = scene::Side::right;
  std::size_t throws = 1;          ///< in the file
  std::vector<std::string> notes;  ///< parts of the file that were left out
};

/// The file, read as the options say it; throws as read_declared().
devices::MotionRecording recording_in(const ImportOptions& options, const scene::Hand& hand);

/// The throw of --throw, or the whole recording; with grab and release of --events.
/// @throws UsageError             the recording has fewer throws
/// @throws std::invalid_argument  no events, or times beyond the recording
Thrown thrown_in(devices::MotionRecording recording, const ImportOptions& options,
                 const scene::Hand& hand);

/// The file, in messages; of one of its throws also where its times begin.
std::string name_of(const ImportOptions& options, const Thrown& thrown);

/// Why a recording is no person's throw.
struct Refusal {
  std::string why;
  std::string remedy = {};  ///< options that would make it one, such as "--units cm"; may be empty
  bool gap = false;         ///< it has a gap, beside which there may be throws
};
std::optional<Refusal> refusal(const ImportOptions& options, const Thrown& thrown,
                               const scene::Hand& hand);

}  // namespace headpin::apps
