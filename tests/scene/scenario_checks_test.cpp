// What a scenario is refused for when it is read, so that no command meets it later.

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/bodies.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/refusal.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ScenarioCheck, SkittlesStandBesideEachOther) {
  EXPECT_EQ(refusal("[rack]\nspots = [\n[0.0, 0.0],\n[0.5, 0.0],\n[0.05, 0.1],\n]"),
            "lane.toml:5: rack.spots must be 0.121 apart, as wide as a skittle is; found spots 1 "
            "and 3 0.1118 apart");
  EXPECT_THAT(refusal("[rack]\nspots = [[0, 0], [0, 0]]"),
              HasSubstr("found spots 1 and 2 0 apart"));
  EXPECT_EQ(refusal("[rack]\nspots = [[0, 0], [0.122, 0]]"), "");
}

TEST(ScenarioCheck, SkittlesStandClearOfTheWalls) {
  EXPECT_THAT(refusal("[rack]\nspots = [[0, 0],\n[0, 1.55]]"),
              HasSubstr("lane.toml:3: rack.spots must stand clear of the walls"));
  EXPECT_THAT(refusal("[rack]\nspots = [[2.2, 0]]"), HasSubstr("clear of the walls"));
  EXPECT_THAT(refusal("[rack]\nspots = [[0, -9]]"), HasSubstr("clear of the walls"));
  EXPECT_THAT(refusal("\n[lane]\nhead_pin = 7.0"), HasSubstr("lane.toml:3: rack.spots must"));
}

TEST(ScenarioCheck, HeadAndHandAreTwoSensors) {
  EXPECT_EQ(
      refusal("[rig]\nhand_station = 1"),
      "lane.toml:2: rig.hand_station must be another than rig.head_station, found 1 for both");
  EXPECT_THAT(refusal("[rig]\nhead_station = 2"), HasSubstr("lane.toml:2: rig.hand_station must"));
  EXPECT_EQ(refusal("[rig]\nhead_station = 2\nhand_station = 1"), "");
}

TEST(ScenarioCheck, BonusesAreForFramesOfTwoBalls) {
  EXPECT_EQ(refusal("[game]\nrules = \"ten-pin\"\nballs = 3"),
            "lane.toml:3: game.balls must be 1 or 2 with game.rules \"ten-pin\", found 3");
  EXPECT_EQ(refusal("[game]\nrules = \"plain\"\nballs = 3"), "");
}

// What is refused today was recorded once, and must replay.
TEST(ScenarioCheck, ATrialMayHaveRunUnderWhatIsNotChosenAnyMore) {
  Scenario old;
  old.rig.head_station = old.rig.hand_station = 2;
  old.game.rules = GameKind::ten_pin;
  old.game.balls = 3;
  Scenario read = scenario_of_trial(to_toml(old), "old.lcmlog");
  EXPECT_EQ(read.game.balls, 3);
  EXPECT_EQ(read.rig.hand_station, read.rig.head_station);
  set(read, "ball.mass=5");
  EXPECT_THROW(set(read, "game.frames=3"), std::invalid_argument);
}

TEST(ScenarioCheck, PartsReachFromTheBaseToTheTopWithoutGaps) {
  const auto parts = [](const std::string& list) {
    return refusal(
        fmt::format("[skittle]\nheight = 0.3\nprofile = [[0, 0.05], [0.1, 0.03], [0.3, 0.0]]\n"
                    "parts = [\n{}]",
                    list));
  };
  EXPECT_EQ(parts("{low = 0.0, high = 0.2},\n{low = 0.1, high = 0.3}"), "");
  EXPECT_EQ(parts("{low = 0.2, high = 0.3},\n{low = 0.0, high = 0.1}"),
            "lane.toml:5: skittle.parts must leave no gap, found one from 0.1 to 0.2");
  EXPECT_EQ(parts("{low = 0.01, high = 0.3}"),
            "lane.toml:5: skittle.parts must begin at the base, 0; found 0.01 as the lowest");
  EXPECT_EQ(parts("{low = 0.0, high = 0.4}"),
            "lane.toml:2: skittle.height must be that of its parts, 0.4; found 0.3");
  EXPECT_THAT(refusal("[skittle]\nheight = 0.4"),
              HasSubstr("lane.toml:2: skittle.height must be that of its parts, 0.381; found 0.4"));
}

