#include "devices/lcm/source.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>
#include <vector>

#include "devices/lcm/datagrams.h"
#include "devices/lcm/provider.h"
#include "devices/trial/messages.h"

namespace headpin::devices {
namespace {

constexpr Time kGone{1'000'000};       // a publisher that is silent for this long is gone
constexpr double kAnother_us = 500e3;  // later by more: the clock of another publisher

}  // namespace

/// The origin of messages: our own listener, or otherwise liblcm's subscriptions.
struct LcmSource::Wire {
  std::unique_ptr<MulticastListener> listener;
  LcmLink::Lcm* lcm = nullptr;
  std::vector<lcm_subscription_t*> all;

  void subscribe(LcmSource& source, std::string_view channel, int queue) {
    lcm_subscription_t* subscription = lcm_subscribe(
        lcm->handle, std::string(channel).c_str(),
        [](const lcm_recv_buf_t* received, const char* on, void* to) {
          auto* subscriber = static_cast<LcmSource*>(to);
          subscriber->stamp_arrival(received->recv_utime);
          subscriber->take(
              on, {static_cast<const std::uint8_t*>(received->data), received->data_size}, 0);
        },
        &source);
    if (!subscription) throw std::runtime_error("cannot subscribe to LCM");
    lcm_subscription_set_queue_capacity(subscription, queue);
    all.push_back(subscription);
  }
  ~Wire() {
    if (!lcm || lcm->lost()) return;  // liblcm would connect again to unsubscribe
    for (lcm_subscription_t* subscription : all) lcm_unsubscribe(lcm->handle, subscription);
  }
};

LcmSource::LcmSource(LcmLink& link, std::size_t queue)
    : link_(link), queue_(queue), wire_(std::make_unique<Wire>()) {
  if (link.is_replay()) return;
  if (const auto& group = link.url().group()) {
    const std::vector<std::string> channels = {std::string(kTrackerChannel),
                                               std::string(kMouseChannel)};
    wire_->listener = std::make_unique<MulticastListener>(*group, channels, queue);
    return;
  }
  if (!link.lcm_)
    throw std::runtime_error(link.url().shown() +
                             ": is opened for writing; expected one for reading");
  wire_->lcm = link.lcm_.get();
  const int capacity = static_cast<int>(std::min<std::size_t>(queue, 1 << 20));
  wire_->subscribe(*this, kTrackerChannel, capacity);
  wire_->subscribe(*this, kMouseChannel, capacity);
}

LcmSource::~LcmSource() = default;

void LcmSource::drain() {
  if (link_.is_replay()) return;
  draining_ = true;
  receive(polled_);
  draining_ = false;
}

void LcmSource::listen() {
  drain();
  if (wire_->listener) wire_->listener->start();
}

void LcmSource::receive(Time now) {
  receiving_ = std::max(now, polled_ + Time{1});
  // At most as many as the queue can hold, so that a flood cannot block this.
  for (std::size_t i = 0; i < queue_ && take_next(now); ++i) continue;
}

/// Takes the next message. @return  whether there was one
bool LcmSource::take_next(Time now) {
  if (link_.is_replay()) {
    const std::optional<LogEvent> event = link_.log_->due(now);
    ended_ = link_.log_->ended();
    if (!event) return false;
    if (event->channel == kTrackerChannel || event->channel == kMouseChannel) {
      take(event->channel, event->data, 0);
    }
    return true;
  }
  if (wire_->listener) {
    const auto message = wire_->listener->take();
    counts_.dropped += wire_->listener->take_dropped();
    if (!message) return false;
    stamp_arrival(message->arrived.count());
    take(message->channel, message->data, message->sender);
    return true;
  }
  link_.lcm_->require_server(link_.url());
  errno = 0;
  const int handled = lcm_handle_timeout(link_.lcm_->handle, 0);
  // For LCM a signal is a failure. Waiting messages are read at the next tick.
  if (handled == 0 || (handled < 0 && errno == EINTR)) return false;
  if (handled > 0) return true;
  link_.lcm_->require_server(link_.url());
  throw std::runtime_error("LCM stopped: " + link_.url().shown());
}

/// Sets the arrival time of the current message from its wall-clock time, as LCM gives it.
void LcmSource::stamp_arrival(std::int64_t wall_us) {
  if (!clock_) return;
  // In this order, so that a pause between the two calls makes the time later and not earlier.
  const Time wall =
      std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
  const Time waited = std::clamp(wall - Time{wall_us}, Time{0}, Time{1'000'000});
  receiving_ = std::max(clock_() - waited, polled_ + Time{1});
}

void LcmSource::take(std::string_view channel, std::span<const std::uint8_t> bytes,
                     std::uint64_t sender) {
  if (draining_) return;
  const std::optional<Message> message = decode(channel, bytes);
  if (!message) {
    ++counts_.undecodable;
    return;
  }
  if (!plausible(*message)) {
    ++counts_.implausible;
    return;
  }
  Sample sample;
  if (const auto* tracker = std::get_if<TrackerSample>(&*message)) {
    if (!tracker->in_transmitters_frame()) {
      ++counts_.foreign;
      return;
    }
    sample = *tracker;
  }
  if (const auto* mouse = std::get_if<MouseSample>(&*message)) sample = *mouse;
  const Device device = device_of(sample);
  if (!is_kept(publishers_[device], device, device_time(sample), sender)) {
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

/// Whether a sample is from the publisher of its station, and not from another publisher.
bool LcmSource::is_kept(Publisher& publisher, Device device, Time theirs, std::uint64_t sender) {
  if (!speaks_for(publisher, device, theirs, sender)) {
    ++publisher.others;
    publisher.other = sender;
    publisher.beside = publisher.sender;
    publisher.other_time = receiving_;
    return false;
  }
  if (publisher.sender != sender) {  // another sender, or the first one
    if (publisher.samples > 0) ++counts_.handovers;
    publisher.sender = sender;
    publisher.clock = {};
    publisher.numbers.begin_anew();
  } else if (is_behind(publisher, device, theirs)) {  // the old publisher is gone
    publisher.clock = {};
    publisher.numbers.begin_anew();
    ++counts_.clock_jumps;
  }
  return true;
}

/// Whether a sample is later than those of its publisher, if only this distinguishes publishers.
bool LcmSource::is_behind(const Publisher& publisher, Device device, Time theirs) const {
  const bool known = publisher.sender != 0;
  if (known || device == Device::mouse || !publisher.clock.started() ||
      is_unstamped(publisher, theirs)) {
    return false;
  }
  const double late_us = static_cast<double>(receiving_.count()) -
                         publisher.clock.ours(static_cast<double>(theirs.count()));
  return late_us > kAnother_us;
}

/// Whether the clocks of all active stations show another time.
bool LcmSource::is_of_another_clock(Time theirs) const {
  bool heard = false;
  for (const auto& [device, publisher] : publishers_) {
    if (device == Device::mouse || receiving_ - publisher.host_time >= kGone) continue;
    const double late_us = static_cast<double>(receiving_.count()) -
                           publisher.clock.ours(static_cast<double>(theirs.count()));
    if (std::abs(late_us) <= kAnother_us) return false;
    heard = true;
  }
  return heard;
}

bool LcmSource::speaks_for(const Publisher& publisher, Device device, Time theirs,
                           std::uint64_t sender) const {
  const bool known = sender != 0;
  if (known && device == Device::mouse) {  // it belongs to the sender of the poses
    for (const auto& [other_device, other] : publishers_) {
      if (other_device == Device::mouse) continue;
      if (other.sender == sender && other.samples > 0) return true;
      if (other.other == sender && receiving_ - other.other_time < kGone) return false;
    }
  }
  if (!known && device == Device::mouse && publisher.follows_station &&
      !is_unstamped(publisher, theirs)) {
    return !is_of_another_clock(theirs);
  }
  if (publisher.samples == 0 || receiving_ - publisher.host_time >= kGone) return true;
  return known ? sender == publisher.sender : !is_behind(publisher, device, theirs);
}

/// Whether a sample has no time. For the first sample, 0 may be the time.
bool LcmSource::is_unstamped(const Publisher& publisher, Time theirs) const {
  return theirs == Time{} && publisher.theirs == Time{} && publisher.samples > 0;
}

/// The time of a sample without its own time.
Time LcmSource::by_arrival(Publisher& publisher) {
  ++counts_.unstamped;
  ++publisher.samples;
  publisher.device_time = std::max(receiving_, publisher.device_time + Time{1});
  publisher.host_time = receiving_;
  return publisher.device_time;
}

std::int64_t LcmSource::lost() const {
  std::int64_t lost = 0;
  for (const auto& [device, publisher] : publishers_) lost += publisher.numbers.lost();
  return lost;
}

void LcmSource::stamp(TrackerSample& sample) {
  Publisher& publisher = publishers_[device_at(sample.station)];
  const bool unstamped = is_unstamped(publisher, sample.device_time);
  publisher.numbers.take(sample.sequence, unstamped ? receiving_ : sample.device_time);
  sample.device_time =
      unstamped ? by_arrival(publisher) : carried_over(publisher, sample.device_time, &publisher);
  sample.host_time = receiving_;
}

/// The delay of a single message is not known, so the mouse uses the clock of the station that
/// shows nearly the same time.
void LcmSource::stamp(MouseSample& sample) {
  constexpr double kSameClock_us = 1e5;
  Publisher& mouse = publishers_[Device::mouse];
  if (is_unstamped(mouse, sample.device_time)) {
    sample.device_time = by_arrival(mouse);
    sample.host_time = receiving_;
    return;
  }
  const auto theirs_us = static_cast<double>(sample.device_time.count());
  const auto off = [&](const auto& entry) {
    const auto& [device, publisher] = entry;
    return device == Device::mouse || !publisher.clock.started()
               ? kSameClock_us
               : std::abs(publisher.clock.ours(theirs_us) -
                          static_cast<double>(receiving_.count()));
  };
  const auto nearest = std::ranges::min_element(publishers_, {}, off);
  if (nearest != publishers_.end() && off(*nearest) < kSameClock_us) {
    mouse.clock = nearest->second.clock;
    mouse.theirs = sample.device_time;
    mouse.device_time = held(sample.device_time, mouse.clock.ours(theirs_us), nullptr);
    mouse.host_time = receiving_;
    mouse.follows_station = true;
    ++mouse.samples;
  } else {
    mouse.follows_station = false;
    carried_over(mouse, sample.device_time, nullptr);
  }
  sample.device_time = mouse.device_time;
  sample.host_time = receiving_;
}

/// @param held_to  identifies this clock for the genlock
Time LcmSource::carried_over(Publisher& publisher, Time theirs, const void* held_to) {
  constexpr double kJump_us = 1e6;
  const auto theirs_us = static_cast<double>(theirs.count());
  const auto seen_us = static_cast<double>(receiving_.count());
  if (publisher.clock.started() && std::abs(seen_us - publisher.clock.ours(theirs_us)) > kJump_us) {
    publisher.clock = {};
    ++counts_.clock_jumps;
  }
  const bool first = !publisher.clock.started();
  ++publisher.samples;
  Time ours = held(theirs, publisher.clock.carry_over(theirs_us, seen_us), held_to);
  // A later measurement stays later, even if the offset of the clock was corrected.
  if (!first && theirs > publisher.theirs) ours = std::max(ours, publisher.device_time + Time{1});
  publisher.theirs = theirs;
  publisher.device_time = ours;
  publisher.host_time = receiving_;
  return ours;
}

/// @param ours_us  the estimate of its time on the session's clock
Time LcmSource::held(Time theirs, double ours_us, const void* held_to) const {
  if (!genlock_) return Time{std::llround(ours_us)};
  const double estimated_us = ours_us - static_cast<double>(theirs.count());
  return theirs + Time{std::llround(genlock_->offset_us(held_to, estimated_us))};
}

void LcmSource::poll(Time now, std::vector<Sample>& out) {
  receive(now);
  polled_ = std::max(polled_, now);
  std::ranges::stable_sort(waiting_, {}, available);
  for (; !waiting_.empty() && available(waiting_.front()) <= now; waiting_.pop_front()) {
    out.push_back(std::move(waiting_.front()));
  }
}

}  // namespace headpin::devices
