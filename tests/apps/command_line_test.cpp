#include "tests/apps/command_line.h"

#include <array>
#include <cstdio>
#include <set>

#include <fmt/format.h>

#include "base/output_file.h"
#include "devices/base/sources.h"
#include "devices/log/event_log.h"
#include "render/image.h"
#include "render/png.h"
#include "scene/record/log.h"

namespace headpin {
namespace {

using testing::HasSubstr;

TEST_F(CommandLine, EveryCommandHelpsWithAnExample) {
  const Result top = headpin("--help");
  EXPECT_EQ(top.code, 0);
  std::istringstream lines(top.out.substr(top.out.find("Subcommands:")));
  std::string line;
  std::getline(lines, line);
  int commands = 0;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string name;
    if (line.rfind("  ", 0) != 0 || line[2] == ' ' || !(words >> name)) continue;
    const Result help = headpin(name + " --help");
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_THAT(help.out, HasSubstr("Example")) << name;
    EXPECT_THAT(help.out, HasSubstr("headpin " + name)) << name;
    ++commands;
  }
  EXPECT_GE(commands, 6);
}

TEST_F(CommandLine, HelpIsACommandToo) {
  EXPECT_EQ(headpin("help").out, headpin("--help").out);
  for (const std::string command : {"replay", "scenario", "help"}) {
    const Result help = headpin("help " + command);
    EXPECT_EQ(help.code, 0) << help.err;
    EXPECT_EQ(help.out, headpin(command + " --help").out) << command;
  }
  expect_refusal("--foo", 2, "unknown option '--foo'; expected a command: one of scenario, ");
  expect_refusal("sweep make", 2, "unknown command 'make'; expected a command: one of ");
  expect_refusal("sweep", 2, "expected a command: one of ");
  expect_refusal("help replya", 2, "unknown command 'replya'; the nearest is replay");
  expect_refusal("help replay more", 2,
                 "unknown command 'more'; replay has no commands of its own");
}

TEST_F(CommandLine, HelpRefusesWhatIsNeitherACommandNorATopic) {
  expect_refusal("help topcs", 2, "no command or topic 'topcs'; the nearest topic is topics");
  expect_refusal("help topics more", 2, "expected no word behind the topic topics, found more");
  expect_refusal("help bowl", 2, "unknown command 'bowl'; one of ");
}

TEST_F(CommandLine, AnOptionSaysWhatItTakesAndHowOften) {
  expect_refusal("replay x --friction", 2, "--friction: expected a value, found none;");
  expect_refusal("replay x -o a.lcmlog -o b.lcmlog", 2, "--output: expected once, found 2 times;");
  expect_refusal("replay x --warm=maybe", 2, "--warm: expected no value, found maybe;");
  expect_refusal("synthesize -o a.lcmlog --participant 1 --duration 9", 2,
                 "--duration excludes --participant");
  expect_refusal("frames x --video -", 2, "--video: expected a name that ends in .mkv, found -;");
  expect_refusal("replay x y", 2, "'y' is one argument too many;");
  expect_refusal("replay x 0.1 --frictoin", 2,
                 "unknown option --frictoin; the nearest is --friction;");
}

TEST_F(CommandLine, HelpNamesThePageOfEachTopic) {
  const fs::path docs = fs::canonical(HEADPIN_SOURCE_DIR "/docs");
  std::set<fs::path> pages;
  for (const auto& entry : fs::recursive_directory_iterator(docs)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".md" && path != docs / "README.md") pages.insert(path);
  }
  EXPECT_GT(pages.size(), 25u);

  std::istringstream lines(headpin("help topics").out);
  std::string line, name, title, page;
  while (std::getline(lines, line)) {
    if (!line.starts_with("  ")) continue;
    std::istringstream words(line);
    words >> name;
    std::getline(words >> std::ws, title);
    std::istringstream says(headpin("help " + name).out);
    std::getline(says, line);
    EXPECT_EQ(line, title);
    std::getline(says, page);
    ASSERT_EQ(pages.erase(fs::canonical(page)), 1u) << name << " names " << page;
    EXPECT_THAT(slurp(page), testing::StartsWith("# " + title + "\n"));
    EXPECT_EQ(headpin(name + " --help").code, 2) << name << " is a command too";
  }
  EXPECT_THAT(pages, testing::IsEmpty());
}

