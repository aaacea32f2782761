#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>

#include "render/contact_shadow.h"
#include "render/gl_functions.h"
#include "render/gl_objects.h"
#include "render/matrices.h"
#include "render/mesh_parts.h"
#include "render/renderer.h"
#include "render/sample_grid.h"
#include "render/shaders.h"

/// The inside of a Renderer, for its own .cpp files.
namespace headpin::render {

inline constexpr double kEndless = 1e6;  // farther than anything drawn [m]
inline constexpr std::array<const char*, DrawList::kLamps> kLampPlace{
    "lamp_p[0]", "lamp_p[1]", "lamp_p[2]", "lamp_p[3]",
    "lamp_p[4]", "lamp_p[5]", "lamp_p[6]", "lamp_p[7]"};
inline constexpr std::array<const char*, DrawList::kLamps> kLampPower{
    "lamp_power[0]", "lamp_power[1]", "lamp_power[2]", "lamp_power[3]",
    "lamp_power[4]", "lamp_power[5]", "lamp_power[6]", "lamp_power[7]"};

/// The surfaces in the order they are drawn; a mesh of another is refused when it is added.
inline constexpr std::array kTurns = {Surface::lit, Surface::floor, Surface::baked};

/// A mesh on the side of the context.
struct Kept {
  Surface surface;
  double gloss;
  bool takes_shadow;
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3d box;
  GLuint arrays = 0, vertices = 0, indices = 0;
};

inline constexpr double kNear = 48.0;  // pixels across: what is smaller is drawn by its far mesh

inline Gl current_functions(GlContext& context) {
  context.make_current();
  const Gl gl = load_functions(context);
  check_drawing(gl);
  return gl;
}

inline Program mesh_program(const Gl& gl, const shaders::Variant& variant, const char* fragment) {
  return {gl, shaders::vertex_shader(variant, shaders::kMeshVertex),
          shaders::shader(variant, fragment)};
}

/// Of bodies: the colour of their mesh is what they reflect, and becomes light here.
inline Program lit_program(const Gl& gl, const Quality& quality, std::size_t lamps) {
  const int count = static_cast<int>(lamps);
  return quality.light == "vertex"
             ? mesh_program(gl, {.early = true, .lamps = true, .count = count},
                            shaders::kBakedFragment)
             : mesh_program(gl, {.coded = true, .shadow = quality.shadow, .count = count},
                            shaders::kLitFragment);
}

/// What one eye looks at.
struct Scene {
  const DrawList* list;
  std::vector<int> meshes;  ///< of the items, as they are seen from there
  Mat4 world_to_clip;
  Mat4 shadow_view;  ///< world to the shadow map, 0..1
  Vec3 eye_W;
  Vec3 grid_x = Vec3::UnitX(), grid_y = Vec3::UnitY();  ///< clip space to that of the samples
  std::vector<Eigen::AlignedBox2d> shades;  ///< what items cover of the shadow map, 0..1
};

struct Renderer::Impl {
  Impl(std::unique_ptr<GlContext> with, Quality wanted)
      : context(std::move(with)), gl(current_functions(*context)), quality(wanted) {
    if (quality.light != "pixel" && quality.light != "vertex") {
      throw std::invalid_argument("light: " + quality.light + ", expected pixel or vertex");
    }
    if (quality.samples < 1 || quality.samples > 8) {
      throw std::invalid_argument("samples: " + std::to_string(quality.samples) +
                                  ", expected 1 to 8");
    }
    gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    gl.GenVertexArrays(1, &contact_arrays);
    gl.BindVertexArray(contact_arrays);
    gl.GenBuffers(1, &contact_buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, contact_buffer);
    attribute(0, 3, sizeof(ContactVertex), offsetof(ContactVertex, p));
    attribute(1, 3, sizeof(ContactVertex), offsetof(ContactVertex, n));
    attribute(2, 4, sizeof(ContactVertex), offsetof(ContactVertex, ball));
  }

  ~Impl() {
    context->make_current();
    for (const Kept& mesh : meshes) {
      gl.DeleteVertexArrays(1, &mesh.arrays);
      gl.DeleteBuffers(1, &mesh.vertices);
      gl.DeleteBuffers(1, &mesh.indices);
    }
    gl.DeleteVertexArrays(1, &contact_arrays);
    gl.DeleteBuffers(1, &contact_buffer);
  }

