#pragma once

#include <string>

namespace headpin::scene {

/// The bundled trial.
inline const std::string kDemo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

}  // namespace headpin::scene
