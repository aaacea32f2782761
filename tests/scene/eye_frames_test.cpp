#include "scene/watch/eye_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <semaphore>
#include <set>

#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/live/frames_beside.h"

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

Session with_a_head(const std::shared_ptr<const Stage>& stage) {
  Session session = make_session(stage);
  devices::TrackerSample head;
  head.station = devices::kHeadStation;
  head.X_TS.p = Vec3(0.0, -0.4, 1.7);
  devices::ReplaySource source({head});
  while (!head_pose(session)) advance(session, source);
  return session;
}

/// Fails at its first frame, draws the second, and then draws no more.
struct FailingDrawer : FrameDrawer {
  const render::Fingerprint& drawn_by() const override { return who; }
  std::optional<DrawnFrame> draw(const FrameJob& job) override {
    ++asked;
    if (asked == 1) throw DrawingFailed("it fell over");
    if (asked > 2) return std::nullopt;
    DrawnFrame done;
    done.record.tick = job.tick;
    return done;
  }
  render::Fingerprint who;
  int asked = 0;
};

TEST(FramesBeside, AFailureOfDrawingCostsThatFrameAndIsTold) {
  FramesBeside eyes([] { return std::make_unique<FailingDrawer>(); });
  Session session = with_a_head(std::make_shared<const Stage>(make_stage({})));
  std::vector<std::int64_t> ticks;
  for (int i = 0; i < 4; ++i) {
    session.tick += 8;  // two frames on: each tick has one that is due
    ticks.push_back(session.tick);
    eyes.tick(session);
    eyes.finish();
  }
  const std::vector<FramesBeside::Done> done = eyes.take_done();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].record.tick, ticks[1]);
  EXPECT_EQ(eyes.take_failures(), std::vector<std::string>{"it fell over"});
  EXPECT_TRUE(eyes.take_failures().empty());
  EXPECT_EQ(eyes.late(), 8);  // nine were due
}

TEST(FramesBeside, TheFrameThatIsBeingShownAtTheEndIsAmongThoseDone) {
  const auto stage = std::make_shared<const Stage>(make_stage({}));
  std::counting_semaphore<> shown{0}, go{0};
  FramesBeside eyes([&] {
    return std::make_unique<DrawerHere>(open_eyes(*stage), std::make_unique<HeldSink>(shown, go));
  });
  Session session = with_a_head(stage);
  RealTime pace;
  pace.begin(240);
  eyes.measure_by(pace);
  eyes.tick(session);
  shown.acquire();
  EXPECT_TRUE(eyes.take_done().empty());  // it is on its way
  go.release();
  eyes.finish();
  const std::vector<FramesBeside::Done> done = eyes.take_done();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].record.tick, session.tick);
}

// With a tracker that is faster than the frames, each sample is fresh and none of them comes with a
// frame: frame k is still at k / 60 s, or up to one frame's time before.
TEST(FramesBeside, KeepTheFramesRateWhateverTheTrackers) {
  Scenario scenario;
  scenario.hmd.optics.width = 16;
  scenario.hmd.optics.height = 8;
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  FramesBeside eyes([&] {
    return std::make_unique<DrawerHere>(open_eyes(*stage), std::unique_ptr<FrameSink>());
  });
  Session session = make_session(stage);
  std::vector<devices::Sample> samples;
  for (std::int64_t i = 0; i < 72 * 4; ++i) {
    devices::TrackerSample head;
    head.station = devices::kHeadStation;
    head.device_time = head.host_time = tick_time(i, 72);
    head.X_TS.p = Vec3(0.0, -0.4, 1.7);
    samples.push_back(head);
  }
  devices::ReplaySource source(samples);
  RealTime pace;
  pace.begin(scenario.rates.physics_hz);
  eyes.measure_by(pace);
  std::int64_t last = 0;
  while (session.now() < Time{4'000'000}) {
    advance(session, source);
    eyes.tick(session);
    if (session.tick % 16 != 0) continue;
    eyes.finish();
    for (const FramesBeside::Done& done : eyes.take_done()) {
      const double early =
          static_cast<double>(done.record.frame) / 60.0 - seconds(done.record.time);
      EXPECT_LT(early, 1.0 / 60.0 + 1.0 / static_cast<double>(scenario.rates.physics_hz) + 1e-5);
      EXPECT_GT(early, -1.0 / 60.0 - 1e-5);
      last = done.record.frame;
    }
  }
  EXPECT_GT(last, 200);
}

