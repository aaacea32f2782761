#include <cstdlib>
#include <stdexcept>

#include "scene/looks/skittle_mesh.h"
#include "scene/play/session.h"
#include "scene/stage/read_scenario.h"

using namespace headpin;

namespace {

class NoSamples : public devices::Source {
 public:
  void poll(Time, std::vector<devices::Sample>&) override {}
  bool exhausted() const override { return true; }
};

}  // namespace

// Whatever a scenario says: it is refused in a short sentence that names the file, or it is written
// and read back to the same text, and a session of it runs.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  scene::Scenario scenario;
  try {
    scenario = scene::parse_scenario(text, "fuzz.toml");
  } catch (const std::invalid_argument& error) {
    const std::string_view what = error.what();
    if (!what.starts_with("fuzz.toml") || what.size() > 1000) std::abort();
    return 0;
  }
  const std::string written = scene::to_toml(scenario);
  if (scene::to_toml(scene::scenario_of_trial(written, "fuzz.lcmlog")) != written) std::abort();
  scene::smooth_outline(scenario.skittle.profile);
  if (scenario.rack.spots.size() > 100) return 0;  // for the sake of time
  scene::Session session = scene::make_session(scenario);
  NoSamples source;
  for (int tick = 0; tick < 3; ++tick) scene::advance(session, source);
  return 0;
}
