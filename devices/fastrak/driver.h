#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/base/source.h"
#include "devices/fastrak/clock.h"
#include "devices/fastrak/codec.h"
#include "devices/fastrak/replies.h"
#include "devices/fastrak/setup.h"
#include "devices/lines/byte_stream.h"

namespace headpin::devices {

struct FastrakStatistics {
  std::int64_t records = 0;        ///< samples handed out
  std::int64_t flagged = 0;        ///< number of these with an error letter
  std::int64_t skipped_bytes = 0;  ///< bytes between records
  std::int64_t missed = 0;         ///< records that did not come, of those that the line can carry
  std::int64_t drained_bytes = 0;  ///< discarded while the unit was started
  std::int64_t restarts = 0;       ///< by the watchdog
  std::int64_t attempts = 0;       ///< total number of attempts to get a status
};

/// Driver of a Fastrak on a line, as a Source of TrackerSamples.
///
/// Starts the unit from any state: resumes it (^Q), stops it (c), discards its output, and asks for
/// its status. If no status arrives, it ends a half-typed line (CR), re-initialises the unit (^Y)
/// and tries other baud rates. Then it sets port, units, frames, envelopes, lists and filters,
/// reads back the settings that the records depend on, and starts the stream. After two seconds
/// without a record it starts again. Never blocks: each poll does the steps that are due.
///
/// Sample times: `host_time` is the arrival of the first byte, from the stream; `device_time` is
/// the estimate of FastrakClock. Samples of the first quarter of a second are delayed until this
/// estimate is stable. `sequence` counts the station's records, as many as the line can carry; a gap
/// is a missing one.
class FastrakDriver : public Source {
 public:
  /// @param clocks  of the session, which date the records; must outlive this
  /// @throws std::invalid_argument  when the list lacks a position, an orientation or an end
  FastrakDriver(std::unique_ptr<ByteStream> stream, Clocks& clocks, FastrakOptions options = {});

  /// With a stream that has its own clock, also returns samples that arrived after `now`.
  void poll(Time now, std::vector<Sample>& out) override;
  bool exhausted() const override { return stream_->closed(); }

  /// True while records arrive.
  bool streaming() const { return phase_ == Phase::streaming; }
  /// A message about why the line does not work; empty when it works.
  std::string trouble() const { return stream_->trouble(); }
  /// What the driver is doing, as text: "asking for the status (attempt 2)".
  std::string activity() const;

  const FastrakStatistics& statistics() const { return statistics_; }
  /// The unit's status at the last start.
  const std::optional<FastrakStatus>& unit() const { return unit_; }
  /// Settings whose read-back at the last start was different or missing, as text; the records do
  /// not depend on them.
  const std::vector<std::string>& unconfirmed() const { return unconfirmed_; }
  /// Stations with a receiver that are switched on.
  const std::array<bool, kFastrakStations>& active() const { return active_; }
  /// The descriptor for poll(2), or -1.
  int descriptor() const { return stream_->descriptor(); }

 private:
  enum class Phase { stopping, starting_up, status, setting_up, active, checking, streaming };
  /// Where in the stream a read began, and when.
  struct Arrival {
    std::uint64_t position;
    Time time;
  };
  /// A whole record that was not handed out yet.
  struct Heard {
    FastrakRecord record;
    Time arrived;  ///< its first byte
  };

  void enter(Phase phase, Time now);
  void start_over(Time now);
  void try_again(Time now);
  bool step(Time now);
  bool stop(Time now);
  bool set_up(Time now);
  bool begin_checks(Time now);
  std::optional<bool> check(Time now);
  Time hear(Time asked);
  void speak(Time now);
  bool said_all(Time now) const;
  void drain();
  void consume(std::size_t count);
  Time arrival_of(std::uint64_t position) const;
  void say(std::vector<std::string> commands);
  void ask_next(Time now);
  void start_stream(Time now);
  void read_records(Time now);
  void hand_out(Time now, std::vector<Sample>& out);
  Time byte_time() const { return Time{10'000'000 / baud_ + 1}; }
  Time answer_time() const { return options_.answer + 100 * byte_time(); }

  std::unique_ptr<ByteStream> stream_;
  FastrakOptions options_;
  FastrakFormats formats_;
  FastrakStatistics statistics_;
  std::optional<FastrakStatus> unit_;
  std::array<bool, kFastrakStations> active_{};

  Phase phase_ = Phase::stopping;
  Time phase_began_{};
  bool begun_ = false;
  bool lost_ = false;                ///< the line has hung up
  int attempt_ = 0;                  ///< since the last record
  int baud_;                         ///< of the line now
  std::deque<FastrakCheck> checks_;  ///< to be sent; the front one has been sent
  std::vector<std::string> unconfirmed_;

  std::deque<std::string> to_say_;  ///< one command each
  Time may_speak_{};
  Time heard_{};  ///< the last byte

  std::vector<std::uint8_t> buffer_;
  std::uint64_t position_ = 0;  ///< of the buffer's front in all that was read
  std::deque<Arrival> arrivals_;
  bool in_step_ = true;
  std::deque<Heard> records_;
  Clocks& clocks_;
  ClockId cycles_;  ///< the unit's clock
  std::optional<FastrakClock> clock_;
  std::int64_t sequence_before_ = 0;  ///< start of counting after a restart
  std::int64_t next_sequence_ = 0;    ///< after the last sample
  Time last_record_{};
};

}  // namespace headpin::devices
