// The motion of recordings that a test writes down, in memory and as if they were on disk.

#include "devices/recordings/recorded_motion.h"

#include <memory>

#include <gtest/gtest.h>

#include "devices/fastrak/geometry.h"

namespace headpin::devices {
namespace {

TrackerSample tracked(std::int32_t station, std::int64_t us, const Vec3& p_TS) {
  TrackerSample sample;
  sample.station = station;
  sample.device_time = Time{us};
  sample.X_TS.p = p_TS;
  return sample;
}

MouseSample clicked(std::int64_t us, bool trigger) {
  MouseSample sample;
  sample.device_time = Time{us};
  sample.trigger = trigger;
  return sample;
}

Vec3 place_in(const FastrakMotion& motion, int station, std::int64_t us) {
  return motion(station, Time{us}).X_TS.p;
}

TEST(RecordedMotion, IsOfTheFourStationsOfAUnitEachWithItsOwnPlaces) {
  std::vector<Sample> samples;
  for (const std::int32_t station : {-1, 0, 1, 2, 3, 4, 5, 1'000'000'000}) {
    samples.push_back(tracked(station, 0, Vec3(station, 0, 0)));
    samples.push_back(tracked(station, 1000, Vec3(station, 1, 0)));
  }
  const FastrakMotion motion = recorded_motion(samples);
  for (int station = 1; station <= 4; ++station) {
    EXPECT_EQ(place_in(motion, station, -5), Vec3(station, 0, 0));    // held before
    EXPECT_EQ(place_in(motion, station, 5000), Vec3(station, 1, 0));  // and after
    EXPECT_LT((place_in(motion, station, 250) - Vec3(station, 0.25, 0)).norm(), 1e-12);
  }
  const FastrakMotion rests = recorded_motion({tracked(2, 0, Vec3(7, 7, 7))});
  for (const int station : {1, 3, 4}) {
    EXPECT_EQ(place_in(rests, station, 0), still_motion(station, {}).X_TS.p);
  }
}

// Letters of the sample before; a space before the first.
TEST(RecordedMotion, HasTheLetterOfTheSampleBefore) {
  std::vector<Sample> samples;
  for (const auto& [us, letter] : {std::pair{1000, 'I'}, {2000, 'I'}, {3000, ' '}, {4000, '\0'}}) {
    TrackerSample sample = tracked(2, us, Vec3(0.5, 0, 0));
    sample.status = letter;
    samples.push_back(sample);
  }
  const FastrakMotion motion = recorded_motion(samples);
  const auto letter_at = [&](std::int64_t us) { return motion(2, Time{us}).error; };
  EXPECT_EQ(letter_at(999), ' ');
  EXPECT_EQ(letter_at(1000), 'I');
  EXPECT_EQ(letter_at(2999), 'I');
  EXPECT_EQ(letter_at(3000), ' ');
  EXPECT_EQ(letter_at(4000), 'x');  // no letter
  EXPECT_EQ(motion(1, Time{1000}).error, ' ');
}

TEST(RecordedMotion, OneSwitchIsPressedByTheTriggerAndByAnyStylus) {
  TrackerSample down = tracked(3, 2000, Vec3(0.5, 0, 0)), other = tracked(3, 3000, down.X_TS.p);
  down.buttons = 3;
  other.buttons = 2;  // not the stylus switch
  const FastrakMotion motion =
      recorded_motion({clicked(500, false), tracked(3, 1000, down.X_TS.p), down, other,
                       clicked(5000, true), clicked(6000, false)});
  for (int station = 1; station <= 4; ++station) {
    const auto pressed = [&](std::int64_t us) { return motion(station, Time{us}).pressed; };
    EXPECT_FALSE(pressed(0) || pressed(700) || pressed(1999)) << station;
    EXPECT_TRUE(pressed(2000) && pressed(2999)) << station;
    EXPECT_FALSE(pressed(3000) || pressed(4999)) << station;
    EXPECT_TRUE(pressed(5000) && pressed(5999)) << station;
    EXPECT_FALSE(pressed(6000)) << station;
  }
}

TEST(RecordedMotion, AMeasurementThatIsNotLaterThanTheOneBeforeCountsForNothing) {
  for (const std::int64_t us : {1000, 2000}) {
    TrackerSample late = tracked(1, us, Vec3(9, 9, 9));
    late.status = 'I';
    late.buttons = 1;
    const FastrakMotion motion =
        recorded_motion({tracked(1, 0, Vec3(1, 0, 0)), tracked(1, 2000, Vec3(1, 0, 0)), late,
                         tracked(1, 3000, Vec3(1, 0, 0))});
    for (const std::int64_t at : {0, 1000, 1500, 2000, 2500, 3000}) {
      const FastrakTruth truth = motion(1, Time{at});
      EXPECT_EQ(truth.X_TS.p, Vec3(1, 0, 0)) << us << " at " << at;
      EXPECT_EQ(truth.error, ' ') << us << " at " << at;
      EXPECT_FALSE(truth.pressed) << us << " at " << at;
    }
  }
}

TEST(RecordedMotion, AnEarlierStateOfTheMouseCountsForNothing) {
  const FastrakMotion motion =
      recorded_motion({clicked(2000, false), clicked(1000, true), clicked(3000, false)});
  for (const std::int64_t us : {0, 1000, 1500, 2000, 2500, 3000}) {
    EXPECT_FALSE(motion(1, Time{us}).pressed) << us;
  }
  // At the same time the last one holds.
  EXPECT_TRUE(recorded_motion({clicked(5, false), clicked(5, true)})(1, Time{5}).pressed);
}

TEST(PlaceOfTheTransmitter, IsTheRecordedOneUntilAReceiverIsNotAheadOrOutOfRange) {
  const auto place = [](const Vec3& p_TS) {
    return place_for({clicked(0, true), tracked(1, 0, Vec3(1, 0, 0)), tracked(2, 0, p_TS)});
  };
  EXPECT_EQ(place(Vec3(0.01, 0, 0)).p_TP, Vec3::Zero());
  EXPECT_EQ(place(Vec3(0, 0, 0)).p_TP, Vec3(-0.3, 0, 0));  // beside it is not ahead
  EXPECT_LT((place(Vec3(-0.2, 0.4, -0.6)).p_TP - Vec3(-0.5, 0.2, -0.3)).norm(), 1e-12);
  EXPECT_EQ(place(Vec3(kFastrakRange, 0, 0)).p_TP, Vec3::Zero());
  const FastrakPlace beyond = place(Vec3(1.25, 2, 3));
  EXPECT_LT((beyond.p_TP - Vec3(0.7, 1, 1.5)).norm(), 1e-12);
  EXPECT_NEAR(beyond.farthest, Vec3(0.55, 1, 1.5).norm(), 1e-12);
}

TEST(PlaceOfTheTransmitter, KeepsTheFactorysEnvelopeUntilThatIsTooSmall) {
  const auto envelope = [](const Vec3& p_TS) {
    return place_for({tracked(1, 0, Vec3(0.5, 0, 0)), tracked(1, 1, p_TS)}).envelope;
  };
  EXPECT_EQ(envelope(Vec3(2, 0.1, 0)), 2.0);
  EXPECT_EQ(envelope(Vec3(2.001, 0.1, 0)), kFastrakRange);
  EXPECT_EQ(envelope(Vec3(0.6, -2.001, 0)), kFastrakRange);
}

TEST(PlaceOfTheTransmitter, IsTheRecordedOneWhereNothingGoodWasMeasured) {
  TrackerSample bad = tracked(1, 0, Vec3(-5, 0, 0));
  bad.status = 'I';
  const FastrakPlace place = place_for({bad, clicked(0, true)});
  EXPECT_EQ(place.p_TP, Vec3::Zero());
  EXPECT_EQ(place.farthest, 0.0);
  EXPECT_EQ(place.envelope, 2.0);
  // Nor does a bad measurement move it where others are good.
  EXPECT_EQ(place_for({bad, tracked(1, 1, Vec3(1, 0, 0))}).p_TP, Vec3::Zero());
}

TEST(RecordedMotion, BeginsWithItsEarliestMeasurementAndEndsWithItsLastSample) {
  const std::vector<Sample> samples = {clicked(3, true), tracked(2, 20, Vec3(2, 0, 0)),
                                       tracked(1, 10, Vec3(1, 0, 0)), tracked(3, 30, Vec3(3, 0, 0)),
                                       clicked(40, false)};
  EXPECT_EQ(first_measurement(samples).station, 1);
  EXPECT_EQ(first_measurement(samples).device_time, Time{10});
  EXPECT_EQ(last_time(samples), Time{40});
  EXPECT_EQ(first_measurement({clicked(3, true)}).device_time, Time{});
  EXPECT_EQ(first_measurement({clicked(3, true)}).X_TS.p, TrackerSample{}.X_TS.p);
}

/// Samples as if they were on disk: who reads them, how often from the start, and how far.
struct OnDisk {
  explicit OnDisk(std::vector<Sample> all) : samples(std::move(all)) {
    for (const Sample& sample : samples) last[device_of(sample)] = device_time(sample);
  }
  RecordedUnit unit() {
    RecordedUnit unit = recorded_unit({.read =
                                           [this] {
                                             ++begun;
                                             at = 0;
                                             return [this] { return next(); };
                                           },
                                       .last = last});
    begun = 0;
    return unit;
  }
  std::optional<Sample> next() {
    if (at == samples.size()) return std::nullopt;
    return samples[at++];
  }

  std::vector<Sample> samples;
  std::map<Device, Time> last;
  std::size_t at = 0;
  int begun = 0;
};

/// Ten seconds of four stations at 10 Hz that go away from the transmitter, another one, and a trigger that goes down
/// at 3 s and up at 4 s.
std::vector<Sample> ten_seconds() {
  std::vector<Sample> samples;
  for (int i = 0; i <= 100; ++i) {
    for (int station = 1; station <= 5; ++station) {
      TrackerSample sample = tracked(station, 100'000 * i + station, Vec3(1 + i, station, 0));
      sample.status = i % 20 == 7 ? 'I' : ' ';
      if (station < 5 || i < 50) samples.push_back(sample);
    }
    if (i % 10 == 0) samples.push_back(clicked(100'000 * i + 6, i == 30));
  }
  return samples;
}

TEST(RecordingOnDisk, MovesAsTheSameOneInMemory) {
  OnDisk disk(ten_seconds());
  const RecordedUnit unit = disk.unit();
  const FastrakMotion whole = recorded_motion(disk.samples);
  std::vector<std::int64_t> times = {-1, 0, 1, 2, 3};
  for (std::int64_t us = 0; us < 11'000'000; us += 33'333) times.push_back(us);
  for (std::int64_t us = 10'900'000; us > -100'000; us -= 91'111) times.push_back(us);
  times.insert(times.end(), {9'000'000, 2'000'000, 100'000'000, 3'500'000, 0});
  for (const std::int64_t us : times) {
    for (int station = 1; station <= 4; ++station) {
      const FastrakTruth a = unit.motion(station, Time{us}), b = whole(station, Time{us});
      ASSERT_EQ(a.X_TS.p, b.X_TS.p) << station << " at " << us;
      ASSERT_EQ(a.error, b.error) << station << " at " << us;
      ASSERT_EQ(a.pressed, b.pressed) << station << " at " << us;
    }
  }
}

TEST(RecordingOnDisk, IsReadForwardAndFromItsStartAgainIfTimesGoBackByMoreThanASecond) {
  OnDisk disk(ten_seconds());
  const RecordedUnit unit = disk.unit();
  EXPECT_EQ(disk.begun, 0);
  unit.motion(1, Time{0});
  EXPECT_EQ(disk.begun, 1);
  EXPECT_LT(disk.at, 20u);  // no farther than it must
  unit.motion(4, Time{5'000'000});
  EXPECT_LT(disk.at, 290u);
  unit.motion(2, Time{4'000'000});
  unit.motion(2, Time{4'900'000});
  EXPECT_EQ(disk.begun, 1);
  unit.motion(2, Time{3'999'999});
  EXPECT_EQ(disk.begun, 2);
  EXPECT_LT(disk.at, 240u);
  unit.motion(2, Time{3'500'000});
  unit.motion(2, Time{3'000'000});
  unit.motion(2, Time{10'500'000});
  EXPECT_EQ(disk.begun, 2);
  unit.motion(2, Time{0});
  EXPECT_EQ(disk.begun, 3);
}

// Behind the last sample of each station nothing more is read: a station that went early is no reason.
TEST(RecordingOnDisk, IsReadNoFartherForAStationThatHasEnded) {
  for (const std::int32_t ends : {1, 2, 3, 4}) {
    std::vector<Sample> samples;
    for (int i = 0; i <= 100; ++i) {
      for (int station = 1; station <= 4; ++station) {
        if (station == ends && i > 0) continue;
        samples.push_back(tracked(station, 100'000 * i, Vec3(1 + i, station, 0)));
      }
    }
    OnDisk disk(samples);
    const RecordedUnit unit = disk.unit();
    EXPECT_EQ(place_in(unit.motion, ends, 1'000'000), Vec3(1, ends, 0));
    EXPECT_LT(disk.at, 50u) << ends;
    for (int station = 1; station <= 4; ++station) {
      if (station == ends) continue;
      EXPECT_EQ(place_in(unit.motion, station, 1'000'000), Vec3(11, station, 0));
    }
  }
}

TEST(RecordingOnDisk, MovesWhicheverStationIsItsOnlyOne) {
  for (const std::int32_t station : {1, 2, 3, 4}) {
    OnDisk disk({tracked(station, 0, Vec3(1, 0, 0)), tracked(station, 1000, Vec3(2, 0, 0)),
                 tracked(station, 2000, Vec3(3, 0, 0))});
    const RecordedUnit unit = disk.unit();
    EXPECT_EQ(place_in(unit.motion, station, 1000), Vec3(2, 0, 0)) << station;
    EXPECT_EQ(place_in(unit.motion, station, 2000), Vec3(3, 0, 0)) << station;
  }
}

// A file may be cut since it was looked through.
TEST(RecordingOnDisk, EndsWhereItsSamplesEnd) {
  OnDisk disk({tracked(1, 0, Vec3(1, 0, 0)), tracked(1, 1000, Vec3(2, 0, 0))});
  disk.last[device_at(1)] = Time{5000};
  disk.last[device_at(2)] = Time{5000};
  const RecordedUnit unit = disk.unit();
  EXPECT_EQ(place_in(unit.motion, 1, 4000), Vec3(2, 0, 0));
  EXPECT_EQ(place_in(unit.motion, 2, 4000), still_motion(2, {}).X_TS.p);
  EXPECT_EQ(place_in(unit.motion, 1, 0), Vec3(1, 0, 0));
}

TEST(RecordingOnDisk, HasTheMousesStatesThatDifferFromTheOneBefore) {
  std::vector<Sample> samples;
  for (const int state : {0, 0, 1, 1, 3, 2, 2, 6, 4, 4, 0}) {
    MouseSample mouse = clicked(1000 * static_cast<std::int64_t>(samples.size()), (state & 4) != 0);
    mouse.left_thumb = (state & 1) != 0;
    mouse.right_thumb = (state & 2) != 0;
    samples.emplace_back(mouse);
  }
  samples.emplace_back(clicked(500, true));  // late
  const std::vector<MouseSample> buttons = OnDisk(samples).unit().buttons;
  std::vector<std::pair<std::int64_t, int>> found;
  for (const MouseSample& mouse : buttons) {
    found.emplace_back(mouse.device_time.count(),
                       mouse.left_thumb + 2 * mouse.right_thumb + 4 * mouse.trigger);
  }
  const std::vector<std::pair<std::int64_t, int>> expected = {
      {0, 0}, {2000, 1}, {4000, 3}, {5000, 2}, {7000, 6}, {8000, 4}, {10000, 0}};
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace headpin::devices
