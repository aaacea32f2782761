#include "devices/recordings/same_times.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

/// A track along x with `speed` [m/s], from `first` to 1 s, a sample each `step`.
PoseTrack moving(Time first, Time step, double speed) {
  PoseTrack track;
  for (Time time = first; time < Time{1'000'000}; time += step)
    track.push(time, {Quat::Identity(), Vec3(speed * seconds(time), 0.0, 0.0)});
  return track;
}

MotionRecording joined(const PoseTrack& head, const PoseTrack* left, const PoseTrack* right) {
  const PartTracks tracks = {&head, left, right};
  return together(tracks, throwing_part(tracks), "x");
}

/// Each sample of a track within the recording is in it, to the last bit and at its time.
void expect_all_samples(const PoseTrack& track, const MotionRecording& r,
                        const std::vector<Pose>& poses) {
  std::size_t i = 0;
  for (const Stamped<Pose>& sample : track.samples()) {
    if (sample.time < r.start + r.times.front() || sample.time > r.start + r.times.back()) continue;
    ASSERT_LT(i, r.times.size());
    EXPECT_EQ(r.start + r.times[i], sample.time);
    EXPECT_EQ(poses[i++].p, sample.value.p);
  }
  EXPECT_EQ(i, r.times.size());
}

// A hand of 200 Hz lost three of four samples where the head has 50 Hz.
TEST(SameTimes, AreThoseOfTheHandWhateverTheRateOfTheHead) {
  const PoseTrack hand = moving(Time{0}, Time{5'000}, 6.0);
  for (const int ms : {1, 20, 47}) {
    const PoseTrack head = moving(Time{3'000}, Time{1000 * ms}, 0.5);
    const MotionRecording r = joined(head, nullptr, &hand);
    EXPECT_NEAR(static_cast<double>(r.times.size()), 200.0, 10.0) << ms;
    expect_all_samples(hand, r, r.right_hand);
    for (std::size_t i = 0; i < r.times.size(); ++i)
      EXPECT_NEAR(r.head[i].p.x(), 0.5 * seconds(r.start + r.times[i]), 1e-12);
    EXPECT_THAT(r.notes, testing::ElementsAre(HasSubstr("samples of the head are interpolated")))
        << ms;
  }
}

TEST(SameTimes, AreThoseOfTheHandThatThrows) {
  const PoseTrack head = moving(Time{0}, Time{10'000}, 0.5);
  const PoseTrack left = moving(Time{2'000}, Time{10'000}, 1.0);
  const PoseTrack right = moving(Time{3'000}, Time{10'000}, 6.0);
  const MotionRecording r = joined(head, &left, &right);
  expect_all_samples(right, r, r.right_hand);
  const MotionRecording mirrored = joined(head, &right, &left);
  expect_all_samples(right, mirrored, mirrored.left_hand);
  EXPECT_EQ(throwing_part({&head, &left, &right}, true), 1u);  // as the user says
  EXPECT_EQ(throwing_part({&head, nullptr, &right}, true), 2u);
  EXPECT_EQ(throwing_part({&head, nullptr, nullptr}), 0u);
}

// A trial has 250 samples a second at most.
TEST(SameTimes, AreThoseOfTheHeadWhereTheHandIsTooFastForATrial) {
  const PoseTrack slow = moving(Time{0}, Time{10'000}, 0.5);
  const PoseTrack most = moving(Time{0}, Time{4'000}, 6.0),
                  fast = moving(Time{0}, Time{2'000}, 6.0);
  EXPECT_EQ(timing_part({&slow, nullptr, &most}, 2), 2u);
  EXPECT_EQ(timing_part({&slow, nullptr, &fast}, 2), 0u);
  EXPECT_EQ(timing_part({&fast, nullptr, &fast}, 2), 2u);
  const PartTracks tracks = {&slow, nullptr, &fast};
  const MotionRecording r = together(tracks, timing_part(tracks, 2), "x");
  expect_all_samples(slow, r, r.head);
  EXPECT_THAT(r.notes,
              testing::ElementsAre(HasSubstr("samples of the right hand are interpolated")));
}

TEST(SameTimes, OfTracksThatHaveThemAreTheirsToTheBit) {
  const PoseTrack head = moving(Time{1'000}, Time{11'111}, 0.1);
  const PoseTrack left = moving(Time{1'000}, Time{11'111}, 0.3);
  const PoseTrack right = moving(Time{1'000}, Time{11'111}, 6.0);
  const MotionRecording r = joined(head, &left, &right);
  EXPECT_EQ(r.times.size(), head.samples().size());
  expect_all_samples(head, r, r.head);
  expect_all_samples(left, r, r.left_hand);
  expect_all_samples(right, r, r.right_hand);
  EXPECT_THAT(r.notes, testing::IsEmpty());
}

// So the samples have a gap there, beside which a throw may be.
TEST(SameTimes, AreNoneInAGapOfTheHead) {
  const PoseTrack hand = moving(Time{0}, Time{10'000}, 6.0);
  PoseTrack head;
  for (const auto& sample : hand.samples()) {
    if (sample.time <= Time{400'000} || sample.time >= Time{600'000})
      head.push(sample.time, sample.value);
  }
  const MotionRecording r = joined(head, nullptr, &hand);
  EXPECT_EQ(r.times.size(), 81u);
  ASSERT_THAT(r.notes, testing::SizeIs(1));
  EXPECT_THAT(r.notes[0], HasSubstr("no samples of the head for more than 0.1 s from 0.4 s: 19"));
}

TEST(SameTimes, NeedEachPartAtOnce) {
  PoseTrack head = moving(Time{0}, Time{10'000}, 0.0);
  PoseTrack left = moving(Time{200'000}, Time{10'000}, 0.0);
  const PoseTrack right = moving(Time{3'000}, Time{10'000}, 1.0);
  const MotionRecording r = joined(head, &left, &right);
  ASSERT_EQ(r.times.size(), 79u);  // from 0.203 s to 0.983 s; the head ends at 0.99 s
  EXPECT_EQ(r.start, Time{200'000});
  EXPECT_EQ(r.times.front(), Time{3'000});
  PoseTrack holed = right, late;
  holed.push(Time{1'500'000}, {});
  head.push(Time{1'300'000}, {});
  head.push(Time{1'600'000}, {});
  left.push(Time{1'600'000}, {});
  EXPECT_EQ(complaint([&] { joined(head, &right, &holed); }), "");
  EXPECT_THAT(complaint([&] { joined(head, &left, &holed); }),
              HasSubstr("no samples of the left hand for"));
  EXPECT_THAT(complaint([&] { joined(head, &left, &late); }),
              HasSubstr("no samples of the right hand"));
  late.push(Time{9'000'000}, {});
  EXPECT_THAT(complaint([&] { joined(head, &head, &late); }), HasSubstr("never recorded"));
}

}  // namespace
}  // namespace headpin::devices
