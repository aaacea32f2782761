#include "scene/stage/seen_mesh.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/looks/eyes.h"
#include "scene/stage/bodies.h"
#include "scene/stage/read_scenario.h"
#include "tests/support/box_object.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

const std::filesystem::path kMeshes = HEADPIN_SOURCE_DIR "/assets/meshes";

/// Skittles that collide as the hull that comes along, from beside the scenario.
std::string hull_scenario(const std::string& more = "") {
  return "[skittle]\nparts = [{shape = 'polyhedron', file = 'hull.obj'" + more + "}]\n";
}

/// What becomes of the rack in a second when the first skittle is thrown at the others.
std::uint64_t after_a_second(const Scenario& scenario) {
  const Stage stage = make_stage(scenario);
  engine::World world = stage.world;
  engine::wake(world, stage.skittles[0]);
  world.states[stage.skittles[0]].v_WB = Vec3(0.3, 3.0, 0.2);
  for (int i = 0; i < scenario.rates.physics_hz; ++i) engine::step(world);
  EXPECT_GT((world.states[stage.skittles[4]].X_WB.p - stage.world.states[stage.skittles[4]].X_WB.p)
                .norm(),
            0.02);
  return engine::state_hash(world);
}

/// Awake skittles that nothing touches stay where they are for two seconds.
void expect_stands(const Scenario& scenario) {
  const Stage stage = make_stage(scenario);
  engine::World world = stage.world;
  for (const engine::BodyId skittle : stage.skittles) engine::wake(world, skittle);
  for (int i = 0; i < 480; ++i) engine::step(world);
  for (const engine::BodyId skittle : stage.skittles) {
    EXPECT_LT((world.states[skittle].X_WB.p - stage.world.states[skittle].X_WB.p).norm(), 1e-3);
  }
}

TEST(PolyhedronPart, OfATrialCollidesWithoutItsFile) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(kMeshes / "skittle_hull.obj", folder / "hull.obj");
  const Scenario scenario = parse_scenario(hull_scenario(), (folder / "hull.toml").string());
  const SkittlePart& hull = scenario.skittle.parts[0];
  EXPECT_EQ(hull.mesh.file, (folder / "hull.obj").string());
  EXPECT_EQ(hull.mesh.sha256.size(), 64u);
  EXPECT_EQ(hull.low, 0.0);
  EXPECT_NEAR(hull.high, scenario.skittle.height, 1e-6);
  EXPECT_NEAR(hull.radius, 0.0605, 1e-4);
  const std::string text = to_toml(scenario);
  const std::uint64_t there = after_a_second(scenario);
  std::filesystem::remove(folder / "hull.obj");
  const Scenario replayed = scenario_of_trial(text, "elsewhere/trial.lcmlog");
  EXPECT_EQ(to_toml(replayed), text);
  EXPECT_EQ(after_a_second(replayed), there);
}

TEST(PolyhedronPart, StandsUntilItIsStruck) {
  const Scenario scenario = parse_scenario(
      fmt::format("[skittle]\nweighed = 'parts'\nparts = [{{shape = 'polyhedron', file = '{}'}}]",
                  (kMeshes / "skittle_hull.obj").string()),
      "x");
  expect_stands(scenario);
}

// By hand: the moments of the boxes about the base, matter where they overlap once.
TEST(PolyhedronPart, OfSeveralShellsIsWeighedAsTheirUnion) {
  const TemporaryFolder folder;
  const auto centre = [&](const std::string& shells) {
    spit(folder / "shells.obj", shells);
    return skittle_body(
               parse_scenario(
                   "[skittle]\nmass = 1.0\nparts = [{shape = 'polyhedron', file = 'shells.obj'}]\n",
                   (folder / "shells.toml").string()))
        .centre_height;
  };
  const std::string base = box_object({-0.05, -0.05, 0.0}, {0.05, 0.05, 0.1}, 1);
  EXPECT_NEAR(centre(base + box_object({-0.02, -0.02, 0.1}, {0.02, 0.02, 0.3}, 9)),
              (1000 * 0.05 + 320 * 0.2) / 1320, 1e-7);
  EXPECT_NEAR(centre(base + box_object({-0.02, -0.02, 0.05}, {0.02, 0.02, 0.3}, 9)),
              (1000 * 0.05 + 320 * 0.2) / 1320, 2e-4);
}

