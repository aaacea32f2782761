#pragma once

#include "scene/record/trial.h"

namespace headpin::scene {

/// The destination of a trial while it is made: a file, or LCM.
class TrialSink {
 public:
  virtual ~TrialSink() = default;

  /// @throws std::runtime_error  when nothing more can be written
  virtual void write(const devices::Sample& sample) = 0;
  virtual void write(const Event& event) = 0;
  virtual void write(const TickState& state) = 0;
  virtual void write(const FrameRecord& frame) = 0;
  /// Whoever needs no replays that start in the middle may drop it.
  virtual void write(const Snapshot&) {}

  /// The end event, which counts the messages before it.
  virtual void close() = 0;

  /// @throws std::runtime_error  when the written file has vanished
  virtual void require_kept() const {}
};

}  // namespace headpin::scene
