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

/// The private part of Renderer, for its .cpp files.
namespace headpin::render {

/// The surfaces in the order of drawing; meshes with other surfaces are refused.
inline constexpr std::array kTurns = {Surface::lit, Surface::floor, Surface::baked};

/// A mesh that is stored in the context.
struct Kept {
  Surface surface;
  bool fine_light;
  double gloss;
  bool takes_shadow;
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3d box;
  GLuint arrays = 0, vertices = 0, indices = 0;
};

inline constexpr double kNear = 48.0;  // pixels across: smaller objects use their far mesh

/// Texels of a shadow map for a length that it covers.
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

/// The scene for one eye.
struct Scene {
  const DrawList* list;
  std::vector<double> sizes;  ///< sizes of the items in the picture [pixels]
  Mat4 world_to_clip = Mat4::Identity();
  Mat4 shadow_view;  ///< world to the shadow map, 0..1
  Vec3 eye_W = Vec3::Zero();
  Vec3 grid_x = Vec3::UnitX(), grid_y = Vec3::UnitY();  ///< clip space to that of the samples
  Vec3 edge = Vec3::Ones();  ///< x and y up to which they are drawn, in clip space
  Vec3 picture_u = Vec3::Zero(),
       picture_v = Vec3::Zero();  ///< (i, j, 1) of a sample to the picture
  bool in_mirror = false;
  std::vector<Eigen::AlignedBox2d> shades;  ///< areas of the shadow map that items cover, 0..1
};

struct Renderer::Impl {
  Impl(std::unique_ptr<GlContext> with, Quality wanted)
      : context(std::move(with)), gl(current_functions(*context)), quality(wanted) {
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

  void check(const DrawList& list, const View& view) const;
  const Kept& kept(int mesh) const { return meshes[static_cast<std::size_t>(mesh)]; }

  /// Draws the wanted visible parts of a mesh, consecutive ones in one call.
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

  /// The size of items in the picture [pixels], seen from between the views, so that both eyes use
  /// the same meshes.
  std::vector<double> sizes_seen(const DrawList& list, std::span<const View> views) const;

  const Kept& seen_mesh(const DrawItem& item, double size) const {
    return kept(size < kNear ? item.far_mesh.value_or(item.mesh) : item.mesh);
  }

  /// Makes a shadow map with texels for the size of the shadow's box.
  void make_shadow_map_for(const Vec2& size) {
    const int width = texels(size.x()), height = texels(size.y());
    if (shadow_map && shadow_map->fits(width, height)) return;
    shadow_map = std::make_unique<ShadowMap>(gl, width, height);
  }

  /// Draws the shadow map: the back faces of each item as seen by the light, so that no item
  /// shadows its own lit side.
  void draw_depth(const DrawList& list, const Mat4& view) const;

  bool takes_shadow(const Kept& mesh) const { return quality.shadow && mesh.takes_shadow; }
  bool mirrors(const Kept& mesh) const { return quality.mirror && mesh.gloss > 0.0; }

  /// The areas of the shadow map that items cover, with a margin for the soft edge.
  std::vector<Eigen::AlignedBox2d> shades_of(const DrawList& list, const Mat4& shadow_view) const;

  /// The cheapest program that draws a mesh: floors without shadow or reflections do not compute
  /// them.
  const Program& program_of(const Kept& mesh, bool shaded, bool in_mirror) const;

  /// @param taken  share of the light, or of its sRGB code, that shadows take
  static void set_shadow(const Program& program, const Scene& scene, double taken);

  /// Sets the uniforms of a surface's program that do not depend on items.
  void set_light(const Kept& mesh, const Program& program, const Scene& scene, bool shaded) const;

  /// Draws the items of one surface; in a reflection only those that are visible there.
  void draw_items(const Scene& scene, Surface surface) const;

  /// Draws all items of one surface, and what follows them. A new surface needs a case here and an
  /// entry in kTurns.
  void draw_surface(const Scene& scene, Surface surface, GLsizei contacts) const;

  /// Draws the reflection of the scene in floors, for the programs that draw floors.
  void draw_mirrored(Scene scene, const View& view, std::unique_ptr<MirrorImage>& image) const;

  void draw_contact(GLsizei count, const Scene& scene) const;
  void make_lit_for(std::size_t lamps) {
    if (lit && lit->count == static_cast<int>(lamps)) return;
    lit = std::make_unique<LitPrograms>(gl, quality, lamps);
  }

  void clear(const Vec3& colour) const {
    const Eigen::Vector3f c = colour.cast<float>();
    gl.ClearColor(c.x(), c.y(), c.z(), 1.0F);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }

  /// Sets the OpenGL state for the start of a picture.
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

  /// Rotates the picture into the grid of its samples; samples outside of it are not drawn.
  ///
  /// @param part  part of the view for which the reflection was drawn
  void lay_grid(Scene& scene, const View& whole, const Part& part, const SampleGrid& laid) const;

  void cut_picture(bool on) const {
    for (GLenum plane = GL_CLIP_DISTANCE1; plane <= GL_CLIP_DISTANCE4; ++plane) {
      on ? gl.Enable(plane) : gl.Disable(plane);
    }
  }

  /// Draws a part of a view into its own target.
  void draw_part(Scene scene, const View& whole, const Part& part, const SampleGrid& laid,
                 GLsizei contacts, std::unique_ptr<Target>& target) const;

  /// Reads the finished picture.
  Image read(const Target& target, const Part& part, const SampleGrid& laid);

  /// The part of a view with small bodies, which are those that cast shadows.
  std::optional<Part> small_part(const Scene& scene, const View& view) const;

  /// Draws small bodies again with more samples, and copies them to their place.
  void refine(const Scene& scene, const View& view, GLsizei contacts, Image& image);

  /// Throws an exception if there was an OpenGL error since the last call.
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
