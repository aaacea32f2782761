#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/draw_list.h"
#include "render/eyes.h"
#include "render/gl_functions.h"
#include "render/matrices.h"
#include "render/mesh_parts.h"

/// The meshes that a context stores.
namespace headpin::render {

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

/// An attribute of the bound vertex array: `numbers` floats at an offset in each of its vertices.
inline void vertex_attribute(const Gl& gl, GLuint place, GLint numbers, std::size_t stride,
                             std::size_t offset) {
  gl.EnableVertexAttribArray(place);
  gl.VertexAttribPointer(place, numbers, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                         reinterpret_cast<const void*>(offset));  // NOLINT: as OpenGL has it
}

/// The mesh of an item in reflections and shadows.
inline int faint_mesh(const DrawItem& item) {
  return item.faint_mesh.value_or(item.far_mesh.value_or(item.mesh));
}

class Meshes {
 public:
  /// @param gl  of the current context; must outlive this
  explicit Meshes(const Gl& gl) : gl_(gl) {}
  ~Meshes();
  Meshes(const Meshes&) = delete;
  Meshes& operator=(const Meshes&) = delete;

  /// Stores a mesh.
  /// @return  its number
  /// @throws std::invalid_argument  for an unknown surface, or an index beyond its vertices
  int add(const Mesh& mesh);

  std::size_t count() const { return meshes_.size(); }
  const Kept& operator[](int mesh) const { return meshes_[static_cast<std::size_t>(mesh)]; }

  /// The sizes of items in the picture [pixels], seen from between the views, so that both eyes use
  /// the same meshes.
  std::vector<double> sizes_seen(const DrawList& list, std::span<const View> views) const;
  /// The mesh of an item of this size in a picture.
  const Kept& seen(const DrawItem& item, double size) const;

  /// Draws the wanted visible parts of a mesh with the current program, consecutive ones in one call.
  template <typename Wanted>
  void draw(const Kept& mesh, const Mat4& mesh_to_clip, const Wanted& wanted) const {
    gl_.BindVertexArray(mesh.arrays);
    std::size_t first = 0, end = 0;
    const auto draw_range = [&] {
      if (end == first) return;
      gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(end - first), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(first * sizeof(std::uint32_t)));  // NOLINT
    };
    for (const MeshPart& p : mesh.parts) {
      if (!wanted(p) || is_outside(p.box, mesh_to_clip)) continue;
      if (p.first != end) {
        draw_range();
        first = p.first;
      }
      end = p.first + p.count;
    }
    draw_range();
  }
  void draw(const Kept& mesh, const Mat4& mesh_to_clip) const {
    draw(mesh, mesh_to_clip, [](const MeshPart&) { return true; });
  }

 private:
  const Gl& gl_;
  std::vector<Kept> meshes_;
};

}  // namespace headpin::render
