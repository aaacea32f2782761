#pragma once

#include <memory>

#include "render/eye_scene.h"
#include "render/gl_objects.h"
#include "render/meshes.h"

namespace headpin::render {

/// Draws the shadow map: the back faces of each item as seen by the light, so that no item shadows its
/// own lit side.
class ShadowPass {
 public:
  /// @param gl  must outlive this
  ShadowPass(const Gl& gl, bool on);

  /// The shadows of a list; the map stays bound for the programs that read it.
  CastShadow draw(const DrawList& list, const Meshes& meshes);

 private:
  void draw_depth(const DrawList& list, const Meshes& meshes, const Mat4& view) const;
  std::vector<Eigen::AlignedBox2d> shades_of(const DrawList& list, const Meshes& meshes,
                                             const Mat4& shadow_view) const;

  const Gl& gl_;
  bool on_;
  Program depth_;
  std::unique_ptr<ShadowMap> map_;  ///< for the box that the last list had
};

}  // namespace headpin::render
