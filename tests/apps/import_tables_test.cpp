// Tables of other programs' make, that `headpin import` makes trials of.

#include <regex>

#include <fmt/format.h>

#include "devices/base/resample.h"
#include "devices/recordings/motion_files.h"
#include "tests/apps/foreign_tables.h"
#include "tests/apps/trial_commands.h"
#include "tests/support/output_of.h"

namespace headpin {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kBundledThrow = HEADPIN_SOURCE_DIR "/assets/throws/example.csv";
const std::string kRealThrow = HEADPIN_SHARED_DIR "/throws/liebers_labstudy21_bowling.csv";

/// A throw at an even rate of 72 Hz.
devices::MotionRecording even_throw(const std::string& file) {
  const devices::MotionRecording r = devices::read_motion(file, {});
  devices::PoseTrack head, hand;
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    head.push(r.times[i], r.head[i]);
    hand.push(r.times[i], r.right_hand[i]);
  }
  devices::MotionRecording even;
  for (std::int64_t i = 0; tick_time(i, 72) < r.times.back(); ++i) {
    even.times.push_back(tick_time(i, 72));
    even.head.push_back(*head.at(tick_time(i, 72)));
    even.right_hand.push_back(*hand.at(tick_time(i, 72)));
  }
  return even;
}

class ImportTables : public TrialCommands {
 protected:
  void write(const std::string& name, const ForeignTable& table) const {
    spit(folder_ / name, foreign_text(table, even_, pressed_, released_));
  }
  ForeignTable table(const std::string& name) const {
    const std::vector<ForeignTable> all = foreign_tables();
    return *std::ranges::find(all, name, &ForeignTable::name);
  }

  void expect_one_game();

  devices::MotionRecording even_ = even_throw(kBundledThrow);
  Time pressed_{1'400'000}, released_{3'950'000};
};

void ImportTables::expect_one_game() {
  write("plain.csv", table("plain"));
  const nlohmann::json wanted = json("import plain.csv -o plain.lcmlog --force --json");
  const nlohmann::json game = json("replay plain.lcmlog --json");
  ASSERT_GT(game["skittles_down"].get<int>(), 0);
  for (const ForeignTable& one : foreign_tables()) {
    SCOPED_TRACE(one.name);
    write("t.csv", one);
    const nlohmann::json found = json("import t.csv -o t.lcmlog --force --json " + one.options);
    ASSERT_TRUE(found.contains("samples")) << found;
    EXPECT_EQ(found["samples"], wanted["samples"]);
    const bool trigger = one.name == "a_trigger";
    EXPECT_EQ(found["by_trigger"], trigger);
    EXPECT_NEAR(found["release_s"].get<double>(), wanted["release_s"].get<double>(),
                trigger ? 0.05 : 1e-3);
    if (trigger) continue;  // another release
    EXPECT_NEAR(found["release_speed_mps"].get<double>(), wanted["release_speed_mps"].get<double>(),
                1e-3);
    EXPECT_EQ(json("replay t.lcmlog --json")["skittles_down"], game["skittles_down"]);
  }
}

TEST_F(ImportTables, OneThrowInAllOfThemIsOneGame) {
  expect_one_game();
}

// As spreadsheets write it: tabs, UTF-16, and names of the world.
TEST_F(ImportTables, InUtf16IsTheSame) {
  std::string plain = foreign_text(table("tabs_mark_and_line_ends"), even_, pressed_, released_);
  plain.erase(0, 3);  // the mark of UTF-8
  spit(folder_ / "utf8.txt", "# Gew\u00f6hnlich \U0001f3b3\n" + plain);
  const nlohmann::json wanted = json("import utf8.txt -o utf8.lcmlog --json");
  for (const auto& [name, mark] : {std::pair{"UTF-16LE", "\xff\xfe"}, {"UTF-16BE", "\xfe\xff"}}) {
    const std::string convert =
        fmt::format("iconv -f UTF-8 -t {} '{}'", name, (folder_ / "utf8.txt").string());
    spit(folder_ / "wide.txt", mark + output_of(convert));
    nlohmann::json found = json("import wide.txt -o wide.lcmlog --force --json");
    EXPECT_EQ(found["release_speed_mps"], wanted["release_speed_mps"]) << name;
    EXPECT_EQ(found["samples"], wanted["samples"]) << name;
    EXPECT_EQ(
        headpin("import wide.txt --explain").out,
        std::regex_replace(headpin("import utf8.txt --explain").out, std::regex("utf8"), "wide"));
    const std::string whole = slurp(folder_ / "wide.txt");
    spit(folder_ / "cut.txt", whole.substr(0, whole.size() - 1));  // half a character
    expect_refusal("import cut.txt -o cut.lcmlog", 1, "expected whole characters of UTF-16");
  }
}