  void attribute(GLuint place, GLint numbers, std::size_t stride, std::size_t offset) const {
    gl.EnableVertexAttribArray(place);
    gl.VertexAttribPointer(place, numbers, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                           reinterpret_cast<const void*>(offset));  // NOLINT: as OpenGL has it
  }

  void check(const DrawList& list, const View& view) const {
    for (const DrawItem& item : list.items) {
      for (const int mesh : {item.mesh, item.far_mesh.value_or(item.mesh)}) {
        if (mesh >= 0 && static_cast<std::size_t>(mesh) < meshes.size()) continue;
        throw std::invalid_argument("draw list: mesh " + std::to_string(mesh) + " of " +
                                    std::to_string(meshes.size()));
      }
    }
    if (list.lamps.size() > DrawList::kLamps) {
      throw std::invalid_argument("draw list: " + std::to_string(list.lamps.size()) +
                                  " lamps, at most " + std::to_string(DrawList::kLamps));
    }
    const int most = largest / (quality.samples + grid.turn()) - 1;
    if (view.width < 1 || view.height < 1 || view.width > most || view.height > most) {
      throw std::invalid_argument("view: " + std::to_string(view.width) + "x" +
                                  std::to_string(view.height) + " pixels, expected 1 to " +
                                  std::to_string(most));
    }
  }

  const Kept& kept(int mesh) const { return meshes[static_cast<std::size_t>(mesh)]; }

  /// The wanted parts of a mesh that may be seen, in one call where they follow each other.
  template <typename Wanted>
  void draw_elements(const Kept& mesh, const Mat4& mesh_to_clip, const Wanted& wanted) const {
    gl.BindVertexArray(mesh.arrays);
    std::size_t first = 0, end = 0;
    const auto draw = [&] {
      if (end == first) return;
      gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(end - first), GL_UNSIGNED_INT,
                      reinterpret_cast<const void*>(first * sizeof(std::uint32_t)));  // NOLINT
    };
    for (const MeshPart& p : mesh.parts) {
      if (!wanted(p) || is_outside(p.box, mesh_to_clip)) continue;
      if (p.first != end) {
        draw();
        first = p.first;
      }
      end = p.first + p.count;
    }
    draw();
  }
  void draw_elements(const Kept& mesh, const Mat4& mesh_to_clip) const {
    draw_elements(mesh, mesh_to_clip, [](const MeshPart&) { return true; });
  }

  /// What items look like from there: decided once, so that both eyes see the same.
  std::vector<int> meshes_seen(const DrawList& list, std::span<const View> views) const {
    Vec3 between = Vec3::Zero();
    for (const View& view : views) between += view.X_WE.p / static_cast<double>(views.size());
    std::vector<int> seen;
    for (const DrawItem& item : list.items) {
      const Eigen::AlignedBox3d& box = kept(item.mesh).box;
      const View& view = views.front();
      const double size = box.sizes().cwiseProduct(item.scale).norm() * view.height /
                          (view.frustum.top - view.frustum.bottom);
      const double away = (item.X_WG * box.center().cwiseProduct(item.scale) - between).norm();
      seen.push_back(size < kNear * away ? item.far_mesh.value_or(item.mesh) : item.mesh);
    }
    return seen;
  }

  /// What lies behind each item, as the light sees it: so none shades its own lit side.
  void draw_depth(const DrawList& list, const Mat4& view) const {
    shadow_map.use();
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.CullFace(GL_FRONT);
    depth.use();
    for (const DrawItem& item : list.items) {
      if (!item.casts_shadow) continue;
      const Mat4 mesh_to_clip = view * matrix(item.X_WG, item.scale);
      depth.set("to_clip", mesh_to_clip);
      draw_elements(kept(item.far_mesh.value_or(item.mesh)), mesh_to_clip);
    }
    gl.CullFace(GL_BACK);
  }

  bool takes_shadow(const Kept& mesh) const { return quality.shadow && mesh.takes_shadow; }
  bool mirrors(const Kept& mesh) const { return quality.mirror && mesh.gloss > 0.0; }

  /// What casts a shadow covers of the map, and a little: a shadow's edge is as wide as texels.
  std::vector<Eigen::AlignedBox2d> shades_of(const DrawList& list, const Mat4& shadow_view) const {
    const Vec2 wide(2.0 / kShadowWidth, 2.0 / kShadowHeight);
    std::vector<Eigen::AlignedBox2d> shades;
    if (!quality.shadow || list.shadow.depth <= 0.0) return shades;
    for (const DrawItem& item : list.items) {
      if (!item.casts_shadow) continue;
      const Eigen::AlignedBox2d box = across(kept(item.far_mesh.value_or(item.mesh)).box,
                                             shadow_view * matrix(item.X_WG, item.scale));
      shades.emplace_back(box.min() - wide, box.max() + wide);
    }
    return shades;
  }

