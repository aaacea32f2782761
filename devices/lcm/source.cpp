#include "devices/lcm/source.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "devices/lcm/datagrams.h"
#include "devices/lcm/provider.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices {

/// The origin of messages: our own listener, or otherwise liblcm's subscriptions.
struct LcmSource::Wire {
  std::unique_ptr<MulticastListener> listener;
  LcmLink::Lcm* lcm = nullptr;
  std::vector<lcm_subscription_t*> all;

  void subscribe(LcmSource& source, std::string_view channel, int queue) {
    lcm_subscription_t* subscription = lcm_subscribe(
        lcm->handle, std::string(channel).c_str(),
        [](const lcm_recv_buf_t* received, const char* on, void* to) {
          const std::span data(static_cast<const std::uint8_t*>(received->data),
                               received->data_size);
          static_cast<LcmSource*>(to)->take({.channel = on, .data = data},
                                            Time{received->recv_utime});
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

LcmSource::LcmSource(LcmLink& link, Clocks& clocks, std::size_t queue)
    : link_(link), queue_(queue), intake_(clocks, queue), wire_(std::make_unique<Wire>()) {
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
  draining_ = true;
  receive({});
  draining_ = false;
}

void LcmSource::listen() {
  drain();
  if (wire_->listener) wire_->listener->start();
}

void LcmSource::receive(Time now) {
  now_ = now;
  // At most as many as the queue can hold, so that a flood cannot block this.
  for (std::size_t i = 0; i < queue_ && take_next(); ++i) continue;
}

/// Takes the next message. @return  whether there was one
bool LcmSource::take_next() {
  if (wire_->listener) {
    const auto message = wire_->listener->take();
    intake_.add_dropped(wire_->listener->take_dropped());
    if (!message) return false;
    take({.channel = message->channel, .data = message->data, .sender = message->sender},
         message->arrived);
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

/// @param at  when the message arrived, by the wall clock
void LcmSource::take(LcmMessage message, Time at) {
  if (draining_) return;
  message.arrived = now_;
  if (clock_) {
    // In this order, so that a pause between the two calls makes the time later and not earlier.
    const Time wall =
        std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
    message.arrived = clock_() - std::clamp(wall - at, Time{0}, Time{1'000'000});
  }
  intake_.take(message);
}

void LcmSource::poll(Time now, std::vector<Sample>& out) {
  receive(now);
  intake_.hand_out(now, out);
}

}  // namespace headpin::devices
