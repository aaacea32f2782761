#include "render/renderer.h"

#include <stdexcept>
#include <string>

#include "render/contact_pass.h"
#include "render/label_pass.h"
#include "render/mesh_pass.h"
#include "render/mirror_pass.h"
#include "render/sample_pass.h"
#include "render/shadow_pass.h"

namespace headpin::render {

namespace {

Gl current_functions(GlContext& context) {
  context.make_current();
  const Gl gl = load_functions(context);
  check_drawing(gl);
  return gl;
}

Quality checked(const Quality& quality) {
  if (quality.samples >= 1 && quality.samples <= 8) return quality;
  throw std::invalid_argument("samples: " + std::to_string(quality.samples) + ", expected 1 to 8");
}

}  // namespace

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

  std::unique_ptr<GlContext> context;
  Gl gl;
  Quality quality;
  Meshes meshes{gl};
  ShadowPass shadow{gl, quality.shadow};
  MeshPass surfaces{gl, meshes, quality};
  MirrorPass mirror{gl, surfaces, quality.mirror};
  ContactPass contact{gl, quality.contact};
  SamplePass samples{gl, meshes, surfaces, contact, quality.samples};
  LabelPass labels{gl, meshes};
};

Renderer::Impl::Impl(std::unique_ptr<GlContext> with, Quality wanted)
    : context(std::move(with)), gl(current_functions(*context)), quality(checked(wanted)) {}

void Renderer::Impl::check(const DrawList& list, const View& view) const {
  for (const DrawItem& item : list.items) {
    for (const int mesh : {item.mesh, item.far_mesh.value_or(item.mesh), faint_mesh(item)}) {
      if (mesh >= 0 && static_cast<std::size_t>(mesh) < meshes.count()) continue;
      throw std::invalid_argument("draw list: mesh " + std::to_string(mesh) + " of " +
                                  std::to_string(meshes.count()));
    }
  }
  if (list.lamps.size() > DrawList::kLamps) {
    throw std::invalid_argument("draw list: " + std::to_string(list.lamps.size()) +
                                " lamps, at most " + std::to_string(DrawList::kLamps));
  }
  const int most = samples.most_pixels();
  if (view.width < 1 || view.height < 1 || view.width > most || view.height > most) {
    const int each = samples.a_pixel();
    throw std::invalid_argument("view: " + std::to_string(view.width) + "x" +
                                std::to_string(view.height) + " pixels with " +
                                std::to_string(each) + (each == 1 ? " sample" : " samples") +
                                " each, expected 1 to " + std::to_string(most) +
                                " pixels on each side (hmd.width, hmd.height; fewer samples by "
                                "look.samples allow more)");
  }
}

void Renderer::Impl::start() const {
  context->make_current();
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  gl.FrontFace(GL_CCW);
  gl.Disable(GL_BLEND);
  cut_picture(gl, false);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
}

void Renderer::Impl::finish(const char* what) const {
  const GLenum error = gl.GetError();
  if (error != GL_NO_ERROR) {
    throw std::runtime_error(std::string("OpenGL error ") + std::to_string(error) + " in " + what);
  }
}

Renderer::Renderer(std::unique_ptr<GlContext> context, Quality quality)
    : impl_(std::make_unique<Impl>(std::move(context), quality)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

std::string Renderer::description() const {
  impl_->context->make_current();
  return describe(*impl_->context, impl_->gl);
}

const std::string& Renderer::instead_of() const {
  return impl_->context->instead_of;
}

const Quality& Renderer::quality() const {
  return impl_->quality;
}

int Renderer::add(const Mesh& mesh) {
  impl_->context->make_current();
  const int number = impl_->meshes.add(mesh);
  impl_->finish("Renderer::add");
  return number;
}

void Renderer::draw(const DrawList& list, std::span<const View> views, std::span<Image> out) {
  Impl& r = *impl_;
  if (views.size() != out.size())
    throw std::invalid_argument("draw: expected one image for each view");
  r.context->make_current();
  for (const View& view : views) r.check(list, view);
  if (views.empty()) return;
  r.start();
  r.surfaces.prepare(list.lamps.size());
  const CastShadow shadow = r.shadow.draw(list, r.meshes);
  r.contact.load(list);
  const std::vector<double> sizes = r.meshes.sizes_seen(list, views);
  std::vector<EyeScene> scenes(views.size(), {.list = &list, .sizes = &sizes, .shadow = &shadow});
  for (std::size_t i = 0; i < views.size(); ++i) {
    scenes[i].world_to_clip = world_to_clip(views[i]);
    scenes[i].eye_W = views[i].X_WE.p;
    r.mirror.draw(scenes[i], views[i], i);
    r.samples.draw(scenes[i], views[i], i);
  }
  // Pictures are read after all are submitted, so that one is drawn while the next is prepared.
  for (std::size_t i = 0; i < views.size(); ++i) {
    r.mirror.use(i);
    out[i] = r.samples.read(scenes[i], views[i], i);
  }
  r.finish("Renderer::draw");
}

Labels Renderer::labels(const DrawList& list, const View& view, std::span<const View> shown) {
  Impl& r = *impl_;
  r.context->make_current();
  r.check(list, view);
  r.start();
  Labels labels = r.labels.draw(list, view, shown);
  r.finish("Renderer::labels");
  return labels;
}

}  // namespace headpin::render
