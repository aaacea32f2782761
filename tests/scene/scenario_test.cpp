#include "scene/scenario/scenario.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/data/hmd.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/refusal.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

TEST(ScenarioText, GivesBackEveryBit) {
  Scenario s;
  s.ball.mass = 0.1 + 0.2;  // no short decimal
  s.rig.X_WT = {rotation(Vec3(0.1, 0.2, 0.3)), Vec3(1.0 / 3.0, -0.0, 1e-7)};
  s.collision.shape = "ellipsoid";
  s.name = "a \"quoted\" name\nand a line";
  s.hmd = hmd_of_profile("flight-helmet-leep");
  s.hmd.optics.eye_distance = 0.0625;
  const std::string text = to_toml(s);
  const Scenario back = parse_scenario(text, "text");
  EXPECT_EQ(back.ball.mass, s.ball.mass);
  EXPECT_EQ(back.rig.X_WT.q.coeffs(), s.rig.X_WT.q.coeffs());
  EXPECT_EQ(back.rig.X_WT.p, s.rig.X_WT.p);
  EXPECT_EQ(back.name, s.name);
  EXPECT_EQ(back.hmd.optics.width, 208);
  EXPECT_EQ(back.hmd.optics.eye_distance, 0.0625);
  EXPECT_EQ(back.skittle.parts.size(), s.skittle.parts.size());
  EXPECT_EQ(to_toml(back), text);
}

TEST(ScenarioText, LeftOutMeansDefault) {
  EXPECT_EQ(to_toml(parse_scenario("", "empty")), to_toml(Scenario{}));
  EXPECT_EQ(parse_scenario("[ball]\nmass = 5", "x").ball.radius, Scenario{}.ball.radius);
}

TEST(ScenarioText, ADisplayIsItsProfileAndWhatOverridesIt) {
  for (const render::HmdProfile& profile : render::hmd_profiles()) {
    const Hmd hmd =
        parse_scenario("[hmd]\nwidth = 100\nprofile = '" + std::string(profile.name) + "'", "x")
            .hmd;
    EXPECT_EQ(hmd.profile, profile.name);
    EXPECT_EQ(hmd.optics.width, 100);  // wherever in the table it stands
    EXPECT_EQ(hmd.optics.height, profile.optics.height);
    EXPECT_EQ(hmd.optics.horizontal_fov_deg, profile.optics.horizontal_fov_deg);
    EXPECT_EQ(hmd.optics.vertical_fov_deg, profile.optics.vertical_fov_deg);
    EXPECT_EQ(hmd.optics.eye_distance, profile.optics.eye_distance);
    EXPECT_EQ(hmd.optics.outward_deg, profile.optics.outward_deg);
    EXPECT_THAT(to_toml(Scenario{}), HasSubstr(std::string(profile.name)));  // so that it is found
  }
  EXPECT_EQ(refusal("\n[hmd]\nprofile = 'visor'"),
            "lane.toml:3: hmd.profile must be one of flight-helmet, flight-helmet-square, "
            "flight-helmet-leep, flight-helmet-elements, flight-helmet-total, "
            "flight-helmet-relayed, flight-helmet-lens, found 'visor'");
  EXPECT_THAT(refusal("[hmd]\nprofile = 3"), HasSubstr("hmd.profile must be a string"));
}

