#pragma once

#include <chrono>
#include <stdexcept>

#include "apps/python/module.h"

/// What long calls need that run without the interpreter's lock.
namespace headpin::python {

/// Looks for Ctrl-C, ten times a second.
class Interrupts {
 public:
  /// Call it often, without the lock.
  /// @throws py::error_already_set  where a signal handler raises, as that of Ctrl-C does
  void check() {
    const Clock::time_point now = Clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point next_ = Clock::now() + std::chrono::milliseconds(100);
};

/// Marks an object whose call runs without the lock, until the end of the scope.
///
/// The object refuses all other calls until then, of other threads and of functions that the call
/// itself calls. Made and destroyed with the lock.
class InUse {
 public:
  explicit InUse(bool& mark) : mark_(mark) { mark_ = true; }
  ~InUse() { mark_ = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  bool& mark_;
};

/// @param what  "world"
/// @throws std::runtime_error  for an object that is in use
inline void require_free(bool in_use, const char* what) {
  if (!in_use) return;
  throw std::runtime_error(std::string(what) +
                           ": is making a step in another call; expected to be called after it");
}

}  // namespace headpin::python
