#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "render/renderer_impl.h"

namespace headpin::render {

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
  Impl& r = *impl_;
  if (std::ranges::find(kTurns, mesh.surface) == kTurns.end()) {
    throw std::invalid_argument("mesh: unknown surface");
  }
  for (const std::uint32_t i : mesh.indices) {
    if (i >= mesh.vertices.size())
      throw std::invalid_argument("mesh: an index exceeds the number of vertices");
  }
  r.context->make_current();
  // Floors have small parts, because each one is tested for shadows.
  const MeshParts parted =
      mesh.surface == Surface::floor ? part_by_place(mesh, 0.35, 16) : part_by_place(mesh);
  Kept kept{mesh.surface, mesh.fine_light, mesh.gloss, mesh.takes_shadow, parted.parts, parted.box};
  r.gl.GenVertexArrays(1, &kept.arrays);
  r.gl.BindVertexArray(kept.arrays);
  r.gl.GenBuffers(1, &kept.vertices);
  r.gl.BindBuffer(GL_ARRAY_BUFFER, kept.vertices);
  r.gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(Vertex)),
                  mesh.vertices.data(), GL_STATIC_DRAW);
  r.attribute(0, 3, sizeof(Vertex), offsetof(Vertex, p));
  r.attribute(1, 3, sizeof(Vertex), offsetof(Vertex, n));
  r.attribute(2, 3, sizeof(Vertex), offsetof(Vertex, colour));
  r.gl.GenBuffers(1, &kept.indices);
  r.gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, kept.indices);
  r.gl.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  static_cast<GLsizeiptr>(parted.indices.size() * sizeof(std::uint32_t)),
                  parted.indices.data(), GL_STATIC_DRAW);
  r.finish("Renderer::add");
  r.meshes.push_back(kept);
  return static_cast<int>(r.meshes.size()) - 1;
}

void Renderer::draw(const DrawList& list, std::span<const View> views, std::span<Image> out) {
  Impl& r = *impl_;
  const Gl& gl = r.gl;
  if (views.size() != out.size())
    throw std::invalid_argument("draw: expected one image for each view");
  for (const View& view : views) r.check(list, view);
  if (views.empty()) return;
  r.start();
  r.make_lit_for(list.lamps.size());

  const LightView light = light_view(list.shadow);
  const Mat4 shadow_view =  // to 0..1, as textures need it
      matrix({Quat::Identity(), Vec3::Constant(0.5)}, Vec3::Constant(0.5)) * light.to_clip;
  if (r.quality.shadow) r.make_shadow_map_for(light.size);
  if (r.quality.shadow && list.shadow.depth > 0.0) r.draw_depth(list, light.to_clip);

  std::vector<ContactVertex> contact;
  if (r.quality.contact) contact = contact_vertices(list);
  gl.BindBuffer(GL_ARRAY_BUFFER, r.contact_buffer);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(contact.size() * sizeof(ContactVertex)),
                contact.data(), GL_STREAM_DRAW);

  const auto contacts = static_cast<GLsizei>(contact.size());
  const Scene common{.list = &list,
                     .sizes = r.sizes_seen(list, views),
                     .shadow_view = shadow_view,
                     .shades = r.shades_of(list, shadow_view)};
  std::vector<Scene> scenes(views.size(), common);
  r.targets.resize(std::max(r.targets.size(), views.size()));
  r.mirror_images.resize(r.targets.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    scenes[i].world_to_clip = world_to_clip(views[i]);
    scenes[i].eye_W = views[i].X_WE.p;
    if (r.quality.mirror) r.draw_mirrored(scenes[i], views[i], r.mirror_images[i]);
    r.draw_part(scenes[i], views[i], whole(views[i]), r.grid, contacts, r.targets[i]);
  }
  // Pictures are read after all are submitted, so that one is drawn while the next is prepared.
  for (std::size_t i = 0; i < views.size(); ++i) {
    out[i] = r.read(*r.targets[i], whole(views[i]), r.grid);
    if (r.quality.mirror) r.mirror_images[i]->bind();
    r.refine(scenes[i], views[i], contacts, out[i]);
  }
  r.finish("Renderer::draw");
}

}  // namespace headpin::render