// What a file does not say follows from its mesh; what it says stays.
TEST(PolyhedronPart, DecidesHeightProfileMassAndLook) {
  const TemporaryFolder folder;
  spit(folder / "box.obj",
       "v -0.05 0 -0.05\nv 0.05 0 -0.05\nv 0.05 0 0.05\nv -0.05 0 0.05\n"
       "v -0.05 0.3 -0.05\nv 0.05 0.3 -0.05\nv 0.05 0.3 0.05\nv -0.05 0.3 0.05\n"
       "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
  const auto read = [&](const std::string& more) {
    return parse_scenario(
        "[skittle]\nparts = [{shape = 'polyhedron', file = 'box.obj', axes = 'RSP'}]\n" + more,
        (folder / "box.toml").string());
  };
  const Skittle box = read("").skittle;
  EXPECT_NEAR(box.height, 0.3, 1e-7);
  EXPECT_EQ(box.weighed, Weighed::parts);
  EXPECT_EQ(box.seen, SeenSkittle::collider);
  EXPECT_EQ(box.profile.back().x(), box.height);
  for (const Vec2& point : box.profile) EXPECT_NEAR(point.y(), std::hypot(0.05, 0.05), 1e-7);
  EXPECT_NEAR(skittle_body(read("")).centre_height, 0.15, 1e-7);

  const Skittle said =
      read("weighed = 'profile'\nseen = 'true'\nprofile = [[0.0, 0.05], [0.15, 0.06], [0.3, 0.05]]")
          .skittle;
  EXPECT_EQ(said.weighed, Weighed::profile);
  EXPECT_EQ(said.seen, SeenSkittle::profile);
  EXPECT_EQ(said.profile.size(), 3u);
  EXPECT_THROW(read("height = 0.31"), std::invalid_argument);
  const std::string metres = slurp(folder / "box.obj");
  std::string millimetres = metres;
  for (std::size_t at = 0; (at = millimetres.find("0.05", at)) != std::string::npos;)
    millimetres.replace(at, 4, "50");
  for (std::size_t at = 0; (at = millimetres.find("0.3", at)) != std::string::npos;)
    millimetres.replace(at, 3, "300");
  spit(folder / "box.obj", millimetres);
  EXPECT_THAT(complaint([&] { read(""); }),
              HasSubstr("box.toml:2: skittle.parts: 300 m high, expected 0.05 to 2; with unit = "
                        "0.001 it would be 0.3 m high"));
  // Primitives alone do not change what is seen.
  const Skittle plain =
      parse_scenario(
          "[skittle]\nparts = [{shape = 'cylinder', radius = 0.05, low = 0.0, high = 0.381}]", "x")
          .skittle;
  EXPECT_EQ(plain.profile, Scenario{}.skittle.profile);
  EXPECT_EQ(plain.weighed, Weighed::profile);
}

/// A square spool in the file's own unit and axes: 300 high, 60 wide at its ends and 24 between them.
std::string spool_obj(bool y_up, double base, double scale) {
  std::string text;
  const std::array<Vec2, 6> rings{Vec2(0, 30),   Vec2(60, 30),  Vec2(100, 12),
                                  Vec2(200, 12), Vec2(240, 30), Vec2(300, 30)};
  for (const Vec2& ring : rings) {
    for (const Vec2& p : {Vec2(1, 1), Vec2(-1, 1), Vec2(-1, -1), Vec2(1, -1)}) {
      const Vec3 at = scale * Vec3(ring.y() * p.x(), ring.y() * p.y(), ring.x() + base);
      text += y_up ? fmt::format("v {} {} {}\n", at.x(), at.z(), -at.y())
                   : fmt::format("v {} {} {}\n", at.x(), at.y(), at.z());
    }
  }
  text += "f 4 3 2 1\nf 21 22 23 24\n";
  for (int ring = 0; ring < 5; ++ring) {
    for (int i = 0; i < 4; ++i) {
      const int a = 4 * ring + i + 1, b = 4 * ring + (i + 1) % 4 + 1;
      text += fmt::format("f {} {} {} {}\n", a, b, b + 4, a + 4);
    }
  }
  return text;
}

// Its mass properties are those of square slices: a square of half side r has m (8 r^2) / 12 about its
// middle.
TEST(PolyhedronPart, ThatIsNotConvexIsItsPieces) {
  const TemporaryFolder folder;
  spit(folder / "hull.obj", spool_obj(false, 0.0, 0.001));
  const Scenario scenario = parse_scenario(
      "[skittle]\nmass = 1.2\nparts = [\n  {shape = 'polyhedron', file = 'hull.obj'},\n"
      "  {shape = 'cylinder', radius = 0.01, low = 0.3, high = 0.31},\n]\n",
      (folder / "hull.toml").string());
  ASSERT_EQ(scenario.skittle.parts.size(), 4u);
  EXPECT_NEAR(scenario.skittle.parts[1].high, 0.2, 1e-7);
  EXPECT_EQ(scenario.skittle.parts[3].shape, PartShape::cylinder);
  EXPECT_THAT(not_convex(scenario),
              testing::ElementsAre(HasSubstr("hull.obj: not convex: 3 convex pieces collide in its "
                                             "place, with 0.0 % more volume")));
  // What is wrong behind it is still told with its own line.
  EXPECT_THAT(complaint([&] {
                parse_scenario(
                    "[skittle]\nparts = [\n  {shape = 'polyhedron', file = 'hull.obj'},\n"
                    "  {shape = 'cylinder', radius = 0.01, low = 0.35, high = 0.36},\n]\n",
                    (folder / "hull.toml").string());
              }),
              HasSubstr("hull.toml:4: skittle.parts must leave no gap"));
  // A trial has the pieces, and needs no file.
  const Scenario alone =
      parse_scenario("[skittle]\nmass = 1.2\nparts = [{shape = 'polyhedron', file = 'hull.obj'}]\n",
                     (folder / "hull.toml").string());
  const std::string text = to_toml(alone);
  std::filesystem::remove(folder / "hull.obj");
  const Scenario replayed = scenario_of_trial(text, "elsewhere/trial.lcmlog");
  EXPECT_EQ(to_toml(replayed), text);
  EXPECT_EQ(replayed.skittle.parts.size(), 3u);
  // Slices of squares: volume 4 r^2, r linear between the rings.
  double volume = 0.0, about_axis = 0.0;
  const std::array<Vec2, 6> rings{Vec2(0, 0.03),    Vec2(0.06, 0.03), Vec2(0.1, 0.012),
                                  Vec2(0.2, 0.012), Vec2(0.24, 0.03), Vec2(0.3, 0.03)};
  for (std::size_t i = 1; i < rings.size(); ++i) {
    constexpr int kSlices = 20000;
    for (int k = 0; k < kSlices; ++k) {
      const double share = (k + 0.5) / kSlices;
      const double r = (1.0 - share) * rings[i - 1].y() + share * rings[i].y();
      const double thick = (rings[i].x() - rings[i - 1].x()) / kSlices;
      volume += 4.0 * r * r * thick;
      about_axis += 4.0 * r * r * thick * (8.0 * r * r) / 12.0;
    }
  }
  const SkittleBody body = skittle_body(replayed);
  EXPECT_NEAR(body.centre_height, 0.15, 1e-7);
  EXPECT_NEAR(body.body.inertia(2, 2), 1.2 * about_axis / volume, 1e-8);
}

// What is told of a mesh is of one use of it, by the file that the corners are from.
TEST(PolyhedronPart, IsToldOfByItsFileUnitAndAxes) {
  const TemporaryFolder folder;
  const std::string lane = (folder / "lane.toml").string();
  const std::string hull = (kMeshes / "skittle_hull.obj").string();
  const auto told = [&](const std::string& parts) {
    return not_convex(parse_scenario("[skittle]\nparts = [" + parts + "]\n", lane));
  };
  const auto part = [](const std::string& file, const std::string& more = "") {
    return "{shape = 'polyhedron', file = '" + file + "'" + more + "}";
  };
  EXPECT_THAT(told(part(hull) + ", " + part(hull)), testing::IsEmpty());
  EXPECT_THAT(told(part(hull) + ", " + part(hull, ", unit = 0.9")), testing::IsEmpty());
  spit(folder / "spool.obj", spool_obj(false, 0.0, 0.001));
  EXPECT_THAT(told(part("spool.obj") + ", " + part("spool.obj")),
              testing::ElementsAre(HasSubstr("3 convex pieces collide in its place, with 0.0 %")));
  // The corners do without the file: where it is another one now, or gone, nothing is told of it.
  const std::string text =
      to_toml(parse_scenario("[skittle]\nparts = [" + part("spool.obj") + "]\n", lane));
  EXPECT_EQ(not_convex(parse_scenario(text, lane)).size(), 1u);
  spit(folder / "spool.obj", spool_obj(false, 0.0, 0.002));
  EXPECT_THAT(not_convex(parse_scenario(text, lane)), testing::IsEmpty());
  std::filesystem::remove(folder / "spool.obj");
  EXPECT_THAT(not_convex(parse_scenario(text, lane)), testing::IsEmpty());
}

TEST(PolyhedronPart, WithANeckStandsUntilItIsStruck) {
  const Scenario scenario =
      parse_scenario(fmt::format("[skittle]\nparts = [{{shape = 'polyhedron', file = '{}'}}]",
                                 (kMeshes / "skittle.obj").string()),
                     "x");
  EXPECT_GT(scenario.skittle.parts.size(), 1u);
  EXPECT_NEAR(scenario.skittle.height, 0.381, 1e-6);
  expect_stands(scenario);
  after_a_second(scenario);
}

// What is offered, taken, gives the skittle.
TEST(PolyhedronPart, OfAnotherUnitAndOtherAxesIsToldWhichFit) {
  const TemporaryFolder folder;
  const auto said = [&](bool y_up, double base, double scale, const std::string& more) {
    spit(folder / "hull.obj", spool_obj(y_up, base, scale));
    return complaint([&] { parse_scenario(hull_scenario(more), (folder / "lane.toml").string()); });
  };
  EXPECT_EQ(said(false, 0.0, 0.001, ""), "");
  EXPECT_THAT(said(true, 0.0, 0.001, ""),
              HasSubstr("; with axes = \"RSP\" it would be 0.3 m high"));
  EXPECT_EQ(said(true, 0.0, 0.001, ", axes = 'RSP'"), "");
  EXPECT_THAT(said(true, 0.0, 1.0, ""),
              HasSubstr("; with unit = 0.001 and axes = \"RSP\" it would be 0.3 m high"));
  EXPECT_EQ(said(true, 0.0, 1.0, ", unit = 0.001, axes = 'RSP'"), "");
  EXPECT_THAT(said(false, -300.0, 0.001, ""),
              HasSubstr("; with axes = \"RPI\" it would be 0.3 m high"));
  EXPECT_EQ(said(false, -300.0, 0.001, ", axes = 'RPI'"), "");
  EXPECT_THAT(said(false, -150.0, 0.001, ""),
              HasSubstr("lane.toml:2: skittle.parts must begin at the base, 0; found -0.15 as the "
                        "lowest; move the mesh so that the middle of its base is at 0, 0, 0"));
}

TEST(PolyhedronPart, ThatIsNoneIsRefusedWithItsPlace) {
  const TemporaryFolder folder;
  const std::string where = (folder / "lane.toml").string();
  const auto refusal = [&](const std::string& text) {
    return complaint([&] { parse_scenario(text, where); });
  };
  EXPECT_THAT(refusal(hull_scenario()), HasSubstr("lane.toml:2: skittle.parts: "));
  EXPECT_THAT(refusal(hull_scenario()), HasSubstr("hull.obj: cannot open"));
  std::filesystem::copy_file(kMeshes / "skittle_hull.obj", folder / "hull.obj");
  EXPECT_THAT(refusal(hull_scenario(", sha256 = 'abc'")), HasSubstr("expected abc"));
  EXPECT_THAT(refusal(hull_scenario(", radius = 0.1")), HasSubstr("unknown key"));
  EXPECT_THAT(refusal(hull_scenario(", axes = 'up'")), HasSubstr("axes 'up'"));
  EXPECT_THAT(refusal(hull_scenario(", unit = 0.0254")),
              HasSubstr("skittle.parts: 0.0096774 m high, expected 0.05 to 2"));
  EXPECT_THAT(refusal(hull_scenario(", corners = [[0, 0, 0]], faces = [[0, 1, 9]]")),
              HasSubstr("lane.toml:2: skittle.parts: polyhedron"));
  EXPECT_THAT(refusal(hull_scenario(", corners = [[0, 0, 0]], faces = [[0, 1, 2], [3, 86.9, 1]]")),
              HasSubstr("lane.toml:2: skittle.parts, part 1: faces, entry 2, number 2 must be a "
                        "whole number from 0 to 2000, found 86.9"));
  EXPECT_THAT(refusal("[skittle]\nparts = [{shape = 'polyhedron'}]"), HasSubstr("neither"));
}

/// Ids from a head at the foul line.
render::Labels seen_by(const Scenario& scenario) {
  Eyes eyes = open_eyes(make_stage(scenario));
  const Pose X_WD{rotation(Vec3(0.5 * std::numbers::pi - 0.15, 0, 0)), Vec3(0, 3.5, 1.2)};
  return see_labels(eyes, glimpse(make_session(scenario), X_WD))[0];
}

TEST(SeenMesh, IsSeenWhereWhatItStandsForWouldBe) {
  Scenario own, files;
  for (const char* what : {"skittle", "ball"}) {
    set(files, fmt::format("{0}.mesh.file={1}/{0}.obj", what, kMeshes.string()));
  }
  const render::Labels a = seen_by(own), b = seen_by(files);
  int skittles = 0, other = 0;
  for (std::size_t i = 0; i < a.id.size(); ++i) {
    skittles += a.id[i] >= kFirstSkittleId;
    other += a.id[i] != b.id[i];
  }
  EXPECT_GT(skittles, 500);
  EXPECT_LT(other, skittles / 20);  // their own are of fewer triangles from afar
}

TEST(SeenMesh, OfARoomIsInTheWorldInPlaceOfItsWalls) {
  const TemporaryFolder folder;
  std::ofstream(folder / "wall.obj")  // across the lane, 1 m before the eye, in millimetres
      << "v -2000 4500 0\nv 2000 4500 0\nv 2000 4500 3000\nv -2000 4500 3000\nf 1 2 3 4\n";
  const Scenario scenario = parse_scenario("[room.mesh]\nfile = 'wall.obj'\nunit = 0.001\n",
                                           (folder / "room.toml").string());
  const render::Labels labels = seen_by(scenario);
  const auto middle = static_cast<std::size_t>(labels.height / 2 * labels.width + labels.width / 2);
  EXPECT_EQ(labels.id[middle], kRoomId);
  EXPECT_NEAR(labels.depth[middle], 1.0 / std::cos(0.15), 0.02);
}

// A landscape around the lane, or a large hall: farther away than any room's own walls.
TEST(SeenMesh, OfARoomIsSeenAsFarAsItReaches) {
  const TemporaryFolder folder;
  std::ofstream(folder / "hill.obj")  // 300 m behind the foul line, and as high
      << "v 200 -300 -100\nv -200 -300 -100\nv -200 -300 300\nv 200 -300 300\nf 1 2 3 4\n";
  const Scenario scenario =
      parse_scenario("[room.mesh]\nfile = 'hill.obj'\n", (folder / "room.toml").string());
  Eyes eyes = open_eyes(make_stage(scenario));
  const Pose X_WD = looking_at(Vec3(0.0, 0.0, 1.6), Vec3(0.0, -300.0, 60.0));
  const render::Labels labels = see_labels(eyes, glimpse(make_session(scenario), X_WD))[0];
  const auto middle = static_cast<std::size_t>(labels.height / 2 * labels.width + labels.width / 2);
  EXPECT_EQ(labels.id[middle], kRoomId);
  // Half a pixel down, it is 0.1 m nearer or farther; so is a step of the depth buffer of 24 bits.
  EXPECT_NEAR(labels.depth[middle], std::hypot(300.0, 58.4), 0.5);
}

TEST(SeenMesh, OfATrialIsFoundAgainByItsHash) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "lab");
  std::filesystem::create_directories(folder / "trials");
  const auto pin = folder / "lab" / "pin.obj", beside = folder / "trials" / "pin.obj";
  std::filesystem::copy_file(kMeshes / "skittle.obj", pin);
  const Scenario scenario =
      parse_scenario("[skittle.mesh]\nfile = 'pin.obj'\n", (folder / "lab" / "room.toml").string());
  EXPECT_EQ(scenario.skittle.mesh.file, pin.string());
  const std::string text = to_toml(scenario);
  const auto again = [&] {
    return scenario_of_trial(text, (folder / "trials" / "one.lcmlog").string()).skittle.mesh;
  };
  EXPECT_EQ(again().file, pin.string());
  std::filesystem::copy_file(kMeshes / "ball.obj", beside);  // another of the same name
  std::filesystem::remove(pin);
  EXPECT_EQ(again().file, pin.string());  // and whoever wants to see it is told
  EXPECT_THAT(complaint([&] { seen_mesh(again(), Vec3::Ones(), 0.5); }),
              HasSubstr("pin.obj: cannot open: No such file"));
  std::filesystem::remove(beside);
  std::filesystem::copy_file(kMeshes / "skittle.obj", beside);
  EXPECT_EQ(again().file, beside.string());
  EXPECT_TRUE(seen_mesh(again(), Vec3::Ones(), 0.5).has_value());
  std::ofstream(beside, std::ios::app) << "# one line more\n";
  MeshFile changed = scenario.skittle.mesh;
  changed.file = beside.string();
  EXPECT_THAT(complaint([&] { seen_mesh(changed, Vec3::Ones(), 0.5); }), HasSubstr("SHA-256"));
}