TEST_F(ImportTables, SoIsARealOne) {
  if (!std::filesystem::exists(kRealThrow)) GTEST_SKIP() << "no recorded throw at " << kRealThrow;
  even_ = even_throw(kRealThrow);
  pressed_ = Time{600'000};
  released_ = Time{3'040'000};
  expect_one_game();
}

// What a table does not say, or says wrongly, is found out and offered; with the offer it is the throw.
TEST_F(ImportTables, TheOptionThatMakesItAThrowIsOffered) {
  for (const ForeignTable& one : foreign_tables()) {
    if (one.options.empty() || one.options.starts_with("--columns") ||
        one.options.starts_with("--time"))
      continue;
    SCOPED_TRACE(one.name);
    write("t.csv", one);
    const Result refused = headpin("import t.csv -o t.lcmlog --force");
    EXPECT_EQ(refused.code, 1);
    const std::size_t at = refused.err.find(": --");
    ASSERT_NE(at, std::string::npos) << refused.err;
    const std::string offered = refused.err.substr(at + 2, refused.err.find('\n') - at - 2);
    EXPECT_EQ(headpin("import t.csv -o t.lcmlog --force " + offered).code, 0) << offered;
    EXPECT_THAT(headpin("import t.csv --explain").out, HasSubstr("try                " + offered));
  }
}

TEST_F(ImportTables, EveryFormatTakesTheOptions) {
  const nlohmann::json wanted = json("import " + kBundledThrow + " -o a.lcmlog --json");
  // As UXF, mirrored in z as by a script that forgot Unity's axes.
  const char* const header = "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n";
  std::string head = header, hand = header;
  ForeignTable unity = table("unity");
  unity.R_positions = unity.R_rotations = Mat3::Identity();
  for (std::size_t i = 0; i < even_.times.size(); ++i) {
    for (const std::string part : {"head", "right"}) {
      std::string row = fmt::format("{:.6f}", seconds(even_.times[i]));
      for (const char* cell : {".x", ".y", ".z", ".ex", ".ey", ".ez"}) {
        row += "," + foreign_cell(unity, even_, i, part + cell, {}, {});
      }
      (part == "head" ? head : hand) += row + "\n";
    }
  }
  std::filesystem::create_directories(folder_ / "S1/trackers");
  spit(folder_ / "S1/trackers/head_movement_T001.csv", head);
  spit(folder_ / "S1/trackers/right_movement_T001.csv", hand);
  expect_refusal("import S1 -o OUT.lcmlog", 1, "with +x right, +y up and +z back: --axes RSP");
  EXPECT_NEAR(json("import S1 -o b.lcmlog --json --axes RSP")["release_speed_mps"].get<double>(),
              wanted["release_speed_mps"].get<double>(), 0.1);
}

TEST_F(ImportTables, ATriggerAndAFileOfEventsSayGrabAndRelease) {
  write("t.csv", table("a_trigger"));
  const nlohmann::json by_trigger = json("import t.csv -o t.lcmlog --json");
  EXPECT_NEAR(by_trigger["grab_s"].get<double>(), 1.4, 0.015);
  EXPECT_NEAR(by_trigger["release_s"].get<double>(), 3.95, 0.015);
  EXPECT_THAT(headpin("import t.csv -o t.lcmlog --force").out, Not(HasSubstr("found")));

  write("p.csv", table("plain"));
  spit(folder_ / "events.tsv",
       "onset\tduration\ttrial_type\n0.5\t1\tstart\n1.4\t0.1\tgrab\n3.95\t0.1\trelease\n");
  const nlohmann::json by_events = json("import p.csv -o p.lcmlog --events events.tsv --json");
  EXPECT_EQ(by_events["grab_s"], 1.4);
  EXPECT_EQ(by_events["release_s"], 3.95);
  EXPECT_TRUE(by_events["by_trigger"].get<bool>());
  // The samples of the trigger have the times of the file, not of a sample beside them.
  std::vector<std::pair<Time, bool>> trigger;
  for (const devices::Sample& sample : trial("p.lcmlog").samples) {
    if (const auto* mouse = std::get_if<devices::MouseSample>(&sample))
      trigger.emplace_back(mouse->device_time, mouse->trigger);
  }
  EXPECT_EQ(trigger, (std::vector<std::pair<Time, bool>>{{Time{1'400'000}, true},
                                                         {Time{3'950'000}, false}}));
  EXPECT_NEAR(json("replay p.lcmlog --json")["release_speed_mps"].get<double>(),
              by_events["release_speed_mps"].get<double>(), 1e-6);

  // As an editor of Windows saves it: with a byte order mark.
  spit(folder_ / "mark.txt",
       "\xef\xbb\xbf"
       "1.4 grab\r\n3.95 release\r\n");
  EXPECT_EQ(json("import p.csv -o m.lcmlog --events mark.txt --json")["grab_s"], 1.4);

  // A file of markers may cover more than the recording.
  spit(folder_ / "session.csv", "time,what\n1.4,grab\n3.95,let go\n100,grab\n101,let go\n");
  EXPECT_EQ(json("import p.csv -o s.lcmlog --events session.csv --json")["release_s"], 3.95);
  spit(folder_ / "late.csv", "time,what\n100,grab\n101,let go\n");
  expect_refusal("import p.csv -o OUT.lcmlog --events late.csv", 1,
                 "expected times of grab and release between 0.000 and");
  spit(folder_ / "none.csv", "time,what\n1,begin\n");
  expect_refusal("import p.csv -o OUT.lcmlog --events none.csv", 1,
                 "none.csv:2: unknown word 'begin'; expected grab or release");
}

TEST_F(ImportTables, ATriggerThatIsNotTheThrowsIsNamedAndCanBeLeftOut) {
  released_ = Time{2'500'000};  // in the back swing
  write("t.csv", table("a_trigger"));
  const Result refused = headpin("import t.csv -o t.lcmlog");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("the trigger is released at 2.5"));
  EXPECT_THAT(refused.err, HasSubstr("it would be one without its trigger, by the motion alone"));
  EXPECT_THAT(refused.err, Not(HasSubstr("--axes")));
  EXPECT_FALSE(json("import t.csv -o t.lcmlog --no-trigger --json")["by_trigger"].get<bool>());
  EXPECT_THAT(headpin("import t.csv --explain --no-trigger").out,
              HasSubstr("trigger            none"));

  // The catalogue's times are milliseconds, those of a person's notes are seconds.
  spit(folder_ / "s.txt", "1.4 grab\n3.95 let go\n");
  spit(folder_ / "ms.txt", "1400 grab\n3950 let go\n");
  for (const std::string events : {"s.txt", "ms.txt"}) {
    EXPECT_EQ(json("import " + kBundledThrow + " -o e.lcmlog --force --json --events " +
                   events)["release_s"],
              3.95);
  }
}

