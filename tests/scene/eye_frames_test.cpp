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

}  // namespace
}  // namespace headpin::scene
