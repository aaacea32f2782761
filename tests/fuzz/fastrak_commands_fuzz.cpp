#include <algorithm>
#include <cstdlib>

#include "devices/fastrak/emulator.h"

using namespace headpin;

// Whatever a host sends, whenever: the unit answers within its buffers, and after a power-cycle it
// gives its status. A byte of 0xF0 to 0xFF lets time pass, 0.5 ms to 2 s.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 4096) return 0;
  devices::FastrakEmulatorOptions options;
  options.early_firmware = true;
  options.boot_time = std::chrono::milliseconds(100);  // shorter than the unit's, to try more
  options.save_time = std::chrono::milliseconds(50);
  options.faults = devices::parse_faults("garbage=0.1,damage=0.1,dropout=0.1,deaf=1");
  devices::FastrakEmulator unit(options, devices::circling_motion);
  Time now{};
  const auto pass = [&](Time span, std::string* heard) {
    // A short look now and then is enough: time passes in big steps.
    for (int step = 0; step < 16; ++step) {
      now += span / 16;
      const devices::Bytes due = unit.due(now);
      if (due.size() > 2048) std::abort();
      if (heard) heard->append(due.begin(), due.end());
      unit.taken(due.size());
    }
  };
  Time passed{};
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] >= 0xF0) {
      const Time span{500 << std::min(data[i] & 0x0F, 12)};
      if ((passed += span) < std::chrono::seconds(4)) pass(span, nullptr);
    } else {
      unit.receive({data + i, 1}, now);
    }
  }
  unit.power_cycle(now);
  pass(std::chrono::milliseconds(200), nullptr);
  constexpr std::uint8_t kStop[] = {0x11, 'o', '1', '1', '5', '2', ',', 'N', ',', '8', '\r', 'c'};
  unit.receive(kStop, now);
  pass(std::chrono::seconds(1), nullptr);
  std::string status;
  constexpr std::uint8_t kStatus[] = {'S', 'S'};  // it may be deaf to the first
  unit.receive(kStatus, now);
  pass(std::chrono::milliseconds(200), &status);
  if (status.size() < 55 || !devices::decode_status(status.substr(0, 55))) std::abort();
  return 0;
}
