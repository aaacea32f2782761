#include "render/fingerprint.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>
#include <string_view>

#include <unistd.h>

namespace headpin::render {

namespace {

std::vector<std::string> processor_features() {
  std::vector<std::string> names;
#if defined(__x86_64__) || defined(__i386__)
  __builtin_cpu_init();
  const auto add = [&](bool there, const char* name) {
    if (there) names.emplace_back(name);
  };
  add(__builtin_cpu_supports("sse2") != 0, "sse2");
  add(__builtin_cpu_supports("ssse3") != 0, "ssse3");
  add(__builtin_cpu_supports("sse4.1") != 0, "sse4.1");
  add(__builtin_cpu_supports("avx") != 0, "avx");
  add(__builtin_cpu_supports("avx2") != 0, "avx2");
  add(__builtin_cpu_supports("fma") != 0, "fma");
  add(__builtin_cpu_supports("avx512f") != 0, "avx512f");
#elif defined(__aarch64__)
  names.emplace_back("neon");
#endif
  // Mesa does not use features above the given level.
  const char* level = std::getenv("GALLIUM_OVERRIDE_CPU_CAPS");
  const auto last = level ? std::ranges::find(names, level) : names.end();
  if (last != names.end()) names.erase(last + 1, names.end());
  return names;
}

std::vector<std::string> environment_of_mesa() {
  std::vector<std::string> found;
  for (char** one = environ; one != nullptr && *one != nullptr; ++one) {
    const std::string_view text = *one;
    for (const std::string_view start : {"LP_", "GALLIUM_", "MESA_", "LIBGL_", "ST_DEBUG"}) {
      if (text.starts_with(start)) found.emplace_back(text);
    }
  }
  std::ranges::sort(found);
  return found;
}

std::string in_a_row(const std::vector<std::string>& words) {
  std::string row;
  for (const std::string& word : words) row += (row.empty() ? "" : " ") + word;
  return row.empty() ? "nothing" : row;
}

/// A floor of 2 m, with small and large triangles and a gradient of colours.
Mesh test_floor() {
  Mesh floor;
  floor.surface = Surface::floor;
  floor.gloss = 0.2;
  for (int i = 0; i < 4; ++i) {
    const double x = -1.0 + 0.5 * i;
    append_face(floor, {x, 0.0, 0.0}, {x + 0.5, 0.0, 0.0}, {x + 0.5, 2.0, 0.0}, {x, 2.0, 0.0},
                Vec3(0.35 + 0.1 * i, 0.3, 0.5 - 0.1 * i));
  }
  return floor;
}

/// A wall behind the floor that emits light, from dark to bright.
Mesh test_wall() {
  Mesh wall;
  wall.surface = Surface::baked;
  for (int i = 0; i < 8; ++i) {
    const double x = -2.0 + 0.5 * i, y = 2.0 - 0.2 * (i % 2);
    append_face(wall, {x, y, 0.0}, {x + 0.5, 2.2 - 0.2 * (i % 2), 0.0},
                {x + 0.5, 2.2 - 0.2 * (i % 2), 1.6}, {x, y, 1.6}, Vec3::Ones());
  }
  for (Vertex& v : wall.vertices) {
    v.colour = Eigen::Vector3f(0.02F + 0.2F * (v.p.x() + 2.0F), 0.11F + 0.3F * v.p.z(),
                               0.05F + 0.5F * v.p.z());
  }
  return wall;
}

DrawItem standing(int mesh, const Vec3& p_W, const Vec3& scale = Vec3::Ones()) {
  DrawItem item;
  item.mesh = mesh;
  item.X_WG = {rotation(Vec3(0.3, 0.2, 0.5)), p_W};
  item.scale = scale;
  item.casts_shadow = true;
  item.mirrored = true;
  return item;
}

}  // namespace

Image test_picture(Renderer& renderer) {
  Mesh body = ellipsoid(0.1, 0.16, 24, 16, [](double z) {
    return z > 0.05 ? Vec3(0.8, 0.1, 0.1) : Vec3(0.75, 0.73, 0.6);
  });
  body.gloss = 0.5;
  DrawList list;
  DrawItem floor;
  floor.mesh = renderer.add(test_floor());
  list.items.push_back(floor);
  DrawItem wall;
  wall.mesh = renderer.add(test_wall());
  list.items.push_back(wall);
  const int mesh = renderer.add(body);
  for (int i = 0; i < 6; ++i) {  // a row of small objects
    list.items.push_back(standing(mesh, {-0.75 + 0.3 * i, 1.75, 0.12}, {0.4, 0.4, 0.7}));
  }
  list.items.push_back(standing(mesh, {-0.25, 0.7, 0.2}));
  list.items.push_back(standing(mesh, {0.3, 1.5, 0.12}, {0.6, 0.6, 0.8}));
  list.items.push_back(standing(mesh, {0.05, 1.1, 0.3}, {0.1, 0.1, 2.0}));
  list.lamps = {{Vec3(-0.5, 0.5, 1.8), Vec3::Constant(0.9)},
                {Vec3(0.8, 1.6, 1.5), Vec3(0.5, 0.45, 0.4)}};
  list.background = Vec3(0.05, 0.06, 0.1);
  list.occluders = {{Vec3(-0.25, 0.7, 0.2), 0.12}, {Vec3(0.3, 1.5, 0.12), 0.08}};
  list.patches = {{Vec3(-1.0, 0.0, 0.0), Vec3(2.0, 0.0, 0.0), Vec3(0.0, 2.0, 0.0)}};
  list.shadow = {Vec3(0.3, -0.4, 1.0).normalized(), Vec3(-1.0, 0.0, 0.0), Vec3(1.0, 2.0, 0.6), 0.4};
  View view;
  view.X_WE = {rotation(Vec3(0.42 * std::numbers::pi, 0.0, 0.0)), Vec3(0.02, -0.3, 0.6)};
  view.frustum = {-0.7, 0.7, -0.5, 0.4, 0.05, 40.0};
  // The same number of samples in any quality. It is enough: in a fast look, SSE4.1 and AVX differ
  // in one of 86,400 samples.
  view.width = 1152 / renderer.quality().samples;
  view.height = 768 / renderer.quality().samples;
  Image image;
  renderer.draw(list, {&view, 1}, {&image, 1});
  return image;
}

Fingerprint fingerprint(Renderer& renderer) {
  return {renderer.description(), processor_features(), environment_of_mesa(),
          pixel_hash(test_picture(renderer))};
}

std::string difference(const Fingerprint& then, const Fingerprint& now) {
  std::string says;
  const auto compare = [&](const char* what, const std::string& a, const std::string& b) {
    if (a == b) return;
    says += std::string(says.empty() ? "" : "; ") + what + " " + a + ", here " + b;
  };
  compare("drawn by", then.renderer, now.renderer);
  compare("on a processor with", in_a_row(then.processor), in_a_row(now.processor));
  compare("in an environment of", in_a_row(then.environment), in_a_row(now.environment));
  if (says.empty() && then.picture != now.picture) {
    says = "nothing that is told of it differs, its test picture does";
  }
  return says;
}

}  // namespace headpin::render
