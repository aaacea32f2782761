#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace headpin::scene {

/// Limits of resources.
struct Limits {
  unsigned cpu_s = 1;                ///< of processor time, whole seconds
  std::size_t memory = 256'000'000;  ///< beyond what this process has [bytes]
};

/// Runs work in a separate process, because a foreign file may make it crash, hang or use all
/// memory.
///
/// @param work  returns bytes; its exceptions are thrown here
/// @throws std::runtime_error  with the reason: an exception of `work`, an exceeded limit, or a
///                             crash
std::string apart(const std::function<std::string()>& work, const Limits& limits);

}  // namespace headpin::scene
