// What is refused where a person chooses it, though a trial may have run under it.

#include <string>

#include <fmt/format.h>
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

TEST(ChosenCheck, APictureIsADegreeWideAndHigh) {
  EXPECT_EQ(refusal("[hmd]\nouter_deg = 0.25\ninner_deg = 0.5"),
            "lane.toml:2: hmd.outer_deg must be 1 degree or more together with hmd.inner_deg, "
            "found 0.25 and 0.5");
  EXPECT_EQ(refusal("[hmd]\nup_deg = 1e-9\ndown_deg = 1e-9"),
            "lane.toml:2: hmd.up_deg must be 1 degree or more together with hmd.down_deg, found "
            "1e-09 and 1e-09");
  EXPECT_EQ(refusal("[hmd]\nouter_deg = 0.58\ninner_deg = 0.42\nup_deg = 0.9\ndown_deg = 0.1"), "");
  EXPECT_EQ(refusal("[hmd]\nouter_deg = 1e-9\nup_deg = 1e-9"), "");  // half of the field is left
  // An edge that is not given is at half of the field of view.
  EXPECT_EQ(refusal("[hmd]\nhorizontal_fov_deg = 1\nvertical_fov_deg = 1"), "");
  EXPECT_EQ(refusal("[hmd]\nvertical_fov_deg = 1\ndown_deg = 0.25"),
            "lane.toml:3: hmd.up_deg must be 1 degree or more together with hmd.down_deg, found "
            "0.5 and 0.25");
}

/// A scenario with buttons at these heights.
std::string buttons_at(double red, double blue, double room) {
  return fmt::format(
      "[version]\nbuttons = true\nradius = 0.1\n"
      "[version.red]\nelasticity = 1\nfriction = 1\nbutton = [-0.55, 0, {}]\n"
      "[version.blue]\nelasticity = 1\nfriction = 1\nbutton = [-0.85, 0, {}]\n"
      "[room]\nheight = {}\n[ball]\nhome = [0, 1, 0.5]",
      red, blue, room);
}

TEST(ChosenCheck, ButtonsAreBelowTheCeiling) {
  EXPECT_EQ(refusal(buttons_at(1.5, 1.1, 1.25)),
            "lane.toml:7: version.red.button must be below the ceiling at room.height: z at most "
            "1.15, found 1.5");
  EXPECT_EQ(refusal(buttons_at(1.1, 1.2, 1.25)),
            "lane.toml:11: version.blue.button must be below the ceiling at room.height: z at most "
            "1.15, found 1.2");
  EXPECT_EQ(refusal(buttons_at(1.1, 1.15, 1.25)), "");
  EXPECT_EQ(refusal(buttons_at(1.3, 1.1, 1.4)), "");  // 1.4 - 0.1 is less than 1.3
  // They are there only if the scenario has buttons.
  EXPECT_EQ(refusal("[version.red]\nbutton = [-0.55, 0, 50]\n"), "");
}

TEST(ChosenCheck, ALowerRoomIsRefusedAtItsOwnKey) {
  Scenario scenario = parse_scenario(buttons_at(1.1, 1.1, 2.5), "lane.toml");
  EXPECT_THAT(complaint([&] { set(scenario, "room.height=1"); }),
              HasSubstr("room.height=1: version.red.button must be below the ceiling"));
}

// What is refused today was recorded once, and must replay, also with another value elsewhere.
TEST(ChosenCheck, ATrialMayHaveRunUnderAnyOfIt) {
  Scenario old = parse_scenario(buttons_at(1.1, 1.1, 2.5), "lane.toml");
  old.release.speed = 0.0;
  old.release.spin = 5.0;
  old.hmd.optics.up_deg = old.hmd.optics.down_deg = 0.25;
  old.room.height = 1.0;
  Scenario read = scenario_of_trial(to_toml(old), "old.lcmlog");
  EXPECT_EQ(read.release.spin, 5.0);
  set(read, "ball.mass=5");
  EXPECT_THAT(complaint([&] { set(read, "release.height=0.1"); }), HasSubstr("release.spin must"));
  EXPECT_THAT(complaint([&] { set(read, "hmd.width=100"); }), HasSubstr("hmd.up_deg must"));
  EXPECT_THAT(complaint([&] { set(read, "room.width=5"); }), HasSubstr("version.red.button must"));
  set(read, "release.spin=0");
  EXPECT_EQ(read.release.spin, 0.0);
}

}  // namespace
}  // namespace headpin::scene
