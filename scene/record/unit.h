#pragma once

#include <memory>

#include "devices/recordings/recorded_motion.h"
#include "scene/record/file.h"

namespace headpin::scene {

/// What the emulator measures when it plays a trial on disk.
/// @throws std::runtime_error  when the file is another by now, also while it is played
devices::RecordedUnit recorded_unit(std::shared_ptr<const TrialFile> file);

}  // namespace headpin::scene
