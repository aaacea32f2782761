// Poses that a publisher predicts.

#include <vector>

#include <gtest/gtest.h>

#include "devices/base/clocks.h"
#include "devices/lcm/link.h"
#include "devices/lcm/source.h"

namespace headpin::devices {
namespace {

TrackerSample pose_for(std::int64_t us) {
  TrackerSample sample;
  sample.device_time = Time{us};
  sample.station = kHandStation;
  return sample;
}

// The publisher's clock is compared by when it told a pose, not by what time the pose is for.
TEST(LcmPredicted, APredictedPoseIsAheadOfItsArrivalAndUsedAtOnce) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  constexpr std::int64_t kTheirs = 1'700'000'000'000'000;
  std::vector<Sample> out;
  for (int i = 0; i < 10; ++i) {
    TrackerSample sample = pose_for(kTheirs + 20'000 * i + 30'000);
    sample.sent_time = Time{kTheirs + 20'000 * i};
    sample.sequence = i;
    link.publish(Sample(sample));
    const Time now{50'000 + 20'000 * i + (i % 3) * 2'000};  // some are delayed
    source.receive(now);
    source.poll(now, out);
    ASSERT_EQ(out.size(), static_cast<std::size_t>(i + 1));
    const auto& read = std::get<TrackerSample>(out.back());
    EXPECT_EQ(read.sent_time, Time{50'000 + 20'000 * i});
    EXPECT_EQ(read.device_time, read.sent_time + Time{30'000});
    EXPECT_EQ(read.host_time, now);
  }
  EXPECT_EQ(source.intake().counts().clock_jumps, 0);
  EXPECT_EQ(source.intake().lost(), 0);
}

// A device that measures tells nothing of when it sent: its samples are as early as ever.
TEST(LcmPredicted, WithoutATimeOfSendingAPoseIsForTheTimeThatItArrives) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  link.publish(Sample(pose_for(30'000)));
  source.receive(Time{50'000});
  std::vector<Sample> out;
  source.poll(Time{60'000}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(std::get<TrackerSample>(out[0]).device_time, Time{50'000});
  EXPECT_EQ(std::get<TrackerSample>(out[0]).sent_time, Time{});
}

}  // namespace
}  // namespace headpin::devices