TEST(ScenarioCheck, AProfileRisesFromTheBaseToTheTop) {
  const auto profile = [](const std::string& list) {
    return refusal(fmt::format("[skittle]\nprofile = [\n{}]", list));
  };
  EXPECT_EQ(profile("[0, 0.02],\n[0.2, 0.05],\n[0.1, 0.04],\n[0.381, 0]"),
            "lane.toml:5: skittle.profile must rise from point to point, found 0.1 after 0.2");
  EXPECT_THAT(profile("[0, 0.02],\n[0.2, -0.05],\n[0.381, 0]"), HasSubstr("lane.toml:4"));
  EXPECT_THAT(profile("[0, 0.02],\n[0.381, 0]"), HasSubstr("3 points or more, found 2"));
  EXPECT_THAT(profile("[0.1, 0.02],\n[0.2, 0.03],\n[0.381, 0]"), HasSubstr("begin at the base"));
  EXPECT_THAT(profile("[0, 0.02],\n[0.2, 0.03],\n[0.3, 0]"),
              HasSubstr("end at the skittle's height, 0.381; found 0.3"));
  // Without a radius it has no volume, so its centre of mass is nowhere.
  EXPECT_EQ(refusal("[skittle]\nprofile = [[0, 0], [0.1, 0], [0.381, 0]]"),
            "lane.toml:2: skittle.profile must have a radius above 0, found 0 for all points");
  EXPECT_EQ(profile("[0, 0],\n[0.1, 0.02],\n[0.381, 0]"), "");
}

TEST(ScenarioCheck, SkittlesStandBelowASolidCeiling) {
  const auto ceiling = [](double height, bool solid) {
    return refusal(
        fmt::format("[room]\nheight = {}\nsolid_ceiling = {}\n[skittle]\nheight = 1.6\n"
                    "profile = [[0, 0.05], [0.8, 0.05], [1.6, 0]]\nparts = [{{high = 1.6}}]",
                    height, solid));
  };
  EXPECT_EQ(ceiling(1.5, true),
            "lane.toml:5: skittle.height must be less than the room's, 1.5, under a solid ceiling; "
            "found 1.6");
  EXPECT_EQ(ceiling(1.7, true), "");
  EXPECT_EQ(ceiling(1.5, false), "");
}

TEST(ScenarioCheck, TheBallIsInNoWallFloorOrSkittle) {
  for (const char* home : {"[2.2, 0, 1]", "[-2.2, 0, 1]", "[0, 7.55, 1]", "[0, -2.95, 1]",
                           "[0, 0, 0.1]", "[0, 0, 2.75]"}) {
    EXPECT_THAT(refusal(fmt::format("[ball]\nradius = 0.11\nhome = {}", home)),
                HasSubstr("lane.toml:3: ball.home must hold the ball clear of floor, walls"))
        << home;
  }
  EXPECT_THAT(refusal("[ball]\nhome = [0, 5.95, 0.3]"), HasSubstr("found it in skittle 1"));
  EXPECT_EQ(refusal("[ball]\nhome = [0, 5.95, 0.6]"), "");
  EXPECT_THAT(refusal("[lane]\nwidth = 5"), HasSubstr("lane.toml:2: lane.width must be less than"));
}

