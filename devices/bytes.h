#pragma once

#include <cstdint>
#include <span>

namespace headpin::devices {

/// Bytes as they came or as they go; what they mean is somebody else's matter.
using Bytes = std::span<const std::uint8_t>;

}  // namespace headpin::devices
