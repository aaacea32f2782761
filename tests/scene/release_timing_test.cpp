// The fastest moment around a release, as a trial's log tells it.

#include "scene/play/release_timing.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using test::play;
using test::straight_throw;

using TimedSamples = std::vector<devices::Sample>;

/// The timings of a trial with these samples.
std::vector<ReleaseTiming> timings_of(const Scenario& scenario, const TimedSamples& samples) {
  const TemporaryFolder folder;
  const std::string path = (folder / "throw.lcmlog").string();
  TrialHeader header;
  header.scenario = to_toml(scenario);
  Recorder recorder(path, header);
  write(recorder, samples, play(scenario, samples, 1.0).events);
  recorder.close();
  return release_timings(TrialFile(path), scenario);
}

Scenario releasing_at(ReleaseAt release_at) {
  Scenario scenario;
  scenario.hand.release_at = release_at;
  if (release_at == ReleaseAt::sample) {
    scenario.hand.release_window_s = 0.06;
    scenario.hand.release_window_most_s = 0.12;
  }
  return scenario;
}

/// The samples of a throw, where `beside` adds some after each of the hand.
TimedSamples with_more(
    const TimedSamples& samples,
    const std::function<void(TimedSamples&, const devices::TrackerSample&)>& beside) {
  TimedSamples all;
  for (const devices::Sample& sample : samples) {
    all.push_back(sample);
    const auto* hand = std::get_if<devices::TrackerSample>(&sample);
    if (hand && hand->station == devices::kHandStation) beside(all, *hand);
  }
  return all;
}

// Neither another sensor between its samples, nor a guess, nor a second sample of the same time.
TEST(FastestRelease, IsTheHandsAlone) {
  for (const ReleaseAt release_at : {ReleaseAt::trigger, ReleaseAt::sample}) {
    const Scenario scenario = releasing_at(release_at);
    const TimedSamples samples = straight_throw(scenario);
    const TimedSamples more =
        with_more(samples, [](TimedSamples& all, const devices::TrackerSample& hand) {
          devices::TrackerSample other = hand;
          other.X_TS.p += Vec3(1.0, 0.0, 0.0);
          all.emplace_back(other);
          other.device_time += Time{4'000};
          other.position_estimated = true;
          all.emplace_back(other);
          other.device_time += Time{4'000};
          other.position_estimated = false;
          other.station = devices::kHeadStation;
          other.X_TS.p = Vec3(-0.2, -0.4, 1.7);
          all.emplace_back(other);
        });
    const auto own = timings_of(scenario, samples), found = timings_of(scenario, more);
    ASSERT_EQ(own.size(), 1u);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].release, own[0].release);
    EXPECT_EQ(found[0].fastest, own[0].fastest);
    EXPECT_EQ(found[0].fastest_speed, own[0].fastest_speed);
  }
}

/// A throw without the hand's samples between two times.
TimedSamples with_gap(const Scenario& scenario, double from_s, double to_s) {
  TimedSamples samples = straight_throw(scenario);
  std::erase_if(samples, [&](const devices::Sample& sample) {
    const auto* hand = std::get_if<devices::TrackerSample>(&sample);
    const bool is_hand = hand && hand->station == devices::kHandStation;
    return is_hand && seconds(hand->device_time) > from_s && seconds(hand->device_time) < to_s;
  });
  return samples;
}

TEST(FastestRelease, IsFoundOnEitherSideOfAGap) {
  for (const ReleaseAt release_at : {ReleaseAt::trigger, ReleaseAt::sample}) {
    const Scenario scenario = releasing_at(release_at);
    const auto found = timings_of(scenario, with_gap(scenario, 0.75, 1.1));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(seconds(found[0].fastest), 0.72, 0.03);
    EXPECT_NEAR(found[0].fastest_speed, 12.0 * 0.52, 0.4);
  }
}

TEST(FastestRelease, IsNotToldWhereTheHandWasNotTracked) {
  for (const ReleaseAt release_at : {ReleaseAt::trigger, ReleaseAt::sample}) {
    const Scenario scenario = releasing_at(release_at);
    EXPECT_TRUE(timings_of(scenario, with_gap(scenario, 0.12, 2.0)).empty());
  }
}

// The hand stops at 0.72 s. A release knows the samples that were told until then, and by one that was told ahead it
// knows of the stop.
TEST(FastestRelease, KnowsThePosesThatAreToldAhead) {
  const auto fastest = [](double delay_s, double predicted_s) {
    Scenario scenario;
    scenario.rig.delay_s = delay_s;
    scenario.rig.predicted_s = predicted_s;
    const auto found = timings_of(scenario, straight_throw(scenario));
    return found.size() == 1 ? found[0].fastest_speed : 0.0;
  };
  const double none = fastest(0.0, 0.0), ahead = fastest(0.0, 0.05), late = fastest(0.05, 0.0);
  EXPECT_GT(none, 0.0);
  EXPECT_NEAR(ahead, late, 0.02);
  EXPECT_GT(std::abs(ahead - none), 0.05);
}

}  // namespace
}  // namespace headpin::scene
