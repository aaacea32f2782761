#include "devices/lcm/link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <headpin/rigid_transform_t.hpp>
#include <lcm/lcm.h>

#include "devices/lcm/datagrams.h"
#include "devices/lcm/provider.h"
#include "devices/trial/event_log.h"
#include "devices/trial/log.h"
#include "devices/trial/messages.h"
#include "devices/trial/sources.h"

namespace headpin::devices {

namespace {

std::string shown(const std::string& url) {
  return url.empty() ? "its default URL" : url;
}

}  // namespace

LcmLink::LcmLink(const std::string& url, std::string_view prefix, files::OutputFile::Options output)
    : url_(url), prefix_(prefix) {
  if (LogPlayer::reads(url)) {
    log_ = std::make_unique<LogPlayer>(url);
    return;
  }
  const char* of_environment = std::getenv("LCM_DEFAULT_URL");
  meant_ = url.empty() && of_environment != nullptr ? of_environment : url;
  if (const std::string path = LogPlayer::written_by(meant_); !path.empty()) {
    if (meant_.find("mode=a") != std::string::npos) {
      throw std::runtime_error(path + ": cannot append to a log; expected mode=w");
    }
    output.live = true;
    written_ = std::make_unique<LogWriter>(path, std::move(output));
    return;
  }
  if (meant_.starts_with("mpudpm:")) {
    throw std::runtime_error(meant_ +
                             ": two datagrams of anybody end a program in which liblcm 1.3.1 reads "
                             "mpudpm; expected udpm://");
  }
  lcm_ = std::make_unique<Lcm>();
  lcm_->handle = lcm_create(meant_.empty() ? nullptr : meant_.c_str());
  if (!lcm_->handle) {
    throw std::runtime_error("cannot open LCM at " + shown(url) + multicast_hint(url));
  }
}

LcmLink::~LcmLink() = default;

void LcmLink::send(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (log_)
    throw std::runtime_error("cannot publish on " + channel + " at " + url_ +
                             ": it is opened for reading");
  if (written_) return written_->write(channel, bytes);
  do {
    errno = 0;
    if (lcm_publish(lcm_->handle, channel.c_str(), bytes.data(),
                    static_cast<unsigned>(bytes.size())) >= 0) {
      return;
    }
  } while (errno == EINTR);
  throw std::runtime_error(fmt::format("cannot publish on {} at {}: {}{}", channel, shown(url_),
                                       errno ? std::strerror(errno) : "refused by LCM",
                                       multicast_hint(url_)));
}

void LcmLink::publish(const TrialHeader& header) {
  encode(header, bytes_);
  send(named(kTrialChannel), bytes_);
}

void LcmLink::publish(const Sample& sample) {
  std::visit([&](const auto& s) { encode(s, bytes_); }, sample);
  const bool tracker = std::holds_alternative<TrackerSample>(sample);
  send(named(tracker ? kTrackerChannel : kMouseChannel), bytes_);
}

void LcmLink::publish(const Event& event) {
  encode(event, bytes_);
  send(named(kEventChannel), bytes_);
}

void LcmLink::publish(const TickState& state) {
  encode(state, bytes_);
  send(named(kStateChannel), bytes_);
}

void LcmLink::publish(const FrameRecord& frame) {
  encode(frame, bytes_);
  send(named(kFrameChannel), bytes_);
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

TrialPublisher::TrialPublisher(LcmLink& link, const TrialHeader& header)
    : link_(link), header_(stamped(header)) {
  link_.publish(header_);
  next_header_ = Time{1'000'000};
}

template <typename T>
void TrialPublisher::send(Time time, const T& message) {
  last_ = std::max(last_, time);
  if (last_ >= next_header_) {
    link_.publish(header_);
    if (drawn_by_) link_.publish(*drawn_by_);
    next_header_ = last_ + Time{1'000'000};
  }
  link_.publish(message);
  ++count_;
}

void TrialPublisher::write(const Sample& sample) {
  send(available(sample), sample);
}

void TrialPublisher::write(const Event& event) {
  send(event.time, event);
  if (event.kind == kDrawnByEvent) drawn_by_ = event;
}

void TrialPublisher::write(const TickState& state) {
  send(state.time, state);
}

void TrialPublisher::write(const FrameRecord& frame) {
  send(frame.time, frame);
}

void TrialPublisher::close() {
  Event end;
  end.time = last_;
  end.kind = kEndEvent;
  end.value = static_cast<double>(count_);
  send(end.time, end);
}

}  // namespace headpin::devices