TEST_F(CommandLine, WhatIsMistypedIsToldWithTheNearest) {
  for (const auto& [typed, nearest] :
       {std::pair{"replya x", "unknown command 'replya'; the nearest is replay"},
        {"enulate", "the nearest is emulate"},
        {"fraems x -o y", "the nearest is frames"},
        {"inf x", "the nearest is info"},
        {"replay x --frction 0.1", "unknown option --frction; the nearest is --friction"},
        {"replay x --elastciity=0.1", "unknown option --elastciity; the nearest is --elasticity"},
        {"live --recrod x", "unknown option --recrod; the nearest is --record"}}) {
    expect_refusal(typed, 2, nearest);
  }
  for (const char* typed : {"bowl", "replay x --nothing-like-it", "replay x y"}) {
    EXPECT_THAT(headpin(typed).err, testing::Not(HasSubstr("nearest"))) << typed;
  }
}

TEST_F(CommandLine, WrongUseIsTwo) {
  expect_refusal("", 2, "expected a command");
  expect_refusal("bowl", 2, "bowl");
  expect_refusal("replay", 2, "TRIAL is required");
  expect_refusal("replay " + kDemo + " --elasticity 1.2", 2, "--elasticity");
  expect_refusal("replay " + kDemo + " --shape cube", 2,
                 "--shape: expected ellipsoid or true, found cube;");
  expect_refusal("replay " + kDemo + " --response coulom", 2,
                 "found coulom; the nearest is coulomb;");
  expect_refusal("replay " + kDemo + " --iterations 5.5", 2,
                 "--iterations: expected a whole number from 5 to 20, found 5.5");
  expect_refusal("replay " + kDemo + " --iterations 21", 2, "from 5 to 20, found 21");
  expect_refusal("replay " + kDemo + " --iterations 1e99999", 2, "found 1e99999");
  expect_refusal("apart " + kDemo + " --iterations 5", 2,
                 "--iterations: expected --detection paper beside it");
  expect_refusal("replay " + kDemo + " --set ball.weight=3", 2,
                 "--set ball.weight=3: unknown key 'ball.weight'");
  expect_refusal("replay " + kDemo + " --set ball.mass=-3", 2, "ball.mass must be a number");
  expect_refusal("frames " + kDemo + " -o OUT --frames 20-10", 2, "ends before it begins");
  expect_refusal("frames " + kDemo + " -o OUT --frames 99999", 2, "expected frames from 0");
  expect_refusal("frames " + kDemo, 2, "nothing to write");
}

TEST_F(CommandLine, MissingAndDamagedFilesAreOneClearLine) {
  std::ofstream(folder_ / "empty.lcmlog").flush();
  std::ofstream(folder_ / "noise.lcmlog") << std::string(5000, 'x');
  for (const std::string command : {"replay", "info", "frames -o OUT", "replay -o OUT.lcmlog"}) {
    expect_refusal(command + " missing.lcmlog", 1, "missing.lcmlog");
    expect_refusal(command + " empty.lcmlog", 1, "empty.lcmlog");
    expect_refusal(command + " noise.lcmlog", 1, "noise.lcmlog");
  }
  expect_refusal("compare missing.lcmlog noise.lcmlog", 1, "missing.lcmlog");
  expect_refusal("compare noise.lcmlog missing.lcmlog", 1, "noise.lcmlog");
}

TEST_F(CommandLine, ACutOffTrialReplaysUpToTheCut) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o whole.lcmlog").code, 0);
  const std::string whole = slurp(folder_ / "whole.lcmlog");
  std::ofstream(folder_ / "cut.lcmlog", std::ios::binary) << whole.substr(0, whole.size() * 2 / 3);
  const nlohmann::json info = json("info cut.lcmlog --json");
  EXPECT_EQ(info["complete"], false);
  EXPECT_EQ(json("info whole.lcmlog --json")["complete"], true);
  const nlohmann::json cut = json("replay cut.lcmlog --verify --json");
  EXPECT_GT(cut["verified_ticks"].get<int>(), 100);
  EXPECT_EQ(cut["complete"], false);
  for (const std::string command : {"replay cut.lcmlog", "compare cut.lcmlog whole.lcmlog",
                                    "plot cut.lcmlog -o cut.svg", "export cut.lcmlog -o tables"}) {
    EXPECT_THAT(headpin(command).err, HasSubstr(": cut.lcmlog: is incomplete: it ends at "));
  }
  EXPECT_EQ(headpin("replay whole.lcmlog").err, "");
}

