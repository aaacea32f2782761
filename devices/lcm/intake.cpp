#include "devices/lcm/intake.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "devices/base/sources.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices {
namespace {

constexpr Time kGone{1'000'000};       // a publisher that is silent for this long is gone
constexpr Time kSetBack{50'000};       // a later number with a time that is earlier by more
constexpr double kAnother_us = 500e3;  // later by more: the clock of another publisher

}  // namespace

void LcmIntake::take(const LcmMessage& message) {
  arrived_ = std::max(message.arrived, handed_out_ + Time{1});
  std::optional<Sample> read = decode_sample(message.channel, message.data);
  if (!read) {
    ++counts_.undecodable;
    return;
  }
  if (!plausible(*read)) {
    ++counts_.implausible;
    return;
  }
  Sample& sample = *read;
  const auto* tracker = std::get_if<TrackerSample>(&sample);
  if (tracker && !tracker->in_transmitters_frame()) {
    ++counts_.foreign;
    return;
  }
  const Device device = device_of(sample);
  if (!admit(publisher_of(device), device, told(sample), message.sender)) {
    ++counts_.others;
    return;
  }
  ++counts_.received;
  std::visit(
      [&](auto& s) {
        stamp(s);
        s.session_time = Time{};  // from another session, if any
      },
      sample);
  waiting_.push_back(std::move(sample));
  if (waiting_.size() > queue_) {
    waiting_.pop_front();
    ++counts_.dropped;
  }
}

LcmIntake::Publisher& LcmIntake::publisher_of(Device device) {
  const auto [entry, is_new] = publishers_.try_emplace(device);
  if (is_new) entry->second.clock = clocks_.add(device == Device::mouse ? Lead::never : Lead::may);
  return entry->second;
}

/// How much later the current message came than a sample of this time with the least delay.
double LcmIntake::late_us(const Publisher& publisher, Time theirs) const {
  return static_cast<double>(arrived_.count()) -
         clocks_.ours_us(publisher.clock, static_cast<double>(theirs.count()));
}

/// Takes the sender of a sample as the publisher of its station, or counts it as another one.
/// @return  whether the sample is taken
bool LcmIntake::admit(Publisher& publisher, Device device, Time theirs, std::uint64_t sender) {
  if (!speaks_for(publisher, device, theirs, sender)) {
    ++publisher.others;
    publisher.other = sender;
    publisher.beside = publisher.sender;
    publisher.other_time = arrived_;
    return false;
  }
  if (publisher.sender != sender) {  // another sender, or the first one
    if (publisher.samples > 0) ++counts_.handovers;
    publisher.sender = sender;
    clocks_.restart(publisher.clock);
    publisher.numbers.begin_anew();
  } else if (is_behind(publisher, device, theirs)) {  // the old publisher is gone
    clocks_.restart(publisher.clock);
    publisher.numbers.begin_anew();
    ++counts_.clock_jumps;
  }
  return true;
}

/// Whether a sample is later than those of its publisher, if only this distinguishes publishers.
bool LcmIntake::is_behind(const Publisher& publisher, Device device, Time theirs) const {
  const bool known = publisher.sender != 0;
  if (known || device == Device::mouse || !clocks_.started(publisher.clock) ||
      is_unstamped(publisher, theirs)) {
    return false;
  }
  return late_us(publisher, theirs) > kAnother_us;
}

/// Whether the clocks of all active stations show another time.
bool LcmIntake::is_of_another_clock(Time theirs) const {
  bool heard = false;
  for (const auto& [device, publisher] : publishers_) {
    if (device == Device::mouse || arrived_ - publisher.host_time >= kGone) continue;
    if (std::abs(late_us(publisher, theirs)) <= kAnother_us) return false;
    heard = true;
  }
  return heard;
}

bool LcmIntake::speaks_for(const Publisher& publisher, Device device, Time theirs,
                           std::uint64_t sender) const {
  const bool known = sender != 0;
  if (known && device == Device::mouse) {  // it belongs to the sender of the poses
    for (const auto& [other_device, other] : publishers_) {
      if (other_device == Device::mouse) continue;
      if (other.sender == sender) return true;
      if (other.other == sender && arrived_ - other.other_time < kGone) return false;
    }
  }
  if (!known && device == Device::mouse && publisher.follows_station &&
      !is_unstamped(publisher, theirs)) {
    return !is_of_another_clock(theirs);
  }
  if (publisher.samples == 0 || arrived_ - publisher.host_time >= kGone) return true;
  return known ? sender == publisher.sender : !is_behind(publisher, device, theirs);
}

/// Whether a sample has no time. For the first sample, 0 may be the time.
bool LcmIntake::is_unstamped(const Publisher& publisher, Time theirs) const {
  return theirs == Time{} && publisher.theirs == Time{} && publisher.samples > 0;
}

std::int64_t LcmIntake::lost() const {
  std::int64_t lost = 0;
  for (const auto& [device, publisher] : publishers_) lost += publisher.numbers.lost();
  return lost;
}

void LcmIntake::stamp(TrackerSample& sample) {
  Publisher& publisher = publisher_of(device_at(sample.station));
  const Time told = sample.told();
  const bool unstamped = is_unstamped(publisher, told);
  const bool set_back =
      told < publisher.theirs - kSetBack && publisher.numbers.advances(sample.sequence);
  if (set_back && clocks_.started(publisher.clock)) {
    clocks_.restart(publisher.clock);
    ++counts_.clock_jumps;
  }
  publisher.numbers.take(sample.sequence, unstamped ? arrived_ : told);
  if (unstamped) {
    date_by_arrival(publisher);
  } else {
    date(publisher, told);
  }
  sample.device_time += publisher.told - told;
  if (sample.sent_time != Time{}) sample.sent_time = publisher.told;
  sample.host_time = arrived_;
}

/// The delay of a single message is not known, so the mouse uses the clock of the station that
/// shows nearly the same time.
void LcmIntake::stamp(MouseSample& sample) {
  constexpr double kSameClock_us = 1e5;
  Publisher& mouse = publisher_of(Device::mouse);
  const auto off_us = [&](const auto& entry) {
    const auto& [device, publisher] = entry;
    return device == Device::mouse || !clocks_.started(publisher.clock)
               ? kSameClock_us
               : std::abs(late_us(publisher, sample.device_time));
  };
  const auto nearest = std::ranges::min_element(publishers_, {}, off_us);
  if (is_unstamped(mouse, sample.device_time)) {
    date_by_arrival(mouse);
  } else if (off_us(*nearest) < kSameClock_us) {
    mouse.told = clocks_.date_like(nearest->second.clock, mouse.clock, sample.device_time);
    mouse.theirs = sample.device_time;
    mouse.host_time = arrived_;
    mouse.follows_station = true;
    ++mouse.samples;
  } else {
    mouse.follows_station = false;
    date(mouse, sample.device_time);
  }
  sample.device_time = mouse.told;
  sample.host_time = arrived_;
}

/// Dates a sample without its own time.
void LcmIntake::date_by_arrival(Publisher& publisher) {
  ++counts_.unstamped;
  ++publisher.samples;
  publisher.told = clocks_.date_by_arrival(publisher.clock, arrived_);
  publisher.host_time = arrived_;
}

void LcmIntake::date(Publisher& publisher, Time theirs) {
  constexpr double kJump_us = 1e6;
  if (clocks_.started(publisher.clock) && std::abs(late_us(publisher, theirs)) > kJump_us) {
    clocks_.restart(publisher.clock);
    ++counts_.clock_jumps;
  }
  ++publisher.samples;
  publisher.theirs = theirs;
  publisher.told = clocks_.date({.clock = publisher.clock,
                                 .theirs = theirs,
                                 .arrived_us = static_cast<double>(arrived_.count())});
  publisher.host_time = arrived_;
}

void LcmIntake::hand_out(Time now, std::vector<Sample>& out) {
  handed_out_ = std::max(handed_out_, now);
  std::ranges::stable_sort(waiting_, {}, available);
  for (; !waiting_.empty() && available(waiting_.front()) <= now; waiting_.pop_front()) {
    out.push_back(std::move(waiting_.front()));
  }
}

}  // namespace headpin::devices
