#pragma once

#include <memory>
#include <string>
#include <utility>

#include "devices/trial/log.h"
#include "scene/play/run.h"

namespace headpin::scene {

/// A trial's header with the session's scenario and bodies put in.
devices::TrialHeader header_of(devices::TrialHeader header, const Session& session);

/// Writes a session as a trial: what it took in, what happened, and every state.
class TrialWriter : public Observer {
 public:
  /// @param header  participant, condition, seed; the session's scenario and bodies are put in
  /// @throws std::runtime_error  as devices::Recorder
  TrialWriter(const std::string& path, devices::TrialHeader header, const Session& session,
              devices::Recorder::Options options);

  /// @param sink  begun with header_of() the session
  explicit TrialWriter(std::unique_ptr<devices::TrialSink> sink) : sink_(std::move(sink)) {}

  void tick(const Session& session) override;
  /// What no tick brings: a frame that was drawn, an event from before the simulation.
  void write(const devices::FrameRecord& frame) { sink_->write(frame); }
  void write(const devices::Event& event) { sink_->write(event); }
  /// @throws std::runtime_error  when the file is no longer what was written
  void require_kept() const { sink_->require_kept(); }
  /// Writes the energy ledger and the game hash and gives the file its final name.
  void close(const Session& session);

 private:
  std::unique_ptr<devices::TrialSink> sink_;
  devices::TickState state_;
};

}  // namespace headpin::scene
