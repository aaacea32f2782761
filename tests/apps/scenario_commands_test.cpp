// Scenarios as the commands meet them: from a file, and inside a trial.

#include <set>

#include <fmt/format.h>

#include "base/output_file.h"
#include "render/image.h"
#include "render/png.h"
#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/apps/command_line.h"
#include "tests/support/hand_script.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class ScenarioCommands : public CommandLine {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// The bundled trial with another scenario in it.
  void write_trial(const std::string& name, const std::string& scenario) const {
    scene::Trial trial = scene::read_trial(kDemo);
    trial.header.scenario = scenario;
    scene::Recorder recorder(base::OutputFile(folder_ / name, {.overwrite = true}), trial.header);
    scene::write(recorder, trial.samples, trial.events);
    recorder.close();
  }
  scene::Scenario scenario_of(const std::string& name) const {
    return scene::scenario_of_trial(scene::read_trial(folder_ / name).header.scenario, name);
  }
};

TEST_F(ScenarioCommands, ThoseThatComeAlongAreListedShownAndChecked) {
  const nlohmann::json all = json("scenario list --json")["scenarios"];
  std::vector<std::string> names;
  for (const nlohmann::json& one : all) {
    names.push_back(one["scenario"]);
    write("shown.toml", headpin("scenario show " + names.back()).out);
    EXPECT_EQ(scene::to_toml(scene::load_scenario((folder_ / "shown.toml").string())),
              scene::to_toml(scene::load_scenario(one["file"])));
    nlohmann::json shown = json("scenario check shown.toml --json");
    shown["file"] = one["file"];
    EXPECT_EQ(shown, one);
  }
  EXPECT_THAT(names, testing::ElementsAre("english-skittles", "german-ninepins", "house-oil",
                                          "paper-experiment", "paper-objects", "paper-room",
                                          "regulation-ten-pin", "sport-oil", "uno-slater-1997"));
  EXPECT_THAT(headpin("scenario check german-ninepins").out, HasSubstr("9 skittles of "));
  write("bad.toml", "name = 'bad'\n[ball]\nmas = 5\n");
  expect_refusal("scenario check bad.toml", 1, "bad.toml:3: unknown key 'ball.mas'");
  expect_refusal("scenario check", 2, "expected headpin scenario check SCENARIO");
  expect_refusal("scenario list paper-room", 2, "expected headpin scenario list");
}

TEST_F(ScenarioCommands, ANewOneHasAllKeysOfAnotherAndItsOwnName) {
  const Result made = headpin("scenario new --from german-ninepins -o mine.toml");
  EXPECT_EQ(made.code, 0) << made.err;
  const nlohmann::json same = json("scenario diff german-ninepins mine.toml --json");
  ASSERT_EQ(same["scenario_differences"].size(), 1u);
  EXPECT_EQ(same["scenario_differences"][0]["key"], "name");
  EXPECT_THAT(slurp(folder_ / "mine.toml"), HasSubstr("name = 'mine'"));
  expect_refusal("scenario new --from paper-room -o mine.toml", 1, "--force replaces it");
  expect_refusal("scenario new --from paper-room -o mine.png", 2, "ends in .toml, found mine.png");
  expect_refusal("scenario new paper-room -o other.toml", 2, "--from SCENARIO -o FILE.toml");
  expect_refusal("scenario new --from mine.toml -o mine.toml --force", 1, "is an input");
  EXPECT_EQ(headpin("scenario new --from paper-room -o mine.toml --force").code, 0);
  write("heavy.toml", "[ball]\nmass = 7.5\n");
  EXPECT_THAT(headpin("scenario diff paper-room heavy.toml").out,
              testing::ContainsRegex("ball.mass +[0-9.]+  ->  7.5\n"));
  EXPECT_EQ(headpin("scenario diff mine.toml mine.toml").out, "the same values\n");
  expect_refusal("scenario diff paper-room", 2, "scenario diff SCENARIO OTHER");
}

