#include "devices/fastrak/clock.h"

#include <algorithm>
#include <cmath>

#include "devices/fastrak/codec.h"

namespace headpin::devices {
namespace {

constexpr double kCycle_us = 1e6 / static_cast<double>(kFastrakCycleRate);
constexpr double kLatency_us = 3750.0;  // mid-sampling to output (manual p. E-4)

/// The first records wait this long, so that at least one of them came without delay.
constexpr Time kSettling{250'000};
/// A late record waits this long for the records behind it.
constexpr Time kPatience{150'000};
/// Part of a cycle by which a record may be early before its cycle number is reduced by one.
constexpr double kEarly = 0.25;

/// Upper bound of the time of measurement: a record was measured before it arrived, and at least
/// one cycle before each record behind it.
double seen(std::span<const Time> arrivals, double lag_us) {
  double least_us = static_cast<double>(arrivals.front().count()) - lag_us;
  for (std::size_t i = 1; i < arrivals.size(); ++i) {
    const double older_us = lag_us + static_cast<double>(i) * kCycle_us;
    least_us = std::min(least_us, static_cast<double>(arrivals[i].count()) - older_us);
  }
  return least_us;
}

/// Whether a record came at the unit's rate after another one. Records that were delayed together
/// arrive all at once.
bool came_by_itself(std::span<const Time> arrivals) {
  const Time half_a_cycle{std::llround(0.5 * kCycle_us)};
  return std::ranges::adjacent_find(arrivals, [&](Time before, Time after) {
           return after - before >= half_a_cycle;
         }) != arrivals.end();
}

}  // namespace

FastrakClock::FastrakClock(int active_stations, Time byte_time, std::size_t record_length,
                           Clocks& clocks, ClockId cycles)
    : active_(std::max(1, active_stations)),
      clocks_(clocks),
      cycles_(cycles),
      lag_us_(kLatency_us + static_cast<double>(byte_time.count())),
      // The last byte of a record leaves while the next record is written.
      line_cycles_(static_cast<double>(record_length - 1) * static_cast<double>(byte_time.count()) /
                   kCycle_us) {
  constexpr double kRounding = 0.01;  // of the byte's time, in cycles
  while (static_cast<double>(step_) + kRounding < line_cycles_) step_ += active_;
  clocks_.restart(cycles_);
}

/// Records that the line carries in so many cycles, up to one whose station is `offset` turns on.
std::int64_t FastrakClock::records_in(std::int64_t cycles, int offset) const {
  const double rounds =
      (static_cast<double>(cycles) / static_cast<double>(step_) - offset) / active_;
  const std::int64_t least = offset > 0 ? offset : active_;
  return std::max<std::int64_t>(least, offset + active_ * std::llround(rounds));
}

std::optional<Time> FastrakClock::measured(int turn, std::span<const Time> arrivals, Time now) {
  const double seen_us = seen(arrivals, lag_us_);
  const Time waited = now - arrivals.front();
  if (!started()) {
    if (waited < kSettling) return std::nullopt;
    cycle_ = record_ = turn;
  } else {
    // Cycles since the last record: the largest number that fits, with this station's turn.
    const int offset = (turn - turn_ + active_) % active_;
    std::int64_t least = offset > 0 ? offset : active_;
    while (static_cast<double>(least) + kEarly < line_cycles_) least += active_;
    const double fit = (seen_us - clocks_.estimate_us(cycles_)) / kCycle_us + kEarly;
    const auto turns = static_cast<std::int64_t>(std::floor((fit - offset) / active_));
    const std::int64_t cycles = std::max(least, turns * active_ + offset);
    const bool only_late_perhaps = !came_by_itself(arrivals) && waited < kPatience;
    if (cycles > least && only_late_perhaps) return std::nullopt;
    cycle_ += cycles;
    record_ += records_in(cycles, offset);
  }
  turn_ = turn;
  return clocks_.date({.clock = cycles_,
                       .theirs = tick_time(cycle_, kFastrakCycleRate),
                       .arrived_us = seen_us,
                       .theirs_us = static_cast<double>(cycle_) * kCycle_us,
                       .apart_us = 0.25 * kCycle_us});
}

}  // namespace headpin::devices
