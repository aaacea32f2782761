#pragma once

#include "render/data/quality.h"
#include "render/gl_objects.h"
#include "render/shaders.h"

/// Programs from variants of the shaders.
namespace headpin::render {

inline Program mesh_program(const Gl& gl, const shaders::Variant& variant, const char* fragment) {
  return {gl, shaders::vertex_shader(variant, shaders::kMeshVertex),
          shaders::shader(variant, fragment)};
}

/// Programs for bodies: the colour of their mesh is reflectance, from which these compute light.
struct LitPrograms {
  LitPrograms(const Gl& gl, const Quality& quality, std::size_t lamps)
      : count(static_cast<int>(lamps)),
        fine(mesh_program(gl, {.shadow = quality.shadow, .count = count}, shaders::kLitFragment)),
        coarse(mesh_program(
            gl, {.early = true, .lamps = true, .shadow = quality.shadow, .count = count},
            shaders::kBakedFragment)),
        mirrored(mesh_program(gl, {.lamps = true, .count = count}, shaders::kBakedFragment)) {}

  int count;
  Program fine, coarse, mirrored;
};

}  // namespace headpin::render
