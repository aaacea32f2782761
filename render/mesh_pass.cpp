#include "render/mesh_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "render/gl_objects.h"

namespace headpin::render {
namespace {

constexpr double kEndless = 1e6;  // farther than all objects [m]
constexpr std::array<const char*, DrawList::kLamps> kLampPlace{
    "lamp_p[0]", "lamp_p[1]", "lamp_p[2]", "lamp_p[3]",
    "lamp_p[4]", "lamp_p[5]", "lamp_p[6]", "lamp_p[7]"};
constexpr std::array<const char*, DrawList::kLamps> kLampPower{
    "lamp_power[0]", "lamp_power[1]", "lamp_power[2]", "lamp_power[3]",
    "lamp_power[4]", "lamp_power[5]", "lamp_power[6]", "lamp_power[7]"};

/// @param taken  share of the light, or of its sRGB code, that shadows take
void set_shadow(const Program& program, const EyeScene& scene, double taken) {
  program.set("shadow_view", scene.shadow->view);
  program.set("shadow_map", 0);
  program.set("shadow_depth", taken);
}

}  // namespace

MeshPass::MeshPass(const Gl& gl, const Meshes& meshes, const Quality& quality)
    : gl_(gl),
      meshes_(meshes),
      quality_(quality),
      baked_(mesh_program(gl, {.early = true}, shaders::kBakedFragment)),
      floor_(mesh_program(gl, {.shadow = true, .mirror = true}, shaders::kFloorFragment)),
      polished_(mesh_program(gl, {.mirror = true}, shaders::kFloorFragment)),
      shadowed_(mesh_program(gl, {.early = true, .shadow = true}, shaders::kFloorFragment)),
      mirrored_(mesh_program(gl, {}, shaders::kBakedFragment)) {}

void MeshPass::prepare(std::size_t lamps) {
  if (lit_ && lit_->count == static_cast<int>(lamps)) return;
  lit_ = std::make_unique<LitPrograms>(gl_, quality_, lamps);
}

/// The cheapest program that draws a mesh: floors without shadow or reflections do not compute them.
const Program& MeshPass::program_of(const Kept& mesh, bool shaded, bool in_mirror) const {
  switch (mesh.surface) {
    case Surface::lit:
      if (in_mirror) return lit_->mirrored;
      return mesh.fine_light && quality_.light == LightPer::pixel ? lit_->fine : lit_->coarse;
    case Surface::floor:
      return mirrors(mesh) ? shaded ? floor_ : polished_ : shaded ? shadowed_ : baked_;
    case Surface::baked:
      return in_mirror ? mirrored_ : baked_;
  }
  throw std::logic_error("this surface has no program");
}

void MeshPass::set_light(const Kept& mesh, const Program& program, const EyeScene& scene,
                         bool shaded) const {
  const DrawList& list = *scene.list;
  switch (mesh.surface) {
    case Surface::baked:
      return;
    case Surface::floor:
      if (mirrors(mesh)) {
        program.set("eye_W", scene.eye_W);
        program.set("gloss", mesh.gloss);
        program.set("mirrored", MirrorImage::kUnit);
        program.set("picture_u", scene.picture_u);
        program.set("picture_v", scene.picture_v);
      }
      // Without reflections, the colour is already an sRGB code, and shadows reduce the code.
      if (shaded) {
        const double taken = list.shadow.depth;
        set_shadow(program, scene, mirrors(mesh) ? taken : 1.0 - std::pow(1.0 - taken, 1.0 / 2.2));
      }
      return;
    case Surface::lit:
      program.set("eye_W", scene.eye_W);
      program.set("sky", list.sky);
      program.set("ground", list.ground);
      program.set("gloss", mesh.gloss);
      for (std::size_t i = 0; i < list.lamps.size(); ++i) {
        program.set(kLampPlace[i], list.lamps[i].p_W);
        program.set(kLampPower[i], list.lamps[i].power);
      }
      if (quality_.shadow) {
        set_shadow(program, scene, list.shadow.depth);
        program.set("shadow_n", list.shadow.n_W);
      }
      return;
  }
}

void MeshPass::draw(const EyeScene& scene, Surface surface) const {
  const DrawList& list = *scene.list;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Kept& mesh =
        scene.in_mirror ? meshes_[faint_mesh(item)] : meshes_.seen(item, (*scene.sizes)[i]);
    if (mesh.surface != surface || (scene.in_mirror && !item.mirrored)) continue;
    const Mat4 mesh_to_world = matrix(item.X_WG, item.scale);
    const Mat4 mesh_to_clip = scene.world_to_clip * mesh_to_world;
    if (is_outside(mesh.box, mesh_to_clip)) continue;
    const auto draw = [&](bool shaded, const auto& wanted) {
      const Program& program = program_of(mesh, shaded, scene.in_mirror);
      program.use();
      set_light(mesh, program, scene, shaded);
      program.set("lowest_z", scene.in_mirror ? list.mirror_z : -kEndless);
      program.set("to_clip", mesh_to_clip);
      program.set("grid_x", scene.grid_x);
      program.set("grid_y", scene.grid_y);
      program.set("edge", scene.edge);
      program.set("world", mesh_to_world);
      program.set("turn", matrix({item.X_WG.q, Vec3::Zero()}, item.scale.cwiseInverse()));
      program.set("tint", item.tint);
      meshes_.draw(mesh, mesh_to_clip, wanted);
    };
    // Reading the shadow map costs more than the rest of a floor, so it is done only where needed.
    const Mat4 mesh_to_map = scene.shadow->view * mesh_to_world;
    const auto in_shade = [&](const MeshPart& part) {
      const Eigen::AlignedBox2d box = across(part.box, mesh_to_map);
      return std::ranges::any_of(scene.shadow->shades,
                                 [&](const auto& shade) { return shade.intersects(box); });
    };
    const bool floor_in_shade = surface == Surface::floor && takes_shadow(mesh) &&
                                std::ranges::any_of(mesh.parts, in_shade);
    if (!floor_in_shade) {
      draw(false, [](const MeshPart&) { return true; });
      continue;
    }
    draw(true, in_shade);
    draw(false, [&](const MeshPart& part) { return !in_shade(part); });
  }
}

}  // namespace headpin::render
