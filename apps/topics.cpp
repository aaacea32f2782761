#include "apps/topics.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "scene/scenario/files.h"

namespace headpin::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::array kTopics = {
    Topic{"tutorial", "tutorial.md", "Tutorial: from the first throw to a figure for a paper"},
    Topic{"tutorial-recording", "tutorial-recording.md", "Tutorial: your own recording"},
    Topic{"tutorial-pins", "tutorial-pins.md", "Tutorial: your own pins"},
    Topic{"tutorial-driver", "tutorial-driver.md",
          "Tutorial: your own driver, tried on the emulator"},
    Topic{"conditions", "guides/replay.md", "Replay a trial and compare conditions"},
    Topic{"page", "guides/page.md", "One page to look at and to send"},
    Topic{"pictures", "guides/frames.md", "See what the participant saw"},
    Topic{"sound", "guides/sound.md", "Hear what happens"},
    Topic{"recordings", "guides/recordings.md", "Bring in your recording"},
    Topic{"scenarios", "guides/scenes.md", "Make your own scene"},
    Topic{"meshes", "guides/meshes.md", "Use your own meshes"},
    Topic{"sessions", "guides/live.md", "A live session"},
    Topic{"browser", "guides/play.md",
          "Play in a browser: with a headset, a mouse, a finger or keys"},
    Topic{"network", "guides/serve.md", "Let people with headsets play, and record them here"},
    Topic{"lcm-spy", "guides/spy.md", "See the channels in lcm-spy"},
    Topic{"trackers", "guides/trackers.md", "Add a tracker"},
    Topic{"fastrak", "guides/fastrak.md", "Emulate a Fastrak"},
    Topic{"games", "guides/games.md", "A game and its rules"},
    Topic{"participants", "guides/participants.md", "Virtual participants"},
    Topic{"study", "experiment.md", "The experiment: plan, play, ask, score, analyse, share"},
    Topic{"sweeps", "guides/sweeps.md", "Many replays: sweeps"},
    Topic{"what-if", "guides/whatif.md", "What if the ball had left the hand differently?"},
    Topic{"seen", "guides/apart.md", "What the eyes can tell apart"},
    Topic{"tables", "guides/tables.md", "Tables and plots"},
    Topic{"scripts", "guides/scripts.md", "Use headpin in scripts"},
    Topic{"python", "guides/python.md", "Use headpin from Python"},
    Topic{"engine", "guides/engine.md", "The engine as a library"},
    Topic{"install", "guides/install.md", "Install headpin"},
    Topic{"cite", "guides/cite.md", "Cite headpin"},
    Topic{"keys", "scenario.md", "Every key of a scenario"},
    Topic{"rules", "rules.md", "Rules of the step and the game, by number"},
    Topic{"events", "events.md", "Every kind of event"},
    Topic{"json", "json.md", "Every key of `--json`"},
    Topic{"columns", "tables.md", "Every column of `headpin export`"},
    Topic{"channels", "channels.md", "LCM channels and types"},
    Topic{"coordinates", "frames.md", "Frames, units, signs"},
    Topic{"decisions", "decisions.md", "What `synthesize` and `import` decide"},
    Topic{"files", "files.md", "What happens to files"},
    Topic{"hashes", "hash-and-ledger.md", "What a hash means, and the energy ledger"},
    Topic{"physics", "physics.md", "The physics in two pages"},
    Topic{"paper", "paper.md", "The paper, claim by claim"},
    Topic{"cells", "cells.md", "All eight conditions of Table 1 can be played"},
    Topic{"pins", "pins.md", "How the pins fall"},
    Topic{"release", "release.md", "How the ball leaves the hand"},
    Topic{"threads", "threads.md", "Threads and processes"},
    Topic{"performance", "performance.md", "Performance"},
};

}  // namespace

std::span<const Topic> topics() {
  return kTopics;
}

std::optional<Topic> find_topic(std::string_view name) {
  const auto found = std::ranges::find(kTopics, name, &Topic::name);
  if (found == kTopics.end()) return std::nullopt;
  return *found;
}

fs::path docs_folder() {
  std::error_code none;
  for (const fs::path& data : scene::data_folders()) {
    const fs::path installed = (data / "../doc/headpin/docs").lexically_normal();
    if (fs::is_directory(installed, none)) return installed;
    const fs::path sources = fs::weakly_canonical(data, none).parent_path() / "docs";
    if (fs::is_directory(sources, none)) return sources;
  }
  return "docs";
}

}  // namespace headpin::apps
