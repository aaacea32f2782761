#include "scene/play/delays.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "scene/live/frames_beside.h"
#include "scene/play/quantile.h"

namespace headpin::scene {
namespace {

// 0.2 ms to 2 s, as many in each decade.
TEST(DelaysTest, QuantilesAreThoseOfTheValuesToOnePercent) {
  Delays delays;
  std::vector<double> all;
  Random random(1, 0, 0);
  for (int i = 0; i < 10'000; ++i) {
    all.push_back(2e-4 * std::pow(10.0, 4.0 * random.uniform()));
    delays.add(all.back());
  }
  EXPECT_EQ(delays.count(), 10'000);
  for (const double share : {0.0, 0.01, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = quantile(all, share);
    EXPECT_NEAR(delays.quantile(share), exact, 0.01 * exact) << share;
  }
  EXPECT_EQ(delays.quantile(1.0), quantile(all, 1.0));
}

TEST(DelaysTest, NoneTinyAndHugeOnesAreCounted) {
  Delays delays;
  EXPECT_EQ(delays.quantile(0.5), 0.0);
  EXPECT_EQ(delays.quantile(1.0), 0.0);
  delays.add(0.0);
  delays.add(-1.0);
  EXPECT_EQ(delays.quantile(0.5), 0.0);
  delays.add(2e5);
  delays.add(3e5);
  delays.add(3e5);
  EXPECT_EQ(delays.quantile(0.9), 3e5);
  EXPECT_NEAR(delays.quantile(0.1), 1e-6, 0.01e-6);
}

// It kept each of them, and looked at all of them while a session ran.
TEST(DelaysTest, LatenciesOfFramesAreOneHistogram) {
  FrameLatency latency;
  for (int i = 0; i < 100; ++i) {
    latency.add(
        {.ticked = 1e-3, .waited = 2e-3, .drawn = 3e-3, .published = i < 90 ? 4e-3 : 14e-3});
  }
  EXPECT_EQ(latency.each.count(), 100);
  EXPECT_NEAR(latency.each.quantile(0.5), 10e-3, 0.1e-3);
  EXPECT_NEAR(latency.each.quantile(0.99), 20e-3, 0.2e-3);
  EXPECT_NEAR(latency.mean().sum(), 11e-3, 1e-9);
}

}  // namespace
}  // namespace headpin::scene
