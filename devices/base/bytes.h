#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace headpin::devices {

/// Conversions between numbers and bytes.
using Bytes = std::span<const std::uint8_t>;

/// The whole number of at most eight bytes, the most significant first.
inline std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Appends a number as a varint: 7 bits a byte, the lowest first, top bit set in all but the last.
inline void append_varint(std::uint64_t number, std::vector<std::uint8_t>& out) {
  for (; number >= 0x80; number >>= 7) out.push_back(static_cast<std::uint8_t>(number | 0x80));
  out.push_back(static_cast<std::uint8_t>(number));
}

/// Removes a varint from the front of `bytes`; nothing if there is no complete one of at most 64
/// bits.
inline std::optional<std::uint64_t> take_varint(Bytes& bytes) {
  std::uint64_t number = 0;
  for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
    const std::uint8_t byte = bytes.front();
    if (shift == 63 && byte > 1) return std::nullopt;
    bytes = bytes.subspan(1);
    number |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return number;
  }
  return std::nullopt;
}

/// Zigzag encoding: 0, -1, 1, -2 become 0, 1, 2, 3.
inline std::uint64_t zigzag(std::int64_t number) {
  return static_cast<std::uint64_t>(number) << 1 ^ static_cast<std::uint64_t>(number >> 63);
}
inline std::int64_t unzigzag(std::uint64_t number) {
  return static_cast<std::int64_t>(number >> 1 ^ (0 - (number & 1)));
}

}  // namespace headpin::devices
