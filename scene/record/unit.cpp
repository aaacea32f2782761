#include "scene/record/unit.h"

#include <utility>

namespace headpin::scene {

devices::RecordedUnit recorded_unit(std::shared_ptr<const TrialFile> file) {
  devices::RecordingOnDisk recording;
  for (const auto& [device, summary] : file->summary().devices) {
    recording.last[device] = summary.last;
  }
  recording.read = [file = std::move(file)]() {
    return [file, items = std::make_shared<TrialItems>(*file)]() -> std::optional<devices::Sample> {
      while (std::optional<TrialFile::Item> item = items->next()) {
        if (auto* sample = std::get_if<devices::Sample>(&*item)) return std::move(*sample);
      }
      return std::nullopt;
    };
  };
  return devices::recorded_unit(std::move(recording));
}

}  // namespace headpin::scene
