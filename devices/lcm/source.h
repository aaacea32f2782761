#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "devices/base/clock_offset.h"
#include "devices/base/genlock.h"
#include "devices/base/sequence_count.h"
#include "devices/base/source.h"
#include "devices/lcm/link.h"

namespace headpin::devices {

/// Receives samples that others publish on TRACKER and MOUSE3D.
///
/// Each station has a publisher with its own clock. ClockOffset converts it to the session's clock
/// from the first sample on, and starts again when it jumps by more than a second; both times of a
/// sample are then on the session's clock. The mouse has few messages, so it uses the offset of the
/// station with nearly the same clock. Samples without times (0) get their time of arrival.
///
/// A station has one publisher: the first one, until it has been silent for a second. Samples of
/// other publishers for this station are skipped. Over multicast, publishers are distinguished by
/// their address; otherwise by their clock, if it is more than half a second behind.
class LcmSource : public Source {
 public:
  struct Counts {
    std::int64_t received = 0;
    std::int64_t dropped = 0;      ///< the oldest, if more wait than the queue can hold
    std::int64_t undecodable = 0;  ///< another type or size
    std::int64_t implausible = 0;  ///< NaN, quaternions not unit, times or places out of range
    std::int64_t foreign = 0;      ///< poses in another frame than the transmitter's
    std::int64_t clock_jumps = 0;  ///< a publisher's clock, against the session's
    std::int64_t unstamped = 0;    ///< without a time of their own
    std::int64_t others = 0;       ///< of a station that another publisher sends
    std::int64_t handovers = 0;    ///< to another publisher, when one had sent nothing
  };
  /// Who publishes a station, or the mouse.
  struct Publisher {
    ClockOffset clock;
    SequenceCount numbers;
    std::int64_t samples = 0;
    Time theirs{};                 ///< time of its newest sample as published
    Time device_time{};            ///< the same on the session's clock
    Time host_time{};              ///< its time of arrival
    std::uint64_t sender = 0;      ///< where it sends from; 0: unknown
    bool follows_station = false;  ///< of the mouse: its clock is that of a station
    /// The last other publisher of this station, its time, and the number of its skipped samples.
    std::uint64_t other = 0, beside = 0;
    Time other_time{};
    std::int64_t others = 0;
    /// How much later it came than the sample with the least delay. If less than 0, its time is
    /// ahead of the session's clock, which waits for it.
    Time late() const { return host_time - device_time; }
  };

  /// @param link   must outlive this
  /// @param queue  largest number of waiting samples
  explicit LcmSource(LcmLink& link, std::size_t queue = 4096);
  ~LcmSource() override;

  /// Uses the arrival times on this clock from now on, instead of the times of the polls.
  void use_clock(std::function<Time()> clock) { clock_ = std::move(clock); }

  /// Uses the first station's clock as the session's clock from now on; null: none.
  void hold_to(Genlock* genlock) { genlock_ = genlock; }

  /// Discards the messages so far. Messages that waited while a session was prepared do not show
  /// the publishers' clocks.
  void drain();

  /// Discards the messages so far, and starts a thread that reads.
  void listen();

  /// Reads the messages that have arrived, without waiting. Their host time is `now`, or just after
  /// the last poll, so that a replay uses them at the same tick. A time after the arrival is
  /// harmless; an earlier one would make all samples too early.
  ///
  /// @throws std::runtime_error  when LCM stops, as a tcpq server does
  void receive(Time now);

  void poll(Time now, std::vector<Sample>& out) override;
  /// At the end of a log; anything else that ends is an error of receive().
  bool exhausted() const override { return ended_ && waiting_.empty(); }

  const Counts& counts() const { return counts_; }
  /// Samples that did not come, by their stations' sequences.
  std::int64_t lost() const;
  const std::map<Device, Publisher>& publishers() const { return publishers_; }

 private:
  struct Wire;
  bool take_next(Time now);
  void stamp(TrackerSample& sample);
  void stamp(MouseSample& sample);
  bool is_kept(Publisher& publisher, Device device, Time theirs, std::uint64_t sender);
  bool speaks_for(const Publisher& publisher, Device device, Time theirs,
                  std::uint64_t sender) const;
  bool is_behind(const Publisher& publisher, Device device, Time theirs) const;
  bool is_of_another_clock(Time theirs) const;
  bool is_unstamped(const Publisher& publisher, Time theirs) const;
  Time by_arrival(Publisher& publisher);
  Time carried_over(Publisher& publisher, Time theirs, const void* held_to);
  Time held(Time theirs, double ours_us, const void* held_to) const;
  void stamp_arrival(std::int64_t wall_us);
  void take(std::string_view channel, std::span<const std::uint8_t> bytes, std::uint64_t sender);

  LcmLink& link_;
  std::size_t queue_;
  std::deque<Sample> waiting_;  // in the order of arrival
  std::map<Device, Publisher> publishers_;
  std::function<Time()> clock_;
  Genlock* genlock_ = nullptr;
  Time receiving_{}, polled_{};
  bool ended_ = false, draining_ = false;
  Counts counts_;
  std::unique_ptr<Wire> wire_;
};

}  // namespace headpin::devices
