#pragma once

#include <memory>
#include <vector>

#include "render/gl_objects.h"
#include "render/mesh_pass.h"

namespace headpin::render {

/// Draws the reflections in floors, one image for each view, for the programs that draw floors.
class MirrorPass {
 public:
  /// @param gl, surfaces  must outlive this
  MirrorPass(const Gl& gl, const MeshPass& surfaces, bool on)
      : gl_(gl), surfaces_(surfaces), on_(on) {}

  /// Draws the image of a view, and lets programs read it.
  ///
  /// @param number  of the view
  void draw(EyeScene scene, const View& view, std::size_t number);
  /// Lets programs read the image of a view.
  void use(std::size_t number) const;

 private:
  const Gl& gl_;
  const MeshPass& surfaces_;
  bool on_;
  std::vector<std::unique_ptr<MirrorImage>> images_;  ///< of the last views' sizes
};

}  // namespace headpin::render
