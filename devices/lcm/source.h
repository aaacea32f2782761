#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "devices/base/source.h"
#include "devices/lcm/intake.h"
#include "devices/lcm/link.h"

namespace headpin::devices {

/// Receives samples that others publish on TRACKER and MOUSE3D.
class LcmSource : public Source {
 public:
  /// @param link    must outlive this
  /// @param clocks  of the session, which date the samples; must outlive this
  /// @param queue   largest number of waiting samples
  /// @throws std::runtime_error  for the link to a log
  LcmSource(LcmLink& link, Clocks& clocks, std::size_t queue = 4096);
  ~LcmSource() override;

  /// Uses the arrival times on this clock from now on, instead of the times of the polls.
  void use_clock(std::function<Time()> clock) { clock_ = std::move(clock); }

  /// Discards the messages so far. Messages that waited while a session was prepared do not show
  /// the publishers' clocks.
  void drain();

  /// Discards the messages so far, and starts a thread that reads.
  void listen();

  /// Reads the messages that have arrived, without waiting. Without a clock, they arrived at `now`. A
  /// time after the arrival is harmless; an earlier one would make all samples too early.
  ///
  /// @throws std::runtime_error  when LCM stops, as a tcpq server does
  void receive(Time now);

  void poll(Time now, std::vector<Sample>& out) override;
  /// Never: what ends is an error of receive().
  bool exhausted() const override { return false; }

  const LcmIntake& intake() const { return intake_; }

 private:
  struct Wire;
  bool take_next();
  void take(LcmMessage message, Time at);

  LcmLink& link_;
  std::size_t queue_;
  LcmIntake intake_;
  std::function<Time()> clock_;
  Time now_{};  // of receive()
  bool draining_ = false;
  std::unique_ptr<Wire> wire_;
};

}  // namespace headpin::devices
