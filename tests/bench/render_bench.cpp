#include <array>
#include <ctime>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "scene/looks.h"
#include "tests/bench/report.h"

// What a stereo frame of the paper's room costs, with and without each effect, and what it costs to
// keep it. Ten standing skittles, the ball on the lane, the hand before the eyes.
namespace {

using namespace headpin;

struct Room {
  scene::Stage stage = scene::make_stage({});
  render::Renderer renderer;
  scene::Looks looks;
  std::vector<Pose> skittles, balls{{Quat::Identity(), Vec3(0.1, 2.5, 0.1085)}};
  std::array<render::Image, 2> images;

  explicit Room(render::Quality quality)
      : renderer(render::osmesa_context(), quality), looks(renderer, stage) {
    for (const engine::BodyId skittle : stage.skittles) {
      skittles.push_back(stage.world.states[skittle].X_WB);
    }
  }

  double draw() {
    const Quat ahead = rotation(Vec3(0.5 * std::numbers::pi, 0, 0));
    const scene::Moving moving{.X_WB_skittles = skittles,
                               .skittle_centre = stage.skittle_centre,
                               .X_WB_balls = balls,
                               .X_WH = Pose{ahead, Vec3(0.2, 0.0, 1.4)},
                               .grips = false};
    const Pose X_WD{ahead * rotation(Vec3(-0.15, 0, 0)), Vec3(0, -0.5, 1.65)};
    renderer.draw(scene::draw_list(looks, moving), render::eyes(X_WD, {}), images);
    return images[0].rgb[0];
  }
};

/// Median processor time of each contestant, run in turn [ms]. Drawing is the processor's work, in
/// as many threads as there are cores, so that wall time tells more of the machine's other work.
std::vector<double> processor_ms(const std::vector<bench::Contestant>& contestants, int rounds) {
  std::vector<std::vector<double>> times(contestants.size());
  for (int round = -1; round < rounds; ++round) {  // the first compiles shaders
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      const std::clock_t start = std::clock();
      bench::sink = bench::sink + contestants[i].run();
      const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      if (round >= 0) times[i].push_back(ms);
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

}  // namespace

int main() {
  Room standard({}), single({.samples = 1}), no_mirror({.mirror = false}),
      no_shadow({.shadow = false}), no_contact({.contact = false}), triple({.samples = 3});
  fmt::print("{}\n", standard.renderer.description());
  const std::vector<double> s =
      processor_ms({{"standard", [&] { return standard.draw(); }},
                    {"one sample", [&] { return single.draw(); }},
                    {"3 x 3 samples", [&] { return triple.draw(); }},
                    {"without mirror", [&] { return no_mirror.draw(); }},
                    {"without shadow", [&] { return no_shadow.draw(); }},
                    {"without contact shadows", [&] { return no_contact.draw(); }}},
                   21);
  const std::array<const char*, 6> names{"",
                                         "one sample a pixel",
                                         "3 x 3 samples a pixel",
                                         "without mirror",
                                         "without shadow",
                                         "without contact shadows"};
  std::vector<bench::Row> rows;
  for (std::size_t i = 1; i < s.size(); ++i) {
    rows.push_back({"stereo frame, 2 x 2 samples", "CPU ms", s[0], names[i], s[i]});
  }

  const render::Image& image = standard.images[0];
  const std::vector<double> png =
      processor_ms({{"ours", [&] { return static_cast<double>(render::encode_png(image).size()); }},
                    {"default", [&] { return encode_by_default(image); }}},
                   11);
  rows.push_back({"PNG of one eye", "CPU ms", png[0], "libpng's defaults", png[1]});
  rows.push_back({"PNG of one eye", "byte", static_cast<double>(render::encode_png(image).size()),
                  "libpng's defaults", encode_by_default(image)});
  bench::publish("render", rows);
}
