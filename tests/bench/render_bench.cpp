#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <png.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/base/sources.h"
#include "render/display.h"
#include "render/png.h"
#include "render/video.h"
#include "scene/looks/eyes.h"
#include "scene/looks/hand_mesh.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "tests/bench/mujoco_pictures.h"
#include "tests/bench/report.h"
#include "tests/support/folder.h"

// What a stereo frame of the bundled throw costs in each look, beside MuJoCo's of a like room; how
// near it comes to one of very many samples; what it costs to keep it. All in processor time on one
// core, in turn.
namespace {

using namespace headpin;

constexpr std::array<std::int64_t, 9> kFrames{60, 120, 200, 252, 270, 300, 320, 340, 400};

/// The bundled throw at those frames.
struct Throw {
  std::shared_ptr<const scene::Stage> stage;
  std::vector<scene::Glimpse> at;

  Throw() {
    const scene::Trial trial = scene::read_trial(HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog");
    scene::Session session =
        scene::make_session(scene::scenario_of_trial(trial.header.scenario, "demo.lcmlog"));
    stage = session.stage;
    devices::ReplaySource source(trial.samples);
    for (const std::int64_t frame : kFrames) {
      while (session.tick < 4 * frame) scene::advance(session, source);
      at.push_back(scene::glimpse(session, scene::head_pose(session).value()));
    }
  }
};

/// Draws them one after another.
struct Drawn {
  scene::Eyes eyes;
  const Throw& shown;
  std::array<render::Image, 2> images;

  Drawn(const Throw& a_throw, const render::Quality& look)
      : eyes(scene::open_eyes(*a_throw.stage, look, "osmesa")), shown(a_throw) {}
  /// A turn: all frames, one after another, as a session draws them.
  double draw() {
    double sum = 0.0;
    for (std::size_t i = 0; i < kFrames.size(); ++i) sum += draw(i);
    return sum;
  }
  double draw(std::size_t i) {
    scene::see(eyes, shown.at[i], images);
    return images[0].rgb[0];
  }
  double labels() {
    double sum = 0.0;
    for (const scene::Glimpse& g : shown.at) sum += scene::see_labels(eyes, g)[0].id[0];
    return sum;
  }
  double nothing() {
    for (std::size_t i = 0; i < kFrames.size(); ++i) {
      eyes.renderer.draw({}, render::eyes({}, eyes.optics), images);
    }
    return images[0].rgb[0];
  }
};

double cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Median processor time of each contestant, run in turn, `frames` a turn [ms a frame].
std::vector<double> processor_ms(const std::vector<bench::Contestant>& contestants, int rounds,
                                 std::size_t frames) {
  std::vector<std::vector<double>> times(contestants.size());
  for (int round = -1; round < rounds; ++round) {  // the first compiles shaders
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      const double start = cpu_s();
      bench::sink = bench::sink + contestants[i].run();
      if (round >= 0) times[i].push_back(1e3 * (cpu_s() - start) / static_cast<double>(frames));
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& t : times) medians.push_back(bench::median(t));
  return medians;
}

/// libpng with its own settings: level 6, every filter tried.
double encode_by_default(const render::Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::uint8_t> bytes(size);
  png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr);
  return static_cast<double>(size);
}

bench::MujocoPictures::Scene like_the_throw(const Throw& a_throw) {
  const scene::Scenario& scenario = a_throw.stage->scenario;
  const scene::Glimpse& g = a_throw.at[5];  // the ball is on its way
  return {.skittle = scene::skittle_mesh(scene::smooth_outline(scenario.skittle.profile),
                                         a_throw.stage->skittle_centre, 13, 12),
          .hand = scene::hand_mesh(scenario.hand.grip, scenario.ball.radius, 0.0),
          .X_WB_skittles = g.X_WB_skittles,
          .X_WB_ball = g.X_WB_balls[0],
          .X_WH = *g.X_WH,
          .ball_radius = scenario.ball.radius,
          .X_WD = g.X_WD};
}

/// Peak signal to noise [dB] of all pictures against those of 8 x 8 pixels for each, and of what is
/// within two pixels of a skittle.
std::array<double, 2> quality_dB(const Throw& a_throw, const render::Quality& look) {
  Drawn shown(a_throw, look);
  render::Quality one = look;
  one.samples = 1;
  Drawn fine(a_throw, one);
  const render::Optics optics = shown.eyes.optics;
  fine.eyes.optics.width *= 8;
  fine.eyes.optics.height *= 8;
  std::array<double, 2> squares{}, count{};
  for (std::size_t i = 0; i < kFrames.size(); ++i) {
    shown.draw(i);
    fine.draw(i);
    const auto labels = scene::see_labels(shown.eyes, a_throw.at[i]);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const render::Image best =
          render::area_filtered(fine.images[eye], optics.width, optics.height);
      const auto near_skittle = [&](int x, int y) {
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) {
            const int u = x + dx, v = y + dy;
            if (u < 0 || v < 0 || u >= optics.width || v >= optics.height) continue;
            if (labels[eye].id[static_cast<std::size_t>(v * optics.width + u)] >=
                scene::kFirstSkittleId) {
              return true;
            }
          }
        }
        return false;
      };
      for (int y = 0; y < optics.height; ++y) {
        for (int x = 0; x < optics.width; ++x) {
          double off = 0.0;
          for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(3 * (y * optics.width + x) + c);
            off += std::pow(int{shown.images[eye].rgb[k]} - int{best.rgb[k]}, 2);
          }
          for (std::size_t part = 0; part < (near_skittle(x, y) ? 2u : 1u); ++part) {
            squares[part] += off;
            count[part] += 3.0;
          }
        }
      }
    }
  }
  return {10.0 * std::log10(255.0 * 255.0 * count[0] / squares[0]),
          10.0 * std::log10(255.0 * 255.0 * count[1] / squares[1])};
}

