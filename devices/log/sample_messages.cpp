#include "devices/log/sample_messages.h"

#include <headpin/mouse3d_t.hpp>
#include <headpin/mouse3d_v1_t.hpp>
#include <headpin/tracked_device_t.hpp>
#include <headpin/tracked_device_v1_t.hpp>
#include <headpin/tracked_device_v2_t.hpp>

#include "devices/log/lcm_message.h"

namespace headpin::devices {
namespace {

/// The fields that all versions of the type have.
template <typename Lcm>
TrackerSample tracker_sample(const Lcm& m) {
  TrackerSample sample;
  sample.device_time = Time{m.device_utime};
  sample.host_time = Time{m.host_utime};
  sample.sequence = m.sequence;
  sample.station = m.station;
  sample.X_TS = pose(m.position, m.quaternion);
  sample.status = static_cast<char>(m.status);
  sample.buttons = static_cast<std::uint8_t>(m.buttons);
  sample.frame = m.frame;
  return sample;
}

std::optional<Sample> decode_tracker(std::span<const std::uint8_t> bytes) {
  if (const auto m = decode_as<tracked_device_t>(bytes)) {
    TrackerSample sample = tracker_sample(*m);
    sample.session_time = Time{m->session_utime};
    sample.sent_time = Time{m->sent_utime};
    sample.position_estimated = m->position_estimated != 0;
    sample.orientation_estimated = m->orientation_estimated != 0;
    return sample;
  }
  if (const auto m = decode_as<tracked_device_v2_t>(bytes)) {
    TrackerSample sample = tracker_sample(*m);
    sample.session_time = Time{m->session_utime};
    return sample;
  }
  const auto v1 = decode_as<tracked_device_v1_t>(bytes);
  if (!v1) return std::nullopt;
  return tracker_sample(*v1);
}

template <typename Lcm>
MouseSample mouse_sample(const Lcm& m) {
  MouseSample sample;
  sample.device_time = Time{m.device_utime};
  sample.host_time = Time{m.host_utime};
  sample.left_thumb = m.left_thumb != 0;
  sample.right_thumb = m.right_thumb != 0;
  sample.trigger = m.trigger != 0;
  return sample;
}

std::optional<Sample> decode_mouse(std::span<const std::uint8_t> bytes) {
  if (const auto m = decode_as<mouse3d_t>(bytes)) {
    MouseSample sample = mouse_sample(*m);
    sample.session_time = Time{m->session_utime};
    return sample;
  }
  const auto v1 = decode_as<mouse3d_v1_t>(bytes);
  if (!v1) return std::nullopt;
  return mouse_sample(*v1);
}

bool plausible_times(const auto& sample) {
  return plausible(sample.device_time) && plausible(sample.host_time) &&
         plausible(sample.session_time);
}

/// Whether what a device tells is for a time at most a second away.
bool near(Time valid, Time told) {
  constexpr Time kMost{1'000'000};
  return told - kMost <= valid && valid <= told + kMost;
}

struct PlausibleSample {
  bool operator()(const TrackerSample& s) const {
    constexpr std::int64_t kMostSamples = 1'000'000'000'000'000;
    constexpr double kReachOfEarth = 1e8;  // from any origin on Earth [m]
    return plausible_times(s) && plausible(s.sent_time) && near(s.device_time, s.told()) &&
           plausible(s.X_TS) && s.X_TS.p.cwiseAbs().maxCoeff() <= kReachOfEarth &&
           s.sequence >= 0 && s.sequence < kMostSamples;
  }
  bool operator()(const MouseSample& s) const { return plausible_times(s); }
};

}  // namespace

char status_letter(const TrackerSample& sample) {
  const char status = sample.status;
  const bool letter = (status >= 'A' && status <= 'Z') || (status >= 'a' && status <= 'z');
  return letter || status == ' ' ? status : 'x';
}

char status_character(const TrackerSample& sample) {
  const char status = sample.status;
  return status > ' ' && status < '\x7f' ? status : 'x';
}

void encode(const TrackerSample& sample, Buffer& out) {
  tracked_device_t m;
  m.device_utime = sample.device_time.count();
  m.host_utime = sample.host_time.count();
  m.sequence = sample.sequence;
  m.station = sample.station;
  put(sample.X_TS, m.position, m.quaternion);
  m.status = static_cast<std::int8_t>(sample.status);
  m.buttons = sample.buttons;
  m.frame = sample.frame;
  m.session_utime = sample.session_time.count();
  m.sent_utime = sample.sent_time.count();
  m.position_estimated = sample.position_estimated;
  m.orientation_estimated = sample.orientation_estimated;
  encode_as(m, out);
}

void encode(const MouseSample& sample, Buffer& out) {
  mouse3d_t m;
  m.device_utime = sample.device_time.count();
  m.host_utime = sample.host_time.count();
  m.left_thumb = sample.left_thumb;
  m.right_thumb = sample.right_thumb;
  m.trigger = sample.trigger;
  m.session_utime = sample.session_time.count();
  encode_as(m, out);
}

std::optional<Sample> decode_sample(std::string_view channel, std::span<const std::uint8_t> bytes) {
  if (channel == kTrackerChannel) return decode_tracker(bytes);
  if (channel == kMouseChannel) return decode_mouse(bytes);
  return std::nullopt;
}

bool plausible(const Sample& sample) {
  return std::visit(PlausibleSample{}, sample);
}

}  // namespace headpin::devices
