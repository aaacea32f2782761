#include "render/meshes.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace headpin::render {

namespace {

constexpr std::array kSurfaces = {Surface::lit, Surface::floor, Surface::baked};
constexpr double kNear = 48.0;  // pixels across: smaller objects use their far mesh

}  // namespace

Meshes::~Meshes() {
  for (const Kept& mesh : meshes_) {
    gl_.DeleteVertexArrays(1, &mesh.arrays);
    gl_.DeleteBuffers(1, &mesh.vertices);
    gl_.DeleteBuffers(1, &mesh.indices);
  }
}

int Meshes::add(const Mesh& mesh) {
  if (std::ranges::find(kSurfaces, mesh.surface) == kSurfaces.end()) {
    throw std::invalid_argument("mesh: unknown surface");
  }
  for (const std::uint32_t i : mesh.indices) {
    if (i >= mesh.vertices.size())
      throw std::invalid_argument("mesh: an index exceeds the number of vertices");
  }
  // Floors have small parts, because each one is tested for shadows.
  const MeshParts parted =
      mesh.surface == Surface::floor ? part_by_place(mesh, 0.35, 16) : part_by_place(mesh);
  Kept kept{mesh.surface, mesh.fine_light, mesh.gloss, mesh.takes_shadow, parted.parts, parted.box};
  gl_.GenVertexArrays(1, &kept.arrays);
  gl_.BindVertexArray(kept.arrays);
  gl_.GenBuffers(1, &kept.vertices);
  gl_.BindBuffer(GL_ARRAY_BUFFER, kept.vertices);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(Vertex)),
                 mesh.vertices.data(), GL_STATIC_DRAW);
  vertex_attribute(gl_, 0, 3, sizeof(Vertex), offsetof(Vertex, p));
  vertex_attribute(gl_, 1, 3, sizeof(Vertex), offsetof(Vertex, n));
  vertex_attribute(gl_, 2, 3, sizeof(Vertex), offsetof(Vertex, colour));
  gl_.GenBuffers(1, &kept.indices);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, kept.indices);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(parted.indices.size() * sizeof(std::uint32_t)),
                 parted.indices.data(), GL_STATIC_DRAW);
  meshes_.push_back(kept);
  return static_cast<int>(meshes_.size()) - 1;
}

std::vector<double> Meshes::sizes_seen(const DrawList& list, std::span<const View> views) const {
  Vec3 between = Vec3::Zero();
  for (const View& view : views) between += view.X_WE.p / static_cast<double>(views.size());
  const View& view = views.front();
  std::vector<double> sizes;
  for (const DrawItem& item : list.items) {
    const Eigen::AlignedBox3d& box = (*this)[item.mesh].box;
    const double size = box.sizes().cwiseProduct(item.scale).norm() * view.height /
                        (view.frustum.top - view.frustum.bottom);
    const double away = (item.X_WG * box.center().cwiseProduct(item.scale) - between).norm();
    sizes.push_back(size / away);
  }
  return sizes;
}

const Kept& Meshes::seen(const DrawItem& item, double size) const {
  return (*this)[size < kNear ? item.far_mesh.value_or(item.mesh) : item.mesh];
}

}  // namespace headpin::render