TEST(SeenMesh, SetAnewHasAnotherHash) {
  Scenario scenario;
  set(scenario, fmt::format("skittle.mesh.file={}", (kMeshes / "skittle.obj").string()));
  const std::string first = scenario.skittle.mesh.sha256;
  set(scenario, "ball.mass=5");  // what is not named stays
  EXPECT_EQ(scenario.skittle.mesh.sha256, first);
  const TemporaryFolder folder;
  std::filesystem::copy_file(kMeshes / "skittle.obj", folder / "other.obj");
  std::ofstream(folder / "other.obj", std::ios::app) << "# one line more\n";
  set(scenario, fmt::format("skittle.mesh.file={}", (folder / "other.obj").string()));
  EXPECT_NE(scenario.skittle.mesh.sha256, first);
  EXPECT_THAT(complaint([&] { set(scenario, "skittle.mesh.file=/nowhere/x.obj"); }),
              HasSubstr("skittle.mesh: /nowhere/x.obj: cannot open"));
}

// What makes a mesh another size is checked as its file is; a trial replays where the file is not.
TEST(SeenMesh, IsMeasuredAgainWhenSomethingElseSetsItsSize) {
  const TemporaryFolder folder;
  const std::filesystem::path ball = folder / "ball.obj";
  std::filesystem::copy_file(kMeshes / "ball.obj", ball);
  Scenario seen;
  set(seen, "skittle.mesh.file=" + (kMeshes / "skittle.obj").string());
  set(seen, "ball.mesh.file=" + ball.string());
  const std::string sha256 = seen.ball.mesh.sha256;
  const auto refusal = [](Scenario scenario, const std::string& assignment) {
    return complaint([&] { set(scenario, assignment); });
  };
  EXPECT_THAT(refusal(seen, "skittle.mesh.unit=0.001"), HasSubstr("its farthest point is"));
  EXPECT_THAT(refusal(seen, "ball.mesh.axes='XYZ'"), HasSubstr("axes 'XYZ'"));
  EXPECT_THAT(refusal(seen, "ball.radius=0.4"), HasSubstr("its farthest point is"));
  set(seen, "ball.radius=0.11");
  EXPECT_EQ(seen.ball.mesh.sha256, sha256);
  std::filesystem::remove(ball);
  set(seen, "ball.radius=0.12");  // not refused
}

