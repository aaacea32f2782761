#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/data/mesh.h"
#include "render/data/quality.h"
#include "render/draw_list.h"
#include "render/eyes.h"
#include "render/gl_context.h"
#include "render/image.h"

namespace headpin::render {

/// What each pixel's centre sees.
struct Labels {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> id;  ///< DrawItem::id, 0 where nothing is; rows from the top
  std::vector<float> depth;       ///< along the eye's -z [m], infinite where nothing is
};

/// Draws lists with one OpenGL context. Equal calls give equal bytes, whatever was drawn before.
class Renderer {
 public:
  /// @throws std::runtime_error  when the context does not draw
  explicit Renderer(std::unique_ptr<GlContext> context, Quality quality = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Keeps a mesh on the side of the context, for DrawItem::mesh.
  int add(const Mesh& mesh);

  /// One picture for each view, of the view's size.
  ///
  /// @throws std::invalid_argument  when the list names a mesh that was not added or has too many
  ///                                lamps, when a view has no pixels or more than can be drawn, or
  ///                                when there are not as many images as views
  void draw(const DrawList& list, std::span<const View> views, std::span<Image> out);

  /// Which item each pixel belongs to, and how far it is: truth for tests and segmentation.
  ///
  /// @param shown  the views of the pictures that it is the truth of: how large items are in those
  ///               says which of their meshes is drawn
  /// @throws std::invalid_argument  as draw()
  Labels labels(const DrawList& list, const View& view, std::span<const View> shown);
  Labels labels(const DrawList& list, const View& view) { return labels(list, view, {&view, 1}); }

  /// Why no context that comes before it draws (GlContext::instead_of).
  const std::string& instead_of() const;

  const Quality& quality() const;

  /// Who draws: backend, renderer, OpenGL version. Pictures are equal where this is.
  std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace headpin::render