TEST(ScenarioCheck, GuttersLieBetweenLaneAndWallAndNoSkittleInThem) {
  EXPECT_EQ(refusal("[lane]\ngutter_width = 0.235\ngutter_depth = 0.048\nkick_backs = true"), "");
  EXPECT_EQ(refusal("[lane]\ngutter_depth = 0.048"),
            "lane.toml:2: lane.gutter_width must be 0.02 to 1.713, between the lane and the wall, "
            "where gutters have a depth; found 0");
  EXPECT_EQ(refusal("[lane]\ngutter_depth = 0.048\nkick_backs = true\ngutter_width = 1.6"),
            "lane.toml:4: lane.gutter_width must be 0.02 to 1.573, between the lane and the "
            "kick-backs, where gutters have a depth; found 1.6");
  EXPECT_EQ(refusal("[lane]\ngutter_width = 0.2\ngutter_depth = 0.001"),
            "lane.toml:3: lane.gutter_depth must be 0, for a painted gutter, or 0.005 and more; "
            "found 0.001");
  EXPECT_EQ(refusal("[lane]\ngutter_width = 0.2\ngutter_depth = 0.05\n[rack]\nspots = [[0, 0],\n"
                    "[0.5, 0]]"),
            "lane.toml:6: rack.spots must stand on the lane beside its gutters: x within 0.4666, "
            "found 0.5");
  EXPECT_EQ(refusal("[lane]\ngutter_depth = 0.75"),
            "lane.toml:2: lane.gutter_depth must be a number from 0 to 0.5, found 0.75");
  EXPECT_EQ(refusal("[lane]\nkick_backs = 1"),
            "lane.toml:2: lane.kick_backs must be true or false, found 1");
  EXPECT_EQ(refusal("[skittle]\nweighed = 'mesh'"),
            "lane.toml:2: skittle.weighed must be \"profile\" or \"parts\", found 'mesh'");
}

TEST(ScenarioCheck, SkittlesStandBetweenTheKickBacks) {
  const std::string rack = "[lane]\nkick_backs = true\n[rack]\nspots = [[0, 0],\n[0.6, 0.3]]";
  EXPECT_EQ(
      refusal(rack),
      "lane.toml:5: rack.spots must stand between the kick-backs: x within 0.5266, found 0.6");
  EXPECT_EQ(refusal(rack + "\n[room]\nwidth = 6"), refusal(rack));
  EXPECT_EQ(refusal("[lane]\nkick_backs = true\nwidth = 1.3\n[rack]\nspots = [[0, 0], [0.6, 0.3]]"),
            "");
  EXPECT_EQ(refusal("[rack]\nspots = [[0, 0], [0.6, 0.3]]"), "");
}

TEST(ScenarioCheck, AVersionHasMaterials) {
  const std::string buttons = "[version]\nbuttons = true\n";
  const std::string red = "[version.red]\nelasticity = 1.0\nfriction = 0.7\n";
  const std::string blue = "[version.blue]\nelasticity = 0.7\nfriction = 0.7\n";
  EXPECT_EQ(refusal(buttons + red + blue), "");
  EXPECT_EQ(refusal(buttons + red),
            "lane.toml:2: version.blue.elasticity must be a number from 0 to 1, because the "
            "scenario has buttons; found none");
  EXPECT_THAT(refusal(buttons + "[version.red]\nelasticity = 1.0\n" + blue),
              HasSubstr("lane.toml:2: version.red.friction must be a number from 0 to 1"));
  EXPECT_EQ(refusal("[version]\nbuttons = false\n"), "");
}

