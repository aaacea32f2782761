#include <cstdlib>

#include "devices/base/sources.h"
#include "scene/record/file.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "scene/record/state_change.h"

using namespace headpin;

namespace {

/// A state that can be told by what is new in it comes back as it was.
void expect_told(const scene::TickState& state, scene::StateHistory& writing,
                 scene::StateHistory& reading) {
  const std::optional<scene::StateChange> change = writing.change_to(state);
  if (!change) {
    writing.begin(state);
    reading.begin(state);
    return;
  }
  devices::Buffer bytes, expected, found;
  encode(*change, bytes);
  const auto again = scene::decode(scene::kStateChangeChannel, bytes);
  if (!again) std::abort();
  const auto* told = reading.go_on(std::get<scene::StateChange>(*again));
  if (!told) std::abort();
  encode(state, expected);
  encode(*told, found);
  if (expected != found) std::abort();
}

}  // namespace

// Whatever a log holds: read_log comes back, and all it lets through can be written, read again
// and replayed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const scene::Trial trial = scene::read_log({data, size});

  devices::Buffer bytes;
  for (const devices::Sample& sample : trial.samples) {
    std::visit([&](const auto& s) { encode(s, bytes); }, sample);
    const bool tracker = std::holds_alternative<devices::TrackerSample>(sample);
    const auto again =
        scene::decode(tracker ? devices::kTrackerChannel : devices::kMouseChannel, bytes);
    if (!again || !scene::plausible(*again)) std::abort();
  }
  scene::StateHistory writing, reading;
  for (const scene::TickState& state : trial.states) {
    encode(state, bytes);
    if (!scene::decode(scene::kStateChannel, bytes)) std::abort();
    expect_told(state, writing, reading);
  }

  const scene::TrialFile file({data, size});
  scene::TrialPlayer player(file);
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
