#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "render/renderer_impl.h"

// Draws the items of a draw list by surface, with light, shadows, reflections and contact shadows.
namespace headpin::render {
namespace {

constexpr double kEndless = 1e6;  // farther than all objects [m]
constexpr std::array<const char*, DrawList::kLamps> kLampPlace{
    "lamp_p[0]", "lamp_p[1]", "lamp_p[2]", "lamp_p[3]",
    "lamp_p[4]", "lamp_p[5]", "lamp_p[6]", "lamp_p[7]"};
constexpr std::array<const char*, DrawList::kLamps> kLampPower{
    "lamp_power[0]", "lamp_power[1]", "lamp_power[2]", "lamp_power[3]",
    "lamp_power[4]", "lamp_power[5]", "lamp_power[6]", "lamp_power[7]"};

}  // namespace

std::vector<double> Renderer::Impl::sizes_seen(const DrawList& list,
                                               std::span<const View> views) const {
  Vec3 between = Vec3::Zero();
  for (const View& view : views) between += view.X_WE.p / static_cast<double>(views.size());
  const View& view = views.front();
  std::vector<double> sizes;
  for (const DrawItem& item : list.items) {
    const Eigen::AlignedBox3d& box = kept(item.mesh).box;
    const double size = box.sizes().cwiseProduct(item.scale).norm() * view.height /
                        (view.frustum.top - view.frustum.bottom);
    const double away = (item.X_WG * box.center().cwiseProduct(item.scale) - between).norm();
    sizes.push_back(size / away);
  }
  return sizes;
}

void Renderer::Impl::draw_depth(const DrawList& list, const Mat4& view) const {
  shadow_map->use();
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.CullFace(GL_FRONT);
  depth.use();
  for (const DrawItem& item : list.items) {
    if (!item.casts_shadow) continue;
    const Mat4 mesh_to_clip = view * matrix(item.X_WG, item.scale);
    depth.set("to_clip", mesh_to_clip);
    draw_elements(kept(faint_mesh(item)), mesh_to_clip);
  }
  gl.CullFace(GL_BACK);
}

std::vector<Eigen::AlignedBox2d> Renderer::Impl::shades_of(const DrawList& list,
                                                           const Mat4& shadow_view) const {
  std::vector<Eigen::AlignedBox2d> shades;
  if (!quality.shadow || list.shadow.depth <= 0.0) return shades;
  const Vec2 wide(2.0 / shadow_map->width(), 2.0 / shadow_map->height());
  for (const DrawItem& item : list.items) {
    if (!item.casts_shadow) continue;
    const Eigen::AlignedBox2d box =
        across(kept(faint_mesh(item)).box, shadow_view * matrix(item.X_WG, item.scale));
    shades.emplace_back(box.min() - wide, box.max() + wide);
  }
  return shades;
}

const Program& Renderer::Impl::program_of(const Kept& mesh, bool shaded, bool in_mirror) const {
  switch (mesh.surface) {
    case Surface::lit:
      if (in_mirror) return lit->mirrored;
      return mesh.fine_light && quality.light == LightPer::pixel ? lit->fine : lit->coarse;
    case Surface::floor:
      return mirrors(mesh) ? shaded ? floor : polished : shaded ? shadowed : baked;
    case Surface::baked:
      return in_mirror ? mirrored : baked;
  }
  throw std::logic_error("this surface has no program");
}

void Renderer::Impl::set_shadow(const Program& program, const Scene& scene, double taken) {
  program.set("shadow_view", scene.shadow_view);
  program.set("shadow_map", 0);
  program.set("shadow_depth", taken);
}

void Renderer::Impl::set_light(const Kept& mesh, const Program& program, const Scene& scene,
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
      if (quality.shadow) {
        set_shadow(program, scene, list.shadow.depth);
        program.set("shadow_n", list.shadow.n_W);
      }
      return;
  }
}

void Renderer::Impl::draw_items(const Scene& scene, Surface surface) const {
  const DrawList& list = *scene.list;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Kept& mesh = scene.in_mirror ? kept(faint_mesh(item)) : seen_mesh(item, scene.sizes[i]);
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
      draw_elements(mesh, mesh_to_clip, wanted);
    };
    // Reading the shadow map costs more than the rest of a floor, so it is done only where needed.
    const Mat4 mesh_to_map = scene.shadow_view * mesh_to_world;
    const auto in_shade = [&](const MeshPart& part) {
      const Eigen::AlignedBox2d box = across(part.box, mesh_to_map);
      return std::ranges::any_of(scene.shades,
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

void Renderer::Impl::draw_surface(const Scene& scene, Surface surface, GLsizei contacts) const {
  switch (surface) {
    case Surface::lit:
    case Surface::baked:
      return draw_items(scene, surface);
    case Surface::floor:
      draw_items(scene, surface);
      return draw_contact(contacts, scene);
  }
}

void Renderer::Impl::draw_mirrored(Scene scene, const View& view,
                                   std::unique_ptr<MirrorImage>& image) const {
  if (!image || !image->fits(view.width, view.height)) {
    image = std::make_unique<MirrorImage>(gl, view.width, view.height);
  }
  image->use();
  cut_picture(false);
  clear(scene.list->background);
  const Mat4 mirror = mirrored_at(scene.list->mirror_z);
  scene.eye_W = (mirror * scene.eye_W.homogeneous()).head<3>();
  scene.world_to_clip = scene.world_to_clip * mirror;
  scene.in_mirror = true;
  gl.FrontFace(GL_CW);
  gl.Enable(GL_CLIP_DISTANCE0);
  draw_items(scene, Surface::lit);
  draw_items(scene, Surface::baked);
  gl.Disable(GL_CLIP_DISTANCE0);
  gl.FrontFace(GL_CCW);
  image->bind();
}

void Renderer::Impl::draw_contact(GLsizei count, const Scene& scene) const {
  if (count == 0) return;
  contact.use();
  contact.set("view", scene.world_to_clip);
  contact.set("grid_x", scene.grid_x);
  contact.set("grid_y", scene.grid_y);
  contact.set("edge", scene.edge);
  contact.set("faint", kFaint);
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ZERO, GL_SRC_COLOR);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(-1.0F, -4.0F);
  gl.DepthMask(GL_FALSE);
  gl.BindVertexArray(contact_arrays);
  gl.DrawArrays(GL_TRIANGLES, 0, count);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_POLYGON_OFFSET_FILL);
  gl.Disable(GL_BLEND);
}

}  // namespace headpin::render
