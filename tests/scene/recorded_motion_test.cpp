#include "devices/recordings/recorded_motion.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include "scene/record/log.h"
#include "scene/record/unit.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using namespace std::chrono_literals;

/// Two receivers at 60 Hz, the second away for a while, some samples out of order, letters, a
/// stylus switch, and thumbs and trigger now and then.
std::vector<devices::Sample> recording(Time length) {
  std::vector<devices::Sample> samples;
  for (Time t{}; t < length; t += 8333us) {
    const int i = static_cast<int>(t / 8333us);
    devices::TrackerSample s;
    s.station = 1 + i % 2;
    s.sequence = i / 2;
    s.device_time = i % 50 == 7 ? t - 40ms : t;
    const double at = seconds(t);
    s.X_TS.p = Vec3(0.5 + 0.3 * at / (1.0 + at), 0.1 * (i % 17), -0.1 * (i % 5));
    s.X_TS.q = rotation(Vec3(0.0, 0.01 * (i % 90), 0.0));
    s.status = i % 200 < 3 ? 'I' : ' ';
    s.buttons = i % 300 < 40 ? 1 : 0;
    if (s.station == 1 || t < 3s || t > 6s) samples.push_back(s);
    if (i % 90 == 0) {
      samples.push_back(devices::MouseSample{.device_time = t, .trigger = i % 180 == 0});
      samples.push_back(devices::MouseSample{.device_time = t + 1ms, .trigger = i % 180 == 0});
    }
  }
  return samples;
}

std::shared_ptr<const TrialFile> on_disk(const TemporaryFolder& folder,
                                         const std::vector<devices::Sample>& samples) {
  const std::string path = folder / "trial.lcmlog";
  Recorder recorder(path, TrialHeader{});
  for (const devices::Sample& sample : samples) recorder.write(sample);
  recorder.close();
  return std::make_shared<const TrialFile>(path);
}

void expect_same(const devices::FastrakTruth& a, const devices::FastrakTruth& b, int station,
                 Time time) {
  EXPECT_EQ(a.X_TS.p, b.X_TS.p) << station << " at " << time.count();
  EXPECT_EQ(a.X_TS.q.coeffs(), b.X_TS.q.coeffs()) << station << " at " << time.count();
  EXPECT_EQ(a.pressed, b.pressed) << station << " at " << time.count();
  EXPECT_EQ(a.error, b.error) << station << " at " << time.count();
}

// Forward, a little and far back, far ahead, before the start and behind the end.
TEST(RecordedUnit, MeasuresWhatAWholeRecordingDoes) {
  const TemporaryFolder folder;
  const std::vector<devices::Sample> samples = recording(10s);
  const devices::RecordedUnit unit = recorded_unit(on_disk(folder, samples));
  const devices::FastrakMotion whole = devices::recorded_motion(samples);
  std::vector<Time> times;
  for (Time t{}; t < 11s; t += 2777us) times.push_back(t - (t.count() % 3 == 0 ? 20ms : 0ms));
  times.insert(times.end(), {0s, 9s, 4s, -1s, 100s, 2s});
  for (Time t = 2s; t < 7s; t += 13ms) times.push_back(t);
  for (const Time time : times) {
    for (int station = 1; station <= 4; ++station) {
      expect_same(unit.motion(station, time), whole(station, time), station, time);
    }
  }
  EXPECT_EQ(unit.place.p_TP, devices::place_for(samples).p_TP);
  EXPECT_EQ(unit.place.envelope, devices::place_for(samples).envelope);
  EXPECT_EQ(unit.place.farthest, devices::place_for(samples).farthest);
  EXPECT_EQ(unit.first.device_time, devices::first_measurement(samples).device_time);
  EXPECT_EQ(unit.length, devices::last_time(samples));
}

TEST(RecordedUnit, KeepsTheMousesChangesAlone) {
  const TemporaryFolder folder;
  const std::vector<devices::MouseSample> buttons =
      recorded_unit(on_disk(folder, recording(10s))).buttons;
  ASSERT_GT(buttons.size(), 5u);
  for (std::size_t i = 1; i < buttons.size(); ++i) {
    EXPECT_NE(buttons[i].trigger, buttons[i - 1].trigger);
    EXPECT_GT(buttons[i].device_time, buttons[i - 1].device_time);
  }
}

devices::TrackerSample measured(Time time, const Vec3& p_TS) {
  devices::TrackerSample sample;
  sample.station = 1;
  sample.device_time = time;
  sample.X_TS.p = p_TS;
  return sample;
}

TEST(RecordedUnit, BeginsWithTheEarliestMeasurementWhereverItStands) {
  const std::vector<devices::Sample> samples = {
      devices::MouseSample{.device_time = 1ms}, measured(20ms, Vec3(0.5, 0.0, 0.0)),
      measured(10ms, Vec3(0.6, 0.0, 0.0)), measured(30ms, Vec3(0.7, 0.0, 0.0))};
  EXPECT_EQ(devices::first_measurement(samples).device_time, 10ms);
  EXPECT_EQ(devices::last_time(samples), 30ms);
}

TEST(RecordedUnit, ItsTransmitterStaysWhereAllIsAheadAndElseGoesBehindAll) {
  const devices::FastrakPlace stays =
      devices::place_for({measured(1ms, Vec3(0.5, 0.2, 0.0)), measured(2ms, Vec3(1.0, -0.2, 0.0))});
  EXPECT_EQ(stays.p_TP, Vec3::Zero());
  EXPECT_DOUBLE_EQ(stays.farthest, Vec3(1.0, -0.2, 0.0).norm());
  const devices::FastrakPlace moved =
      devices::place_for({measured(1ms, Vec3(-0.4, 0.2, 1.0)), measured(2ms, Vec3(0.6, 0.6, 0.0))});
  EXPECT_LT((moved.p_TP - Vec3(-0.7, 0.4, 0.5)).norm(), 1e-12);
  EXPECT_NEAR(moved.farthest, Vec3(1.3, 0.2, 0.5).norm(), 1e-12);
}

TEST(RecordedUnit, HoldsLittleOfALongRecording) {
#ifdef HEADPIN_SANITIZED
  GTEST_SKIP() << "AddressSanitizer has an allocator of its own";
#endif
  const auto in_use = [] {
    const struct mallinfo2 now = mallinfo2();
    return now.uordblks + now.hblkhd;
  };
  const TemporaryFolder folder;
  const auto file = on_disk(folder, recording(400s));  // 48000 poses of 64 bytes
  const std::size_t before = in_use();
  const devices::RecordedUnit unit = recorded_unit(file);
  std::size_t most = 0;
  for (Time t{}; t < 400s; t += 8333us) {
    unit.motion(1 + static_cast<int>(t / 8333us) % 2, t);
    most = std::max(most, in_use());
  }
  EXPECT_LT(most, before + 300'000);
}

}  // namespace
}  // namespace headpin::scene
