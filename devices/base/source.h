#pragma once

#include <vector>

#include "devices/base/sample.h"

namespace headpin::devices {

/// Sources of samples: a recording, LCM, a serial line, an emulator.
///
/// Live, emulated, imported and replayed sessions differ only in their Source.
class Source {
 public:
  virtual ~Source() = default;

  /// Appends all samples measured up to and including `now` that were not handed out before, in
  /// the order of their device time (equal times: in the order they came). Never blocks.
  virtual void poll(Time now, std::vector<Sample>& out) = 0;

  /// True when no sample will ever come again.
  virtual bool exhausted() const = 0;
};

}  // namespace headpin::devices
