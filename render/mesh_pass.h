#pragma once

#include <memory>

#include "render/data/quality.h"
#include "render/eye_scene.h"
#include "render/meshes.h"
#include "render/programs.h"

namespace headpin::render {

/// Draws the items of a list by surface, with light, shadows and reflections.
class MeshPass {
 public:
  /// @param gl, meshes  must outlive this
  MeshPass(const Gl& gl, const Meshes& meshes, const Quality& quality);

  /// Makes the programs for a number of lamps.
  void prepare(std::size_t lamps);

  /// Draws the items of one surface; in a reflection only those that are visible there.
  void draw(const EyeScene& scene, Surface surface) const;

 private:
  bool takes_shadow(const Kept& mesh) const { return quality_.shadow && mesh.takes_shadow; }
  bool mirrors(const Kept& mesh) const { return quality_.mirror && mesh.gloss > 0.0; }
  const Program& program_of(const Kept& mesh, bool shaded, bool in_mirror) const;
  void set_light(const Kept& mesh, const Program& program, const EyeScene& scene,
                 bool shaded) const;

  const Gl& gl_;
  const Meshes& meshes_;
  Quality quality_;
  std::unique_ptr<LitPrograms> lit_;  ///< for as many lamps as the last list had
  Program baked_, floor_, polished_, shadowed_, mirrored_;
};

}  // namespace headpin::render
