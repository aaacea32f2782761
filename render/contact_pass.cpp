#include "render/contact_pass.h"

#include "render/contact_shadow.h"
#include "render/meshes.h"
#include "render/shaders.h"

namespace headpin::render {

ContactPass::ContactPass(const Gl& gl, bool on)
    : gl_(gl),
      on_(on),
      program_(gl, shaders::vertex_shader({}, shaders::kContactVertex),
               shaders::shader({}, shaders::kContactFragment)) {
  gl.GenVertexArrays(1, &arrays_);
  gl.BindVertexArray(arrays_);
  gl.GenBuffers(1, &buffer_);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  vertex_attribute(gl, 0, 3, sizeof(ContactVertex), offsetof(ContactVertex, p));
  vertex_attribute(gl, 1, 3, sizeof(ContactVertex), offsetof(ContactVertex, n));
  vertex_attribute(gl, 2, 4, sizeof(ContactVertex), offsetof(ContactVertex, ball));
}

ContactPass::~ContactPass() {
  gl_.DeleteVertexArrays(1, &arrays_);
  gl_.DeleteBuffers(1, &buffer_);
}

void ContactPass::load(const DrawList& list) {
  std::vector<ContactVertex> vertices;
  if (on_) vertices = contact_vertices(list);
  gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(ContactVertex)),
                 vertices.data(), GL_STREAM_DRAW);
  count_ = static_cast<GLsizei>(vertices.size());
}

void ContactPass::draw(const EyeScene& scene) const {
  if (count_ == 0) return;
  program_.use();
  program_.set("view", scene.world_to_clip);
  program_.set("grid_x", scene.grid_x);
  program_.set("grid_y", scene.grid_y);
  program_.set("edge", scene.edge);
  program_.set("faint", kFaint);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ZERO, GL_SRC_COLOR);
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(-1.0F, -4.0F);
  gl_.DepthMask(GL_FALSE);
  gl_.BindVertexArray(arrays_);
  gl_.DrawArrays(GL_TRIANGLES, 0, count_);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
  gl_.Disable(GL_BLEND);
}

}  // namespace headpin::render
