// Recordings of other programs that `headpin import` makes trials of.

#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/motion_files.h"
#include "tests/apps/trial_commands.h"

namespace headpin {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kRecorded = HEADPIN_SHARED_DIR "/throws/liebers_labstudy21_bowling.csv";

TEST_F(TrialCommands, ARecordedThrowIsImportedAndKnocksSkittlesOver) {
  if (!std::filesystem::exists(kRecorded)) GTEST_SKIP() << "no recorded throw at " << kRecorded;
  const nlohmann::json found = json("import " + kRecorded + " -o throw.lcmlog --json");
  EXPECT_EQ(found["samples"], 517);
  EXPECT_EQ(found["duration_s"], 7.185);
  EXPECT_NEAR(found["rate_hz"].get<double>(), 71.8, 0.05);
  EXPECT_NEAR(found["peak_hand_speed_mps"].get<double>(), 7.7, 0.05);
  EXPECT_NEAR(found["release_s"].get<double>(), 3.03, 0.015);
  EXPECT_NEAR(found["grab_s"].get<double>(), 0.6, 0.03);

  const nlohmann::json game = json("replay throw.lcmlog -o game.lcmlog --json");
  EXPECT_GT(game["skittles_down"].get<int>(), 0);
  // What import says of the ball is what a session makes of the samples.
  EXPECT_NEAR(game["release_speed_mps"].get<double>(), found["release_speed_mps"].get<double>(),
              1e-6);
  EXPECT_EQ(json("replay game.lcmlog --verify --json")["state_hash"], game["state_hash"]);
  for (const char* heading : {"gaze", "keep"}) {
    EXPECT_EQ(headpin("import " + kRecorded + " --force -o throw.lcmlog --heading " + heading).code,
              0);
  }
  expect_refusal("import " + kRecorded + " -o OUT.lcmlog --units m", 1, "in centimetres");
}

/// What VRPN's server logs of a Fastrak: positions from the transmitter, in its frame (x ahead, y
/// right, z down), quaternions x, y, z, w; sensor 0 on the head, 1 on the right hand.
std::string fastrak_log_of(const devices::MotionRecording& r, double height) {
  std::string log = "vrpn: ver. 07.35  1";
  log.resize(24, '\0');
  const auto put = [&](std::uint64_t value, int size) {
    while (size-- > 0) log += static_cast<char>(value >> (8 * size));
  };
  const auto message = [&](int type, int sender, Time time, std::size_t size) {
    for (const std::int64_t field :
         {std::int64_t{type}, std::int64_t{sender},
          std::int64_t{1'700'000'000} + time.count() / 1'000'000, time.count() % 1'000'000,
          static_cast<std::int64_t>(size), std::int64_t{0}}) {
      put(static_cast<std::uint64_t>(field), 4);
    }
  };
  const auto name = [&](int type, int sender, const std::string& text) {
    message(type, sender, {}, text.size() + 5);
    put(text.size() + 1, 4);
    log += text + std::string(1, '\0');
  };
  name(-1, 0, "Tracker0");
  name(-2, 5, "vrpn_Tracker Pos_Quat");
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    for (int sensor = 0; sensor < 2; ++sensor) {
      const Pose& pose = sensor == 0 ? r.head[i] : r.right_hand[i];
      message(5, 0, r.times[i], 64);
      put(static_cast<std::uint64_t>(sensor), 4);
      put(0, 4);
      for (const double v : {-pose.p.z(), pose.p.x(), height - pose.p.y(), -pose.q.z(), pose.q.x(),
                             -pose.q.y(), pose.q.w()}) {
        put(std::bit_cast<std::uint64_t>(v), 8);
      }
    }
  }
  return log;
}

TEST_F(TrialCommands, AVrpnLogOfAFastrakWithHeadAndHandIsTheThrowItRecorded) {
  const std::string example = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
  std::ofstream(folder_ / "fastrak.vrpn", std::ios::binary)
      << fastrak_log_of(devices::read_motion(example, {}), 0.9);
  const nlohmann::json wanted = json("import " + example + " -o csv.lcmlog --json");
  const std::string import = "import fastrak.vrpn --axes ARI -o ";
  expect_refusal(import + "OUT.lcmlog", 1, "the head is up ");
  for (const std::string names : {"", " --names 0,,1"}) {
    const nlohmann::json found =
        json(import + "vrpn.lcmlog --transmitter 0,0.9,0 --force --json" + names);
    EXPECT_EQ(found["hand"], "right");
    EXPECT_EQ(found["samples"], wanted["samples"]);
    EXPECT_NEAR(found["release_speed_mps"].get<double>(), wanted["release_speed_mps"].get<double>(),
                1e-6);
  }
  EXPECT_EQ(json("replay vrpn.lcmlog --json")["skittles_down"],
            json("replay csv.lcmlog --json")["skittles_down"]);
  EXPECT_THAT(headpin(import + "vrpn.lcmlog --transmitter 0,0.9,0 --force").out,
              HasSubstr("of head and one hand"));
  // Cut within its last report.
  const std::string log = slurp(folder_ / "fastrak.vrpn");
  spit(folder_ / "fastrak.vrpn", log.substr(0, log.size() - 20));
  const std::string told = "the log ends within a message: 68 bytes at its end are left out";
  EXPECT_THAT(headpin(import + "cut.lcmlog --transmitter 0,0.9,0").err, HasSubstr(told));
  expect_refusal(import + "OUT.lcmlog", 1, told);
  expect_refusal(import + "OUT.lcmlog --transmitter 0,0.9,0 --hand left", 1,
                 "it would be one by the right hand");
  expect_refusal(import + "OUT.lcmlog --names 0,,", 2, "one hand of which may be empty");
  expect_refusal(import + "OUT.lcmlog --transmitter 0,0.9", 2, "--transmitter");
}

TEST_F(TrialCommands, ImportRefusesInOneLineAndLeavesNothing) {
  std::ofstream(folder_ / "bad.csv") << "delta_time_ms,head_pos_x\n0,1\n";
  const std::string example =
      "import " HEADPIN_SOURCE_DIR "/assets/throws/example.csv -o OUT.lcmlog";
  expect_refusal(example + " --axes RSX", 2, "--axes: expected where +x, +y and +z point");
  expect_refusal(example + " --axes RSA,RSP,RSP", 2, "where rotations have others, found RSA,RSP,");
  expect_refusal(example + " --names a,b,c", 2, "--names: no columns of ");
  expect_refusal("import bad.csv -o OUT.lcmlog", 1,
                 "seems to be CSV that begins with 'delta_time_ms,head_pos_x'");
  expect_refusal("import missing.csv -o OUT.lcmlog", 1, "missing.csv: cannot open");
  expect_refusal("import bad.csv", 2, "--output is required: a trial to write (.lcmlog)");
  expect_refusal("import bad.csv -o OUT.toml", 2,
                 "--output: expected a name that ends in .lcmlog, found OUT.toml (.toml is written "
                 "only with --explain)");
  expect_refusal("import bad.csv --explain -o OUT.lcmlog", 2,
                 "--output: expected a name that ends in .toml, found OUT.lcmlog");
  expect_refusal("import " + kDemo + " -o OUT.lcmlog", 1,
                 "demo.lcmlog: is an LCM event log (a trial) and needs no import");
  expect_refusal("import bad.csv -o OUT.lcmlog --heading north", 2, "--heading");
  expect_refusal("import bad.csv -o OUT.lcmlog --units furlong", 2, "--units");
}

// The bundled recording is the arm model's, and whoever asks for it again gets the same file.
TEST_F(TrialCommands, TheExampleThrowIsTheArmModelsAndIsImported) {
  ASSERT_EQ(headpin("synthesize -o throw.csv --seed 5").code, 0);
  const std::string bundled = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
  EXPECT_EQ(slurp(folder_ / "throw.csv"), slurp(bundled));
  const nlohmann::json made = json("synthesize --json -o throw.lcmlog --seed 5");
  const nlohmann::json found = json("import --json -o found.lcmlog " + bundled);
  // What is found without buttons is what the model did, within a sample or two of 72 a second.
  EXPECT_NEAR(found["release_s"].get<double>(), made["release_s"].get<double>(), 0.04);
  EXPECT_NEAR(found["release_speed_mps"].get<double>(), made["planned_speed_mps"].get<double>(),
              0.4);
  EXPECT_GT(json("replay --json found.lcmlog")["skittles_down"].get<int>(), 3);
  expect_refusal("synthesize -o throw.csv", 1, "throw.csv: exists already");
}

/// The bundled throw twice in one file, with a gap of three seconds between both.
std::string twice(const std::string& csv) {
  const std::size_t first = csv.find('\n') + 1;
  std::string text = csv;
  std::istringstream rows(csv.substr(first));
  for (std::string row; std::getline(rows, row);) {
    text += fmt::format("{:.3f}{}\n", std::stod(row) + 10'000.0, row.substr(row.find(',')));
  }
  return text;
}

TEST_F(TrialCommands, AThrowOfSeveralIsTakenByItsNumberAndItsTrialSaysSo) {
  const std::string example = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
  spit(folder_ / "two.csv", twice(slurp(example)));
  expect_refusal("import two.csv -o OUT.lcmlog", 1, "--throw N takes one of its throws (2)");
  const Result whole = headpin("import two.csv --explain");
  EXPECT_THAT(whole.out, HasSubstr("throws             2; --throw N takes one of them"));
  EXPECT_THAT(whole.out,
              HasSubstr("result             two.csv: not a person's throw: no samples for"));
  const nlohmann::json second = json("import two.csv --explain --throw 2 --json");
  EXPECT_EQ(second["throw_count"], 2);
  EXPECT_TRUE(second["can_be_imported"].get<bool>());
  expect_refusal("import two.csv --explain --throw 3", 2, "expected 1 to 2");

  const nlohmann::json wanted = json("import " + example + " -o one.lcmlog --json");
  const nlohmann::json found = json("import two.csv -o second.lcmlog --throw 2 --json");
  EXPECT_NEAR(found["release_speed_mps"].get<double>(), wanted["release_speed_mps"].get<double>(),
              1e-9);
  const auto origin = [&](const std::string& trial) {
    std::string said;
    const nlohmann::json info = json("info " + trial + " --json");
    for (const nlohmann::json& event : info["events"]) {
      if (event["kind"] != "imported") continue;
      said += fmt::format("{} from {:.3f} s", event["detail"].get<std::string>(),
                          event["value"].get<double>());
    }
    return said;
  };
  EXPECT_EQ(origin("one.lcmlog"), "example.csv from 0.000 s");
  EXPECT_EQ(origin("second.lcmlog"), "two.csv, throw 2 of 2 from 10.001 s");
}

// `import` puts the ball on the foul line; rounding puts it 1e-17 m to either side of it.
TEST_F(TrialCommands, AnImportedThrowIsNoFoul) {
  const std::string alley = " --scenario regulation-ten-pin";
  ASSERT_EQ(headpin("synthesize --seed 3 -o f.csv" + alley).code, 0);
  for (const std::string heading : {"release", "keep"}) {
    ASSERT_EQ(headpin("import f.csv -o f.lcmlog --force --heading " + heading + alley).code, 0);
    const nlohmann::json played = json("replay f.lcmlog --json");
    const nlohmann::json& thrown = played["throws"].at(0);
    EXPECT_NEAR(thrown["position_m"][1].get<double>(), 0.0, 1e-12) << heading;
    EXPECT_FALSE(thrown["foul"].get<bool>()) << heading;
    EXPECT_THAT(headpin("replay f.lcmlog").out, Not(HasSubstr("foul"))) << heading;
  }
}

TEST_F(TrialCommands, WhatImportNotesOfItsDataIsInTheTrial) {
  const std::string example = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
  const std::string all = slurp(example);
  std::size_t end = 0;
  for (int row = 0; row < 330; ++row) end = all.find('\n', end) + 1;
  spit(folder_ / "short.csv", all.substr(0, end));
  const Result result = headpin("import short.csv -o short.lcmlog");
  ASSERT_EQ(result.code, 0);
  EXPECT_THAT(result.err, HasSubstr("after the release: a replay ends there too"));
  std::string notes;
  const nlohmann::json info = json("info short.lcmlog --json");
  for (const nlohmann::json& event : info["events"]) {
    if (event["kind"] == "import_note") notes += event["detail"].get<std::string>();
  }
  EXPECT_THAT(notes, HasSubstr("after the release: a replay ends there too"));
}

// The head alone, on a clock that began five seconds before.
TEST_F(TrialCommands, AHeadAloneTakesNoOptionsOfAThrow) {
  std::istringstream lines(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"));
  std::string line, head;
  for (int row = 0; std::getline(lines, line); ++row) {
    std::size_t end = 0;
    for (int cell = 0; cell < 8; ++cell) end = line.find(',', end) + 1;
    const std::size_t time = line.find(',');
    head += row == 0 ? line.substr(0, time) : std::to_string(5000 + std::stoi(line));
    head += line.substr(time, end - 1 - time) + "\n";
  }
  spit(folder_ / "head.csv", head);
  const nlohmann::json made = json("import head.csv -o head.lcmlog --hand none --json");
  EXPECT_NEAR(made["duration_s"].get<double>(), 6.998, 1e-9);  // from 5.001 to 11.999 s
  for (const char* option : {"--throw 3", "--events nofile.txt", "--no-trigger"}) {
    const std::string line_of_option = std::string("import head.csv --hand none ") + option;
    expect_refusal(line_of_option + " -o OUT.lcmlog", 2, "with --hand none nothing is thrown");
    expect_refusal(line_of_option + " --explain", 2, "with --hand none nothing is thrown");
  }
}

TEST_F(TrialCommands, RotationsThatAreNotReadAreSoInTheFileOfColumns) {
  const std::string example = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
  EXPECT_THAT(headpin("import " + example + " --rotations none --explain -o map.toml").out,
              HasSubstr("--rotations none"));
  EXPECT_THAT(slurp(folder_ / "map.toml"), HasSubstr("rotations = 'none'"));
  const nlohmann::json all = json("import " + example + " -o all.lcmlog --json"),
                       none = json("import " + example + " --rotations none -o none.lcmlog --json"),
                       mapped = json("import " + example +
                                     " --columns map.toml -o mapped.lcmlog --json");
  EXPECT_EQ(mapped["release_speed_mps"], none["release_speed_mps"]);
  EXPECT_NE(mapped["release_speed_mps"], all["release_speed_mps"]);
  // Angles that are not read are no angles.
  spit(folder_ / "angles.csv",
       "t,HMD_x,HMD_y,HMD_z,HMD_yaw,HMD_pitch,HMD_roll,ctrl_right_x,ctrl_right_y,ctrl_right_z\n"
       "0,0,1.7,0,1,2,3,0.2,1,0\n0.1,0,1.7,0,1,2,3,0.2,1,-0.1\n");
  headpin("import angles.csv --time-unit s --rotations none --explain -o angles.toml");
  EXPECT_THAT(slurp(folder_ / "angles.toml"), HasSubstr("rotations = 'none'"));
}

/// A table of a head alone that is at x, for each time.
std::string head_at(const std::vector<std::pair<double, double>>& times_and_x) {
  std::string text = "time_s,head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz\n";
  for (const auto& [time, x] : times_and_x)
    text += fmt::format("{:.4f},{:.5f},1.7,0,1,0,0,0\n", time, x);
  return text;
}

// Two recordings whose times alternate became a head that jumps by metres.
TEST_F(TrialCommands, AHeadAloneThatIsTooFastIsNoPersons) {
  for (const double rate_hz : {100.0, 120.0, 160.0}) {
    std::vector<std::pair<double, double>> alternating;
    for (int i = 0; i < 400; ++i) alternating.emplace_back(i / rate_hz, i % 2);
    spit(folder_ / "jumps.csv", head_at(alternating));
    const Result refused = headpin("import jumps.csv -o OUT.lcmlog --hand none");
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.err,
                HasSubstr("not a person's head: it is faster than 3 m/s in 100 % of the time"));
    EXPECT_FALSE(fs::exists(folder_ / "OUT.lcmlog"));
    EXPECT_THAT(headpin("import jumps.csv --hand none --explain").out,
                HasSubstr("result             jumps.csv: not a person's head"));
  }
}

// One sample that was measured wrongly refused a whole recording, and so did times of arrival.
TEST_F(TrialCommands, AHeadAloneMayBeWrongInAFewSamplesOrDatedAsItArrived) {
  const auto sways = [](double t) { return 0.3 * std::sin(1.8 * t); };  // 0.54 m/s at most
  std::vector<std::pair<double, double>> glitch, bursts;
  for (int i = 0; i < 900; ++i) {
    const double t = i / 90.0;
    glitch.emplace_back(t, sways(t) + (i == 540 ? 0.3 : 0.0));  // at 6 s
    bursts.emplace_back(i / 4 * 4 / 90.0 + i % 4 * 0.0003, sways(t));
  }
  spit(folder_ / "glitch.csv", head_at(glitch));
  spit(folder_ / "bursts.csv", head_at(bursts));
  const Result noted = headpin("import glitch.csv -o glitch.lcmlog --hand none");
  EXPECT_EQ(noted.code, 0) << noted.err;
  EXPECT_THAT(noted.err, HasSubstr("the head's fastest is "));
  EXPECT_THAT(noted.err, HasSubstr("above 3 m/s it is no person's motion"));
  EXPECT_THAT(headpin("import glitch.csv --hand none --explain").out,
              HasSubstr("note               the head's fastest is "));
  const Result plain = headpin("import bursts.csv -o bursts.lcmlog --hand none");
  EXPECT_EQ(plain.code, 0) << plain.err;
  EXPECT_THAT(plain.err, Not(HasSubstr("the head's fastest is ")));
}

// The order of the angles was not in the file of columns where another part has a quaternion.
TEST_F(TrialCommands, AnglesBesideAQuaternionAreInTheFileOfColumns) {
  spit(folder_ / "both.csv",
       "t,head_x,head_y,head_z,head_rx,head_ry,head_rz,right_x,right_y,right_z,right_qw,right_qx,"
       "right_qy,right_qz\n"
       "0,0,1.7,0,0.1,0.2,0.3,0.2,1,0,1,0,0,0\n0.1,0,1.7,0,0.1,0.2,0.3,0.2,1,-0.1,1,0,0,0\n");
  headpin("import both.csv --time-unit s --rotations ZYX,rad --explain -o both.toml");
  EXPECT_THAT(slurp(folder_ / "both.toml"), HasSubstr("rotations = 'wxyz,ZYX,rad'"));
  EXPECT_THAT(headpin("import both.csv --columns both.toml --explain").out,
              HasSubstr("--rotations wxyz,ZYX,rad"));
}

TEST_F(TrialCommands, UnitsThatDifferAreNotOneInTheFileOfColumns) {
  spit(folder_ / "units.csv",
       "t,head_x [m],head_y [m],head_z [m],right_x [mm],right_y [mm],right_z [mm]\n"
       "0,0,1.7,0,200,1000,0\n0.1,0,1.7,0,200,1000,-100\n");
  const std::string told = headpin("import units.csv --time-unit s --explain -o units.toml").out;
  EXPECT_THAT(told, Not(HasSubstr("--units")));
  EXPECT_THAT(slurp(folder_ / "units.toml"), Not(HasSubstr("units =")));
  headpin("import units.csv --time-unit s --units mm --explain -o units.toml --force");
  EXPECT_THAT(slurp(folder_ / "units.toml"), HasSubstr("units = 'mm'"));
}

// Its trial began at 100 s, and a replay refused it.
TEST_F(TrialCommands, ACatalogueFileThatWasCutOutOfALongerOneBeginsAtZero) {
  std::istringstream lines(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"));
  std::string line, late;
  for (int row = 0; std::getline(lines, line); ++row) {
    const std::size_t comma = line.find(',');
    late += row == 0 ? line.substr(0, comma) : std::to_string(100'000 + std::stoi(line));
    late += line.substr(comma) + "\n";
  }
  spit(folder_ / "late.csv", late);
  const nlohmann::json made = json("import late.csv -o late.lcmlog --json");
  EXPECT_LT(made["release_s"].get<double>(), 5.0);
  EXPECT_EQ(headpin("replay late.lcmlog").code, 0);
  EXPECT_NEAR(trial("late.lcmlog").events.front().value, 100.001, 1e-9);
}

/// The bundled throw as a table of another program: its positions in units that some headers say.
struct UnitsOfParts {
  double head_m = 1.0, hands_m = 1.0;
  std::string head = {}, hands = {};  ///< as in the header: " [mm]"
};

std::string example_in(const UnitsOfParts& units) {
  std::istringstream lines(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"));
  std::string line, table;
  std::vector<std::string> names;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    std::vector<std::string> row;
    while (std::getline(cells, cell, ',')) row.push_back(cell);
    const bool first = names.empty();
    if (first) names = row;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool is_head = names[i].starts_with("head_");
      if (first && names[i] == "delta_time_ms") row[i] = "time_ms";
      if (names[i].find("_pos_") != std::string::npos) {
        const double unit_m = is_head ? units.head_m : units.hands_m;
        row[i] = first ? names[i] + (is_head ? units.head : units.hands)
                       : fmt::format("{:.9g}", 0.01 * std::stod(row[i]) / unit_m);
      }
      table += fmt::format("{}{}", i == 0 ? "" : ",", row[i]);
    }
    table += "\n";
  }
  return table;
}

// A head in metres without a unit, beside hands in millimetres, was read in millimetres.
TEST_F(TrialCommands, PartsWithoutAUnitAreReadInThatWithWhichTheyAreAThrow) {
  struct Case {
    UnitsOfParts units;
    std::string note;
  };
  const std::vector<Case> cases = {
      {{1.0, 0.001, " [m]", " [mm]"}, ""},
      {{1.0, 0.001, "", " [mm]"}, "positions of the head have no unit: read in metres"},
      {{0.001, 0.001, "", " [mm]"}, "positions of the head have no unit: read in millimetres"},
      {{0.001, 0.001, " [mm]", ""},
       "positions of the left hand and the right hand have no unit: read in millimetres"},
      {{0.001, 1.0, " [mm]", ""},
       "positions of the left hand and the right hand have no unit: read in metres"}};
  std::vector<double> speeds;
  for (const Case& one : cases) {
    spit(folder_ / "parts.csv", example_in(one.units));
    const nlohmann::json made = json("import parts.csv -o parts.lcmlog --force --json");
    speeds.push_back(made["release_speed_mps"].get<double>());
    EXPECT_NEAR(speeds.back(), speeds.front(), 1e-6);
    const std::string notes = made["notes"].dump();
    const std::string told = headpin("import parts.csv --explain -o parts.toml --force").out;
    EXPECT_THAT(told, HasSubstr("result             can be imported"));
    if (one.note.empty()) {
      EXPECT_THAT(notes, Not(HasSubstr("no unit")));
    } else {
      EXPECT_THAT(notes, HasSubstr(one.note));
      EXPECT_THAT(told, HasSubstr(one.note));
    }
    const nlohmann::json mapped =
        json("import parts.csv --columns parts.toml -o mapped.lcmlog --force --json");
    EXPECT_EQ(mapped["release_speed_mps"], made["release_speed_mps"]);
  }
}

// The order of one part was in the file of columns as that of all, and the person stood on the head.
TEST_F(TrialCommands, QuaternionsInSeveralOrdersAreNotInOneInTheFileOfColumns) {
  std::istringstream lines(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"));
  std::string line, table;
  std::ptrdiff_t w = -1;
  while (std::getline(lines, line)) {
    std::istringstream in(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    if (w < 0) w = std::ranges::find(cells, "right_hand_rot_w") - cells.begin();
    std::rotate(cells.begin() + w, cells.begin() + w + 1, cells.begin() + w + 4);
    table += fmt::format("{}\n", fmt::join(cells, ","));
  }
  spit(folder_ / "orders.csv", table);
  const nlohmann::json made = json("import orders.csv -o orders.lcmlog --json");
  EXPECT_THAT(headpin("import orders.csv --explain -o orders.toml").out,
              Not(HasSubstr("--rotations")));
  EXPECT_THAT(slurp(folder_ / "orders.toml"), Not(HasSubstr("rotations =")));
  const nlohmann::json mapped =
      json("import orders.csv --columns orders.toml -o mapped.lcmlog --json");
  EXPECT_EQ(mapped["release_speed_mps"], made["release_speed_mps"]);
  // What is told holds for all.
  headpin("import orders.csv --rotations wxyz --explain -o told.toml");
  EXPECT_THAT(slurp(folder_ / "told.toml"), HasSubstr("rotations = 'wxyz'"));
}

// It said that the head, in metres beside a hand in millimetres, is up 0.0017 m.
TEST_F(TrialCommands, WhatIsNoThrowInAnyUnitIsReadInThatInWhichItIsAPersonsHead) {
  std::string table =
      "time [s],hmd_x,hmd_y,hmd_z,hmd_qw,hmd_qx,hmd_qy,hmd_qz,right_x [mm],right_y [mm],"
      "right_z [mm],right_qw,right_qx,right_qy,right_qz\n";
  for (int i = 0; i < 200; ++i)  // the hand goes 2 m ahead of the head
    table += fmt::format("{:.4f},0,1.7,0,1,0,0,0,200,1000,{},1,0,0,0\n", i / 60.0, -10 * i);
  spit(folder_ / "far.csv", table);
  const std::string told = headpin("import far.csv --explain").out;
  EXPECT_THAT(told, HasSubstr("positions of the head have no unit: read in metres"));
  EXPECT_THAT(told, HasSubstr("not a person's throw: the right hand goes from the head up to"));
}

// A part of another hand was ignored, and of a key that was told twice the first or the last one.
TEST_F(TrialCommands, ColumnsThatAreToldInVainAreRefused) {
  const std::string text = slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv");
  const std::size_t end = text.find('\n');
  std::string header = text.substr(0, end);
  for (std::size_t at; (at = header.find("left_hand")) != std::string::npos;)
    header.replace(at, 9, "elbow");
  spit(folder_ / "one.csv", header + text.substr(end));
  const auto refused = [&](const std::string& columns, const std::string& says) {
    expect_refusal("import one.csv -o OUT.lcmlog --columns '" + columns + "'", 2, says);
  };
  refused("left.x=#2", "--columns: left.x = '#2' is of a left hand that was not found");
  refused("right.x=#2,right.x=#3", "--columns: expected each key once, found right.x");
  refused("right.qw=#2,right.rx=#3",
          "--columns: right.qw = '#2' and right.rx = '#3' are of two rotations");
}

// The release after midnight was taken to be before the grab.
TEST_F(TrialCommands, MarkersGoOnOverMidnightAsTheRecordingDoes) {
  const auto clock = [](double s) {
    const auto ms = std::llround(86'397'500 + 1000.0 * s) % 86'400'000;
    return fmt::format("{:02}:{:02}:{:02}.{:03}", ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60,
                       ms % 1000);
  };
  std::istringstream lines(slurp(HEADPIN_SOURCE_DIR "/assets/throws/example.csv"));
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.find(',');
    table += table.empty() ? "time" : clock(1e-3 * std::stod(line.substr(0, comma)));
    table += line.substr(comma) + "\n";
  }
  spit(folder_ / "night.csv", table);
  spit(folder_ / "marks.txt", clock(1.4) + " grab\n" + clock(3.95) + " release\n");
  const nlohmann::json found =
      json("import night.csv -o n.lcmlog --units cm --events marks.txt --json");
  EXPECT_NEAR(found["grab_s"].get<double>(), 1.4, 0.002);
  EXPECT_NEAR(found["release_s"].get<double>(), 3.95, 0.002);
}

}  // namespace
}  // namespace headpin
