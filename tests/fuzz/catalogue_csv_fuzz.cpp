#include <cstdlib>
#include <stdexcept>

#include "devices/recordings/catalogue_csv.h"

using namespace headpin;

// Whatever a file holds: it is refused, or every pose is finite and time advances.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const devices::MotionRecording recording = devices::parse_catalogue_csv(text, "fuzz.csv", 0.01);
    for (std::size_t i = 0; i < recording.times.size(); ++i) {
      if (i > 0 && recording.times[i] <= recording.times[i - 1]) std::abort();
      for (const auto* track : {&recording.head, &recording.left_hand, &recording.right_hand}) {
        const Pose& X = track->at(i);
        if (!X.p.allFinite() || !(std::abs(X.q.norm() - 1.0) < 1e-3)) std::abort();
      }
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
