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
  const std::size_t thrower = throwing_part(tracks);
  return together(tracks, thrower, thrower, "x");
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
  const MotionRecording r = together(tracks, 2, timing_part(tracks, 2), "x");
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

TEST(SameTimes, AreNoneInAGapOfAThrowingHandWhoseTimesAreNotTaken) {
  const PoseTrack head = moving(Time{0}, Time{10'000}, 0.5);
  PoseTrack hand;
  const PoseTrack whole = moving(Time{0}, Time{2'000}, 6.0);
  for (const Stamped<Pose>& sample : whole.samples()) {
    if (sample.time <= Time{400'000} || sample.time >= Time{600'000})
      hand.push(sample.time, sample.value);
  }
  const MotionRecording r = together({&head, nullptr, &hand}, 2, 0, "x");
  EXPECT_EQ(r.times.size(), 81u);
  EXPECT_THAT(r.notes, testing::Contains(HasSubstr(
                           "no samples of the right hand for more than 0.1 s from 0.4 s: 19")));
}

TEST(SameTimes, NeedHeadAndThrowingHandAtOnce) {
  const PoseTrack head = moving(Time{0}, Time{10'000}, 0.0);
  const PoseTrack late = moving(Time{200'000}, Time{10'000}, 0.0);
  const PoseTrack right = moving(Time{3'000}, Time{10'000}, 1.0);
  const MotionRecording r = joined(late, nullptr, &right);
  ASSERT_EQ(r.times.size(), 79u);  // from 0.203 s to 0.983 s; the head ends at 0.99 s
  EXPECT_EQ(r.start, Time{200'000});
  EXPECT_EQ(r.times.front(), Time{3'000});
  PoseTrack none, after;
  EXPECT_THAT(complaint([&] { joined(head, &late, &none); }),
              HasSubstr("no samples of the right hand"));
  after.push(Time{9'000'000}, {});
  EXPECT_THAT(complaint([&] { joined(head, &head, &after); }),
              HasSubstr("head and right hand were never recorded"));
}

// A left hand that was put down after a few seconds took the rest of the right hand's throws away.
TEST(SameTimes, AreThoseOfTheThrowingHandHoweverShortTheOtherIsTracked) {
  const PoseTrack head = moving(Time{0}, Time{10'000}, 0.0);
  const PoseTrack right = moving(Time{0}, Time{10'000}, 6.0);
  PoseTrack left;
  for (const int ms : {300, 310, 320, 500, 510})
    left.push(Time{1000 * ms}, {Quat::Identity(), Vec3(0.0, 0.001 * ms, 0.0)});
  const MotionRecording r = joined(head, &left, &right);
  EXPECT_EQ(r.times.size(), right.samples().size());
  expect_all_samples(right, r, r.right_hand);
  ASSERT_EQ(r.left_hand.size(), r.times.size());
  EXPECT_EQ(r.left_hand.front().p.y(), 0.3);
  EXPECT_NEAR(r.left_hand[41].p.y(), 0.41, 1e-12);  // between two samples, 0.18 s apart
  EXPECT_EQ(r.left_hand.back().p.y(), 0.51);
  EXPECT_THAT(
      r.notes,
      testing::IsSupersetOf(
          {HasSubstr("no samples of the left hand before 0.3 s: its first pose is held there (20"),
           HasSubstr("no samples of the left hand for 0.18 s from 0.32 s: its poses in such gaps "
                     "are interpolated (17"),
           HasSubstr(
               "no samples of the left hand after 0.51 s: its last pose is held there (38")}));
  const PoseTrack none;
  const MotionRecording alone = joined(head, &none, &right);
  EXPECT_EQ(alone.times.size(), right.samples().size());
  EXPECT_THAT(alone.left_hand, testing::IsEmpty());
  EXPECT_THAT(alone.notes, testing::ElementsAre("no samples of the left hand: left out"));
}

// So one throw ends there and the next begins, as in a gap of all.
TEST(SameTimes, OfAThrowingHandWithAGapHaveIt) {
  const PoseTrack head = moving(Time{0}, Time{10'000}, 0.0);
  PoseTrack right;
  const PoseTrack whole = moving(Time{0}, Time{10'000}, 6.0);
  for (const Stamped<Pose>& sample : whole.samples()) {
    if (sample.time <= Time{400'000} || sample.time >= Time{600'000})
      right.push(sample.time, sample.value);
  }
  const MotionRecording r = joined(head, nullptr, &right);
  EXPECT_EQ(r.times.size(), 81u);
  expect_all_samples(right, r, r.right_hand);
  EXPECT_THAT(r.notes, testing::Contains(
                           "no samples of the right hand for 0.2 s from 0.4 s: the recording has a "
                           "gap there"));
}

/// A resting track of `count` samples, a sample each `step`.
PoseTrack still_track(std::size_t count, Time step) {
  PoseTrack track;
  for (std::size_t i = 0; i < count; ++i)
    track.push(step * static_cast<int>(i), {Quat::Identity(), Vec3::Zero()});
  return track;
}

TEST(SameTimes, AreThoseOfAHandOfUpTo250SamplesASecondHoweverLongItIs) {
  const PoseTrack head = still_track(21, Time{100'000});  // 2 s
  const auto timer = [&](const PoseTrack& hand) { return timing_part({&head, nullptr, &hand}, 2); };
  EXPECT_EQ(timer(still_track(401, Time{5'000})), 2u);
  EXPECT_EQ(timer(still_track(501, Time{4'000})), 2u);
  EXPECT_EQ(timer(still_track(502, Time{3'999})), 0u);
  // One sample has no rate, two have.
  EXPECT_EQ(timer(still_track(1, Time{1'000})), 2u);
  EXPECT_EQ(timer(still_track(2, Time{4'000})), 2u);
  EXPECT_EQ(timer(still_track(2, Time{3'999})), 0u);
}

TEST(SameTimes, OfATrackWithATwentiethMoreSamplesNeedNoNote) {
  const PoseTrack hand = still_track(21, Time{10'000});
  PoseTrack twentieth, more;
  for (const Stamped<Pose>& sample : hand.samples()) {
    if (sample.time != Time{100'000}) twentieth.push(sample.time, sample.value);
    if (sample.time != Time{50'000} && sample.time != Time{100'000})
      more.push(sample.time, sample.value);
  }
  EXPECT_THAT(joined(hand, nullptr, &twentieth).notes, testing::IsEmpty());  // 21 for 20
  EXPECT_THAT(joined(twentieth, nullptr, &hand).notes, testing::IsEmpty());
  EXPECT_THAT(joined(hand, nullptr, &more).notes,
              testing::ElementsAre("21 samples of the head are interpolated at the 19 times of "
                                   "the right hand"));
}

TEST(SameTimes, InAGapOfAllHaveNoNoteOfTheHandAlone) {
  PoseTrack head, hand;
  const PoseTrack whole = moving(Time{0}, Time{10'000}, 6.0);
  for (const Stamped<Pose>& sample : whole.samples()) {
    if (sample.time > Time{400'000} && sample.time < Time{600'000}) continue;
    head.push(sample.time, sample.value);
    hand.push(sample.time, sample.value);
  }
  EXPECT_THAT(joined(head, nullptr, &hand).notes, testing::IsEmpty());
  // Nor where the times of the head are taken, and it has more samples.
  const PoseTrack slow = moving(Time{0}, Time{20'000}, 6.0);
  EXPECT_THAT(together({&slow, nullptr, &hand}, 2, 0, "x").notes,
              testing::Not(testing::Contains(HasSubstr("the recording has a gap there"))));
}

}  // namespace
}  // namespace headpin::devices
