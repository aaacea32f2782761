#include <stdexcept>

#include "scene/stage/mesh_file.h"

// In place of scene/stage/mesh_file.cpp where there is no assimp. What collides is in a trial corner by
// corner; a mesh that is only seen is a file, and says that it cannot be read here.
namespace headpin::scene {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw std::runtime_error(path.string() + ": a mesh file, which is not read here");
}

}  // namespace

std::string read_mesh_file(const std::filesystem::path& path) {
  refuse(path);
}

MeshData mesh_of(std::string_view, const std::filesystem::path& path, const MeshMeasure&) {
  refuse(path);
}

std::vector<engine::Polyhedron> polyhedra_of(std::string_view, const std::filesystem::path& path,
                                             const MeshMeasure&, std::size_t) {
  refuse(path);
}

double added_by(std::span<const engine::Polyhedron>, std::string_view,
                const std::filesystem::path& path, const MeshMeasure&) {
  refuse(path);
}

std::string offer_of_measure(std::span<const Vec3>, const MeshMeasure&) {
  return "";
}

}  // namespace headpin::scene
