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
#include "render/labels.h"

namespace headpin::render {

/// Draws lists with one OpenGL context. Equal calls give equal bytes, independent of earlier calls.
class Renderer {
 public:
  /// @throws std::runtime_error  when the context does not draw
  explicit Renderer(std::unique_ptr<GlContext> context, Quality quality = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Stores a mesh in the context, for DrawItem::mesh.
  int add(const Mesh& mesh);

  /// Draws one picture for each view, of the view's size.
  ///
  /// @throws std::invalid_argument  when the list names a mesh that was not added or has too many
  ///                                lamps, when a view has no pixels or more than can be drawn, or
  ///                                when there are not as many images as views
  void draw(const DrawList& list, std::span<const View> views, std::span<Image> out);

  /// The item and the depth of each pixel: ground truth for tests and segmentation.
  ///
  /// @param shown  the views of the pictures; the size of items in them determines which of their
  ///               meshes is drawn
  /// @throws std::invalid_argument  as draw()
  Labels labels(const DrawList& list, const View& view, std::span<const View> shown);
  Labels labels(const DrawList& list, const View& view) { return labels(list, view, {&view, 1}); }

  /// Why an earlier kind of context does not draw (GlContext::instead_of).
  const std::string& instead_of() const;

  const Quality& quality() const;

  /// Backend, renderer and OpenGL version; pictures with equal descriptions are equal.
  std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace headpin::render
