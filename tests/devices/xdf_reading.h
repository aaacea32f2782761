#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "devices/recordings/xdf_file.h"

namespace headpin::devices {

/// The bytes of a file that outlives the result.
inline XdfBytes bytes_in(const std::string& file) {
  return {file.size(), [&file](std::size_t at, std::size_t count) {
            at = std::min(at, file.size());
            return std::span(reinterpret_cast<const std::uint8_t*>(file.data()) + at,
                             std::min(count, file.size() - at));
          }};
}

inline XdfFile read_all_streams(const std::string& file) {
  return read_xdf(bytes_in(file), "x.xdf", [](const XdfStream&) { return true; });
}

}  // namespace headpin::devices
