#include "devices/base/sources.h"

#include <string>

#include <gtest/gtest.h>
#include <headpin/mouse3d_v1_t.hpp>
#include <headpin/tracked_device_v1_t.hpp>
#include <headpin/tracked_device_v2_t.hpp>

#include "devices/log/lcm_message.h"

namespace headpin::devices {
namespace {

TrackerSample sample(std::int64_t station, std::int64_t device_us, std::int64_t host_us = 0) {
  TrackerSample s;
  s.station = static_cast<std::int32_t>(station);
  s.device_time = Time{device_us};
  s.host_time = Time{host_us};
  return s;
}

std::vector<std::int32_t> stations(const std::vector<Sample>& samples) {
  std::vector<std::int32_t> found;
  for (const Sample& s : samples) found.push_back(std::get<TrackerSample>(s).station);
  return found;
}

TEST(Device, IsCalledByWhatItIsWornOn) {
  EXPECT_EQ(device_name(Device::mouse), "3D mouse");
  EXPECT_EQ(device_name(device_at(1)), "head");
  EXPECT_EQ(device_name(device_at(2)), "right hand");
  EXPECT_EQ(device_name(device_at(3)), "left hand");
  EXPECT_EQ(device_name(device_at(4)), "station 4");
}

// Any number may come in a message.
TEST(Device, OfAnyStationIsNotTheMouse) {
  constexpr std::numeric_limits<std::int32_t> kAny;
  for (const std::int32_t station : {0, -1, kAny.min(), kAny.max()}) {
    TrackerSample sample;
    sample.station = station;
    const Device device = device_of(sample);
    EXPECT_NE(device, Device::mouse);
    EXPECT_EQ(station_of(device), station);
  }
  EXPECT_EQ(device_of(MouseSample{}), Device::mouse);
  EXPECT_EQ(station_of(Device::mouse), std::nullopt);
}

TEST(Available, IsTheLatestOfWhatASampleSays) {
  TrackerSample s = sample(1, 3000, 2000);
  EXPECT_EQ(available(s), Time{3000});
  s.host_time = Time{4000};
  EXPECT_EQ(available(s), Time{4000});
  s.session_time = Time{8333};
  EXPECT_EQ(available(s), Time{8333});
  EXPECT_EQ(arrival(s), Time{4000});  // whatever the session made of it
}

TEST(Available, OfASessionsSampleComesBackFromItsMessage) {
  TrackerSample tracker = sample(2, 1000, 2000);
  tracker.session_time = Time{4166};
  MouseSample mouse;
  mouse.device_time = Time{1000};
  mouse.trigger = true;
  mouse.session_time = Time{8333};
  Buffer bytes;
  encode(tracker, bytes);
  EXPECT_EQ(std::get<TrackerSample>(*decode_sample(kTrackerChannel, bytes)).session_time,
            Time{4166});
  encode(mouse, bytes);
  EXPECT_EQ(std::get<MouseSample>(*decode_sample(kMouseChannel, bytes)).session_time, Time{8333});
}

// A headset tells poses for a time to come.
TEST(Available, OfAPredictedPoseIsWhenItWasTold) {
  TrackerSample s = sample(1, 130'000, 101'000);
  s.sent_time = Time{100'000};
  EXPECT_EQ(available(s), Time{101'000});
  s.host_time = Time{};
  EXPECT_EQ(available(s), Time{100'000});
}

/// A message with what all versions of the type have, and its session's time if it has one.
template <typename Lcm>
Lcm message_of(const TrackerSample& s) {
  Lcm m;
  m.device_utime = s.device_time.count();
  m.host_utime = s.host_time.count();
  m.sequence = s.sequence;
  m.station = s.station;
  put(s.X_TS, m.position, m.quaternion);
  m.status = static_cast<std::int8_t>(s.status);
  m.buttons = s.buttons;
  m.frame = s.frame;
  return m;
}

TEST(SampleMessages, OfOlderVersionsAreRead) {
  TrackerSample s = sample(7, 1000, 2000);
  s.sequence = 5;
  s.X_TS = {rotation(Vec3(0.1, 0.2, 0.3)), Vec3(1.0, 2.0, 3.0)};
  auto v2 = message_of<headpin::tracked_device_v2_t>(s);
  v2.session_utime = 4166;
  Buffer first, second;
  encode_as(message_of<headpin::tracked_device_v1_t>(s), first);
  encode_as(v2, second);
  for (const Buffer& bytes : {first, second}) {
    const auto read = std::get<TrackerSample>(*decode_sample(kTrackerChannel, bytes));
    EXPECT_EQ(read.device_time, s.device_time);
    EXPECT_EQ(read.host_time, s.host_time);
    EXPECT_EQ(read.station, 7);
    EXPECT_EQ(read.X_TS.p, s.X_TS.p);
    EXPECT_EQ(read.session_time, Time{bytes == second ? 4166 : 0});
    EXPECT_EQ(read.sent_time, Time{});
    EXPECT_FALSE(read.position_estimated || read.orientation_estimated);
  }
}

TEST(SampleMessages, TellWhatIsPredictedAndEstimated) {
  TrackerSample s = sample(2, 130'000, 101'000);
  s.sent_time = Time{100'000};
  for (const auto& [position, orientation] : {std::pair(true, false), {false, true}}) {
    s.position_estimated = position;
    s.orientation_estimated = orientation;
    Buffer bytes;
    encode(s, bytes);
    const auto read = std::get<TrackerSample>(*decode_sample(kTrackerChannel, bytes));
    EXPECT_EQ(read.sent_time, s.sent_time);
    EXPECT_EQ(read.position_estimated, position);
    EXPECT_EQ(read.orientation_estimated, orientation);
    EXPECT_EQ(read.places_hand(), !position);
  }
}

TEST(SampleMessages, OfAPoseFarFromWhenItWasToldAreImplausible) {
  TrackerSample s = sample(2, 5'000'000);
  EXPECT_TRUE(plausible(s));  // not predicted
  for (const auto& [sent, is_near] : {std::pair{4'000'000, true},
                                      {6'000'000, true},
                                      {3'999'999, false},
                                      {6'000'001, false},
                                      {1, false}}) {
    s.sent_time = Time{sent};
    EXPECT_EQ(plausible(s), is_near) << sent;
  }
}

/// Hands out what it was given, all at once, whatever the time.
class Eager : public Source {
 public:
  explicit Eager(std::vector<Sample> samples) : samples_(std::move(samples)) {}
  void poll(Time, std::vector<Sample>& out) override {
    out.insert(out.end(), samples_.begin(), samples_.end());
    samples_.clear();
  }
  bool exhausted() const override { return samples_.empty(); }

 private:
  std::vector<Sample> samples_;
};

TEST(MergedSource, HandsOutEachSampleWhenAReplayWould) {
  const std::vector<Sample> first = {sample(1, 1000), sample(2, 3000, 9000)};
  const std::vector<Sample> second = {sample(3, 2000), sample(4, 8000)};
  Eager a(first), b(second);
  MergedSource merged({&a, &b});
  std::vector<Sample> all = first;
  all.insert(all.end(), second.begin(), second.end());
  ReplaySource replay(all);
  for (const std::int64_t now : {0, 1000, 2500, 8500, 9000}) {
    std::vector<Sample> from_merged, from_replay;
    merged.poll(Time{now}, from_merged);
    replay.poll(Time{now}, from_replay);
    EXPECT_EQ(stations(from_merged), stations(from_replay)) << now;
    EXPECT_EQ(merged.exhausted(), replay.exhausted()) << now;
  }
  EXPECT_TRUE(merged.exhausted());
}

TEST(SampleMessages, OfAnOlderMouseAreRead) {
  headpin::mouse3d_v1_t m{};
  m.device_utime = 1000;
  m.host_utime = 2000;
  m.right_thumb = m.trigger = 1;
  Buffer bytes;
  encode_as(m, bytes);
  const auto read = std::get<MouseSample>(*decode_sample(kMouseChannel, bytes));
  EXPECT_EQ(read.device_time, Time{1000});
  EXPECT_EQ(read.host_time, Time{2000});
  EXPECT_EQ(read.session_time, Time{});
  EXPECT_TRUE(read.right_thumb && read.trigger && !read.left_thumb);
  EXPECT_FALSE(decode_sample(kTrackerChannel, bytes));
  bytes.push_back(0);
  EXPECT_FALSE(decode_sample(kMouseChannel, bytes));
  EXPECT_FALSE(decode_sample("OTHER", bytes));
}

TEST(SampleMessages, EachNumberOfASampleIsPlausibleByItself) {
  const TrackerSample good = sample(2, 5'000'000);
  const auto is_plausible = [&](auto&& change) {
    TrackerSample s = good;
    change(s);
    return plausible(s);
  };
  EXPECT_TRUE(is_plausible([](TrackerSample&) {}));
  static constexpr Time kFar{4'000'000'000'000'000};
  EXPECT_FALSE(is_plausible([](auto& s) { s.device_time = kFar; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.host_time = -kFar; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.session_time = kFar; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.device_time = s.sent_time = kFar; }));
  EXPECT_FALSE(is_plausible([](auto& s) {  // near each other, one too far
    s.device_time = kFar - Time{1};
    s.sent_time = kFar;
  }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.sent_time = Time{1}; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.X_TS.q.w() = 1.1; }));
  // The Earth reaches so far.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(is_plausible([&](auto& s) { s.X_TS.p[axis] = -1e8; }));
    EXPECT_FALSE(is_plausible([&](auto& s) { s.X_TS.p[axis] = 1.0001e8; }));
  }
  EXPECT_TRUE(is_plausible([](auto& s) { s.sequence = 999'999'999'999'999; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.sequence = 1'000'000'000'000'000; }));
  EXPECT_FALSE(is_plausible([](auto& s) { s.sequence = -1; }));
  MouseSample mouse;
  EXPECT_TRUE(plausible(mouse));
  mouse.host_time = kFar;
  EXPECT_FALSE(plausible(mouse));
}

TEST(SampleMessages, AStatusIsALetterOrASpaceOrSentAsX) {
  TrackerSample s;
  for (int byte = -128; byte < 128; ++byte) {
    s.status = static_cast<char>(byte);
    const std::string letters = " ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    const bool is_letter = letters.find(s.status) != std::string::npos;
    EXPECT_EQ(status_letter(s), is_letter ? s.status : 'x') << byte;
  }
}

}  // namespace
}  // namespace headpin::devices