// With a tracker at the frames' rate, frames are moved to the tick that takes a sample in, or the one
// behind it. Here samples come in the first of a frame's four ticks and would wait for three.
TEST(FramesBeside, AreMovedToFreshSamplesOfATrackerAtTheirRate) {
  Scenario scenario;
  scenario.hmd.optics.width = 16;
  scenario.hmd.optics.height = 8;
  const std::int64_t hz = scenario.rates.physics_hz, ticks = hz / scenario.rates.frame_hz;
  ASSERT_GE(ticks, 4);
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  FramesBeside eyes([&] {
    return std::make_unique<DrawerHere>(open_eyes(*stage), std::unique_ptr<FrameSink>());
  });
  Session session = make_session(stage);
  std::vector<devices::Sample> samples;
  for (std::int64_t i = 0; i < 60; ++i) {
    devices::TrackerSample head;
    head.station = devices::kHeadStation;
    head.device_time = head.host_time = tick_time(ticks * i, hz) + Time{1'000};
    head.X_TS.p = Vec3(0.0, -0.4, 1.7);
    samples.push_back(head);
  }
  devices::ReplaySource source(samples);
  RealTime pace;
  pace.begin(hz);
  eyes.measure_by(pace);
  std::vector<std::int64_t> waited;  // ticks, of each frame
  while (session.tick < 60 * ticks) {
    advance(session, source);
    eyes.tick(session);
    eyes.finish();
    for (const FramesBeside::Done& done : eyes.take_done()) {
      waited.push_back((done.record.tick - 1) % ticks);
    }
  }
  ASSERT_GE(waited.size(), 50u);
  EXPECT_EQ(waited[1], 3);  // frame 0 is at the first tick
  EXPECT_LE(*std::max_element(waited.begin() + 5, waited.end()), 1);
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

// A picture ends where the room ends, not at 40 m.
TEST(Eyes, SeeTheSkittlesOfALongRoom) {
  Scenario scenario;
  scenario.room.ahead = 60.0;
  scenario.lane.head_pin = 48.0;
  const auto stage = std::make_shared<const Stage>(make_stage(scenario));
  Eyes eyes = open_eyes(*stage);
  eyes.optics.horizontal_fov_deg = 6.0;  // as with a telescope: a skittle is pixels wide
  eyes.optics.vertical_fov_deg = 4.0;
  const Pose X_WD{rotation(Vec3(0.5 * std::numbers::pi - 0.03, 0.0, 0.0)), Vec3(0.0, -2.0, 1.7)};
  const Session session = make_session(stage);
  for (const render::Labels& labels : see_labels(eyes, glimpse(session, X_WD))) {
    const std::set<std::uint32_t> ids(labels.id.begin(), labels.id.end());
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(ids.contains(kFirstSkittleId + i)) << i;
    EXPECT_FALSE(ids.contains(0));  // and the wall behind them
  }
}

// The eyes of some displays are turned outward; a camera elsewhere in the room is not.
TEST(Eyes, OfACameraLookWhereItLooks) {
  Scenario scenario;
  scenario.hmd.optics.outward_deg = 12.0;
  Eyes eyes = open_eyes(make_stage(scenario));
  for (const Pose& X_WC :
       {top_camera(scenario), side_camera(scenario), third_person_camera(scenario)}) {
    for (const render::View& view : views_of(eyes, {.X_WC = X_WC})) {
      EXPECT_NEAR(view.X_WE.q.angularDistance(X_WC.q), 0.0, 1e-7);
    }
  }
  const auto [left, right] = views_of(eyes, {.X_WD = Pose()});
  EXPECT_NEAR(left.X_WE.q.angularDistance(right.X_WE.q), 24.0 * std::numbers::pi / 180.0, 1e-7);
}

// A relayed picture has the display's size and about the light of one that is drawn in it.
TEST(Eyes, ShowWhatTheDisplayShows) {
  std::vector<render::Image> pictures;
  for (const char* profile : {"flight-helmet", "flight-helmet-relayed", "flight-helmet-lens"}) {
    Scenario scenario;
    scenario.hmd = hmd_of_profile(profile);
    const auto stage = std::make_shared<const Stage>(make_stage(scenario));
    Eyes eyes = open_eyes(*stage);
    const Pose X_WD{rotation(Vec3(0.45 * std::numbers::pi, 0.0, 0.0)), Vec3(0.0, -0.5, 1.7)};
    std::array<render::Image, 2> images;
    const auto views = see(eyes, glimpse(make_session(stage), X_WD), images);
    EXPECT_EQ(images[0].width, scenario.hmd.optics.width);
    EXPECT_EQ(views[1].height, scenario.hmd.optics.height);
    pictures.push_back(images[0]);
  }
  ASSERT_EQ(pictures[0].rgb.size(), pictures[1].rgb.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < pictures[0].rgb.size(); ++i) {
    squares += std::pow(pictures[0].rgb[i] - pictures[1].rgb[i], 2);
  }
  const double rms = std::sqrt(squares / static_cast<double>(pictures[0].rgb.size()));
  EXPECT_GT(rms, 0.0);
  EXPECT_LT(rms, 6.0);  // of 255: they differ in how edges are smoothed
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