TEST(SeenMesh, AGivenHashIsCheckedBeforeAndAfterItsFile) {
  const std::string file = "skittle.mesh.file=" + (kMeshes / "skittle.obj").string();
  const auto refusal = [](Scenario scenario, const std::vector<std::string>& assignments) {
    return complaint([&] {
      for (const std::string& one : assignments) set(scenario, one);
    });
  };
  Scenario seen;
  set(seen, file);
  const std::string hash = "skittle.mesh.sha256=" + seen.skittle.mesh.sha256;
  EXPECT_THAT(refusal({}, {file, "skittle.mesh.sha256=abcd"}),
              HasSubstr("skittle.mesh.sha256=abcd: skittle.mesh: "));
  EXPECT_THAT(refusal({}, {file, "skittle.mesh.sha256=abcd"}), HasSubstr("expected abcd"));
  EXPECT_THAT(refusal({}, {"skittle.mesh.sha256=abcd", file}), HasSubstr("expected abcd"));
  EXPECT_EQ(refusal({}, {file, hash}), "");
  EXPECT_EQ(refusal({}, {hash, file}), "");
  // The hash of an earlier file is no given one, also where that file is taken away or gone.
  const std::string trial = to_toml(seen);
  const Scenario replayed = scenario_of_trial(trial, "elsewhere/trial.lcmlog");
  const TemporaryFolder folder;
  std::filesystem::copy_file(kMeshes / "skittle.obj", folder / "other.obj");
  std::ofstream(folder / "other.obj", std::ios::app) << "# one line more\n";
  const std::string other = "skittle.mesh.file=" + (folder / "other.obj").string();
  EXPECT_EQ(refusal(replayed, {other}), "");
  EXPECT_EQ(refusal(replayed, {"skittle.mesh.file=", other}), "");
  Scenario gone = seen;
  gone.skittle.mesh.file = "/nowhere/x.obj";
  const Scenario without = scenario_of_trial(to_toml(gone), "elsewhere/trial.lcmlog");
  EXPECT_EQ(without.skittle.mesh.sha256, seen.skittle.mesh.sha256);
  EXPECT_EQ(refusal(without, {"ball.mass=5"}), "");
  EXPECT_EQ(refusal(without, {other}), "");
}