TEST_F(CommandLine, StatesThatAreLostAreNeitherVerifiedNorEqual) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o whole.lcmlog --states all").code, 0);
  std::string log = slurp(folder_ / "whole.lcmlog");
  const scene::Trial whole = scene::read_trial(folder_ / "whole.lcmlog");
  std::size_t state = 0, lost = 0;
  for (std::size_t at = log.find("STATE"); at != std::string::npos;
       at = log.find("STATE", at + 5)) {
    if (log.compare(at - 8, 4, std::string("\0\0\0\5", 4)) != 0) continue;  // no channel's name
    if (++state % 10 == 3) {
      log[at + 5] ^= 1;  // the first byte of its type
      ++lost;
    }
  }
  ASSERT_EQ(state, whole.states.size());
  std::ofstream(folder_ / "lost.lcmlog", std::ios::binary) << log;
  const Result replayed = headpin("replay lost.lcmlog --verify");
  EXPECT_EQ(replayed.code, 1);
  EXPECT_THAT(
      replayed.err,
      HasSubstr(fmt::format(
          "{} of the {} recorded ticks have no state to compare with; the other {} are equal", lost,
          state, state - lost)));
  const nlohmann::json compared = json("compare lost.lcmlog whole.lcmlog --json");
  EXPECT_EQ(compared["first_difference_tick"], whole.states[2].tick);
  EXPECT_EQ(compared["first_difference_lacking"], "lost.lcmlog");
  EXPECT_THAT(headpin("compare lost.lcmlog whole.lcmlog").out,
              HasSubstr(", which lost.lcmlog has not"));
}

// A number that somebody changed in a state, and not in its hash, is not what the hash tells.
TEST_F(CommandLine, AStateThatWasEditedIsToldFromOneThatDiffers) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o whole.lcmlog").code, 0);
  scene::Trial whole = scene::read_trial(folder_ / "whole.lcmlog");
  const auto write = [&] {
    scene::Recorder recorder(base::OutputFile(folder_ / "edited.lcmlog", {.overwrite = true}),
                             whole.header);
    scene::write(recorder, whole.samples, {});
    for (const scene::TickState& state : whole.states) recorder.write(state);
    recorder.close();
  };
  const std::string verify = "replay edited.lcmlog --verify";
  whole.states[400].bodies[0].X_WB.p.x() += 1e-9;
  write();
  const Result edited = headpin(verify);
  EXPECT_EQ(edited.code, 1);
  EXPECT_THAT(edited.err, HasSubstr("tick 401 "));
  EXPECT_THAT(edited.err, HasSubstr("the recorded state does not match its hash"));
  EXPECT_THAT(edited.err, testing::Not(HasSubstr("expected state")));
  whole.states[400].hash ^= 1;
  write();
  EXPECT_THAT(headpin(verify).err, HasSubstr("expected state"));
}

// A receiver may report one place far away as good; the log's summary says so.
TEST_F(CommandLine, ALoneSampleFarAwayIsAstray) {
  scene::Trial trial = scene::read_trial(kDemo);
  std::size_t at = 300;
  while (!std::holds_alternative<devices::TrackerSample>(trial.samples[at])) ++at;
  auto& far = std::get<devices::TrackerSample>(trial.samples[at]);
  far.X_TS.p.x() += 50.0;
  scene::Recorder recorder(folder_ / "far.lcmlog", trial.header);
  scene::write(recorder, trial.samples, {});
  recorder.close();
  const nlohmann::json odd = json("info far.lcmlog --json"),
                       even = json("info " + kDemo + " --json");
  for (const nlohmann::json& device : odd["devices"]) {
    const bool its = device["device"] == (far.station == 1 ? "head" : "right hand");
    EXPECT_EQ(device["astray"], its ? 1 : 0) << device;
  }
  EXPECT_THAT(headpin("info far.lcmlog").out, testing::ContainsRegex(" 1 astray of "));
  // It is told at its own time, not at that of the next sample, by which it is found.
  const double sent =
      nearest_seconds(devices::available(trial.samples[at]));  // the log begins at 0
  for (const nlohmann::json& stretch : odd["trouble"]) {
    if (stretch["kind"] != "astray") continue;
    EXPECT_NEAR(stretch["from_s"].get<double>(), sent, 0.002);
  }
  for (const nlohmann::json& device : even["devices"]) {
    EXPECT_EQ(device["astray"], 0);
  }
}

