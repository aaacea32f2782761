#include "devices/lcm_link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <headpin/rigid_transform_t.hpp>
#include <lcm/lcm.h>

#include "devices/log.h"
#include "devices/messages.h"

namespace headpin::devices {

namespace {

std::string shown(const std::string& url) {
  return url.empty() ? "its default URL" : url;
}

/// What users of multicast meet most, and what helps.
std::string hint_for(const std::string& url) {
  const bool multicast = url.empty() || url.starts_with("udpm:") || url.starts_with("mpudpm:");
  return multicast ? "; multicast needs a route, without a network: ip link set lo multicast on && "
                     "ip route add 224.0.0.0/4 dev lo"
                   : "";
}

}  // namespace

struct LcmLink::Lcm {
  lcm_t* handle = nullptr;
  ~Lcm() {
    if (handle) lcm_destroy(handle);
  }
};

LcmLink::LcmLink(const std::string& url) : url_(url), lcm_(std::make_unique<Lcm>()) {
  lcm_->handle = lcm_create(url.empty() ? nullptr : url.c_str());
  if (!lcm_->handle) {
    throw std::runtime_error("cannot open LCM at " + shown(url) + hint_for(url));
  }
}

LcmLink::~LcmLink() = default;

bool LcmLink::is_replay() const {
  return url_.starts_with("file:") && url_.find("mode=w") == std::string::npos;
}

void LcmLink::send(const std::string& channel, std::span<const std::uint8_t> bytes) {
  errno = 0;
  if (lcm_publish(lcm_->handle, channel.c_str(), bytes.data(),
                  static_cast<unsigned>(bytes.size())) >= 0) {
    return;
  }
  throw std::runtime_error(fmt::format("cannot publish on {} at {}: {}{}", channel, shown(url_),
                                       errno ? std::strerror(errno) : "refused by LCM",
                                       hint_for(url_)));
}

void LcmLink::publish(const TrialHeader& header) {
  encode(header, bytes_);
  send(std::string(kTrialChannel), bytes_);
}

void LcmLink::publish(const Sample& sample) {
  std::visit([&](const auto& s) { encode(s, bytes_); }, sample);
  const bool tracker = std::holds_alternative<TrackerSample>(sample);
  send(std::string(tracker ? kTrackerChannel : kMouseChannel), bytes_);
}

void LcmLink::publish(const Event& event) {
  encode(event, bytes_);
  send(std::string(kEventChannel), bytes_);
}

void LcmLink::publish(const TickState& state) {
  encode(state, bytes_);
  send(std::string(kStateChannel), bytes_);
}

void LcmLink::publish(const FrameRecord& frame) {
  encode(frame, bytes_);
  send(std::string(kFrameChannel), bytes_);
}

void LcmLink::publish(std::span<const ViewerLink> links) {
  encode(links, bytes_);
  send(kViewerLoadChannel, bytes_);
}

void LcmLink::publish(Time time, std::span<const ViewerPose> poses) {
  encode(time, poses, bytes_);
  send(kViewerDrawChannel, bytes_);
}

void LcmLink::publish(const EyePictures& eyes) {
  encode(eyes, bytes_);
  send(kEyesChannel, bytes_);
}

void LcmLink::publish_pose(const std::string& channel, Time time, const Pose& pose) {
  rigid_transform_t m;
  m.utime = time.count();
  std::copy_n(pose.p.data(), 3, m.trans);
  const std::array quat = {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
  std::ranges::copy(quat, m.quat);
  bytes_.resize(static_cast<std::size_t>(m.getEncodedSize()));
  m.encode(bytes_.data(), 0, m.getEncodedSize());
  send(channel, bytes_);
}

struct LcmSource::Subscriptions {
  lcm_t* lcm = nullptr;
  std::vector<lcm_subscription_t*> all;

  void add(LcmSource& source, std::string_view channel, int queue) {
    lcm_subscription_t* subscription = lcm_subscribe(
        lcm, std::string(channel).c_str(),
        [](const lcm_recv_buf_t* received, const char* on, void* to) {
          static_cast<LcmSource*>(to)->take(
              on, {static_cast<const std::uint8_t*>(received->data), received->data_size});
        },
        &source);
    if (!subscription) throw std::runtime_error("cannot subscribe to LCM");
    lcm_subscription_set_queue_capacity(subscription, queue);
    all.push_back(subscription);
  }
  ~Subscriptions() {
    for (lcm_subscription_t* subscription : all) lcm_unsubscribe(lcm, subscription);
  }
};

LcmSource::LcmSource(LcmLink& link, std::size_t queue)
    : link_(link), queue_(queue), subscriptions_(std::make_unique<Subscriptions>()) {
  subscriptions_->lcm = link.lcm_->handle;
  const int capacity = static_cast<int>(std::min<std::size_t>(queue, 1 << 20));
  subscriptions_->add(*this, kTrackerChannel, capacity);
  subscriptions_->add(*this, kMouseChannel, capacity);
}

LcmSource::~LcmSource() = default;

void LcmSource::receive(Time now) {
  receiving_ = std::max(now, polled_ + Time{1});
  // No more at once than the queue holds, so that a flood cannot keep us here.
  for (std::size_t i = 0; i < queue_; ++i) {
    const int handled = lcm_handle_timeout(link_.lcm_->handle, 0);
    if (handled < 0 && !link_.is_replay()) {
      throw std::runtime_error("LCM stopped: " + link_.url());
    }
    ended_ = handled < 0;
    if (handled <= 0) return;
  }
}

void LcmSource::take(std::string_view channel, std::span<const std::uint8_t> bytes) {
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
  if (const auto* tracker = std::get_if<TrackerSample>(&*message)) sample = *tracker;
  if (const auto* mouse = std::get_if<MouseSample>(&*message)) sample = *mouse;
  ++counts_.received;

  constexpr Time kJump{1'000'000};
  std::visit(
      [&](auto& s) {
        const bool first = !offset_;
        const Time ahead = s.device_time + offset_.value_or(Time{}) - receiving_;
        if (first || ahead > kJump || ahead < -kJump) {
          offset_ = receiving_ - s.device_time;
          counts_.clock_jumps += !first;
        }
        s.device_time += *offset_;
        s.host_time = receiving_;
      },
      sample);
  waiting_.push_back(std::move(sample));
  if (waiting_.size() > queue_) {
    waiting_.pop_front();
    ++counts_.dropped;
  }
}

void LcmSource::poll(Time now, std::vector<Sample>& out) {
  polled_ = std::max(polled_, now);
  std::ranges::stable_sort(waiting_, {}, available);
  for (; !waiting_.empty() && available(waiting_.front()) <= now; waiting_.pop_front()) {
    out.push_back(std::move(waiting_.front()));
  }
}

}  // namespace headpin::devices