  /// The cheapest that draws a mesh: floors without shadow or polish do not ask for either.
  const Program& program_of(const Kept& mesh, bool shaded) const {
    switch (mesh.surface) {
      case Surface::lit:
        return *lit;  // by vertex or by pixel
      case Surface::floor:
        return mirrors(mesh) ? shaded ? floor : polished : shaded ? shadowed : baked;
      case Surface::baked:
        return baked;
    }
    throw std::logic_error("a surface without a program");
  }

  static void set_shadow(const Program& program, const Scene& scene) {
    program.set("shadow_view", scene.shadow_view);
    program.set("shadow_map", 0);
    program.set("shadow_depth", scene.list->shadow.depth);
  }

  /// What a surface's program asks for beside the items.
  void set_light(const Kept& mesh, const Program& program, const Scene& scene, bool shaded) const {
    const DrawList& list = *scene.list;
    switch (mesh.surface) {
      case Surface::baked:
        return;
      case Surface::floor:
        if (mirrors(mesh)) {
          program.set("eye_W", scene.eye_W);
          program.set("gloss", mesh.gloss);
        }
        if (shaded) set_shadow(program, scene);
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
          set_shadow(program, scene);
          program.set("shadow_n", list.shadow.n_W);
        }
        return;
    }
  }

  /// Draws the items of one surface, or of them only those that are mirrored.
  void draw_items(const Scene& scene, Surface surface, bool only_mirrored) const {
    const DrawList& list = *scene.list;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
      const DrawItem& item = list.items[i];
      const Kept& mesh =
          kept(only_mirrored ? item.far_mesh.value_or(scene.meshes[i]) : scene.meshes[i]);
      if (mesh.surface != surface || (only_mirrored && !item.mirrored)) continue;
      const Mat4 mesh_to_world = matrix(item.X_WG, item.scale);
      const Mat4 mesh_to_clip = scene.world_to_clip * mesh_to_world;
      if (is_outside(mesh.box, mesh_to_clip)) continue;
      const auto draw = [&](bool shaded, const auto& wanted) {
        const Program& program = program_of(mesh, shaded);
        program.use();
        set_light(mesh, program, scene, shaded);
        program.set("lowest_z", only_mirrored ? list.mirror_z : -kEndless);
        program.set("to_clip", mesh_to_clip);
        program.set("grid_x", scene.grid_x);
        program.set("grid_y", scene.grid_y);
        program.set("world", mesh_to_world);
        program.set("turn", matrix({item.X_WG.q, Vec3::Zero()}, item.scale.cwiseInverse()));
        program.set("tint", item.tint);
        if (surface == Surface::floor && mirrors(mesh)) {
          draw_over_mirrored([&] { draw_elements(mesh, mesh_to_clip, wanted); });
        } else {
          draw_elements(mesh, mesh_to_clip, wanted);
        }
      };
      // To look a shadow up costs more than all else of a floor: it is done where one may fall.
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

  /// Lets the mirror images shine through what is drawn: the target takes light then, not its code.
  template <typename Draw>
  void draw_over_mirrored(const Draw& draw) const {
    gl.Enable(GL_FRAMEBUFFER_SRGB);
    gl.Enable(GL_BLEND);
    draw();
    gl.Disable(GL_BLEND);
    gl.Disable(GL_FRAMEBUFFER_SRGB);
  }

  /// All items of one surface in their turn, and what follows them. A new surface has its turn here
  /// and in kTurns.
  void draw_surface(const Scene& scene, Surface surface, GLsizei contacts) const {
    switch (surface) {
      case Surface::lit:
      case Surface::baked:
        return draw_items(scene, surface, false);
      case Surface::floor:
        gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        draw_items(scene, surface, false);
        return draw_contact(contacts, scene);
    }
  }

  void draw_mirrored(Scene scene) const {
    const Mat4 mirror = mirrored_at(scene.list->mirror_z);
    scene.eye_W = (mirror * scene.eye_W.homogeneous()).head<3>();
    scene.world_to_clip = scene.world_to_clip * mirror;
    gl.FrontFace(GL_CW);
    gl.Enable(GL_CLIP_DISTANCE0);
    draw_items(scene, Surface::lit, true);
    draw_items(scene, Surface::baked, true);
    gl.Disable(GL_CLIP_DISTANCE0);
    gl.FrontFace(GL_CCW);
    gl.Clear(GL_DEPTH_BUFFER_BIT);  // the images stay, as colours behind the floor
  }

  void draw_contact(GLsizei count, const Scene& scene) const {
    if (count == 0) return;
    contact.use();
    contact.set("view", scene.world_to_clip);
    contact.set("grid_x", scene.grid_x);
    contact.set("grid_y", scene.grid_y);
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

  void make_lit_for(std::size_t lamps) {
    if (lit && lit_lamps == lamps) return;
    lit.reset(new Program(lit_program(gl, quality, lamps)));
    lit_lamps = lamps;
  }

  /// Lays out the state every picture starts from.
  void start() {
    context->make_current();
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_LEQUAL);
    gl.Enable(GL_CULL_FACE);
    gl.CullFace(GL_BACK);
    gl.FrontFace(GL_CCW);
    gl.Disable(GL_BLEND);
    cut_picture(false);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  /// Turns the picture into the grid of its samples.
  void lay_grid(Scene& scene, const View& view) const {
    const double n = grid.n, w = view.width, h = view.height;
    const int across = grid.width(view.width, view.height);
    const int up = grid.height(view.width, view.height);
    scene.grid_x = Vec3(n * w, -grid.turn() * h, 0.0) / across;
    scene.grid_y = Vec3(grid.turn() * w, n * h, 0.0) / up;
  }

  /// Samples beside the picture are not drawn.
  void cut_picture(bool on) const {
    if (grid.turn() == 0) return;
    for (GLenum plane = GL_CLIP_DISTANCE1; plane <= GL_CLIP_DISTANCE4; ++plane) {
      on ? gl.Enable(plane) : gl.Disable(plane);
    }
  }

  void use_target(std::size_t i, const View& view) {
    const int width = grid.width(view.width, view.height);
    const int height = grid.height(view.width, view.height);
    if (!targets[i] || !targets[i]->fits(width, height)) {
      targets[i] = std::make_unique<Target>(gl, GL_SRGB8_ALPHA8, width, height);
    }
    targets[i]->use();
  }

  /// What was painted, once it is.
  void read(const View& view, Image& out) {
    const int width = grid.width(view.width, view.height);
    const int height = grid.height(view.width, view.height);
    samples.resize(std::size_t{4} * static_cast<std::size_t>(width) *
                   static_cast<std::size_t>(height));
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, samples.data());
    out = average(samples, view.width, view.height, quality.samples);
  }

  /// Reports what OpenGL found wrong since it was last asked, by throwing.
  void finish(const char* what) const {
    const GLenum error = gl.GetError();
    if (error != GL_NO_ERROR) {
      throw std::runtime_error(std::string("OpenGL error ") + std::to_string(error) + " in " +
                               what);
    }
  }

  std::unique_ptr<GlContext> context;
  Gl gl;
  Quality quality;
  SampleGrid grid{quality.samples};
  std::vector<Kept> meshes;
  std::unique_ptr<Program> lit;  ///< for as many lamps as the last list had
  std::size_t lit_lamps = 0;
  // Shaders write sRGB themselves, where it costs least; polished floors leave it to the target.
  Program baked = mesh_program(gl, {.early = true}, shaders::kBakedFragment);
  Program floor = mesh_program(gl, {.shadow = true, .mirror = true}, shaders::kFloorFragment);
  Program polished = mesh_program(gl, {.mirror = true}, shaders::kFloorFragment);
  Program shadowed =
      mesh_program(gl, {.coded = true, .early = true, .shadow = true}, shaders::kFloorFragment);
  Program contact{gl, shaders::vertex_shader({}, shaders::kContactVertex),
                  shaders::shader({.coded = true}, shaders::kContactFragment)};
  Program depth{gl, shaders::kDepthVertex, shaders::kDepthFragment};
  ShadowMap shadow_map{gl};
  std::vector<std::unique_ptr<Target>> targets;  // of the last views' sizes, in samples
  std::unique_ptr<Target> label_target;          // made when first asked for
  std::unique_ptr<Program> label;
  GLuint contact_arrays = 0, contact_buffer = 0;
  GLint largest = 0;
  std::vector<std::uint8_t> samples;
};

}  // namespace headpin::render
