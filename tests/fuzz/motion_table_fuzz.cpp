#include <cstdlib>
#include <stdexcept>

#include "devices/recordings/marker_file.h"
#include "devices/recordings/motion_files.h"
#include "devices/recordings/table_motion.h"

using namespace headpin;

// Whatever a file holds: it is refused, or every pose is finite and time advances.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    devices::inspect_table(text, "fuzz.csv", {});
  } catch (const std::invalid_argument&) {
  }
  try {
    devices::parse_markers(text, "fuzz.csv", 1.0);
  } catch (const std::invalid_argument&) {
  }
  try {
    const devices::MotionTracks read = devices::parse_motion_table(text, "fuzz.csv", {});
    const devices::MotionRecording recording = devices::recording_of(read, {}, "fuzz.csv");
    for (std::size_t i = 0; i < recording.times.size(); ++i) {
      if (i > 0 && recording.times[i] <= recording.times[i - 1]) std::abort();
      for (const auto* track : {&recording.head, &recording.left_hand, &recording.right_hand}) {
        if (track->empty()) continue;
        const Pose& X = track->at(i);
        if (!X.p.allFinite() || !(std::abs(X.q.norm() - 1.0) < 1e-3)) std::abort();
      }
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
