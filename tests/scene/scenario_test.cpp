#include "scene/scenario/scenario.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/data/hmd.h"
#include "scene/scenario/nearest.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/refusal.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

TEST(ScenarioText, GivesBackEveryBit) {
  Scenario s;
  s.ball.mass = 0.1 + 0.2;  // no short decimal
  s.rig.X_WT = {rotation(Vec3(0.1, 0.2, 0.3)), Vec3(1.0 / 3.0, -0.0, 1e-7)};
  s.collision.shape = SkittleShape::ellipsoid;
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

// TOML leaves out a line end right after the three quotes before a text of several lines.
TEST(ScenarioText, GivesBackEveryLineOfAText) {
  for (const std::string name :
       {"\nfoo", "\n", "\n\nfoo\n", "\r\nfoo", "foo\r\nbar", "\x27\x27\x27\n\"\x22\x22",
        "a\\\nb\t\x01\x7f", "\nKegel, \u00fcber"}) {
    Scenario s;
    s.name = name;
    const std::string text = to_toml(s);
    EXPECT_EQ(parse_scenario(text, "text").name, name) << text.substr(0, 100);
  }
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
  EXPECT_THAT(refusal("[hmd]\nprofile = 3"), HasSubstr("hmd.profile must be text, found 3"));
}

TEST(ScenarioText, RefusalsNameFileLineKeyAndWhatIsAllowed) {
  EXPECT_EQ(refusal("\n[ball]\nmas = 5"),
            "lane.toml:3: unknown key 'ball.mas'; the nearest is ball.mass");
  EXPECT_EQ(refusal("[material.ball]\nelasticity = 1.5"),
            "lane.toml:2: material.ball.elasticity must be a number from 0 to 1, found 1.5");
  EXPECT_EQ(refusal("[material.ball]\nfriction = 'high'"),
            "lane.toml:2: material.ball.friction must be a number from 0 to 1, found 'high'");
  EXPECT_THAT(refusal("[collision]\nshape = 'cube'"),
              HasSubstr("must be \"true\" or \"ellipsoid\""));
  EXPECT_THAT(refusal("[ball]\nmass = nan"), HasSubstr("ball.mass must be a number"));
  EXPECT_THAT(refusal("[ball]\nmass = inf"), HasSubstr("ball.mass must be a number"));
  EXPECT_THAT(refusal("ball = 3"), HasSubstr("ball must be a table"));
  EXPECT_EQ(refusal("[rates]\nphysics_hz = 240.5"),
            "lane.toml:2: rates.physics_hz must be a whole number from 120 to 99960, found 240.5");
  EXPECT_EQ(refusal("[hmd]\nwidth = -5"),
            "lane.toml:2: hmd.width must be a whole number from 1 to 16384, found -5");
  EXPECT_THAT(refusal("[rates]\nphysics_hz = 250"), HasSubstr("a multiple of 120"));
  EXPECT_THAT(refusal("[lane]\nhead_pin = 7.0"), HasSubstr("must stand clear of the walls"));
  EXPECT_THAT(refusal("[rig]\nX_WT = {q = [1.0, 1.0, 0.0, 0.0]}"), HasSubstr("a unit quaternion"));
  EXPECT_EQ(refusal("[rack]\nspots = [\n[0.0, 0.0],\n[0.0, 1.0, 2.0]]"),
            "lane.toml:4: rack.spots, entry 2 must be a list of 2 numbers, found [0.0, 1.0, 2.0]");
  EXPECT_EQ(
      refusal("[skittle]\nparts = [{low = 0.0, high = 0.3},\n{low = 0.2, high = 0.1}]"),
      "lane.toml:3: skittle.parts, part 2: low must be below high, found low 0.2 and high 0.1");
  EXPECT_THAT(refusal("[ball\nmass = 5"), HasSubstr("lane.toml:1: not TOML"));
}

TEST(ScenarioText, ValuesAreShownAsTheyAreWritten) {
  EXPECT_EQ(refusal("ball.home = [0.35, -0.25]"),
            "lane.toml:1: ball.home must be a list of 3 numbers, found [0.35, -0.25]");
  EXPECT_EQ(refusal("ball.home = [0.35, 'left', 0.9]"),
            "lane.toml:1: ball.home, number 2 must be a number from -100 to 100, found 'left'");
  EXPECT_EQ(refusal("[skittle]\nparts = [{low = 0, high = 0.1, radius = 7}]"),
            "lane.toml:2: skittle.parts, part 1: radius must be a number from 0.001 to 1, found 7");
  EXPECT_EQ(refusal("skittle.parts = 'cone'"),
            "lane.toml:1: skittle.parts must be a list of 1 to 16 parts, found 'cone'");
  EXPECT_EQ(refusal("lane.width = {narrow = true}"),
            "lane.toml:1: lane.width must be a number from 0.2 to 20, found {narrow = true}");
  EXPECT_EQ(refusal("lane.width = [1, 2, 3, 4, 5]"),
            "lane.toml:1: lane.width must be a number from 0.2 to 20, found a list of 5 values");
}

TEST(ScenarioText, ANumberInQuotesIsToldWithItsUnit) {
  EXPECT_EQ(refusal("[ball]\nmass = '3.0 kg'"),
            "lane.toml:2: ball.mass must be a number in kg, found the text '3.0 kg'; write "
            "ball.mass = 3.0");
  EXPECT_EQ(refusal("[ball]\nmass = '3000 g'"),
            "lane.toml:2: ball.mass must be a number in kg, found the text '3000 g'");
  EXPECT_EQ(refusal("rates.physics_hz = '240Hz'"),
            "lane.toml:1: rates.physics_hz must be a whole number in Hz, found the text '240Hz'; "
            "write rates.physics_hz = 240");
  EXPECT_EQ(refusal("collision.gravity = '9.81 m/s^2'"),
            "lane.toml:1: collision.gravity must be a number in m/s2, found the text '9.81 m/s^2'; "
            "write collision.gravity = 9.81");
  EXPECT_EQ(refusal("lane.width = '1.05'"),
            "lane.toml:1: lane.width must be a number from 0.2 to 20, found the text '1.05'; write "
            "lane.width = 1.05");
  EXPECT_EQ(refusal("lane.width = '105 cm'"),
            "lane.toml:1: lane.width must be a number from 0.2 to 20, found the text '105 cm'; "
            "units are metre, kilogram and second");
}

TEST(ScenarioText, AnUnknownKeyIsToldWithTheNearestOrThoseOfItsName) {
  EXPECT_EQ(refusal("[material.bal]\nfriction = 1"),
            "lane.toml:1: unknown key 'material.bal'; the nearest is material.ball");
  EXPECT_EQ(refusal("lane.friction = 0.2"),
            "lane.toml:1: unknown key 'lane.friction'; the nearest is material.lane.friction");
  EXPECT_EQ(refusal("ball_mass = 3"),
            "lane.toml:1: unknown key 'ball_mass'; the nearest is ball.mass");
  EXPECT_EQ(unknown_key("ball", {"ball.mass", "ball.rings.mass", "ball.rings.radius"}),
            "unknown key 'ball': it is a table; known in it: mass, rings");
  EXPECT_EQ(refusal("mass = 3"),
            "lane.toml:1: unknown key 'mass'; keys of that name are skittle.mass, ball.mass");
  EXPECT_EQ(
      refusal("ball.colour = 3"),
      "lane.toml:1: unknown key 'ball.colour'; known here: differential, home, intermediate, mass, mass_bias, mesh, pin, radius, rg, rings");
  EXPECT_EQ(refusal("[skittle]\nparts = [{low = 0, high = 0.1},\n{lo = 0, high = 0.1}]"),
            "lane.toml:3: skittle.parts, part 2: unknown key 'lo'; the nearest is low");
}

TEST(ScenarioText, WhatIsNotTomlIsToldWithColumnAndWord) {
  EXPECT_EQ(refusal("[ball]\nmass = 7kg"),
            "lane.toml:2: not TOML: column 9: '7kg': expected digit, saw 'k'");
  EXPECT_EQ(refusal("[ball\nmass = 5"),
            "lane.toml:1: not TOML: column 6: '[ball': expected ']', saw the end of the line");
  EXPECT_EQ(refusal("\xef\xbb\xbf[ball\r\nmass = 5"),
            "lane.toml:1: not TOML: column 6: '[ball': expected ']', saw the end of the line");
  EXPECT_EQ(refusal("name = '\u00fc' z"),
            "lane.toml:1: not TOML: column 12: 'z': expected a comment or whitespace, saw 'z'");
  EXPECT_EQ(refusal("name = alley"),
            "lane.toml:1: not TOML: column 8: 'alley': could not determine value type; text needs "
            "quotes");
  EXPECT_EQ(refusal("name = \"alley\n"),
            "lane.toml:1: not TOML: column 14: '\"alley': a quotation mark is not closed");
  EXPECT_EQ(refusal("rack.spots = [[0, 0],\n"),
            "lane.toml:1: not TOML: column 23: ',': the text ends within the list");
  EXPECT_EQ(
      refusal("name = 'a' # \x01"),
      "lane.toml:1: not TOML: column 14: '\\u0001': control characters other than TAB (U+0009) "
      "are explicitly prohibited in comments");
  // Of a long word, the part at that column.
  EXPECT_THAT(refusal("ball.mass = 7" + std::string(100, 'k')), HasSubstr(" 14: '7kkkk"));
  EXPECT_LT(refusal("ball.mass = 7" + std::string(100, 'k')).size(), 120u);
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
  EXPECT_EQ(s.collision.shape, SkittleShape::ellipsoid);
  EXPECT_EQ(s.material.lane.friction, 0.25);
  EXPECT_EQ(s.material.ball.friction, 0.7);
  EXPECT_THROW(set(s, "ball.mass=-1"), std::invalid_argument);
  EXPECT_THROW(set(s, "ball.weight=1"), std::invalid_argument);
  EXPECT_THROW(set(s, "ball.mass"), std::invalid_argument);
  EXPECT_THROW(set(s, "=3"), std::invalid_argument);
}

TEST(SetValue, TakesAnyText) {
  for (const char* name : {"O'Brien", "a \"lane\" of 'mine'", "a=b", "lane #2"}) {
    Scenario s;
    set(s, std::string("name=") + name);
    EXPECT_EQ(s.name, name);
  }
}

// TOML takes these for a truth value or a number, but the keys are of text.
TEST(SetValue, TakesUnquotedTextThatLooksLikeAnotherValue) {
  Scenario s;
  s.collision.shape = s.version.red.shape = SkittleShape::ellipsoid;
  set(s, "collision.shape=true");
  set(s, "version.red.shape = true");
  EXPECT_EQ(s.collision.shape, SkittleShape::parts);
  EXPECT_EQ(s.version.red.shape, SkittleShape::parts);
  for (const char* name : {"5", "true", "1e3", "2026-01-02", "inf"}) {
    set(s, std::string("name=") + name);
    EXPECT_EQ(s.name, name);
  }
  EXPECT_THAT(complaint([&] { set(s, "collision.shape=5"); }),
              HasSubstr("must be \"true\" or \"ellipsoid\", found '5'"));
  EXPECT_THAT(complaint([&] { set(s, "collision.shape=[5]"); }), HasSubstr("found [5]"));
  EXPECT_THAT(complaint([&] { set(s, "ball.mass=true"); }), HasSubstr("ball.mass must be"));
}

TEST(SetValue, SaysWhatToTypeInstead) {
  const auto says = [](const std::string& assignment) {
    Scenario s;
    return complaint([&] { set(s, assignment); });
  };
  EXPECT_EQ(says("skittle.parts[0].radius=0.05"),
            "skittle.parts[0].radius=0.05: one entry of a list cannot be set; expected the "
            "whole list, skittle.parts=[{...}, ...]");
  EXPECT_THAT(says("rack.spots[2]=[0, 1]"), HasSubstr("the whole list, rack.spots=[[x, y], ...]"));
  EXPECT_THAT(says("ball.home[2]=1"), HasSubstr("the whole list, ball.home=[x, y, z]"));
  EXPECT_THAT(says("ball.mass[0]=1"), HasSubstr("ball.mass is no list; expected ball.mass=VALUE"));
  EXPECT_THAT(says("rack.spot[2]=1"), HasSubstr("'rack.spot'; the nearest is rack.spots"));
  EXPECT_EQ(says("ball..mass=3"),
            "ball..mass=3: expected a name on both sides of a dot, as in ball.mass, found "
            "'ball..mass'");
  EXPECT_EQ(says("rack.spots=[[0, 0]"),
            "rack.spots=[[0, 0]: not TOML: column 19: '0]': the text ends within the list");
  EXPECT_EQ(says("ball.mass=3 kg"),
            "ball.mass=3 kg: ball.mass must be a number in kg, found the text '3 kg'; write "
            "ball.mass = 3");
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
  EXPECT_EQ(files, 9);
  EXPECT_EQ(to_toml(load_scenario((folder / "paper-room.toml").string())), to_toml(Scenario{}));
}

}  // namespace
}  // namespace headpin::scene
