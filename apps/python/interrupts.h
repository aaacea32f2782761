#pragma once

#include <chrono>

#include <pybind11/pybind11.h>

namespace headpin::python {

/// Looks for Ctrl-C in a long computation that has released the GIL.
class Interrupts {
 public:
  /// To be called often: looks about ten times a second.
  /// @throws pybind11::error_already_set  KeyboardInterrupt, or what a signal handler raises
  void check() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    const pybind11::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace headpin::python
