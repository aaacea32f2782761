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

  /// Appends the samples that a session may use by `now` (`available`, sources.h) and that were not
  /// handed out before, in the order of that time (equal times: in the order they came). A device
  /// may hand some out early: MergedSource holds them back. Never blocks.
  virtual void poll(Time now, std::vector<Sample>& out) = 0;

  /// True when no sample will ever come again.
  virtual bool exhausted() const = 0;
};

}  // namespace headpin::devices