/// Most memory that this process had at once. Of a child, wait4 tells no less than its parent had
/// when it was made.
double most_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1024.0;
  }
  throw std::runtime_error("/proc/self/status: no VmHWM");
}

pid_t start_drawing(int frames, int core, const char* shader_cache) {
  const pid_t child = fork();
  if (child != 0) return child;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  sched_setaffinity(0, sizeof set, &set);
  setenv("MESA_SHADER_CACHE_DIR", shader_cache, 1);
  execl("/proc/self/exe", "render_bench", "--draw", std::to_string(frames).c_str(), nullptr);
  _exit(127);
}

/// Processor time [s] of a process that draws so many frames of the standard look.
double finished(pid_t child) {
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (status != 0) throw std::runtime_error("a process that draws has failed");
  const auto s = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return s(usage.ru_utime) + s(usage.ru_stime);
}

/// Processor time of ffmpeg for so many stereo frames, of which there are enough to hide its start.
double video_ms(Drawn& drawn, bool copy) {
  constexpr int kCount = 180;
  std::vector<render::Image> pictures;
  for (std::size_t i = 0; i < kFrames.size(); ++i) {
    drawn.draw(i);
    pictures.push_back(render::side_by_side(drawn.images[0], drawn.images[1]));
  }
  const auto children_s = [] {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  };
  const double start = children_s() + cpu_s();
  const std::string path = fmt::format("out/bench/render.{}.mkv", getpid());
  render::VideoWriter video(render::open_video(path, {.overwrite = true}, copy), pictures[0].width,
                            pictures[0].height, 60, 1.405);
  for (int i = 0; i < kCount; ++i) video.add(pictures[static_cast<std::size_t>(i) / 20]);
  video.close();
  std::filesystem::remove(path);
  if (copy) std::filesystem::remove(std::filesystem::path(path).replace_extension(".mp4"));
  return 1e3 * (children_s() + cpu_s() - start) / kCount;
}

void add_looks_and_peer(const Throw& a_throw, std::vector<bench::Row>& rows, double& standard_ms) {
  Drawn standard(a_throw, {}), fast(a_throw, render::looks()[1].quality),
      old(a_throw, render::looks()[2].quality);
  Drawn no_mirror(a_throw, {.mirror = false}), no_shadow(a_throw, {.shadow = false}),
      no_contact(a_throw, {.contact = false}), one(a_throw, {.samples = 1}),
      three(a_throw, {.samples = 3});
  render::Quality plainest = render::looks()[2].quality;  // light at vertices, nothing else
  plainest.samples = 2;
  Drawn least(a_throw, plainest);
  bench::MujocoPictures plain(like_the_throw(a_throw), 0), fine(like_the_throw(a_throw), 4);
  fmt::print("{}\n", standard.eyes.renderer.description());
  const std::vector<double> s =
      processor_ms({{"standard", [&] { return standard.draw(); }},
                    {"fast", [&] { return fast.draw(); }},
                    {"1997", [&] { return old.draw(); }},
                    {"nothing, one sample", [&] { return one.nothing(); }},
                    {"flat, ids and depth", [&] { return one.labels(); }},
                    {"standard of one sample", [&] { return one.draw(); }},
                    {"standard of ten samples", [&] { return three.draw(); }},
                    {"standard without mirror", [&] { return no_mirror.draw(); }},
                    {"standard without shadows", [&] { return no_shadow.draw(); }},
                    {"standard without contact shadows", [&] { return no_contact.draw(); }},
                    {"1997 with the standard's samples", [&] { return least.draw(); }},
                    {"MuJoCo, shadow, MSAA 4x", [&] { return fine.draw(kFrames.size()); }},
                    {"MuJoCo, shadow, no AA", [&] { return plain.draw(kFrames.size()); }}},
                   7, kFrames.size());
  standard_ms = s[0];
  rows.push_back({"standard look", "CPU ms", s[0], "MuJoCo, shadow, MSAA 4x", s[11]});
  rows.push_back({"1997 look, five samples", "CPU ms", s[10], "MuJoCo, shadow, MSAA 4x", s[11]});
  rows.push_back({"fast look", "CPU ms", s[1], "MuJoCo, shadow, no AA", s[12]});
  rows.push_back({"1997 look", "CPU ms", s[2], "MuJoCo, shadow, no AA", s[12]});
  const std::array<const char*, 8> names{
      "1997 look",   "nothing, one sample", "flat, ids and depth", "one sample",
      "ten samples", "without mirror",      "without shadows",     "without contact shadows"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    rows.push_back({"standard look", "CPU ms", s[0], names[i], s[i + 2]});
  }
}

