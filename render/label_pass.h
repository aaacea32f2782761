#pragma once

#include <memory>
#include <span>

#include "render/draw_list.h"
#include "render/eyes.h"
#include "render/gl_objects.h"
#include "render/labels.h"
#include "render/meshes.h"

namespace headpin::render {

/// Draws the item and the depth of each pixel.
class LabelPass {
 public:
  /// @param gl, meshes  must outlive this
  LabelPass(const Gl& gl, const Meshes& meshes) : gl_(gl), meshes_(meshes) {}

  /// As Renderer::labels.
  Labels draw(const DrawList& list, const View& view, std::span<const View> shown);

 private:
  const Gl& gl_;
  const Meshes& meshes_;
  // Made when they are first needed.
  std::unique_ptr<Target> target_;
  std::unique_ptr<Program> program_;
};

}  // namespace headpin::render