TEST_F(ScenarioCommands, ADrawingShowsTheRoomFromFourSides) {
  ASSERT_EQ(headpin("scenario draw paper-room -o room.png").code, 0);
  const render::Image all = render::read_png(folder_ / "room.png");
  EXPECT_EQ(all.width, 1440);
  const auto quarter = [&](int row, int column) {
    render::Image part{all.width / 2, all.height / 2, {}};
    for (int y = row * part.height; y < (row + 1) * part.height; ++y) {
      const auto begin = all.rgb.begin() + 3 * (y * all.width + column * part.width);
      part.rgb.insert(part.rgb.end(), begin, begin + 3 * part.width);
    }
    return part;
  };
  std::set<std::uint64_t> different;
  for (const int row : {0, 1}) {
    for (const int column : {0, 1}) {
      const render::Image part = quarter(row, column);
      different.insert(render::pixel_hash(part));
      const std::set<std::uint8_t> shades(part.rgb.begin(), part.rgb.end());
      EXPECT_GT(shades.size(), 100u) << row << column;
    }
  }
  EXPECT_EQ(different.size(), 4u);
  expect_refusal("scenario draw paper-room", 2, "scenario draw SCENARIO -o FILE.png");
  expect_refusal("scenario draw paper-room -o room.png", 1, "--force replaces it");
  expect_refusal("scenario check paper-room --gl osmesa", 2, "scenario check SCENARIO");
}

TEST_F(ScenarioCommands, ADrawingOfAVeryTallOrWideFieldOfViewIsOfASizeThatCanBeDrawn) {
  write("tall.toml", "[hmd]\nhorizontal_fov_deg = 20\nvertical_fov_deg = 100\n");
  ASSERT_EQ(headpin("scenario draw tall.toml -o tall.png").code, 0);
  const render::Image tall = render::read_png(folder_ / "tall.png");
  EXPECT_EQ(tall.height, 2 * 1800);
  EXPECT_EQ(tall.width, 2 * 266);  // square pixels: 1800 tan 10 / tan 50 = 266.3
  write("taller.toml", "[hmd]\nhorizontal_fov_deg = 1\nvertical_fov_deg = 170\n");
  ASSERT_EQ(headpin("scenario draw taller.toml -o taller.png").code, 0);
  EXPECT_EQ(render::read_png(folder_ / "taller.png").width, 2 * 90);
  write("wide.toml", "[hmd]\nhorizontal_fov_deg = 170\nvertical_fov_deg = 1\n");
  EXPECT_EQ(headpin("scenario draw wide.toml -o wide.png").code, 0);
}

TEST_F(ScenarioCommands, AGameOfTwoVersionsIsScoredReplayedAndVerified) {
  const scene::Scenario scenario =
      scene::load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  scene::HandScript hand(scenario);
  hand.touch(scenario.version.red.button);
  hand.throw_from(0.0);
  hand.throw_from(0.2);
  hand.touch(scenario.version.blue.button);
  hand.throw_from(0.0);
  scene::TrialHeader header;
  header.scenario = scene::to_toml(scenario);
  scene::Recorder recorder(folder_ / "hand.lcmlog", header);
  scene::write(recorder, hand.samples, {});
  recorder.close();
  const nlohmann::json played = json("replay hand.lcmlog -o game.lcmlog --json");
  ASSERT_EQ(played["games"].size(), 2u);
  EXPECT_EQ(played["games"][0]["name"], "red");
  EXPECT_EQ(played["games"][0]["rolls"].size(), 1u);  // the frame that was begun then has none
  EXPECT_EQ(played["games"][0]["rolls"][0].size(), 2u);
  EXPECT_FALSE(played["games"][0]["over"].get<bool>());
  EXPECT_EQ(played["games"][1]["name"], "blue");
  EXPECT_EQ(json("info game.lcmlog --json")["result"]["games"], played["games"]);
  const std::string sheet = played["games"][0]["sheet"];
  EXPECT_THAT(headpin("info game.lcmlog").out, HasSubstr(sheet));
  EXPECT_THAT(headpin("replay hand.lcmlog").out, HasSubstr(sheet));
  EXPECT_EQ(json("replay game.lcmlog --verify --json")["state_hash"], played["state_hash"]);
  // A version played otherwise is noticed, at the tick at which it differs.
  expect_refusal("replay game.lcmlog --verify --set version.red.friction=0.2", 1, "differs");
  EXPECT_NE(json("replay hand.lcmlog --set version.red.friction=0.0 --json")["ledger"],
            played["ledger"]);
  expect_refusal("replay hand.lcmlog -o OUT --set 'version.red.button=[0, 0, 9]'", 2,
                 "version.red.button must be within a hand's reach");
  expect_refusal("replay hand.lcmlog -o OUT --set walk.speed=-1", 2, "walk.speed must be");
}

