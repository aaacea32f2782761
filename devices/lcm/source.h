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

/// Samples that others publish on TRACKER and MOUSE3D.
///
/// Each station has a publisher with a clock of its own. ClockOffset carries it over to the
/// session's from the first sample on, and anew when it jumps by more than a second; a sample's
/// stamps are then both on the session's clock. The mouse's few messages follow the station whose
/// clock shows nearly the same. A publisher without a clock, whose times are 0, is stamped by
/// arrival.
///
/// A station has one publisher: the first, until nothing has come from it for a second. What others
/// send of that station meanwhile is passed over. Over multicast they are told apart by where they
/// send from; elsewhere by their clock, when it is more than half a second behind.
class LcmSource : public Source {
 public:
  struct Counts {
    std::int64_t received = 0;
    std::int64_t dropped = 0;      ///< the oldest, when more wait than the queue holds
    std::int64_t undecodable = 0;  ///< another type or size
    std::int64_t implausible = 0;  ///< NaN, quaternions not unit, times or places out of range
    std::int64_t foreign = 0;      ///< poses in another frame than the transmitter's
    std::int64_t clock_jumps = 0;  ///< a publisher's clock, against the session's
    std::int64_t unstamped = 0;    ///< without a time of their own
    std::int64_t others = 0;       ///< of a station that another publisher sends
    std::int64_t handovers = 0;    ///< to another publisher, when one had sent nothing
  };
  static constexpr std::int32_t kMouse = 0;
  /// Who publishes a station, or the mouse.
  struct Publisher {
    ClockOffset clock;
    SequenceCount numbers;
    std::int64_t samples = 0;
    Time theirs{};             ///< time of its newest sample as published
    Time device_time{};        ///< the same on the session's clock
    Time host_time{};          ///< when that came
    std::uint64_t sender = 0;  ///< where it sends from; 0: unknown
    /// Who else sent this station last, when, while whom, and how many samples of such were left out.
    std::uint64_t other = 0, beside = 0;
    Time other_time{};
    std::int64_t others = 0;
    /// What that came later than the one of its samples that was late the least; less than 0: its
    /// time is ahead of the session's clock, which waits for it.
    Time late() const { return host_time - device_time; }
  };

  /// @param link   must outlive this
  /// @param queue  how many samples wait at most until they are polled
  explicit LcmSource(LcmLink& link, std::size_t queue = 4096);
  ~LcmSource() override;

  /// From now on messages are stamped with when LCM got them on this clock, in place of the time at
  /// which they are asked for; that is before they came when a session is late.
  void use_clock(std::function<Time()> clock) { clock_ = std::move(clock); }

  /// From now on the first station's clock is taken for the session's; null: none is.
  void hold_to(Genlock* genlock) { genlock_ = genlock; }

  /// Throws away what has arrived up to now. What waited while a session was made ready would say
  /// nothing of the publishers' clocks.
  void drain();

  /// Throws it away, and reads what comes from now on at once, in a thread of its own.
  void listen();

  /// Takes in what has arrived, without waiting, and stamps it with `now` as its host time, or with
  /// just after the last poll, so that a replay hands it out at the same tick. A time that is later
  /// than the arrival does no harm; an earlier one makes all samples too early.
  ///
  /// @throws std::runtime_error  when LCM stops, as a tcpq server does
  void receive(Time now);

  void poll(Time now, std::vector<Sample>& out) override;
  /// At the end of a log; anything else that ends is an error of receive().
  bool exhausted() const override { return ended_ && waiting_.empty(); }

  const Counts& counts() const { return counts_; }
  /// Samples that did not come, by their stations' sequences.
  std::int64_t lost() const;
  /// By station; kMouse is the mouse.
  const std::map<std::int32_t, Publisher>& publishers() const { return publishers_; }

 private:
  struct Wire;
  bool take_next(Time now);
  void stamp(TrackerSample& sample);
  void stamp(MouseSample& sample);
  bool is_kept(Publisher& publisher, std::int32_t station, Time theirs, std::uint64_t sender);
  bool speaks_for(const Publisher& publisher, std::int32_t station, Time theirs,
                  std::uint64_t sender) const;
  bool is_behind(const Publisher& publisher, std::int32_t station, Time theirs) const;
  bool is_unstamped(const Publisher& publisher, Time theirs) const;
  Time by_arrival(Publisher& publisher);
  Time carried_over(Publisher& publisher, Time theirs, const void* held_to);
  Time held(Time theirs, double ours_us, const void* held_to) const;
  void stamp_arrival(std::int64_t wall_us);
  void take(std::string_view channel, std::span<const std::uint8_t> bytes, std::uint64_t sender);

  LcmLink& link_;
  std::size_t queue_;
  std::deque<Sample> waiting_;  // in the order they came
  std::map<std::int32_t, Publisher> publishers_;
  std::function<Time()> clock_;
  Genlock* genlock_ = nullptr;
  Time receiving_{}, polled_{};
  bool ended_ = false, draining_ = false;
  Counts counts_;
  std::unique_ptr<Wire> wire_;
};

}  // namespace headpin::devices
