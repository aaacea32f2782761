#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace headpin::scene {

/// What may be spent on a piece of work.
struct Limits {
  unsigned cpu_s = 1;                ///< of processor time, whole seconds
  std::size_t memory = 256'000'000;  ///< beyond what this process has [bytes]
};

/// Does in a process of its own what a foreign file may bring to crash, hang or swallow all memory.
///
/// @param work  from bytes it knows of to bytes; what it throws is thrown here
/// @throws std::runtime_error  with the reason: what `work` threw, a limit that was passed, or a crash
std::string apart(const std::function<std::string()>& work, const Limits& limits);

}  // namespace headpin::scene