// Its unit, or what it must be as large as, may come before it or after it.
TEST(SeenMesh, AssignmentsFitTogetherInAnyOrder) {
  const TemporaryFolder folder;
  spit(folder / "mm.obj", spool_obj(false, 0.0, 1.0));  // 300 high
  const std::string file = "skittle.mesh.file=" + (folder / "mm.obj").string(),
                    unit = "skittle.mesh.unit=0.001";
  const auto refusal = [](Scenario scenario, const std::vector<std::string>& assignments) {
    std::vector<Assignment> all;
    for (const std::string& one : assignments) all.push_back({one, one.substr(0, 17)});
    return complaint([&] { set(scenario, all); });
  };
  EXPECT_EQ(refusal({}, {unit, file}), "");
  EXPECT_EQ(refusal({}, {file, unit}), "");
  EXPECT_THAT(refusal({}, {file}), HasSubstr("skittle.mesh.file: skittle.mesh: "));
  EXPECT_THAT(refusal({}, {file, "ball.mass=5"}), testing::StartsWith("skittle.mesh.file: "));
  // A room of 4.5 m is 4500 in millimetres, farther than any mesh may reach in metres.
  spit(folder / "room.obj", spool_obj(false, 0.0, 15.0));
  const std::string room = "room.mesh.file=" + (folder / "room.obj").string();
  EXPECT_THAT(refusal({}, {room}), HasSubstr("expected within 1000 m"));
  EXPECT_EQ(refusal({}, {room, "room.mesh.unit=0.001"}), "");
  EXPECT_EQ(refusal({}, {"room.mesh.unit=0.001", room}), "");
  // A scenario that has a mesh may get another one with another unit.
  Scenario seen;
  set(seen, "skittle.mesh.file=" + (kMeshes / "skittle.obj").string());
  EXPECT_EQ(refusal(seen, {unit, file}), "");
  EXPECT_EQ(refusal(seen, {file, unit}), "");
  EXPECT_THAT(refusal(seen, {unit, "ball.mass=5"}), testing::StartsWith("skittle.mesh.unit"));
  // A hash that is given is checked all the same.
  for (const std::vector<std::string>& all :
       {std::vector<std::string>{file, unit, "skittle.mesh.sha256=abcd"},
        {file, "skittle.mesh.sha256=abcd", unit},
        {"skittle.mesh.sha256=abcd", file, unit}}) {
    EXPECT_THAT(refusal({}, all), HasSubstr("expected abcd"));
  }
}

}  // namespace
}  // namespace headpin::scene