TEST_F(ImportTables, NamesThatAreNotUnderstoodAreNotPassedOverInSilence) {
  ForeignTable strange = table("plain");
  strange.header = {"t",       "head_x",   "head_y",   "head_z",   "head_q1",
                    "head_q2", "head_q3",  "head_q4",  "right_x",  "right_y",
                    "right_z", "right_q1", "right_q2", "right_q3", "right_q4"};
  write("t.csv", strange);
  const Result imported = headpin("import t.csv -o t.lcmlog");
  EXPECT_EQ(imported.code, 0);
  EXPECT_THAT(imported.err, HasSubstr("the right hand has no rotation"));
  EXPECT_THAT(imported.err, HasSubstr("not understood: head_q1, head_q2"));
  EXPECT_THAT(imported.err, HasSubstr("the ball leaves without spin, at the speed of the hand"));
  EXPECT_THAT(json("import t.csv -o t.lcmlog --force --json")["notes"].dump(),
              HasSubstr("not understood"));

  // Told what the four are, it is the throw again.
  const nlohmann::json told = json(
      "import t.csv -o t.lcmlog --force --json --columns "
      "'head.qx=head_q1,head.qy=head_q2,head.qz=head_q3,"
      "head.qw=head_q4,right.qx=right_q1,right.qy=right_q2,right.qz=right_q3,right.qw=right_q4'");
  write("plain.csv", table("plain"));
  EXPECT_EQ(told["release_speed_mps"],
            json("import plain.csv -o p.lcmlog --json")["release_speed_mps"]);

  strange.header = {"zeit", "kopf_x", "b", "c", "d", "e", "f", "g",
                    "h",    "i",      "j", "k", "l", "m", "n"};
  write("u.csv", strange);
  expect_refusal("import u.csv -o OUT.lcmlog", 1,
                 "no column of the time was found; the 15 columns are zeit, kopf_x,");
  ASSERT_EQ(headpin("import u.csv --explain -o u.toml").code, 0);
  EXPECT_THAT(slurp(folder_ / "u.toml"), HasSubstr("#   kopf_x"));
}

