#pragma once

#include <cstdint>
#include <span>

namespace headpin::devices {

/// Bytes as they came or as they go; what they mean is somebody else's matter.
using Bytes = std::span<const std::uint8_t>;

/// The whole number that they are, most significant first; at most eight.
inline std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace headpin::devices