TEST_F(CommandLine, ReplayTellsWhatHappenedAndRepeatsToTheBit) {
  const nlohmann::json first = json("replay " + kDemo + " -o a.lcmlog --json");
  for (const char* key : {"skittles", "skittles_down", "release_speed_mps", "impact_speed_mps",
                          "simulated_s", "realtime_factor", "ticks", "state_hash", "elasticity",
                          "friction", "shape", "response", "version"}) {
    EXPECT_TRUE(first.contains(key)) << key;
  }
  EXPECT_GT(first["skittles_down"].get<int>(), 0);
  EXPECT_LT(first["ledger"]["impact_j"].get<double>(), -1.0);  // skittles and lane take energy
  EXPECT_GT(first["ledger"]["hand_j"].get<double>(), 100.0);   // half of 6.8 kg at 6.6 m/s, squared
  EXPECT_GT(first["statistics"]["impacts"].get<int>(), 10);
  const nlohmann::json again = json("replay a.lcmlog -o b.lcmlog --verify --json");
  EXPECT_EQ(again["state_hash"], first["state_hash"]);
  EXPECT_EQ(again["verified_ticks"], first["ticks"]);
  EXPECT_TRUE(json("compare a.lcmlog b.lcmlog --json")["first_difference_tick"].is_null());
}

TEST_F(CommandLine, OneWordMeansOneThingInAllObjects) {
  const nlohmann::json made = json("synthesize -o made.lcmlog --json");
  EXPECT_EQ(made["output"], "made.lcmlog");
  const nlohmann::json same = json("replay made.lcmlog -o a.lcmlog --json");
  const nlohmann::json other =
      json("replay made.lcmlog -o b.lcmlog --set material.ball.friction=0.1 --json");
  EXPECT_EQ(same["output"], "a.lcmlog");
  EXPECT_EQ(same["trial"], "made.lcmlog");
  EXPECT_TRUE(json("replay made.lcmlog --json")["output"].is_null());
  for (const nlohmann::json& replay : {same, other}) {
    for (const char* object : {"skittle", "ball", "lane", "wall"}) {
      EXPECT_TRUE(replay["friction"][object].is_number()) << object;
      EXPECT_EQ(replay["elasticity"][object], 0.7) << object;
    }
  }
  EXPECT_EQ(other["friction"]["ball"], 0.1);
  EXPECT_THAT(headpin("replay made.lcmlog").out, HasSubstr("friction          0.7 each"));
  EXPECT_THAT(headpin("replay b.lcmlog").out, HasSubstr("ball 0.1, lane 0.7"));
  const nlohmann::json info = json("info a.lcmlog --json");
  EXPECT_EQ(info["version"], same["version"]);
  EXPECT_EQ(info["ledger"], same["ledger"]);
  const nlohmann::json frames = json("frames made.lcmlog -o eyes --frames 3 --json");
  EXPECT_EQ(frames["output"], "eyes");
  EXPECT_TRUE(frames["video"].is_null());
  EXPECT_TRUE(json("compare a.lcmlog b.lcmlog --json")["a"]["friction"]["lane"].is_number());
  const nlohmann::json streamed = json("stream made.lcmlog --lcm memq:// --speed 0 --json");
  EXPECT_TRUE(streamed["lateness_p99_s"].is_number());
  for (const nlohmann::json& object : {made, same, info, frames, streamed}) {
    for (const auto& [key, value] : object.items()) {
      EXPECT_FALSE(key.ends_with("_ms") || key.ends_with("_us")) << key;
    }
  }
}

TEST_F(CommandLine, AnotherConditionIsAnotherGameAndVerifyNamesTickAndBody) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o rough.lcmlog --friction 0.7 --elasticity 0.7").code,
            0);
  ASSERT_EQ(headpin("replay " + kDemo + " -o smooth.lcmlog --friction 0 --elasticity 1").code, 0);
  const nlohmann::json compared = json("compare rough.lcmlog smooth.lcmlog --json");
  EXPECT_GT(compared["first_difference_tick"].get<int>(), 0);
  EXPECT_EQ(compared["first_difference_body"], "ball");
  expect_refusal("replay rough.lcmlog --verify --friction 0.6", 1,
                 "of the replay differs from the recording, first difference in the ball");
  // The ball differs from where it first touches the lane.
  const std::string tick = std::to_string(
      json("compare rough.lcmlog smooth.lcmlog --json")["first_difference_tick"].get<int>());
  expect_refusal("replay rough.lcmlog --verify --friction 0 --elasticity 1", 1,
                 "rough.lcmlog: tick " + tick + " (");
  expect_refusal("replay " + kDemo + " --verify", 1, "holds no states");
}