TEST_F(ScenarioCommands, WhatCannotBeReadIsRefusedByAll) {
  fs::create_directory(folder_ / "folder");
  for (const std::string& command : std::vector<std::string>{
           "synthesize -o OUT", "live --lcm memq:// --duration 0.1 --record OUT"}) {
    expect_refusal(command + " --scenario ./folder", 1, "./folder: cannot be read: Is a directory");
    expect_refusal(command + " --scenario none.toml", 1, "none.toml: cannot be read: No such file");
  }
}

TEST_F(ScenarioCommands, WhatDoesNotFitIsRefusedByAllAlike) {
  write("gap.toml", "[skittle]\nheight = 0.3\nparts = [{low = 0.1, high = 0.3}]\n");
  write("wall.toml", "\n\nball.home = [0.0, 0.0, 9.0]\n");
  for (const std::string& command : std::vector<std::string>{
           "synthesize -o OUT", "live --lcm memq:// --duration 0.1 --record OUT"}) {
    expect_refusal(command + " --scenario gap.toml", 1, "gap.toml:3: skittle.parts must begin at");
    expect_refusal(command + " --scenario wall.toml", 1, "wall.toml:3: ball.home must hold");
  }
  expect_refusal("replay " + kDemo + " -o OUT --set skittle.height=0.5", 2,
                 "--set skittle.height=0.5: skittle.height must be that of its parts");
}