TEST(ScenarioText, RefusalsNameFileLineKeyAndWhatIsAllowed) {
  EXPECT_EQ(refusal("\n[ball]\nmas = 5"),
            "lane.toml:3: unknown key 'ball.mas'; known here: home, mass, mesh, radius");
  EXPECT_EQ(refusal("[material.ball]\nelasticity = 1.5"),
            "lane.toml:2: material.ball.elasticity must be a number from 0 to 1, found 1.5");
  EXPECT_EQ(refusal("[material.ball]\nfriction = 'high'"),
            "lane.toml:2: material.ball.friction must be a number from 0 to 1, found 'high'");
  EXPECT_THAT(refusal("[collision]\nshape = 'cube'"),
              HasSubstr("must be \"true\" or \"ellipsoid\""));
  EXPECT_THAT(refusal("[ball]\nmass = nan"), HasSubstr("ball.mass must be a number"));
  EXPECT_THAT(refusal("[ball]\nmass = inf"), HasSubstr("ball.mass must be a number"));
  EXPECT_THAT(refusal("ball = 3"), HasSubstr("ball must be a table"));
  EXPECT_THAT(refusal("[rates]\nphysics_hz = 240.5"), HasSubstr("must be a whole number"));
  EXPECT_THAT(refusal("[rates]\nphysics_hz = 250"), HasSubstr("a multiple of 120"));
  EXPECT_THAT(refusal("[lane]\nhead_pin = 7.0"), HasSubstr("must stand clear of the walls"));
  EXPECT_THAT(refusal("[rig]\nX_WT = {q = [1.0, 1.0, 0.0, 0.0]}"), HasSubstr("a unit quaternion"));
  EXPECT_THAT(refusal("[rack]\nspots = [[0.0, 1.0, 2.0]]"), HasSubstr("an array of 2 numbers"));
  EXPECT_THAT(refusal("[skittle]\nparts = [{radius = 0.1, low = 0.2, high = 0.1}]"),
              HasSubstr("low below high"));
  EXPECT_THAT(refusal("[ball\nmass = 5"), HasSubstr("lane.toml:1: not TOML"));
}

TEST(ScenarioText, NeitherCutsNorFlippedBytesDoMoreThanRefuse) {
  const std::string text = to_toml(Scenario{});
  for (std::size_t cut = 0; cut < text.size(); cut += 7) {
    try {
      parse_scenario(text.substr(0, cut), "cut");
    } catch (const std::invalid_argument&) {
    }
  }
  int refused = 0;
  for (std::size_t i = 0; i < text.size(); i += 11) {
    std::string broken = text;
    broken[i] = static_cast<char>(broken[i] ^ (1 << (i % 8)));
    try {
      parse_scenario(broken, "flipped");
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("flipped"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(SetValue, ChangesOneValueAndChecksIt) {
  Scenario s;
  set(s, "ball.mass=5");
  set(s, "collision.shape=ellipsoid");
  set(s, "material.lane.friction=0.25");
  EXPECT_EQ(s.ball.mass, 5.0);
  EXPECT_EQ(s.collision.shape, "ellipsoid");
  EXPECT_EQ(s.material.lane.friction, 0.25);
  EXPECT_EQ(s.material.ball.friction, 0.7);
  EXPECT_THROW(set(s, "ball.mass=-1"), std::invalid_argument);
  EXPECT_THROW(set(s, "ball.weight=1"), std::invalid_argument);
  EXPECT_THROW(set(s, "ball.mass"), std::invalid_argument);
  EXPECT_THROW(set(s, "=3"), std::invalid_argument);
}

TEST(TenPins, StandTwelveInchesApart) {
  const Scenario s;
  ASSERT_EQ(s.rack.spots.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    double nearest = 1e9;
    for (std::size_t j = 0; j < 10; ++j) {
      if (i != j) nearest = std::min(nearest, (s.rack.spots[i] - s.rack.spots[j]).norm());
    }
    EXPECT_NEAR(nearest, 0.3048, 2e-5);  // rows are rounded to 10 um
  }
}

TEST(ScenarioFiles, AreAcceptedAndThePapersRoomIsTheDefault) {
  const std::filesystem::path folder = HEADPIN_SOURCE_DIR "/assets/scenarios";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Scenario s = load_scenario(entry.path().string());
    EXPECT_EQ(s.name, entry.path().stem().string());
    ++files;
  }
  EXPECT_EQ(files, 7);
  EXPECT_EQ(to_toml(load_scenario((folder / "paper-room.toml").string())), to_toml(Scenario{}));
}

}  // namespace
}  // namespace headpin::scene
