#pragma once

#include <memory>
#include <utility>

#include "scene/play/run.h"
#include "scene/record/log.h"
#include "scene/record/sink.h"

namespace headpin::scene {

/// A trial's header, with the session's scenario and bodies.
TrialHeader header_of(TrialHeader header, const Session& session);

/// Writes a session as a trial: its samples, its events, every state, and a snapshot every ten
/// seconds.
class TrialWriter : public Observer {
 public:
  /// @param sink  destination, with a header from header_of()
  explicit TrialWriter(std::unique_ptr<TrialSink> sink) : sink_(std::move(sink)) {}

  void tick(const Session& session) override;
  /// Writes what belongs to no tick: a drawn frame, or an event from before the simulation.
  void write(const FrameRecord& frame) { sink_->write(frame); }
  void write(const Event& event) { sink_->write(event); }
  /// @throws std::runtime_error  when the file was changed or removed by others
  void require_kept() const { sink_->require_kept(); }
  /// Writes the way of a ball that is still on it, the energy ledger and the game hash, and gives the file its final name.
  void close(const Session& session);

 private:
  std::unique_ptr<TrialSink> sink_;
  TickState state_;
};

}  // namespace headpin::scene
