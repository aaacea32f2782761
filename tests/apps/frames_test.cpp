// What was shown to whoever took part comes back, or is said not to be comparable.

#include <regex>

#include "devices/log.h"
#include "devices/sources.h"
#include "scene/events.h"
#include "scene/scenario.h"
#include "tests/apps/command_line.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class Frames : public CommandLine {
 protected:
  devices::Trial trial(const std::string& name) const {
    return devices::read_trial(folder_ / name);
  }

  /// A session of 1.2 s of the bundled trial, drawn with one sample a pixel.
  void record_session() const {
    ASSERT_EQ(headpin("info " + kDemo + " --scenario").code, 0);
    fs::rename(folder_ / "out.txt", folder_ / "room.toml");
    const Result live = headpin("live --lcm 'file://" + kDemo +
                                "' --scenario room.toml --duration 1.2 --record shown.lcmlog");
    ASSERT_EQ(live.code, 0) << live.err;
  }

  /// `shown.lcmlog` as NAME, changed.
  template <typename Change>
  void rewrite(const std::string& name, const Change& change) const {
    devices::Trial t = trial("shown.lcmlog");
    change(t);
    devices::Recorder recorder(folder_ / name, t.header);
    for (const devices::Event& event : t.events) {
      if (event.kind == scene::kind::drawn_by) recorder.write(event);
    }
    devices::write(recorder, t.samples, {});
    for (const devices::FrameRecord& frame : t.frames) recorder.write(frame);
    recorder.close();
  }

  /// Columns of a frames.csv by frame: time, tick, both hashes.
  std::map<std::int64_t, std::array<std::string, 4>> index(const std::string& folder) const {
    std::map<std::int64_t, std::array<std::string, 4>> rows;
    std::istringstream lines(slurp(folder_ / folder / "frames.csv"));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      rows[std::stoll(cells.at(0))] = {cells.at(1), cells.at(2), cells.at(10), cells.at(18)};
    }
    return rows;
  }
};

TEST_F(Frames, AsShownAreThoseThatWereShownAtTheirTicks) {
  record_session();
  const devices::Trial shown = trial("shown.lcmlog");
  ASSERT_GT(shown.frames.size(), 2u);
  const nlohmann::json told = json("frames shown.lcmlog --as-shown -o frames --json");
  EXPECT_EQ(told["frames"], shown.frames.size());
  EXPECT_EQ(told["verified_frames"], shown.frames.size());
  const auto rows = index("frames");
  ASSERT_EQ(rows.size(), shown.frames.size());
  for (const devices::FrameRecord& frame : shown.frames) {
    const auto& [time, tick, left, right] = rows.at(frame.frame);
    EXPECT_NEAR(std::stod(time), seconds(frame.time), 1e-6);
    EXPECT_EQ(std::stoll(tick), frame.tick);
    EXPECT_EQ(std::stoull(left, nullptr, 16), frame.hash[0]);
    EXPECT_EQ(std::stoull(right, nullptr, 16), frame.hash[1]);
  }
  // One of them alone is the same one.
  const std::string last = std::to_string(shown.frames.back().frame);
  EXPECT_EQ(json("frames shown.lcmlog --as-shown -o one --json --frames " + last)["frames"], 1);
  EXPECT_EQ(index("one").at(shown.frames.back().frame), rows.at(shown.frames.back().frame));
  expect_refusal("frames shown.lcmlog --as-shown -o OUT --frames 99999", 2,
                 "expected some of those shown, from");
  expect_refusal("frames " + kDemo + " --as-shown -o OUT", 1, "holds no frames that were shown");
}

TEST_F(Frames, TheFirstPictureThatDiffersIsNamed) {
  record_session();
  std::int64_t number = 0;
  rewrite("other.lcmlog", [&](devices::Trial& t) {
    number = t.frames[1].frame;
    for (std::size_t i = 1; i < t.frames.size(); ++i) t.frames[i].hash[1] ^= 1;
  });
  expect_refusal("frames other.lcmlog --as-shown -o OUT", 1,
                 "frame " + std::to_string(number) + " (tick ");
  expect_refusal("frames other.lcmlog --as-shown -o OUT", 1, "first in the right eye");
}

// Another Mesa, processor or setting may draw other bits: a test picture decides whether it does.
TEST_F(Frames, DrawnElsewhereAreNotComparedAndItIsSaidWhy) {
  record_session();
  rewrite("elsewhere.lcmlog", [](devices::Trial& t) {
    for (devices::Event& event : t.events) {
      if (event.kind != scene::kind::drawn_by) continue;
      nlohmann::json who = nlohmann::json::parse(event.detail);
      who["renderer"] = "OSMesa, llvmpipe of another day";
      who["test_picture"] = "0123456789abcdef";
      event.detail = who.dump();
    }
    for (devices::FrameRecord& frame : t.frames) frame.hash[0] ^= 1;
  });
  const Result drawn = headpin("frames elsewhere.lcmlog --as-shown -o frames");
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr("pictures are not compared: a test picture comes out otherwise: "
                                   "drawn by OSMesa, llvmpipe of another day, here OSMesa, "));
  EXPECT_EQ(drawn.out.find("equal the recording"), std::string::npos);
  expect_refusal("frames elsewhere.lcmlog --verify", 1, "cannot be compared here");
}

