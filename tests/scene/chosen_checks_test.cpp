// What is refused where a person chooses it, though a trial may have run under it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/refusal.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

// The spin is about the direction of the throw.
TEST(ChosenCheck, ABallAtRestGetsNoSpin) {
  EXPECT_EQ(refusal("[release]\nspeed = 0\nspin = 5"),
            "lane.toml:3: release.spin must be 0 with release.speed 0, because a ball at rest has "
            "no direction to spin about; found 5");
  EXPECT_THAT(refusal("[release]\nspeed = 0\nspin = -0.1"), HasSubstr("found -0.1"));
  EXPECT_EQ(refusal("[release]\nspeed = 0\nspin = 0"), "");
  EXPECT_EQ(refusal("[release]\nspeed = 0.01\nspin = 5"), "");
  Scenario scenario;
  set(scenario, "release.spin=5");
  EXPECT_THAT(complaint([&] { set(scenario, "release.speed=0"); }),
              HasSubstr("release.speed=0: release.spin must be 0 with release.speed 0"));
}

TEST(ChosenCheck, TogetherSpeedAndSpinFit) {
  Scenario scenario;
  set(scenario, "release.spin=5");
  set(scenario, {{"release.speed=0", "a"}, {"release.spin=0", "b"}});
  EXPECT_EQ(scenario.release.speed, 0.0);
  EXPECT_EQ(scenario.release.spin, 0.0);
}

// What is refused today was recorded once, and must replay, also with another value elsewhere.
TEST(ChosenCheck, ATrialMayHaveRunUnderAnyOfIt) {
  Scenario old;
  old.release.speed = 0.0;
  old.release.spin = 5.0;
  Scenario read = scenario_of_trial(to_toml(old), "old.lcmlog");
  EXPECT_EQ(read.release.spin, 5.0);
  set(read, "ball.mass=5");
  EXPECT_THAT(complaint([&] { set(read, "release.height=0.1"); }), HasSubstr("release.spin must"));
  set(read, "release.spin=0");
  EXPECT_EQ(read.release.spin, 0.0);
}

}  // namespace
}  // namespace headpin::scene
