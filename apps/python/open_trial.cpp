#include "apps/python/open_trial.h"

#include <filesystem>

#include "apps/python/reading.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"

namespace headpin::python {

namespace {

/// The path from the root; standard input stays what it is.
std::string whole_path(const std::string& path) {
  if (path == "-") return path;
  std::error_code none;  // without a working folder, no relative path can be opened
  const std::filesystem::path whole = std::filesystem::absolute(path, none);
  return whole.empty() ? path : whole.string();
}

}  // namespace

OpenTrial::OpenTrial(const std::string& path, Time longest_gap)
    : path_(path),
      file_path_(whole_path(path)),
      file_(reading<DamagedTrial>(path, [&] { return scene::TrialFile(path); })) {
  try {
    file_.require_trial(longest_gap);
  } catch (const std::runtime_error& error) {
    throw DamagedTrial(error.what());
  }
}

const scene::Scenario& OpenTrial::scenario() {
  if (!scenario_) scenario_ = scene::scenario_of_trial(summary().header.scenario, path_);
  return *scenario_;
}

Run::Run(OpenTrial& trial, const scene::Scenario& scenario, const engine::Response* own,
         scene::TrialPlayer::Beside beside)
    : session(scene::make_session(scenario)),
      source(trial.file(), beside),
      ticks(scene::tick_count(trial.summary(), scenario.rates.physics_hz,
                              trial.scenario().rates.physics_hz)) {
  if (trial.summary().sample_count == 0) {
    throw DamagedTrial(trial.path() + ": expected samples of a tracker, found none");
  }
  if (own != nullptr) scene::set_response(session, *own);
}

void Run::go(std::span<scene::Observer* const> seen_by, const std::function<bool()>& enough) {
  Interrupts interrupts;
  scene::NoPace pace;
  scene::run(session, source, pace, seen_by, [&](const scene::Session& s) {
    interrupts.check();
    return s.tick >= ticks || (enough && enough());
  });
}

}  // namespace headpin::python
