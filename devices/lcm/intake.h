#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "devices/base/clocks.h"
#include "devices/base/sample.h"
#include "devices/base/sequence_count.h"

namespace headpin::devices {

/// A message as it comes from LCM or from a log.
struct LcmMessage {
  std::string_view channel;
  std::span<const std::uint8_t> data;
  std::uint64_t sender = 0;  ///< where it was sent from, as sender_name() reads it; 0: unknown
  Time arrived{};            ///< on the session's clock
};

/// Makes samples of the messages that others publish on TRACKER and MOUSE3D.
///
/// Each station has a publisher with its own clock. Clocks converts it to the session's clock from
/// the first sample on, by the times at which samples were told: a predicted pose stays ahead of
/// them. It starts again when it jumps by more than a second, or by half a second if nothing else
/// tells the sender. All times of a sample are then on the session's clock. The mouse has few
/// messages, so it uses the offset of the station with nearly the same clock. Samples without times
/// (0) get their time of arrival.
///
/// A station has one publisher: the first one, until it has been silent for a second. Samples of
/// other publishers for this station are skipped. Over multicast, publishers are distinguished by
/// their address; otherwise by their clock, if it is more than half a second behind.
class LcmIntake {
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
    ClockId clock{};
    SequenceCount numbers;
    std::int64_t samples = 0;
    Time theirs{};                 ///< when it told its newest sample, as published
    Time told{};                   ///< the same on the session's clock
    Time host_time{};              ///< its time of arrival
    std::uint64_t sender = 0;      ///< where it sends from; 0: unknown
    bool follows_station = false;  ///< of the mouse: its clock is that of a station
    /// The last other publisher of this station, its time, and the number of its skipped samples.
    std::uint64_t other = 0, beside = 0;
    Time other_time{};
    std::int64_t others = 0;
    /// How much later it came than the sample with the least delay. If less than 0, its time is
    /// ahead of the session's clock, which waits for it.
    Time late() const { return host_time - told; }
  };

  /// @param clocks  date the samples; must outlive this
  /// @param queue   largest number of waiting samples
  LcmIntake(Clocks& clocks, std::size_t queue) : clocks_(clocks), queue_(queue) {}

  /// A message that arrived before the last hand_out() counts as one that arrived just after it, so
  /// that a replay uses its sample at the same tick.
  void take(const LcmMessage& message);
  /// Appends the samples that are available by now and were not handed out before.
  void hand_out(Time now, std::vector<Sample>& out);
  /// Whether no sample waits.
  bool empty() const { return waiting_.empty(); }
  /// Counts messages that were dropped before they came here.
  void add_dropped(std::int64_t messages) { counts_.dropped += messages; }

  const Counts& counts() const { return counts_; }
  /// Samples that did not come, by their stations' sequences.
  std::int64_t lost() const;
  const std::map<Device, Publisher>& publishers() const { return publishers_; }

 private:
  void stamp(TrackerSample& sample);
  void stamp(MouseSample& sample);
  Publisher& publisher_of(Device device);
  bool admit(Publisher& publisher, Device device, Time theirs, std::uint64_t sender);
  bool speaks_for(const Publisher& publisher, Device device, Time theirs,
                  std::uint64_t sender) const;
  bool is_behind(const Publisher& publisher, Device device, Time theirs) const;
  bool is_of_another_clock(Time theirs) const;
  bool is_unstamped(const Publisher& publisher, Time theirs) const;
  double late_us(const Publisher& publisher, Time theirs) const;
  void date_by_arrival(Publisher& publisher);
  void date(Publisher& publisher, Time theirs);

  Clocks& clocks_;
  std::size_t queue_;
  std::deque<Sample> waiting_;  // in the order of arrival
  std::map<Device, Publisher> publishers_;
  Time arrived_{};     // the current message
  Time handed_out_{};  // the last time
  Counts counts_;
};

}  // namespace headpin::devices
