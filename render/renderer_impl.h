#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>

#include "render/contact_shadow.h"
#include "render/finer_part.h"
#include "render/gl_functions.h"
#include "render/gl_objects.h"
#include "render/matrices.h"
#include "render/mesh_parts.h"
#include "render/programs.h"
#include "render/renderer.h"
#include "render/sample_grid.h"

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
  bool fine_light;
  double gloss;
  bool takes_shadow;
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3d box;
  GLuint arrays = 0, vertices = 0, indices = 0;
};

inline constexpr double kNear = 48.0;  // pixels across: what is smaller is drawn by its far mesh

/// Of a shadow map, for a length that it covers.
inline int texels(double length) {
  constexpr double kTexel = 0.008;  // [m]; coarser where that would be more than kMost
  constexpr double kMost = 2048.0;
  return static_cast<int>(std::ceil(std::clamp(length / kTexel, 1.0, kMost)));
}

inline Gl current_functions(GlContext& context) {
  context.make_current();
  const Gl gl = load_functions(context);
  check_drawing(gl);
  return gl;
}

inline int faint_mesh(const DrawItem& item) {
  return item.faint_mesh.value_or(item.far_mesh.value_or(item.mesh));
}

/// What one eye looks at.
struct Scene {
  const DrawList* list;
  std::vector<double> sizes;  ///< of the items, as they are seen from there [pixels]
  Mat4 world_to_clip = Mat4::Identity();
  Mat4 shadow_view;  ///< world to the shadow map, 0..1
  Vec3 eye_W = Vec3::Zero();
  Vec3 grid_x = Vec3::UnitX(), grid_y = Vec3::UnitY();  ///< clip space to that of the samples
  Vec3 edge = Vec3::Ones();  ///< x and y up to which they are drawn, in clip space
  Vec3 picture_u = Vec3::Zero(),
       picture_v = Vec3::Zero();  ///< (i, j, 1) of a sample to the picture
  bool in_mirror = false;
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
      for (const int mesh : {item.mesh, item.far_mesh.value_or(item.mesh), faint_mesh(item)}) {
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

  /// How large items look from there [pixels]: from between the views, so that both eyes see the same.
  std::vector<double> sizes_seen(const DrawList& list, std::span<const View> views) const {
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

  const Kept& seen_mesh(const DrawItem& item, double size) const {
    return kept(size < kNear ? item.far_mesh.value_or(item.mesh) : item.mesh);
  }

  /// As many texels as the shadow's box is large.
  void make_shadow_map_for(const Vec2& size) {
    const int width = texels(size.x()), height = texels(size.y());
    if (shadow_map && shadow_map->fits(width, height)) return;
    shadow_map = std::make_unique<ShadowMap>(gl, width, height);
  }

  /// What lies behind each item, as the light sees it: so none shades its own lit side.
  void draw_depth(const DrawList& list, const Mat4& view) const {
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

  bool takes_shadow(const Kept& mesh) const { return quality.shadow && mesh.takes_shadow; }
  bool mirrors(const Kept& mesh) const { return quality.mirror && mesh.gloss > 0.0; }

  /// What casts a shadow covers of the map, and a little: a shadow's edge is as wide as texels.
  std::vector<Eigen::AlignedBox2d> shades_of(const DrawList& list, const Mat4& shadow_view) const {
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

  /// The cheapest that draws a mesh: floors without shadow or polish do not ask for either.
  const Program& program_of(const Kept& mesh, bool shaded, bool in_mirror) const {
    switch (mesh.surface) {
      case Surface::lit:
        if (in_mirror) return lit->mirrored;
        return mesh.fine_light && quality.light == "pixel" ? lit->fine : lit->coarse;
      case Surface::floor:
        return mirrors(mesh) ? shaded ? floor : polished : shaded ? shadowed : baked;
      case Surface::baked:
        return in_mirror ? mirrored : baked;
    }
    throw std::logic_error("a surface without a program");
  }

  /// @param taken  of the light, or of its code, by shadows
  static void set_shadow(const Program& program, const Scene& scene, double taken) {
    program.set("shadow_view", scene.shadow_view);
    program.set("shadow_map", 0);
    program.set("shadow_depth", taken);
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
          program.set("mirrored", MirrorImage::kUnit);
          program.set("picture_u", scene.picture_u);
          program.set("picture_v", scene.picture_v);
        }
        // Where there is no mirror, the colour is code already, and shadows take of that.
        if (shaded) {
          const double taken = list.shadow.depth;
          set_shadow(program, scene,
                     mirrors(mesh) ? taken : 1.0 - std::pow(1.0 - taken, 1.0 / 2.2));
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

  /// Draws the items of one surface, in a mirror only those that are seen there.
  void draw_items(const Scene& scene, Surface surface) const {
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

  /// All items of one surface in their turn, and what follows them. A new surface has its turn here
  /// and in kTurns.
  void draw_surface(const Scene& scene, Surface surface, GLsizei contacts) const {
    switch (surface) {
      case Surface::lit:
      case Surface::baked:
        return draw_items(scene, surface);
      case Surface::floor:
        draw_items(scene, surface);
        return draw_contact(contacts, scene);
    }
  }

  /// What floors mirror of the scene, for the programs that draw them.
  void draw_mirrored(Scene scene, const View& view, std::unique_ptr<MirrorImage>& image) const {
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

  void draw_contact(GLsizei count, const Scene& scene) const {
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

  void make_lit_for(std::size_t lamps) {
    if (lit && lit->count == static_cast<int>(lamps)) return;
    lit = std::make_unique<LitPrograms>(gl, quality, lamps);
  }

  void clear(const Vec3& colour) const {
    const Eigen::Vector3f c = colour.cast<float>();
    gl.ClearColor(c.x(), c.y(), c.z(), 1.0F);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
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

  /// Turns the picture into the grid of its samples; those beside it are not drawn.
  ///
  /// @param part  what it is of the view that the mirror image was drawn for
  void lay_grid(Scene& scene, const View& whole, const Part& part, const SampleGrid& laid) const {
    const double n = laid.n, w = part.width, h = part.height;
    const int across = laid.width(part.width, part.height);
    const int up = laid.height(part.width, part.height);
    scene.grid_x = Vec3(n * w, -laid.turn() * h, 0.0) / across;
    scene.grid_y = Vec3(laid.turn() * w, n * h, 0.0) / up;
    scene.edge = Vec3(1.0 + 1.0 / w, 1.0 + 1.0 / h, 0.0);
    Eigen::Matrix2d turned;
    turned << scene.grid_x.x(), scene.grid_x.y(), scene.grid_y.x(), scene.grid_y.y();
    const Eigen::Matrix2d back = turned.inverse();
    const auto place = [&](int k, double from, double size, double whole_size) {
      const Vec3 in_part(back(k, 0) / across, back(k, 1) / up, 0.5 - 0.5 * back.row(k).sum());
      return Vec3((size * in_part + from * Vec3::UnitZ()) / whole_size);
    };
    scene.picture_u = place(0, part.x, w, whole.width);
    scene.picture_v = place(1, part.y, h, whole.height);
    cut_picture(laid.turn() == 1);
  }

  void cut_picture(bool on) const {
    for (GLenum plane = GL_CLIP_DISTANCE1; plane <= GL_CLIP_DISTANCE4; ++plane) {
      on ? gl.Enable(plane) : gl.Disable(plane);
    }
  }

  /// Draws a part of a view into its own target.
  void draw_part(Scene scene, const View& whole, const Part& part, const SampleGrid& laid,
                 GLsizei contacts, std::unique_ptr<Target>& target) const {
    const int width = laid.width(part.width, part.height);
    const int height = laid.height(part.width, part.height);
    if (!target || !target->fits(width, height)) {
      target = std::make_unique<Target>(gl, GL_RGBA8, width, height);
    }
    target->use();
    clear(srgb_of(scene.list->background));
    scene.world_to_clip = world_to_clip(view_of(whole, part));
    lay_grid(scene, whole, part, laid);
    for (const Surface surface : kTurns) draw_surface(scene, surface, contacts);
  }

  /// What was painted, once it is.
  Image read(const Target& target, const Part& part, const SampleGrid& laid) {
    target.use();
    const int width = laid.width(part.width, part.height);
    const int height = laid.height(part.width, part.height);
    samples.resize(std::size_t{4} * static_cast<std::size_t>(width) *
                   static_cast<std::size_t>(height));
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, samples.data());
    return average(samples, part.width, part.height, laid.n);
  }

  /// Where a view shows bodies, which cast shadows, that are small.
  std::optional<Part> small_part(const Scene& scene, const View& view) const {
    Eigen::AlignedBox2d all;
    for (std::size_t i = 0; i < scene.list->items.size(); ++i) {
      const DrawItem& item = scene.list->items[i];
      if (!item.casts_shadow || scene.sizes[i] >= kSmall) continue;
      const auto pixels =
          pixels_of(kept(item.mesh).box, scene.world_to_clip * matrix(item.X_WG, item.scale), view);
      if (pixels) all.extend(*pixels);
    }
    return part_of(view, all);
  }

  /// Draws what is small again, with more samples, and puts it in its place.
  void refine(const Scene& scene, const View& view, GLsizei contacts, Image& image) {
    if (quality.samples == 1) return;
    const std::optional<Part> part = small_part(scene, view);
    if (!part) return;
    const std::optional<SampleGrid> finer = finer_grid(grid, view, *part);
    if (!finer) return;
    draw_part(scene, view, *part, *finer, contacts, finer_target);
    paste(read(*finer_target, *part, *finer), *part, image);
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
  std::unique_ptr<LitPrograms> lit;  ///< for as many lamps as the last list had
  Program baked = mesh_program(gl, {.early = true}, shaders::kBakedFragment);
  Program floor = mesh_program(gl, {.shadow = true, .mirror = true}, shaders::kFloorFragment);
  Program polished = mesh_program(gl, {.mirror = true}, shaders::kFloorFragment);
  Program shadowed = mesh_program(gl, {.early = true, .shadow = true}, shaders::kFloorFragment);
  Program mirrored = mesh_program(gl, {}, shaders::kBakedFragment);
  Program contact{gl, shaders::vertex_shader({}, shaders::kContactVertex),
                  shaders::shader({}, shaders::kContactFragment)};
  Program depth{gl, shaders::kDepthVertex, shaders::kDepthFragment};
  std::unique_ptr<ShadowMap> shadow_map;         ///< for the box that the last list had
  std::vector<std::unique_ptr<Target>> targets;  // of the last views' sizes, in samples
  std::vector<std::unique_ptr<MirrorImage>> mirror_images;
  std::unique_ptr<Target> finer_target;  // of the last part that was drawn again
  std::unique_ptr<Target> label_target;  // made when first asked for
  std::unique_ptr<Program> label;
  GLuint contact_arrays = 0, contact_buffer = 0;
  GLint largest = 0;
  std::vector<std::uint8_t> samples;
};

}  // namespace headpin::render
