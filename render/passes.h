#pragma once

#include <memory>

#include "render/contact_pass.h"
#include "render/mesh_pass.h"
#include "render/mirror_pass.h"
#include "render/renderer.h"
#include "render/sample_pass.h"
#include "render/shadow_pass.h"

/// The private part of Renderer, for its .cpp files.
namespace headpin::render {

/// The context, its meshes, and the passes in the order in which a picture is drawn.
struct Renderer::Impl {
  Impl(std::unique_ptr<GlContext> with, Quality wanted);
  ~Impl() { context->make_current(); }

  /// @throws std::invalid_argument  as Renderer::draw
  void check(const DrawList& list, const View& view) const;
  /// Sets the OpenGL state for the start of a picture.
  void start() const;
  /// Throws an exception if there was an OpenGL error since the last call.
  void finish(const char* what) const;
  /// All surfaces of a scene, and what follows them.
  void draw_all(const EyeScene& scene) const;

  std::unique_ptr<GlContext> context;
  Gl gl;
  Quality quality;
  Meshes meshes{gl};
  ShadowPass shadow{gl, quality.shadow};
  MeshPass surfaces{gl, meshes, quality};
  MirrorPass mirror{gl, surfaces, quality.mirror};
  ContactPass contact{gl, quality.contact};
  SamplePass samples{gl, meshes, quality.samples,
                     [this](const EyeScene& scene) { draw_all(scene); }};

  // Of Renderer::labels, made when first asked for.
  std::unique_ptr<Target> label_target;
  std::unique_ptr<Program> label;
};

}  // namespace headpin::render