TEST(ScenarioCheck, NestedBeyondUseIsRefusedBeforeTheParserFalls) {
  std::string dotted = "a", headers, brackets = "a = ", braces = "a = ";
  for (int i = 0; i < 50'000; ++i) {
    dotted += ".a";
    brackets += "[";
    braces += "{a=";
  }
  for (const std::string& text :
       {dotted + " = 1", fmt::format("[{}]", dotted), fmt::format("[[{}]]", dotted), brackets,
        braces, fmt::format("x = {{{} = 1}}", dotted)}) {
    EXPECT_EQ(refusal(fmt::format("\n{}", text)), "lane.toml:2: nested more than 16 deep");
  }
  std::string quoted = "\"a\"";
  for (int i = 0; i < 50'000; ++i) quoted += " . 'a'";
  EXPECT_THAT(refusal(quoted + " = 1"), HasSubstr("nested more than 16 deep"));
  Scenario scenario;
  EXPECT_THAT(complaint([&] { set(scenario, dotted + "=1"); }), HasSubstr("nested more than"));
  // Dots and brackets that nest nothing.
  const std::string dots(99, '.'), open(99, '['), curly(99, '{');
  EXPECT_EQ(refusal(fmt::format("# {}{}\nname = '{}{}'", dots, open, dots, curly)), "");
  EXPECT_EQ(refusal(fmt::format("name = \"\"\"{}\n...\\\"\"\" # x", open)),
            "lane.toml:2: not TOML: column 12: 'x': a quotation mark is not closed");
}

TEST(ScenarioCheck, MessagesAreShortHoweverMuchIsWrong) {
  std::string spots = "rack.spots = [";
  for (int i = 0; i < 100'000; ++i) spots += "[0.0, 0.0],";
  EXPECT_EQ(
      refusal(spots + "]"),
      "lane.toml:1: rack.spots must be a list of 1 to 10000 pairs of numbers, found a list of "
      "100000 values");
  for (const std::string& text :
       {fmt::format("name = {:x>1000000}", ""), fmt::format("{:x>1000000} = 1", ""),
        fmt::format("ball.mass = '{:x>1000000}'", ""), fmt::format("ball = '{:\n>1000000}'", "")}) {
    EXPECT_THAT(refusal(text), Not(testing::IsEmpty()));
    EXPECT_LT(refusal(text).size(), 400u);
  }
}

TEST(ScenarioFile, WhatCannotBeReadIsNoScenario) {
  TemporaryFolder folder;
  const auto refused = [](const std::string& path) {
    return complaint([&] { load_scenario(path); });
  };
  EXPECT_THAT(refused(folder.path()), HasSubstr("cannot be read: Is a directory"));
  EXPECT_THAT(refused(folder / "missing"), HasSubstr("cannot be read: No such file"));
  EXPECT_THAT(refused("/proc/self/mem"), HasSubstr("cannot be read"));
  EXPECT_THAT(refused("/dev/zero"), HasSubstr("too long for a scenario"));
  spit(folder / "ball.toml", "[ball]\nmass = 5");
  EXPECT_EQ(load_scenario(folder / "ball.toml").ball.mass, 5.0);
}

TEST(ScenarioText, StepRatesAreThoseThatAreAllowed) {
  EXPECT_THAT(refusal("rates.physics_hz = 60"), HasSubstr("from 120 to 99960"));
  EXPECT_EQ(refusal("rates.physics_hz = 120"), "");
  EXPECT_EQ(refusal("rates.physics_hz = 99960"), "");
}

TEST(ScenarioText, ASourceStandsOnlyBesideTheValueThatIsFromThere) {
  Scenario s;
  EXPECT_THAT(to_toml(s), HasSubstr("mass = 1.588  # 3 lb 8 oz: USBC\n"));
  EXPECT_THAT(to_toml(s), HasSubstr("width = 1.0541  # 41.5 in: USBC\n"));
  s.skittle.mass = 2.0;
  s.lane.width = 1.5;
  s.ball.radius = 0.1;
  s.ball.mass = 5.0;
  s.rack.spots = {Vec2(0.0, 0.0)};
  s.material.lane.friction = 0.1;
  s.hmd = hmd_of_profile("flight-helmet-leep");
  s.hmd.optics.eye_distance = 0.06;
  const std::string text = to_toml(s);
  EXPECT_THAT(text, HasSubstr("mass = 2.0\n"));
  EXPECT_THAT(text, HasSubstr("width = 1.5\n"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "friction = 0.1  # friction as in the paper; two bodies in contact: the product\n"));
  EXPECT_THAT(text, Not(HasSubstr("15 lb")));
  EXPECT_THAT(text, Not(HasSubstr("8.54 in")));
  EXPECT_THAT(text, Not(HasSubstr("12 in apart")));
  EXPECT_THAT(text, Not(HasSubstr("64 mm")));
  EXPECT_THAT(text, Not(HasSubstr("section 3")));
}

/// Keys that trials may lack, because the keys came later.
const std::set<std::string>& later_keys() {
  // clang-format off
  static const std::set<std::string> keys = {
      "hand.release_at", "hand.release_window_most_s", "hand.release_accuracy",
      "hand.falls_at_once", "hand.spin", "release.speed", "release.direction_deg", "release.height", "release.boards", "release.revs", "release.rotation_deg", "release.spin", "hand.takes_skittles", "hand.solid", "hand.elasticity",
      "hand.friction", "rig.head_station", "rig.hand_station", "collision.warm",
      "collision.friction_tau_s", "collision.rules", "look.samples", "look.contact",
      "look.shadow", "look.mirror", "look.light", "walk.speed", "walk.acceleration",
      "walk.clearance", "skittle.seen", "game.rules", "game.frames", "game.balls",
      "game.ball_back_s", "game.off_spot", "version.buttons", "version.radius",
      "version.red.button", "version.red.elasticity", "version.red.friction", "version.red.shape",
      "version.blue.button", "version.blue.elasticity", "version.blue.friction",
      "version.blue.shape", "room.solid_ceiling", "lane.masking_panel", "lane.kick_backs",
      "lane.gutter_width", "lane.gutter_depth", "hmd.outer_deg", "hmd.inner_deg", "hmd.up_deg",
      "hmd.down_deg", "hmd.relay_width", "hmd.relay_height", "hmd.lens_k1", "hmd.lens_k2",
      "room.mesh.file", "room.mesh.unit", "room.mesh.axes", "room.mesh.sha256",
      "skittle.mesh.file", "skittle.mesh.unit", "skittle.mesh.axes", "skittle.mesh.sha256",
      "ball.mesh.file", "ball.mesh.unit", "ball.mesh.axes", "ball.mesh.sha256", "hand.mesh.file",
      "hand.mesh.unit", "hand.mesh.axes", "hand.mesh.sha256", "collision.answer",
      "lane.oil.zones", "lane.oil.dry", "lane.oil.mirrored", "lane.oil.wear", "lane.oil.carry_down", "ball.rg", "ball.differential",
      "ball.intermediate", "ball.pin", "ball.mass_bias", "ball.rings",
      "skittle.ellipsoid_weighed", "version.red.detection", "version.red.iterations",
      "version.blue.detection", "version.blue.iterations", "walk.along", "game.ends",
      "game.hand_fells", "game.foul", "skittle.weighed", "sound.on", "rig.away_after_s", "game.show_score",
      "game.not_stored", "rig.predicted_s", "game.stray_fells"};
  // clang-format on
  return keys;
}

TEST(ScenarioOfATrial, TakesNoDefaultOfToday) {
  // Whatever key is taken out of what a trial carries, the rest is no scenario of a trial.
  const std::string whole = to_toml(Scenario{});
  EXPECT_EQ(to_toml(scenario_of_trial(whole, "old.lcmlog")), whole);
  std::istringstream lines(whole);
  int keys = 0;
  std::size_t at = 0;
  std::string section;
  for (std::string line; std::getline(lines, line); at += line.size() + 1) {
    if (line.starts_with('[')) section = line.substr(1, line.find(']') - 1) + ".";
    const std::size_t equals = line.find(" = ");
    if (equals == std::string::npos || line[0] == ' ') continue;
    const std::string without =  // as a comment
        fmt::format("{}#{}", whole.substr(0, at), whole.substr(at + equals));
    if (line.ends_with("[")) continue;  // an array of many lines
    if (later_keys().contains(section + line.substr(0, equals))) continue;
    const std::string why = complaint([&] { scenario_of_trial(without, "old.lcmlog"); });
    EXPECT_THAT(why, HasSubstr("old.lcmlog (scenario): ")) << line;
    EXPECT_THAT(why, HasSubstr(line.substr(0, equals) + " is missing")) << line;
    EXPECT_EQ(complaint([&] { parse_scenario(without, "file"); }), "") << line;
    ++keys;
  }
  EXPECT_GT(keys, 40);
}

TEST(ScenarioOfATrial, WithoutAKeyThatCameLaterRanUnderWhatThenHeld) {
  Scenario other;
  other.rig.head_station = 3;
  other.rig.hand_station = 4;
  other.hand.release_window_most_s = 0.2;
  other.hand.release_accuracy = 0.1;
  other.collision.warm = false;
  other.collision.friction_tau_s = 0.1;
  other.collision.rules = 2;
  std::string text = to_toml(other);
  for (const char* key :
       {"head_station", "hand_station", "release_window_most_s", "release_accuracy", "warm",
        "friction_tau_s", "rules = 2", "solid = ", "takes_skittles", "speed = 1.2", "solid_ceiling",
        "masking_panel", "kick_backs", "gutter_width", "gutter_depth", "weighed", "answer",
        "ellipsoid_weighed"}) {
    text[text.find(key)] = '#';
  }
  const Scenario read = scenario_of_trial(text, "old.lcmlog");
  EXPECT_EQ(read.rig.head_station, 1);
  EXPECT_EQ(read.rig.hand_station, 2);
  EXPECT_EQ(read.hand.release_window_most_s, 0.12);
  EXPECT_EQ(read.hand.release_accuracy, 0.3);
  EXPECT_TRUE(read.collision.warm);
  EXPECT_EQ(read.collision.friction_tau_s, 1.0 / 60.0);
  EXPECT_EQ(read.collision.rules, 1);
  EXPECT_FALSE(read.hand.solid || read.hand.takes_skittles);
  EXPECT_EQ(read.walk.speed, 0.0);
  EXPECT_FALSE(read.room.solid_ceiling);
  EXPECT_TRUE(read.lane.masking_panel && read.lane.kick_backs);
  EXPECT_EQ(read.lane.gutter_width, 0.235);
  EXPECT_EQ(read.lane.gutter_depth, 0.0);
  EXPECT_EQ(read.skittle.weighed, Weighed::parts);
  EXPECT_EQ(read.skittle.ellipsoid_weighed, WeighedEllipsoid::itself);
  EXPECT_EQ(read.collision.answer, PlaneAtCap::last);
}

// The paper's S is the accuracy of collisions, and not the weight.
TEST(AnEllipsoid, WeighsAsTheTrueShapeUnlessAnOldTrialSaysNo) {
  for (const Weighed weighed : {Weighed::profile, Weighed::parts}) {
    Scenario s;
    s.skittle.weighed = weighed;
    const SkittleBody whole = skittle_body(s);
    s.collision.shape = SkittleShape::ellipsoid;
    const SkittleBody alike = skittle_body(s);
    EXPECT_EQ(alike.body.shape->parts.size(), 1u);
    EXPECT_EQ(alike.body.mass, whole.body.mass);
    EXPECT_EQ(alike.body.inertia, whole.body.inertia);
    EXPECT_EQ(alike.centre_height, whole.centre_height);
    s.skittle.ellipsoid_weighed = WeighedEllipsoid::itself;
    EXPECT_NEAR(skittle_body(s).centre_height, 0.5 * s.skittle.height, 1e-9);
  }
}

TEST(AVersion, HasACapOfZeroOrOneThatDetectionHas) {
  const auto with_cap = [](int cap) {
    return fmt::format(
        "[version]\nbuttons = true\n"
        "[version.red]\nelasticity = 1\nfriction = 1\nshape = 'true'\niterations = {}\n"
        "[version.blue]\nelasticity = 1\nfriction = 1\nshape = 'true'",
        cap);
  };
  for (const int cap : {0, 5, 20}) EXPECT_EQ(refusal(with_cap(cap)), "");
  EXPECT_THAT(refusal(with_cap(4)),
              HasSubstr("version.red.iterations must be 0, or a cap from 5 to 20; found 4"));
}

TEST(ScenarioOfATrial, TheBundledTrialIsRead) {
  const Trial trial = read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
  EXPECT_EQ(complaint([&] { scenario_of_trial(trial.header.scenario, "demo.lcmlog"); }), "");
}

TEST(ScenarioOfATrial, EmptyAndForeignOnesAreRefused) {
  for (const char* text : {"", "name = 'lane'", "[ball]\nmass = 5", "# nothing"}) {
    EXPECT_THAT(complaint([&] { scenario_of_trial(text, "x.lcmlog"); }), HasSubstr("is missing"));
  }
  EXPECT_THAT(complaint([&] { scenario_of_trial("<xml/>", "x.lcmlog"); }), HasSubstr("not TOML"));
}

}  // namespace
}  // namespace headpin::scene
