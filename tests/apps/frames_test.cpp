// What was shown to whoever took part comes back, or is said not to be comparable.

#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include <fmt/format.h>

#include "devices/base/sources.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/scenario/scenario.h"
#include "tests/apps/command_line.h"
#include "tests/apps/decoded.h"

namespace headpin {
namespace {

using testing::HasSubstr;

class Frames : public CommandLine {
 protected:
  scene::Trial trial(const std::string& name) const { return scene::read_trial(folder_ / name); }

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
    scene::Trial t = trial("shown.lcmlog");
    change(t);
    scene::Recorder recorder(folder_ / name, t.header);
    for (const scene::Event& event : t.events) {
      if (event.kind == scene::kind::drawn_by) recorder.write(event);
    }
    scene::write(recorder, t.samples, {});
    for (const scene::FrameRecord& frame : t.frames) recorder.write(frame);
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
  const scene::Trial shown = trial("shown.lcmlog");
  ASSERT_GT(shown.frames.size(), 2u);
  const nlohmann::json told = json("frames shown.lcmlog --as-shown -o frames --json");
  EXPECT_EQ(told["frames"], shown.frames.size());
  EXPECT_EQ(told["verified_frames"], shown.frames.size());
  const auto rows = index("frames");
  ASSERT_EQ(rows.size(), shown.frames.size());
  for (const scene::FrameRecord& frame : shown.frames) {
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
                 "expected recorded frames, from");
  expect_refusal("frames " + kDemo + " --as-shown -o OUT", 1,
                 "demo.lcmlog: has no recorded frames");
}

TEST_F(Frames, TheFirstPictureThatDiffersIsNamed) {
  record_session();
  std::int64_t number = 0;
  rewrite("other.lcmlog", [&](scene::Trial& t) {
    number = t.frames[1].frame;
    for (std::size_t i = 1; i < t.frames.size(); ++i) t.frames[i].hash[1] ^= 1;
  });
  expect_refusal("frames other.lcmlog --as-shown -o OUT", 1,
                 "frame " + std::to_string(number) + " (tick ");
  expect_refusal("frames other.lcmlog --as-shown -o OUT", 1, "first difference in the right eye");
}

// Another Mesa, processor or setting may draw other bits: a test picture decides whether it does.
TEST_F(Frames, DrawnElsewhereAreNotComparedAndItIsSaidWhy) {
  record_session();
  rewrite("elsewhere.lcmlog", [](scene::Trial& t) {
    for (scene::Event& event : t.events) {
      if (event.kind != scene::kind::drawn_by) continue;
      auto who = event.detail.value_or(render::Fingerprint{});
      who.renderer = "OSMesa, llvmpipe of another day";
      who.picture = 0x0123456789abcdef;
      event.detail = who;
    }
    for (scene::FrameRecord& frame : t.frames) frame.hash[0] ^= 1;
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

// A process each: Mesa reads the number once.
TEST_F(Frames, AreTheSameWhateverTheNumberOfMesasThreads) {
  const auto drawn = [&] {
    json("frames " + kDemo + " --force -o drawn --frames 200-202 --look fast --json");
    return slurp(folder_ / "drawn" / "frames.csv");
  };
  unsetenv("LP_NUM_THREADS");
  const std::string ours = drawn();
  for (const char* threads : {"0", "1", "4"}) {
    setenv("LP_NUM_THREADS", threads, 1);
    EXPECT_EQ(drawn(), ours) << threads;
  }
  unsetenv("LP_NUM_THREADS");
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
  const nlohmann::json nothing = json("doctor --json");
  EXPECT_EQ(nothing["eyes"]["works"], false);
  unsetenv("LD_LIBRARY_PATH");
  EXPECT_EQ(fallen.code, 0) << fallen.err;
  EXPECT_THAT(fallen.err, HasSubstr("drawn by EGL, "));
  EXPECT_THAT(fallen.err, HasSubstr("; osmesa: cannot load libOSMesa.so.8"));
  EXPECT_EQ(index("fallen").at(200), own);
  EXPECT_EQ(doctor["osmesa"]["works"], false);
  EXPECT_THAT(std::string(doctor["osmesa"]["says"]), HasSubstr("; not needed"));
  EXPECT_EQ(doctor["osmesa"]["remedy"], "");
  EXPECT_NE(nothing["osmesa"]["remedy"], "");  // where nothing draws
  EXPECT_EQ(doctor["eyes"]["works"], true);
  EXPECT_THAT(std::string(doctor["eyes"]["says"]), HasSubstr("EGL, "));
}

TEST_F(Frames, TheEnvironmentChoosesWhatDraws) {
  setenv("HEADPIN_GL", "egl", 1);
  const nlohmann::json egl = json("doctor --json");
  setenv("HEADPIN_GL", "glut", 1);
  const Result wrong = headpin("frames " + kDemo + " -o OUT");
  const Result draws_nothing = headpin("info " + kDemo);
  unsetenv("HEADPIN_GL");
  if (egl["egl"]["works"]) {
    EXPECT_THAT(std::string(egl["eyes"]["says"]), HasSubstr("EGL, "));
    EXPECT_THAT(std::string(egl["egl"]["says"]), HasSubstr("; draws the same"));
  }
  EXPECT_EQ(wrong.code, 2) << wrong.err;
  EXPECT_THAT(wrong.err,
              HasSubstr("HEADPIN_GL in the environment: expected osmesa, egl, egl:auto or "
                        "egl:NUMBER, found 'glut'"));
  EXPECT_EQ(draws_nothing.code, 0) << draws_nothing.err;
}

/// The picture's bytes, as ffmpeg reads the PNG of both eyes.
std::string both_eyes(const fs::path& folder, std::int64_t frame) {
  return decoded(folder / fmt::format("both_{:06}.png", frame), "rgb24");
}

// Every display and ten odd ones, whose pixels have other aspects. What ffmpeg reads of the video is
// what it reads of the PNG files.
TEST_F(Frames, AreInTheLosslessVideoToTheBitForEveryDisplay) {
  std::vector<std::string> displays;
  for (const char* name :
       {"flight-helmet", "flight-helmet-square", "flight-helmet-leep", "flight-helmet-elements",
        "flight-helmet-total", "flight-helmet-relayed", "flight-helmet-lens"}) {
    displays.push_back(fmt::format("--set hmd.profile={}", name));
  }
  for (const double degrees : {20.3, 27.1, 33.7, 38.9, 41.3, 47.7, 53.1, 61.9, 73.3, 88.7}) {
    displays.push_back(fmt::format("--set hmd.vertical_fov_deg={}", degrees));
  }
  for (const std::string& display : displays) {
    ASSERT_EQ(headpin("replay " + kDemo + " " + display + " --force -o other.lcmlog").code, 0);
    const Result drawn = headpin(
        "frames other.lcmlog --frames 210-214 --look fast --layout side-by-side --force -o out "
        "--video film.mkv --no-mp4");
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    std::string pictures;
    for (std::int64_t frame = 210; frame <= 214; ++frame) {
      pictures += both_eyes(folder_ / "out", frame);
    }
    EXPECT_TRUE(decoded(folder_ / "film.mkv", "rgb24") == pictures) << display;
  }
}

// At k / 60 s a video shows the newest frame that was shown until then, to half a picture; where two
// came within one, the second is a picture late at most.
TEST_F(Frames, AsShownAreInTheVideoAtTheirTimes) {
  record_session();
  ASSERT_EQ(headpin("frames shown.lcmlog --as-shown --layout side-by-side -o out --video film.mkv "
                    "--no-mp4")
                .code,
            0);
  const std::string film = decoded(folder_ / "film.mkv", "rgb24");
  constexpr std::size_t kPicture = std::size_t{3} * 720 * 240;
  const scene::Trial shown = trial("shown.lcmlog");
  std::vector<std::string> pictures;
  for (const scene::FrameRecord& frame : shown.frames) {
    pictures.push_back(both_eyes(folder_ / "out", frame.frame));
  }
  const double end = seconds(shown.frames.back().time);
  ASSERT_EQ(film.size() % kPicture, 0u);
  EXPECT_NEAR(static_cast<double>(film.size() / kPicture), 60.0 * end + 1.0, 1.51);
  for (std::size_t k = 0; k < film.size() / kPicture; ++k) {
    const std::string picture = film.substr(k * kPicture, kPicture);
    const double now = static_cast<double>(k) / 60.0;
    bool found = now < seconds(shown.frames.front().time) &&
                 picture.find_first_not_of('\0') == std::string::npos;
    for (std::size_t i = 0; i < pictures.size() && !found; ++i) {
      const double from = seconds(shown.frames[i].time) - 0.51 / 60.0;
      const double to =
          (i + 1 < pictures.size() ? seconds(shown.frames[i + 1].time) : end + 1.0 / 60.0) +
          1.51 / 60.0;
      found = from <= now && now <= to && picture == pictures[i];
    }
    EXPECT_TRUE(found) << "picture " << k;
  }
  // A few of them take as long as they took, from the first.
  ASSERT_GT(shown.frames.size(), 2u);
  const auto &first = shown.frames[1], &last = shown.frames.back();
  ASSERT_EQ(headpin(fmt::format("frames shown.lcmlog --as-shown --frames {}-{} --video few.mkv "
                                "--no-mp4",
                                first.frame, last.frame))
                .code,
            0);
  EXPECT_NEAR(static_cast<double>(decoded(folder_ / "few.mkv", "rgb24").size() / kPicture),
              60.0 * (end - seconds(first.time)) + 1.0, 1.51);
}

TEST_F(Frames, SideBySideAreBothEyesInOnePicture) {
  ASSERT_EQ(headpin("frames " + kDemo + " -o two --frames 200").code, 0);
  ASSERT_EQ(headpin("frames " + kDemo + " -o one --frames 200 --layout side-by-side").code, 0);
  EXPECT_EQ(index("one"), index("two"));
  EXPECT_FALSE(fs::exists(folder_ / "one/left_000200.png"));
  const std::string both = decoded(folder_ / "one/both_000200.png", "rgb24"),
                    left = decoded(folder_ / "two/left_000200.png", "rgb24"),
                    right = decoded(folder_ / "two/right_000200.png", "rgb24");
  ASSERT_EQ(both.size(), left.size() + right.size());
  constexpr std::size_t kRow = std::size_t{3} * 360;
  for (std::size_t y = 0; y < 240; ++y) {
    EXPECT_EQ(both.substr(2 * kRow * y, kRow), left.substr(kRow * y, kRow)) << y;
    EXPECT_EQ(both.substr(2 * kRow * y + kRow, kRow), right.substr(kRow * y, kRow)) << y;
  }
}

// Depth in both forms is the same to half a millimetre; ids are where things are.
TEST_F(Frames, DepthAndIdsTellWhatEachPixelSees) {
  ASSERT_EQ(headpin("frames " + kDemo + " -o out --frames 280 --depth --ids").code, 0);
  const std::string png = decoded(folder_ / "out/left_000280_depth.png", "gray16le"),
                    ids = decoded(folder_ / "out/left_000280_ids.png", "gray16le"),
                    raw = slurp(folder_ / "out/left_000280_depth.raw");
  ASSERT_EQ(png.size(), std::size_t{2} * 360 * 240);
  ASSERT_EQ(ids.size(), png.size());
  ASSERT_EQ(raw.size(), 2 * png.size());
  std::map<int, double> nearest;  // of each id [m]
  for (std::size_t i = 0; i < std::size_t{360} * 240; ++i) {
    std::uint16_t millimetres = 0, id = 0;
    float metres = 0.0F;
    std::memcpy(&millimetres, png.data() + 2 * i, 2);
    std::memcpy(&id, ids.data() + 2 * i, 2);
    std::memcpy(&metres, raw.data() + 4 * i, 4);
    ASSERT_NEAR(millimetres, 1000.0 * metres, 0.51) << i;
    const auto [at, first] = nearest.emplace(id, metres);
    if (!first) at->second = std::min<double>(at->second, metres);
  }
  EXPECT_EQ(nearest.count(0), 0u);
  ASSERT_EQ(nearest.count(100),
            1u);  // the head pin, 6 m from the foul line, behind which one stands
  EXPECT_GT(nearest[100], 5.5);
  EXPECT_LT(nearest[100], 8.5);
  EXPECT_GT(nearest.size(), 10u);
  EXPECT_THAT(slurp(folder_ / "out/ids.csv"), HasSubstr("10,ball\n100,skittle 1\n101,skittle 2\n"));
  EXPECT_THAT(slurp(folder_ / "out/ids.csv"), HasSubstr("5,head\n"));
  expect_refusal("frames " + kDemo + " --video OUT.mkv --depth", 2, "need -o DIR");
}

TEST_F(Frames, ThoseBeyondTheEndAreTold) {
  const Result beyond = headpin("frames " + kDemo + " --cameras few.json --frames 3,419-430");
  EXPECT_EQ(beyond.code, 0) << beyond.err;
  EXPECT_EQ(beyond.err,
            "headpin frames: --frames 3,419-430: frame 421 does not exist; of the wanted ones 3 "
            "do\n");
  EXPECT_EQ(headpin("frames " + kDemo + " --cameras all.json --frames 0-420").err, "");
}

TEST_F(Frames, GoToStandardOutputAsY4m) {
  const Result piped = headpin("frames " + kDemo + " --y4m - --frames 200-202");
  EXPECT_EQ(piped.code, 0) << piped.err;
  EXPECT_THAT(piped.out, testing::StartsWith("YUV4MPEG2 W720 H240 F60:1 Ip A14055:10000 C444"));
  EXPECT_EQ(piped.out.size(), piped.out.find('\n') + 1 + 3 * (6 + std::size_t{3} * 720 * 240));
  EXPECT_THAT(piped.err, HasSubstr("3 frames of two eyes"));
  // Another program reads the colours it was given, to the rounding.
  std::ofstream(folder_ / "film.y4m", std::ios::binary) << piped.out;
  ASSERT_EQ(headpin("frames " + kDemo + " -o one --frames 200 --layout side-by-side").code, 0);
  const std::string film = decoded(folder_ / "film.y4m", "rgb24"),
                    picture = decoded(folder_ / "one/both_000200.png", "rgb24");
  ASSERT_EQ(film.size(), 3 * picture.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const double off = static_cast<unsigned char>(film[i]) - static_cast<unsigned char>(picture[i]);
    squares += off * off;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(picture.size())), 1.5);
}

TEST_F(Frames, FromOutsideShowWhoThrows) {
  for (const std::string view : {"third-person", "top"}) {
    ASSERT_EQ(
        headpin("frames " + kDemo + " -o " + view + " --ids --frames 230 --view " + view).code, 0);
    const std::string ids = decoded(folder_ / view / "left_000230_ids.png", "gray16le");
    std::set<int> seen;
    for (std::size_t i = 0; i < ids.size(); i += 2) {
      std::uint16_t id = 0;
      std::memcpy(&id, ids.data() + i, 2);
      seen.insert(id);
    }
    for (const int id : {2, 5, 10, 100}) EXPECT_TRUE(seen.contains(id)) << view << " " << id;
  }
  record_session();
  const Result shown = headpin("frames shown.lcmlog --as-shown --view top -o seen");
  EXPECT_EQ(shown.code, 0);
  EXPECT_THAT(shown.err, HasSubstr("not compared: they are not what the eyes saw"));
  expect_refusal("frames shown.lcmlog --verify --view top", 2, "no --view");
}

TEST_F(Frames, OfATrialThatIsCutAreDrawnAndItIsSaid) {
  const std::string whole = slurp(kDemo);
  std::ofstream(folder_ / "cut.lcmlog", std::ios::binary) << whole.substr(0, whole.size() / 2);
  const Result cut = headpin("frames cut.lcmlog -o out --frames 60");
  EXPECT_EQ(cut.code, 0) << cut.err;
  EXPECT_THAT(cut.err, HasSubstr("cut.lcmlog: is incomplete: it ends at "));
  EXPECT_EQ(headpin("frames " + kDemo + " -o whole --frames 60").err, "");
  EXPECT_EQ(index("out").at(60), index("whole").at(60));
}

TEST_F(Frames, AVideoComesWithoutItsCopyWhenToldSo) {
  ASSERT_EQ(headpin("frames " + kDemo + " --video film.mkv --no-mp4 --frames 3-9").code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "film.mkv"));
  EXPECT_FALSE(fs::exists(folder_ / "film.mp4"));
}

}  // namespace
}  // namespace headpin