TEST_F(ImportTables, OfManyObjectsTheHeadAndTheHandAreTaken) {
  ForeignTable many = table("plain");
  for (const char* other : {"head_forward", "right_hand_index", "right_elbow", "ball"}) {
    for (const char* cell : {"x", "y", "z", "qx", "qy", "qz", "qw"}) {
      many.header.push_back(std::string(other) + "_" + cell);
      many.columns.push_back("=0.5");
    }
  }
  for (std::string& name : many.header) {
    if (name.starts_with("ctrl_right")) name.replace(0, 10, "right_hand");
  }
  write("many.csv", many);
  write("plain.csv", table("plain"));
  EXPECT_EQ(json("import many.csv -o m.lcmlog --json")["release_speed_mps"],
            json("import plain.csv -o p.lcmlog --json")["release_speed_mps"]);
}

// A row for each object, and no head among them: the other objects are not the hand.
TEST_F(ImportTables, AnObjectsRowsAreItsOwn) {
  std::string text = "time,device,x,y,z,qx,qy,qz,qw\n";
  const ForeignTable plain = table("plain");
  for (std::size_t i = 0; i < even_.times.size(); ++i) {
    std::string row = plain.time(even_.times[i]) + ",controller_left";
    for (const char* cell : {".x", ".y", ".z", ".qx", ".qy", ".qz", ".qw"}) {
      row += "," + foreign_cell(plain, even_, i, std::string("right") + cell, {}, {});
    }
    text += row + "\n" + plain.time(even_.times[i]) + ",ball,1,1,1,0,0,0,1\n";
  }
  spit(folder_ / "t.csv", text);
  const Vec3 p = even_.head.front().p;
  const Result refused = headpin(
      fmt::format("import t.csv -o t.lcmlog --head={:.3f},{:.3f},{:.3f}", p.x(), p.y(), p.z()));
  EXPECT_THAT(
      refused.err,
      HasSubstr("it would be one by the right hand"));  // it is called left, and is on the right
  EXPECT_THAT(refused.err, Not(HasSubstr("time of another")));
}

