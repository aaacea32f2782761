#include <cstdlib>
#include <stdexcept>

#include "devices/recordings/xdf_motion.h"
#include "scene/record/xdf.h"

using namespace headpin;

namespace {

void look_at_motion(const devices::XdfBytes& bytes) {
  const devices::MotionTracks read = devices::parse_xdf_motion(bytes, "fuzz.xdf", {});
  const devices::MotionRecording recording = devices::recording_of(read, {}, "fuzz.xdf");
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    if (i > 0 && recording.times[i] <= recording.times[i - 1]) std::abort();
    for (const auto* track : {&recording.head, &recording.left_hand, &recording.right_hand}) {
      if (track->empty()) continue;
      const Pose& X = track->at(i);
      if (!X.p.allFinite() || !(std::abs(X.q.norm() - 1.0) < 1e-3)) std::abort();
    }
  }
}

void look_at_trial(const devices::XdfBytes& bytes) {
  for (const devices::Sample& sample : scene::read_xdf_trial(bytes, "fuzz.xdf").samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (tracker && !tracker->X_TS.p.allFinite()) std::abort();
  }
}

}  // namespace

// Whatever a file holds: it is refused, or its samples are finite, and times of motion advance.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const devices::XdfBytes bytes = {size, [&](std::size_t at, std::size_t count) {
                                     at = std::min(at, size);
                                     return std::span(data + at, std::min(count, size - at));
                                   }};
  for (const auto look : {look_at_motion, look_at_trial}) {
    try {
      look(bytes);
    } catch (const std::invalid_argument&) {
    }
  }
  try {
    devices::inspect_xdf(bytes, "fuzz.xdf", {});
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