TEST_F(ScenarioCommands, ATrialWithoutItsWholeScenarioIsRefusedByAll) {
  std::string deep = "a";
  for (int i = 0; i < 50'000; ++i) deep += ".a";
  const std::string whole = scene::read_trial(kDemo).header.scenario;
  std::string cut = whole;
  cut[cut.find("gravity")] = '#';
  for (const auto& [text, says] :
       {std::pair{std::string(), "name is missing"},
        {std::string("[ball]\nmass = 5\n"), "name is missing"},
        {std::string("<lane/>"), "not TOML"},
        {cut, "collision.gravity is missing"},
        {fmt::format("{}\n[gutter]\ndepth = 1\n", whole), "unknown key 'gutter'"},
        {fmt::format("{} = 1", deep), "nested more than 16 deep"}}) {
    write_trial("x.lcmlog", text);
    for (const char* command : {"replay x.lcmlog -o OUT", "frames x.lcmlog -o OUT",
                                "stream x.lcmlog --lcm memq:// --speed 0"}) {
      expect_refusal(command, 1, says);
    }
    EXPECT_EQ(headpin("info x.lcmlog").code, 0);
  }
  write_trial("x.lcmlog", whole);
  EXPECT_EQ(json("replay x.lcmlog --json")["state_hash"],
            json("replay --json " + kDemo)["state_hash"]);
}

TEST_F(ScenarioCommands, ALookByNameIsKeptInTheTrialAndMovesNothing) {
  const nlohmann::json as_it_was = json("replay " + kDemo + " --json");
  const nlohmann::json looked = json("replay " + kDemo + " --look 1997 -o looked.lcmlog --json");
  EXPECT_EQ(looked["state_hash"], as_it_was["state_hash"]);
  const std::string scenario = headpin("info looked.lcmlog --scenario").out;
  for (const char* line :
       {"samples = 1", "contact = false", "shadow = false", "mirror = false", "light = 'vertex'"}) {
    EXPECT_THAT(scenario, testing::HasSubstr(line));
  }
  EXPECT_EQ(headpin("live --lcm memq:// --look fast --samples 3").code, 2);
  EXPECT_EQ(headpin("replay " + kDemo + " --look 2027").code, 2);
}

TEST_F(ScenarioCommands, SynthesizeKeepsWhatTheScenarioSays) {
  ASSERT_EQ(headpin("synthesize -o usual.lcmlog --seed 3").code, 0);
  const scene::Scenario usual = scenario_of("usual.lcmlog");
  Vec3 home = usual.ball.home + Vec3(0.01, 0.02, 0.0);
  write("own.toml", fmt::format("ball.home = [{}, {}, {}]\n[rig]\nX_WT = {{p = [0.5, -2.0, 1.0]}}\n"
                                "delay_s = 0.0\n",
                                home.x(), home.y(), home.z()));
  ASSERT_EQ(headpin("synthesize -o own.lcmlog --seed 3 --scenario own.toml").code, 0);
  const scene::Scenario own = scenario_of("own.lcmlog");
  EXPECT_EQ(own.ball.home, home);
  EXPECT_EQ(own.rig.X_WT.p, Vec3(0.5, -2.0, 1.0));
  EXPECT_EQ(own.rig.delay_s, 0.0);
  EXPECT_EQ(own.rig.X_SH.p, Vec3::Zero().eval());
  // The same arm throws the same ball, whatever measures it.
  const nlohmann::json thrown = json("replay own.lcmlog --json");
  EXPECT_NEAR(thrown["release_speed_mps"].get<double>(), 6.5, 0.6);
  write("far.toml", "ball.home = [1.5, 1.0, 0.85]\n");
  expect_refusal("synthesize -o OUT --scenario far.toml", 2, "ball.home must be within the arm's");
}

// A box of 0.1 x 0.1 x 0.3 m and 1 kg, a ball of 6 kg and 0.1 m: by their formulas.
TEST_F(ScenarioCommands, CheckTellsWhereMassLies) {
  write("box.toml",
        "[ball]\nmass = 6.0\nradius = 0.1\n[skittle]\nmass = 1.0\nheight = 0.3\nweighed = 'parts'\n"
        "parts = [{shape = 'polyhedron', file = 'box.obj', axes = 'RSP'}]\n");
  write("box.obj",
        "v -0.05 0 -0.05\nv 0.05 0 -0.05\nv 0.05 0 0.05\nv -0.05 0 0.05\nv -0.05 0.3 -0.05\n"
        "v 0.05 0.3 -0.05\nv 0.05 0.3 0.05\nv -0.05 0.3 0.05\n"
        "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
  const nlohmann::json told = json("scenario check box.toml --json");
  EXPECT_NEAR(told["centre_of_mass_m"], 0.15, 1e-7);  // the file has single precision
  const double across = (0.1 * 0.1 + 0.3 * 0.3) / 12.0, about = (0.1 * 0.1 + 0.1 * 0.1) / 12.0;
  EXPECT_NEAR(told["inertia_kgm2"][0], across, 1e-6 * across);
  EXPECT_NEAR(told["inertia_kgm2"][1], across, 1e-6 * across);
  EXPECT_NEAR(told["inertia_kgm2"][2], about, 1e-6 * about);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(told["ball_inertia_kgm2"][axis], 0.024, 1e-9);
  EXPECT_THAT(
      headpin("scenario check box.toml").out,
      HasSubstr("centre of mass 0.1500 m up, moments of inertia 0.00833, 0.00833, 0.00167 kg m2 "
                "about x, y, z; ball: 0.024 kg m2"));
}

// A mesh with a neck is thrown at as its pieces, which are in the trial.
TEST_F(ScenarioCommands, AMeshThatIsNotConvexIsThrownAtAndToldOf) {
  fs::create_directory(folder_ / "lab");
  fs::copy_file(HEADPIN_SOURCE_DIR "/assets/meshes/skittle.obj", folder_ / "lab" / "pin.obj");
  write("lab/pins.toml", "[skittle]\nparts = [{shape = 'polyhedron', file = 'pin.obj'}]\n");
  const nlohmann::json told = json("scenario check lab/pins.toml --json");
  EXPECT_GT(told["primitives"], 1);
  ASSERT_EQ(told["not_convex"].size(), 1u);
  EXPECT_THAT(told["not_convex"][0].get<std::string>(), HasSubstr("pin.obj: not convex: "));
  EXPECT_EQ(json("scenario check paper-room --json")["not_convex"].size(), 0u);
  ASSERT_EQ(headpin("synthesize -o thrown.lcmlog --seed 3 --scenario lab/pins.toml").code, 0);
  fs::remove_all(folder_ / "lab");
  const nlohmann::json game = json("replay thrown.lcmlog -o a.lcmlog --json");
  EXPECT_GT(game["skittles_down"], 0);
  EXPECT_EQ(headpin("replay a.lcmlog --verify").code, 0);
}

// What collides is in the trial, what is only seen is a file beside it.
TEST_F(ScenarioCommands, ATrialReplaysWithoutItsMeshesAndIsSeenWithThem) {
  const fs::path meshes = HEADPIN_SOURCE_DIR "/assets/meshes";
  fs::create_directory(folder_ / "lab");
  fs::copy_file(meshes / "skittle_hull.obj", folder_ / "lab" / "hull.obj");
  fs::copy_file(meshes / "skittle.obj", folder_ / "lab" / "pin.obj");
  write("lab/pins.toml",
        "[skittle]\nparts = [{shape = 'polyhedron', file = 'hull.obj'}]\n"
        "mesh = {file = 'pin.obj'}\n");
  ASSERT_EQ(headpin("synthesize -o thrown.lcmlog --seed 3 --scenario lab/pins.toml").code, 0);
  ASSERT_EQ(headpin("replay thrown.lcmlog -o a.lcmlog").code, 0);
  ASSERT_EQ(headpin("frames a.lcmlog -o there --frames 300").code, 0);
  fs::remove_all(folder_ / "lab");
  EXPECT_EQ(headpin("replay a.lcmlog --verify").code, 0);
  expect_refusal("frames a.lcmlog -o OUT --frames 300", 1, "pin.obj: cannot open");
  fs::copy_file(meshes / "skittle.obj", folder_ / "pin.obj");
  ASSERT_EQ(headpin("frames a.lcmlog -o beside --frames 300").code, 0);
  EXPECT_EQ(slurp(folder_ / "there/frames.csv"), slurp(folder_ / "beside/frames.csv"));
  ASSERT_EQ(headpin("replay a.lcmlog --set skittle.mesh.file=\"''\" -o own.lcmlog").code, 0);
  EXPECT_EQ(headpin("frames own.lcmlog -o own --frames 300").code, 0);
}

/// A wedge, 0.3 m high: its middle is beside the axis.
constexpr const char* kLopsided =
    "v -0.1 -0.05 0\nv 0.1 -0.05 0\nv -0.1 -0.05 0.3\nv -0.1 0.05 0\nv 0.1 0.05 0\nv -0.1 0.05 0.3\n"
    "f 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 1 3 6 4\n";

TEST_F(ScenarioCommands, ASkittleThatCannotStandIsRefusedByEveryCommandWithItsLine) {
  spit(folder_ / "wedge.obj", kLopsided);
  write("wedge.toml",
        "[skittle]\nmass = 1.0\nparts = [{shape = 'polyhedron', file = 'wedge.obj'}]\n");
  const std::string says =
      "wedge.toml:3: skittle.parts have their centre of mass 0.03333 m beside the axis";
  expect_refusal("scenario check wedge.toml", 1, says);
  expect_refusal("scenario new --from wedge.toml -o OUT.toml", 1, says);
  expect_refusal("synthesize --scenario wedge.toml -o OUT.lcmlog", 1, says);
  expect_refusal("scenario show paper-room --json", 2, "--json: scenario show takes none");
}

}  // namespace
}  // namespace headpin
