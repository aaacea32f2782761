#pragma once

#include <string_view>

#include "base/math.h"

namespace headpin::scene {

/// When a session ended, as an exported trial tells it (`end_s`).
///
/// @param end_s  [s]
/// @param where  the file, for the message
/// @throws std::invalid_argument  for what is no time of a session: no number, or 4e9 s and more
Time end_time(double end_s, std::string_view where);

}  // namespace headpin::scene
