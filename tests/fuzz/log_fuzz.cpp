#include <cstdlib>

#include "devices/trial/file.h"
#include "devices/trial/log.h"
#include "devices/trial/messages.h"
#include "devices/trial/sources.h"
#include "devices/trial/state_change.h"

using namespace headpin;

namespace {

/// A state that can be told by what is new in it comes back as it was.
void expect_told(const devices::TickState& state, devices::StateHistory& writing,
                 devices::StateHistory& reading) {
  const std::optional<devices::StateChange> change = writing.change_to(state);
  if (!change) {
    writing.begin(state);
    reading.begin(state);
    return;
  }
  devices::Buffer bytes, expected, found;
  devices::encode(*change, bytes);
  const auto again = devices::decode(devices::kStateChangeChannel, bytes);
  if (!again) std::abort();
  const auto* told = reading.go_on(std::get<devices::StateChange>(*again));
  if (!told) std::abort();
  devices::encode(state, expected);
  devices::encode(*told, found);
  if (expected != found) std::abort();
}

}  // namespace

// Whatever a log holds: read_log comes back, and all it lets through can be written, read again
// and replayed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const devices::Trial trial = devices::read_log({data, size});

  devices::Buffer bytes;
  for (const devices::Sample& sample : trial.samples) {
    std::visit([&](const auto& s) { devices::encode(s, bytes); }, sample);
    const bool tracker = std::holds_alternative<devices::TrackerSample>(sample);
    const auto again =
        devices::decode(tracker ? devices::kTrackerChannel : devices::kMouseChannel, bytes);
    if (!again || !devices::plausible(*again)) std::abort();
  }
  devices::StateHistory writing, reading;
  for (const devices::TickState& state : trial.states) {
    devices::encode(state, bytes);
    if (!devices::decode(devices::kStateChannel, bytes)) std::abort();
    expect_told(state, writing, reading);
  }

  const devices::TrialFile file({data, size});
  devices::TrialPlayer player(file);
  std::int64_t samples = 0;
  std::vector<devices::Sample> some;
  while (const std::optional<Time> time = player.next_time()) {
    some.clear();
    player.poll(*time, some);
    samples += static_cast<std::int64_t>(some.size());
  }
  if (samples != static_cast<std::int64_t>(trial.samples.size())) std::abort();
  devices::ReplaySource source(trial.samples);
  std::vector<devices::Sample> out;
  source.poll(source.end(), out);
  if (out.size() != trial.samples.size() || !source.exhausted()) std::abort();
  return 0;
}
