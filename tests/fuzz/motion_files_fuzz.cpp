#include <cstdlib>
#include <stdexcept>

#include "devices/recordings/motion_bids.h"
#include "devices/recordings/motion_files.h"
#include "devices/recordings/uxf.h"
#include "devices/recordings/vrpn_log.h"

using namespace headpin;

namespace {

void look_at(const devices::PoseTrack& track) {
  Time last = Time::min();
  for (const auto& sample : track.samples()) {
    if (sample.time <= last || !sample.value.p.allFinite()) std::abort();
    if (!(std::abs(sample.value.q.norm() - 1.0) < 1e-3)) std::abort();
    last = sample.time;
  }
}

}  // namespace

// The first byte says which reader; whatever the rest is: refused, or finite poses in time's order.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    std::vector<std::string> notes;
    if (data[0] % 3 == 0) look_at(devices::parse_uxf(text, "fuzz", notes));
    if (data[0] % 3 == 1) {
      const auto tracks = devices::parse_vrpn({data + 1, size - 1}, "fuzz", 1.0, notes);
      for (const auto& [name, track] : tracks) look_at(track);
    }
    if (data[0] % 3 == 2) {  // channels, a zero byte, motion
      const std::string_view channels = text.substr(0, text.find('\0'));
      const devices::BidsFrame frame{.axes = "ALS", .rotation_order = "ZXY", .rate_hz = 100.0};
      const std::string_view motion = text.substr(std::min(text.size(), channels.size() + 1));
      for (const auto& [name, track] :
           devices::parse_motion_bids(motion, channels, "fuzz", frame).tracks) {
        look_at(track);
      }
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
