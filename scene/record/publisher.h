#pragma once

#include <cstdint>
#include <optional>

#include "devices/lcm/link.h"
#include "scene/record/sink.h"

/// Publishes trials over LCM.
namespace headpin::scene {

/// @throws std::runtime_error  when it cannot be sent, as LcmLink::publish
void publish(devices::LcmLink& link, const TrialHeader& header);
void publish(devices::LcmLink& link, const Event& event);

/// Publishes a trial while it is made. The header and the event drawn_by are repeated every second
/// for later listeners.
class TrialPublisher : public TrialSink {
 public:
  /// @param link    must outlive this
  /// @param header  completed as by stamped()
  TrialPublisher(devices::LcmLink& link, const TrialHeader& header);

  void write(const devices::Sample& sample) override;
  void write(const Event& event) override;
  void write(const TickState& state) override;
  void write(const FrameRecord& frame) override;
  void close() override;

 private:
  template <typename T>
  void send(Time time, const T& message);

  devices::LcmLink& link_;
  TrialHeader header_;
  std::optional<Event> drawn_by_;
  std::int64_t count_ = 1;  ///< of messages; repeated ones count once
  Time last_{}, next_header_{};
};

}  // namespace headpin::scene