void add_outputs(const Throw& a_throw, double standard_ms, std::vector<bench::Row>& rows) {
  Drawn standard(a_throw, {});
  const double lossless = video_ms(standard, false), both = video_ms(standard, true);
  rows.push_back({"lossless video", "CPU ms", lossless, "standard look", standard_ms});
  rows.push_back({"its copy as .mp4", "CPU ms", both - lossless, "standard look", standard_ms});
  standard.draw(5);
  const render::Image& image = standard.images[0];
  const std::vector<double> png =
      processor_ms({{"ours", [&] { return static_cast<double>(render::encode_png(image).size()); }},
                    {"default", [&] { return encode_by_default(image); }}},
                   15, 1);
  rows.push_back({"PNG of one eye", "CPU ms", png[0], "libpng's defaults", png[1]});
  rows.push_back({"PNG of one eye", "byte", static_cast<double>(render::encode_png(image).size()),
                  "libpng's defaults", encode_by_default(image)});
}

void add_processes(std::vector<bench::Row>& rows) {
  const std::string cache = fresh_folder("cache");
  const double empty = finished(start_drawing(0, 0, cache.c_str()));
  const double cold = finished(start_drawing(1, 0, cache.c_str()));
  double megabytes = 0.0;
  std::ifstream(cache + "/megabytes") >> megabytes;
  const double warm = finished(start_drawing(1, 0, cache.c_str()));
  rows.push_back({"first frame, cold", "CPU s", cold - empty, "goal", 0.8});
  rows.push_back({"first frame, warm", "CPU s", warm - empty, "goal", 0.4});
  rows.push_back({"memory with one renderer", "MB", megabytes, "goal", 150.0});
  double alone = 0.0, together = 0.0;
  for (int round = 0; round < 3; ++round) {
    alone += 2.0 * finished(start_drawing(200, 0, cache.c_str()));
    const pid_t a = start_drawing(200, 0, cache.c_str()), b = start_drawing(200, 1, cache.c_str());
    together += finished(a) + finished(b);
  }
  std::filesystem::remove_all(cache);
  rows.push_back({"two processes at once", "CPU s", together, "one after another", alone});
}

}  // namespace

int main(int argc, char** argv) {
  const Throw a_throw;
  if (argc == 3 && std::string(argv[1]) == "--draw") {
    const int count = std::atoi(argv[2]);
    if (count == 0) return 0;
    Drawn drawn(a_throw, {});
    for (int i = 0; i < count; ++i) {
      bench::sink = drawn.draw(static_cast<std::size_t>(i) % kFrames.size());
    }
    std::ofstream(std::string(std::getenv("MESA_SHADER_CACHE_DIR")) + "/megabytes")
        << most_megabytes();
    return 0;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(0, &one);
  sched_setaffinity(0, sizeof one, &one);  // Mesa then draws in the thread that asks
  std::filesystem::create_directories("out/bench");
  std::vector<bench::Row> rows;
  double standard_ms = 0.0;
  add_looks_and_peer(a_throw, rows, standard_ms);
  add_outputs(a_throw, standard_ms, rows);
  add_processes(rows);
  for (const render::Look& look : {render::looks()[0], render::looks()[1]}) {
    const auto [whole_dB, skittles_dB] = quality_dB(a_throw, look.quality);
    rows.push_back({fmt::format("{} look against 8 x 8", look.name), "dB", whole_dB,
                    "goal of the standard", 42.0});
    rows.push_back({fmt::format("{} look, skittles", look.name), "dB", skittles_dB,
                    "goal of the standard", 30.0});
  }
  bench::publish("render", rows);
}