// The samples of the hand are the throw. A head at half their rate is interpolated.
TEST_F(ImportTables, AHeadOfAnotherRateLeavesTheThrowAsItIs) {
  const ForeignTable plain = table("plain");
  const auto told = [&](std::size_t every) {
    std::string text = "time,device,x,y,z,qx,qy,qz,qw\n";
    for (std::size_t i = 0; i < even_.times.size(); ++i) {
      for (const std::string thing : {"head", "right"}) {
        if (thing == "head" && i % every != 0 && i + 1 < even_.times.size()) continue;
        text += plain.time(even_.times[i]) + "," + (thing == "head" ? "HMD" : "right_hand");
        for (const char* cell : {".x", ".y", ".z", ".qx", ".qy", ".qz", ".qw"})
          text += "," + foreign_cell(plain, even_, i, thing + cell, {}, {});
        text += "\n";
      }
    }
    spit(folder_ / "t.csv", text);
    return json("import t.csv -o t.lcmlog --force --json");
  };
  const nlohmann::json full = told(1), half = told(2);
  EXPECT_EQ(full["samples"], even_.times.size());
  for (const char* key : {"samples", "release_s", "grab_s", "peak_hand_speed_mps"})
    EXPECT_EQ(half[key], full[key]) << key;
  EXPECT_NEAR(half["release_speed_mps"].get<double>(), full["release_speed_mps"].get<double>(),
              1e-9);
  EXPECT_THAT(half["notes"].dump(), HasSubstr("samples of the head are interpolated at the"));
  EXPECT_THAT(full["notes"].dump(), Not(HasSubstr("interpolated at")));
}

TEST_F(ImportTables, ARecordingThatEndsTooSoonForTheSkittlesSaysSo) {
  EXPECT_EQ(headpin("import " + kBundledThrow + " -o a.lcmlog").err, "");
  while (even_.times.back() > Time{4'600'000}) {
    even_.times.pop_back();
    even_.head.pop_back();
    even_.right_hand.pop_back();
  }
  write("short.csv", table("plain"));
  EXPECT_THAT(headpin("import short.csv -o s.lcmlog").err,
              HasSubstr("after the release: a replay ends there too"));
}

