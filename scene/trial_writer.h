#pragma once

#include <string>

#include "devices/log.h"
#include "scene/run.h"

namespace headpin::scene {

/// Writes a session as a trial: what it took in, what happened, and every state.
class TrialWriter : public Observer {
 public:
  /// @param header  participant, condition, seed; the session's scenario and bodies are put in
  /// @throws std::runtime_error  as devices::Recorder
  TrialWriter(const std::string& path, devices::TrialHeader header, const Session& session,
              devices::Recorder::Options options);

  void tick(const Session& session) override;
  /// What no tick brings: a frame that was drawn, an event from before the simulation.
  void write(const devices::FrameRecord& frame) { recorder_.write(frame); }
  void write(const devices::Event& event) { recorder_.write(event); }
  /// @throws std::runtime_error  when the file is no longer what was written
  void require_kept() const { recorder_.require_kept(); }
  /// Writes the energy ledger and gives the file its final name.
  void close(const Session& session);

 private:
  devices::Recorder recorder_;
  devices::TickState state_;
};

}  // namespace headpin::scene