// As by a logger that lost a message on a busy network.
TEST_F(CommandLine, ARecordingThatLacksASampleSaysSoWhereItDiffers) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o whole.lcmlog").code, 0);
  const std::string whole = slurp(folder_ / "whole.lcmlog");
  std::string lacking;
  int buttons = 0;
  devices::LogReader reader({reinterpret_cast<const std::uint8_t*>(whole.data()), whole.size()});
  for (std::size_t at = 0; const auto event = reader.next();) {
    const std::size_t size = 28 + event->channel.size() + event->data.size();
    if (event->channel != "MOUSE3D" || ++buttons != 2) lacking += whole.substr(at, size);
    at += size;
  }
  ASSERT_EQ(buttons, 2);  // grab and release
  std::ofstream(folder_ / "lacking.lcmlog") << lacking;
  expect_refusal("replay lacking.lcmlog --verify", 1,
                 "the recording is not complete, and what the session got may be missing in it");
}

TEST_F(CommandLine, AValueIsSetWhereverItStands) {
  const nlohmann::json heavy =
      json("replay --set ball.mass=7.2 --set collision.sleep=false --json " + kDemo);
  EXPECT_NE(heavy["state_hash"], json("replay --json " + kDemo)["state_hash"]);
}

TEST_F(CommandLine, NothingIsOverwrittenUnasked) {
  ASSERT_EQ(headpin("replay " + kDemo + " -o a.lcmlog").code, 0);
  const std::string before = slurp(folder_ / "a.lcmlog");
  expect_refusal("replay " + kDemo + " -o a.lcmlog --friction 0", 1, "a.lcmlog");
  EXPECT_EQ(slurp(folder_ / "a.lcmlog"), before);
  EXPECT_EQ(headpin("replay " + kDemo + " -o a.lcmlog --friction 0 --force").code, 0);
  EXPECT_NE(slurp(folder_ / "a.lcmlog"), before);

  ASSERT_EQ(headpin("frames " + kDemo + " -o pictures --frames 3").code, 0);
  expect_refusal("frames " + kDemo + " -o pictures --frames 4", 1, "pictures: exists already");
  EXPECT_TRUE(fs::exists(folder_ / "pictures/left_000003.png"));
}

TEST_F(CommandLine, FramesAreWhatTheirIndexSays) {
  const nlohmann::json told =
      json("frames " + kDemo + " -o pictures --frames 0,100-102,200 --json");
  EXPECT_EQ(told["frames"], 5);
  std::ifstream index(folder_ / "pictures/frames.csv");
  std::string line;
  std::getline(index, line);
  std::vector<std::string> columns;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) columns.push_back(name);
  ASSERT_EQ(columns.size(), 19u);
  EXPECT_EQ(columns[10], "left_hash");
  EXPECT_EQ(columns[18], "right_hash");
  int rows = 0;
  while (std::getline(index, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), columns.size());
    for (const auto& [eye, column] : {std::pair{"left", 10}, {"right", 18}}) {
      char name[64];
      std::snprintf(name, sizeof name, "%s_%06d.png", eye, std::stoi(cells[0]));
      const render::Image image = render::read_png(folder_ / "pictures" / name);
      EXPECT_EQ(image.width, 360);
      EXPECT_EQ(image.height, 240);
      EXPECT_EQ(std::stoull(cells[static_cast<std::size_t>(column)], nullptr, 16),
                render::pixel_hash(image));
    }
    EXPECT_NE(cells[10], cells[18]) << "both eyes see the same";
    EXPECT_EQ(std::stoi(cells[2]), 4 * std::stoi(cells[0]));  // 240 Hz and 60 Hz
    ++rows;
  }
  EXPECT_EQ(rows, 5);
}

TEST_F(CommandLine, AFrameDrawnAloneEqualsTheOneInSequence) {
  ASSERT_EQ(headpin("frames " + kDemo + " -o many --frames 150-156").code, 0);
  ASSERT_EQ(headpin("frames " + kDemo + " -o one --frames 155").code, 0);
  EXPECT_EQ(slurp(folder_ / "many/left_000155.png"), slurp(folder_ / "one/left_000155.png"));
  EXPECT_EQ(slurp(folder_ / "many/right_000155.png"), slurp(folder_ / "one/right_000155.png"));
}

TEST_F(CommandLine, AnUnknownOptionIsToldAlsoWhereSomethingIsMissing) {
  expect_refusal("replay --nosuch", 2, "unknown option --nosuch");
  expect_refusal("replay --nosuch --json", 2, "unknown option --nosuch");
  expect_refusal("plot " + kDemo + " --ouput=OUT.svg", 2,
                 "unknown option --ouput; the nearest is --output");
}

}  // namespace
}  // namespace headpin
