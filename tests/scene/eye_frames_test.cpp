#include "scene/eye_frames.h"

#include <semaphore>

#include <gtest/gtest.h>

#include "devices/sources.h"

namespace headpin::scene {
namespace {

/// Holds each frame until it may go.
struct HeldSink : FrameSink {
  explicit HeldSink(std::counting_semaphore<>& s, std::counting_semaphore<>& g) : shown(s), go(g) {}
  void add(const EyeFrame&) override {
    shown.release();
    go.acquire();
  }
  std::counting_semaphore<>&shown, &go;
};

TEST(FramesBeside, TheFrameThatIsBeingShownAtTheEndIsAmongThoseDone) {
  const auto stage = std::make_shared<const Stage>(make_stage({}));
  std::counting_semaphore<> shown{0}, go{0};
  FramesBeside eyes({.eyes = [&] { return open_eyes(*stage); },
                     .sink = [&](const Eyes&) { return std::make_unique<HeldSink>(shown, go); }});
  Session session = make_session(stage);
  devices::TrackerSample head;
  head.station = devices::kHeadStation;
  head.X_TS.p = Vec3(0.0, -0.4, 1.7);
  devices::ReplaySource source({head});
  while (!head_pose(session)) advance(session, source);
  eyes.begin(FramesBeside::Clock::now());
  eyes.tick(session);
  shown.acquire();
  EXPECT_TRUE(eyes.take_done().empty());  // it is on its way
  go.release();
  eyes.finish();
  const std::vector<FramesBeside::Done> done = eyes.take_done();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].record.tick, session.tick);
}

/// Keeps where the eyes were.
struct SeenFrom : FrameSink {
  void add(const EyeFrame& frame) override {
    times.push_back(frame.time);
    middles.push_back(0.5 * (frame.views[0].X_WE.p + frame.views[1].X_WE.p));
  }
  std::vector<Time> times;
  std::vector<Vec3> middles;
};

/// A head that moves to the right at 1 m/s, told at 120 Hz.
std::vector<devices::Sample> moving_head(double until_s) {
  std::vector<devices::Sample> samples;
  for (std::int64_t i = 0; seconds(tick_time(i, 120)) <= until_s; ++i) {
    devices::TrackerSample head;
    head.station = devices::kHeadStation;
    head.device_time = head.host_time = tick_time(i, 120);
    head.X_TS.p = Vec3(seconds(tick_time(i, 120)), -0.4, 1.7);
    samples.push_back(head);
  }
  return samples;
}

/// How far the eyes are from where the head was at each frame's own time, and the delay before [m].
double farthest(std::int64_t fps, double delay_s) {
  Scenario scenario;
  scenario.rig.delay_s = delay_s;
  scenario.hmd.optics.width = 16;
  scenario.hmd.optics.height = 8;
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  Eyes eyes = open_eyes(*stage);
  Session session = make_session(stage);
  devices::ReplaySource source(moving_head(0.5));
  SeenFrom seen;
  FrameByFrame drawing(eyes,
                       {.fps = fps,
                        .frames = fps / 3,
                        .wanted = [](auto) { return true; },
                        .X_WD_first = {},
                        .progress = [](auto) {}},
                       {&seen});
  drawing.start(session);
  while (session.now() < Time{400'000}) {
    advance(session, source);
    drawing.tick(session);
  }
  double most = 0.0;
  for (std::size_t i = 0; i < seen.times.size(); ++i) {
    const double at = seconds(seen.times[i]) - delay_s;
    if (at < 0.02) continue;  // before that there is one sample
    most = std::max(most, std::abs(seen.middles[i].x() - at));
  }
  EXPECT_GT(seen.times.size(), 15u);
  return most;
}

// With the delay both samples around a moment are there. Without, the newest one is held, and is
// a sample of 120 Hz old at most. A microsecond is what times are rounded to.
TEST(FrameByFrame, ReadsTheHeadAtEachFramesOwnTime) {
  for (const std::int64_t fps : {60, 90, 144}) EXPECT_LT(farthest(fps, 0.02), 2e-6) << fps;
  EXPECT_LT(farthest(90, 0.0), 1.0 / 120 + 2e-6);
}

TEST(BetweenTicks, BodiesAreOnTheirWayAndWhatIsSetElsewhereIsNot) {
  Session session = make_session(Scenario());
  const engine::BodyId ball = session.stage->balls[0], skittle = session.stage->skittles[0];
  session.tick = 240;
  session.world.states[ball].X_WB.p = Vec3(0.0, 1.0, 0.2);
  session.world.states[ball].v_WB = Vec3(0.0, 12.0, 0.0);
  const Pose spot = session.world.states[skittle].X_WB;
  BetweenTicks between;
  between.keep(session);
  session.tick = 241;
  session.world.states[ball].X_WB.p.y() += 0.05;
  session.world.states[skittle].X_WB.p.x() += 0.3;  // at rest: it was put there
  const Time at{1'001'041};                         // a quarter of the tick
  const Glimpse seen = between.glimpse(session, at, {});
  EXPECT_NEAR(seen.X_WB_balls[0].p.y(), 1.0 + 0.05 * 0.25, 1e-5);
  EXPECT_EQ(seen.X_WB_skittles[0].p, spot.p);
  EXPECT_EQ(between.glimpse(session, session.now(), {}).X_WB_skittles[0].p.x(), spot.p.x() + 0.3);
}

}  // namespace
}  // namespace headpin::scene