TEST_F(ImportTables, WideAndLongLinesAreRefusedAtOnce) {
  std::string wide = "1";
  for (int i = 0; i < 100'000; ++i) wide += ",1";
  spit(folder_ / "wide.csv", wide + "\n" + wide + "\n");
  expect_refusal("import wide.csv -o OUT.lcmlog", 1,
                 "wide.csv:1: expected at most 4000 columns, found 100001");
  std::string line = "1,2,3,4\n1";
  for (int i = 0; i < 600'000; ++i) line += ",1";
  spit(folder_ / "long.csv", line + "\n");
  expect_refusal("import long.csv -o OUT.lcmlog", 1,
                 "long.csv:2: expected a line of a table, found one of 1200001 bytes");
}

TEST_F(ImportTables, WhatWasNotMeasuredIsAllowedAndSaidInTheTrial) {
  ForeignTable places = table("plain");
  places.columns = {"t", "head.x", "head.y", "head.z", "right.x", "right.y", "right.z"};
  places.header = {"t", "head_x", "head_y", "head_z", "right_x", "right_y", "right_z"};
  write("places.csv", places);
  const auto not_measured = [&](const std::string& name) {
    std::string said;
    for (const scene::Event& event : trial(name).events) {
      if (event.kind == "not_measured") said += event.detail.text() + "\n";
    }
    return said;
  };
  ASSERT_EQ(headpin("import places.csv -o places.lcmlog").code, 0);
  EXPECT_THAT(not_measured("places.lcmlog"),
              HasSubstr("the rotation of the head: it looks level, along the throw"));
  EXPECT_THAT(not_measured("places.lcmlog"), HasSubstr("the rotation of the hands"));
  EXPECT_GT(json("replay places.lcmlog --json")["skittles_down"].get<int>(), 0);

  ForeignTable hand = table("plain");
  hand.columns = {"t",        "right.x",  "right.y",  "right.z",
                  "right.qx", "right.qy", "right.qz", "right.qw"};
  hand.header = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
  write("hand.csv", hand);
  expect_refusal("import hand.csv -o OUT.lcmlog", 1, "no head was found");
  const Vec3 p = even_.head.front().p;
  ASSERT_EQ(headpin(fmt::format("import hand.csv -o hand.lcmlog --head {:.3f},{:.3f},{:.3f}", p.x(),
                                p.y(), p.z()))
                .code,
            0);
  EXPECT_THAT(not_measured("hand.lcmlog"), HasSubstr("the head: it stays in one place"));

  ForeignTable head = hand;
  head.columns = {"t", "head.x", "head.y", "head.z", "head.qx", "head.qy", "head.qz", "head.qw"};
  head.header = {"t", "hmd_x", "hmd_y", "hmd_z", "hmd_qx", "hmd_qy", "hmd_qz", "hmd_qw"};
  write("head.csv", head);
  expect_refusal("import head.csv -o OUT.lcmlog", 1, "no hand was found");
  ASSERT_EQ(headpin("import head.csv -o head.lcmlog --hand none").code, 0);
  EXPECT_THAT(not_measured("head.lcmlog"), HasSubstr("the hands: nothing is thrown"));
  EXPECT_EQ(json("replay head.lcmlog --json")["skittles_down"], 0);
}

TEST_F(ImportTables, RowsThatAreLateRepeatedOrBlankAreReadWithANote) {
  std::string text = foreign_text(table("plain"), even_, {}, {});
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::swap(lines[50], lines[51]);
  lines.insert(lines.begin() + 80, lines[80]);
  lines[100] = lines[100].substr(0, lines[100].find(',')) + std::string(14, ',');
  lines[120] = "// a remark";
  text.clear();
  for (const std::string& line : lines) text += line + "\n";
  spit(folder_ / "t.csv", text);
  const Result result = headpin("import t.csv -o t.lcmlog");
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.err,
              HasSubstr("t.csv: 1 rows are earlier than the row before (the furthest by 0.0"));
  EXPECT_THAT(result.err, HasSubstr("s, at line 52): put in order"));
  EXPECT_THAT(result.err, HasSubstr("1 samples of the head have the time of another one: ignored"));
  EXPECT_THAT(result.err, HasSubstr("1 samples of the head have blank cells"));
}

TEST_F(ImportTables, ExplainSaysWhatIsUnderstoodAndWritesItsColumns) {
  write("t.csv", table("unity"));
  const Result said = headpin("import t.csv --explain");
  EXPECT_EQ(said.code, 0);
  for (const char* line : {"HeadPosX", "head, position x", "right hand, angle about z",
                           "m up, looking", "try                --axes RSA"}) {
    EXPECT_THAT(said.out, HasSubstr(line));
  }
  EXPECT_THAT(headpin("import t.csv --explain --axes RSA").out, HasSubstr("looking down the lane"));
  ASSERT_EQ(headpin("import t.csv --explain --axes RSA -o map.toml").code, 0);
  EXPECT_THAT(slurp(folder_ / "map.toml"), HasSubstr("rotations = 'YXZ,deg'"));
  EXPECT_EQ(headpin("import t.csv --explain -o map.toml").code, 1);  // not overwritten unasked
  const nlohmann::json by_map = json("import t.csv --columns map.toml -o a.lcmlog --json");
  EXPECT_EQ(by_map["release_speed_mps"],
            json("import t.csv --axes RSA -o b.lcmlog --json")["release_speed_mps"]);
  EXPECT_FALSE(json("import t.csv --explain --json")["can_be_imported"].get<bool>());
  EXPECT_TRUE(json("import t.csv --explain --json --axes RSA")["can_be_imported"].get<bool>());

  spit(folder_ / "other.csv", "a,b,c,d\n1,2,3,4\n2,3,4,5\n");
  EXPECT_THAT(headpin("import other.csv --explain").out,
              HasSubstr("no column of the time was found"));
  spit(folder_ / "bad.toml", "time = 't'\nhead = HMD_*\n");
  expect_refusal("import t.csv --columns bad.toml -o OUT.lcmlog", 1,
                 "bad.toml:2: not TOML: column 8: 'HMD_*': could not determine value type; text "
                 "needs quotes");
  spit(folder_ / "bad.toml", "time = 3\n");
  expect_refusal("import t.csv --columns bad.toml -o OUT.lcmlog", 1,
                 "bad.toml:1: time: expected a name in quotes");
  expect_refusal("import t.csv --columns nonsense -o OUT.lcmlog", 2, "expected WHAT=COLUMN");
  expect_refusal("import t.csv --rotations xyzw -o OUT.lcmlog", 1,
                 "expected quaternions to read as xyzw");
}

TEST_F(ImportTables, NamesSayWhichColumnsAreHeadAndHands) {
  write("t.csv", table("plain"));
  std::string text = slurp(folder_ / "t.csv");
  for (const auto& [from, to] : {std::pair{"HMD_", "A_"}, {"ctrl_right_", "C_"}}) {
    text = std::regex_replace(text, std::regex(from), to);
  }
  spit(folder_ / "named.csv", text);
  EXPECT_EQ(headpin("import named.csv -o OUT.lcmlog").code, 1);
  EXPECT_EQ(json("import named.csv --names A,,C -o named.lcmlog --json")["release_speed_mps"],
            json("import t.csv -o own.lcmlog --json")["release_speed_mps"]);
}

TEST_F(ImportTables, AWrongWordIsNamedByItsOption) {
  write("t.csv", table("plain"));
  const std::string import = "import t.csv -o OUT.lcmlog ";
  for (const auto& [option, says] :
       {std::pair{"--columns time=tt", "--columns: t.csv has no column 'tt'; the nearest is t\n"},
        {"--columns time=nothing",
         "--columns: t.csv has no column 'nothing'; the 15 columns are t, HMD_x, HMD_y, "},
        {"--columns tim=t",
         "--columns: unknown key 'tim'; expected time, trigger, object, head, left or right\n"},
        {"--columns head.foo=t", "--columns: unknown component 'head.foo'; expected x, y, z, qw"},
        {"--columns head=HMD", "--columns: head = 'HMD'; expected a name with one *"},
        {"--columns 'head=H*_x'", "--columns: the columns of t.csv that are called 'H*_x' lack x"},
        {"--columns 'head=*'", "begin with '' are of 2 objects; expected x, y and z of one object"},
        {"--names a,b,c",
         "--names: no columns of t.csv begin with 'a'; the 15 columns are t, HMD_x"},
        {"--names HMD,", "--names: expected three names HEAD,LEFT,RIGHT, one hand of which may be"},
        {"--rotations quick", "--rotations: expected the order of a quaternion"},
        {"--time-unit h",
         "--time-unit: expected s, ms, us, ns, 100ns, or the rate of frames such "
         "as 90Hz, found h\n"},
        {"--head 1,2", "--head: expected X,Y,Z in metres from -100 to 100, found 1,2\n"}}) {
    expect_refusal(import + option, 2, says);
  }
  EXPECT_EQ(headpin("import t.csv --explain --columns time=tt").code, 2);
  // What is not found can be told.
  spit(folder_ / "few.csv", "t,a,b,c\n0,1,2,3\n0.1,1,2,3\n");
  const Result few = headpin("import few.csv -o OUT.lcmlog");
  EXPECT_EQ(few.code, 1);
  EXPECT_THAT(few.err, HasSubstr("; the 4 columns are t, a, b, c; --columns 'time=t, head=HMD_*, "
                                 "right=ctrl_*' says which columns are meant"));
  // A head that was told is not what is missing.
  spit(folder_ / "none.csv", "t,a,b,c\n0,1,2,3\n0.1,1,2,3\n");
  expect_refusal("import none.csv -o OUT.lcmlog --head 0,1.7,0", 1, "none.csv: no hand was found");
}

TEST_F(ImportTables, AWrongWordInAFileIsNamedByItsLine) {
  write("t.csv", table("plain"));
  for (const auto& [text, says] :
       {std::pair{"time = 't'\nunits = 'km'\n",
                  "c.toml:2: units: expected m, cm, mm, in or ft, found 'km'\n"},
        {"axes = 'RRP'\n", "c.toml:1: axes: expected where +x, +y and +z point, one letter each"},
        {"time_unit = 'h'\n", "c.toml:1: time_unit: expected s, ms, us, ns, 100ns,"},
        {"tim = 't'\n",
         "c.toml:1: unknown key 'tim'; expected time, trigger, object, head, left or right"},
        {"time = 'tt'\n", "c.toml:1: t.csv has no column 'tt'; the nearest is t\n"},
        {"[head]\nx = 'HMD_'\n", "c.toml:2: t.csv has no column 'HMD_'; the nearest is HMD_x\n"}}) {
    spit(folder_ / "c.toml", text);
    expect_refusal("import t.csv --columns c.toml -o OUT.lcmlog", 1, says);
  }
}

}  // namespace
}  // namespace headpin
