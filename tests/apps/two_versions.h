#pragma once

#include <filesystem>
#include <string>

#include "base/math.h"
#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"

namespace headpin {

constexpr double kTouchesRed = 0.5, kTouchesBlue = 1.5, kOfTwoVersions = 2.5;  // s

/// Writes a trial whose hand touches the red button, and then the blue one: true skittles, then
/// ellipsoids.
inline void write_two_versions(const std::filesystem::path& path) {
  scene::Scenario scenario =
      scene::load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  scenario.skittle.seen = scene::SeenSkittle::collider;
  scenario.collision.shape = scenario.version.red.shape = scene::SkittleShape::parts;
  scenario.version.blue.shape = scene::SkittleShape::ellipsoid;
  const scene::Rig& rig = scenario.rig;
  scene::TrialHeader header;
  header.scenario = scene::to_toml(scenario);
  scene::Recorder recorder(path, header);
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(60.0 * kOfTwoVersions); ++i) {
    const Time now = tick_time(i, 60);
    const auto give = [&](std::int64_t station, const Pose& X_TS) {
      devices::TrackerSample sample;
      sample.device_time = now;
      sample.sequence = i;
      sample.station = static_cast<std::int32_t>(station);
      sample.X_TS = X_TS;
      recorder.write(devices::Sample(sample));
    };
    Pose X_WH{Quat::Identity(), Vec3(0.0, -1.0, 1.2)};
    if (seconds(now) >= kTouchesRed) X_WH.p = scenario.version.red.button;
    if (seconds(now) >= kTouchesBlue) X_WH.p = scenario.version.blue.button;
    const Pose X_WD{Quat::Identity(), Vec3(0.0, -1.2, 1.7)};
    give(rig.head_station, rig.X_WT.inverse() * X_WD * rig.X_SD.inverse());
    give(rig.hand_station, rig.X_WT.inverse() * X_WH * rig.X_SH.inverse());
  }
  recorder.close();
}

}  // namespace headpin
