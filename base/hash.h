#pragma once

#include <cstdint>

namespace headpin {

/// FNV-1a of bytes, 64 bits (draft-eastlake-fnv), to compare states and pictures.
class Fnv {
 public:
  void add(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001b3u; }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace headpin
