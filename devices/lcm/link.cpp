#include "devices/lcm/link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <headpin/rigid_transform_t.hpp>
#include <lcm/lcm.h>

#include "devices/lcm/provider.h"
#include "devices/lcm/server.h"
#include "devices/log/event_log.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices {

LcmLink::LcmLink(LcmUrl url, base::OutputFile log)
    : url_(std::move(url)), written_(std::make_unique<LogWriter>(std::move(log))) {}

LcmLink::LcmLink(LcmUrl url, std::string_view prefix) : url_(std::move(url)), prefix_(prefix) {
  if (const auto& log = url_.log()) {
    if (!log->written) {
      throw std::runtime_error(
          fmt::format("cannot publish at {}: it is opened for reading", url_.shown()));
    }
    written_ = std::make_unique<LogWriter>(base::OutputFile(log->path, {.live = true}));
    return;
  }
  lcm_ = std::make_unique<Lcm>();
  lcm_->has_server = url_.server().has_value();
  const std::string complete = lcm_->has_server ? find_server(url_) : url_.for_liblcm();
  lcm_->handle = lcm_create(complete.c_str());
  if (!lcm_->handle) {
    throw std::runtime_error(fmt::format("cannot open LCM at {}{}", url_.shown(), url_.hint()));
  }
  lcm_->require_server(url_);
}

LcmLink::LcmLink(const std::string& url, std::string_view prefix) : LcmLink(LcmUrl(url), prefix) {}

LcmLink::~LcmLink() = default;

void LcmLink::send(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (written_) return written_->write(channel, bytes);
  lcm_->require_server(url_);
  do {
    errno = 0;
    if (lcm_publish(lcm_->handle, channel.c_str(), bytes.data(),
                    static_cast<unsigned>(bytes.size())) >= 0) {
      return;
    }
  } while (errno == EINTR);
  const int why = errno;
  lcm_->require_server(url_);
  throw std::runtime_error(fmt::format("cannot publish on {} at {}: {}{}", channel, url_.shown(),
                                       why ? std::strerror(why) : "refused by LCM", url_.hint()));
}

void LcmLink::publish(const Sample& sample) {
  std::visit([&](const auto& s) { encode(s, bytes_); }, sample);
  const bool tracker = std::holds_alternative<TrackerSample>(sample);
  send(named(tracker ? kTrackerChannel : kMouseChannel), bytes_);
}

void LcmLink::publish(std::string_view channel, std::span<const std::uint8_t> bytes) {
  send(named(channel), bytes);
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

}  // namespace headpin::devices