// Mesa held to SSE2 draws other bits under the same name.
TEST_F(Frames, AnotherProcessorIsFoundOutByTheTestPicture) {
  record_session();
  setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse2", 1);
  const Result verified = headpin("frames shown.lcmlog --verify");
  unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
  EXPECT_EQ(verified.code, 1);
  EXPECT_THAT(verified.err, HasSubstr("cannot be compared here: a test picture comes out"));
  EXPECT_THAT(verified.err, HasSubstr("GALLIUM_OVERRIDE_CPU_CAPS=sse2"));
}

TEST_F(Frames, AnotherLookIsDrawnWhenAskedFor) {
  record_session();
  const auto hash = [&](const std::string& options) {
    json("frames " + kDemo + " --force -o look --frames 200 --json " + options);
    return index("look").at(200);
  };
  const auto own = hash("");
  EXPECT_EQ(hash("--look standard"), own);
  EXPECT_EQ(hash("--samples 2"), own);
  EXPECT_NE(hash("--look fast"), own);
  EXPECT_NE(hash("--samples 3"), own);
  EXPECT_NE(hash("--look fast --samples 2"), hash("--look fast"));
  const Result other = headpin("frames shown.lcmlog --as-shown --look 1997 -o frames");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("not compared: the look is another than the trial's"));
  expect_refusal("frames shown.lcmlog --verify --look fast", 2, "--verify compares with what was");
  expect_refusal("frames " + kDemo + " -o OUT --samples 9", 2, "--samples");
}

// Without OSMesa, as with Mesa 25.1 and later, EGL draws the same, and it is said why.
TEST_F(Frames, WithoutOsMesaAreDrawnByEgl) {
  const auto hash = [&](const std::string& options) {
    json("frames " + kDemo + " --force -o drawn --frames 200 --json " + options);
    return index("drawn").at(200);
  };
  const auto own = hash("");
  if (!json("doctor --json")["egl"]["works"]) GTEST_SKIP() << "no EGL here";
  EXPECT_EQ(hash("--gl egl"), own);
  for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
    std::ofstream(folder_ / name) << "";  // found first, and nothing that can be loaded
  }
  setenv("LD_LIBRARY_PATH", folder_.c_str(), 1);
  const Result fallen = headpin("frames " + kDemo + " -o fallen --frames 200");
  const nlohmann::json doctor = json("doctor --json");
  expect_refusal("frames " + kDemo + " -o OUT --gl osmesa", 1, "nothing to draw with: osmesa: ");
  std::ofstream(folder_ / "libEGL.so.1") << "";
  expect_refusal("frames " + kDemo + " -o OUT", 1, "; egl: cannot load libEGL.so.1");
  EXPECT_EQ(json("doctor --json")["eyes"]["works"], false);
  unsetenv("LD_LIBRARY_PATH");
  EXPECT_EQ(fallen.code, 0) << fallen.err;
  EXPECT_THAT(fallen.err, HasSubstr("drawn by EGL, "));
  EXPECT_THAT(fallen.err, HasSubstr("; osmesa: cannot load libOSMesa.so.8"));
  EXPECT_EQ(index("fallen").at(200), own);
  EXPECT_EQ(doctor["osmesa"]["works"], false);
  EXPECT_EQ(doctor["eyes"]["works"], true);
  EXPECT_THAT(std::string(doctor["eyes"]["says"]), HasSubstr("EGL, "));
}

TEST_F(Frames, TheEnvironmentChoosesWhatDraws) {
  setenv("HEADPIN_GL", "egl", 1);
  const nlohmann::json egl = json("doctor --json");
  setenv("HEADPIN_GL", "glut", 1);
  const Result wrong = headpin("frames " + kDemo + " -o OUT");
  unsetenv("HEADPIN_GL");
  if (egl["egl"]["works"]) {
    EXPECT_THAT(std::string(egl["eyes"]["says"]), HasSubstr("EGL, "));
    EXPECT_THAT(std::string(egl["egl"]["says"]), HasSubstr("; draws the same"));
  }
  EXPECT_EQ(wrong.code, 2) << wrong.err;
  EXPECT_THAT(wrong.err, HasSubstr("glut"));
}

}  // namespace
}  // namespace headpin
