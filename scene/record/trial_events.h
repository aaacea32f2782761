#pragma once

#include <functional>
#include <string_view>

#include "devices/log/event_log.h"
#include "scene/record/messages.h"
#include "scene/record/sink.h"
#include "scene/record/state_change.h"
#include "scene/record/trial.h"

/// A trial as the events of an LCM log, for whoever writes them.
namespace headpin::scene {

/// How states are stored: all of them whole, or most of them as changes (state_change_t).
enum class States { all, changes };

/// The header with this program's format, version, commit and schema.
TrialHeader stamped(TrialHeader header, States states = States::all);

/// Encodes a trial, each message as one event, in order.
class TrialEvents : public TrialSink {
 public:
  struct Options {
    States states = States::all;
    Time epoch{};  ///< added to the stamps of LCM's event headers; wall clock of time 0, if any
  };
  /// Takes an event; channel and data are valid during the call.
  using Take = std::function<void(const devices::LogEvent& event)>;

  /// Gives the header, with format, software and schema put in, to `take`.
  TrialEvents(const TrialHeader& header, const Options& options, Take take);

  /// @throws  what `take` throws
  void write(const devices::Sample& sample) override;
  void write(const Event& event) override;
  void write(const TickState& state) override;
  void write(const FrameRecord& frame) override;
  void write(const Snapshot& snapshot) override;
  void close() override;

 private:
  template <typename T>
  void give(std::string_view channel, Time time, const T& message);
  std::optional<StateChange> change_to(const TickState& state);

  Options options_;
  Take take_;
  devices::Buffer bytes_;    // of the current message
  std::int64_t number_ = 0;  // of events
  std::int64_t count_ = 0;   // of messages
  Time last_{};
  StateHistory states_;
  Time whole_due_{};  // time of the next whole state
};

}  // namespace headpin::scene
