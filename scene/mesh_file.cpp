#include "scene/mesh_file.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace headpin::scene {
namespace {

/// Index of each corner among the distinct ones, which are returned: within `apart` is the same.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& corners, double apart,
                                std::vector<Vec3>& distinct) {
  std::vector<std::uint32_t> by_x(corners.size());
  for (std::uint32_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t i, std::uint32_t j) {
    return corners[i].x() != corners[j].x() ? corners[i].x() < corners[j].x() : i < j;
  });
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> index(corners.size(), kNone);
  for (std::size_t k = 0; k < by_x.size(); ++k) {
    const std::uint32_t i = by_x[k];
    if (index[i] != kNone) continue;
    index[i] = static_cast<std::uint32_t>(distinct.size());
    distinct.push_back(corners[i]);
    for (std::size_t m = k + 1; m < by_x.size(); ++m) {
      const std::uint32_t j = by_x[m];
      if (corners[j].x() - corners[i].x() > apart) break;
      if (index[j] == kNone && (corners[j] - corners[i]).norm() <= apart) index[j] = index[i];
    }
  }
  return index;
}

}  // namespace

engine::Polyhedron load_polyhedron(const std::filesystem::path& path, double scale) {
  if (!(scale > 0.0)) {
    throw std::invalid_argument(path.string() + ": scale " + std::to_string(scale) +
                                ", expected above 0");
  }
  std::string kind = path.extension().string();
  for (char& c : kind) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (kind != ".obj" && kind != ".stl" && kind != ".off") {
    throw std::runtime_error(path.string() + ": kind \"" + kind +
                             "\", expected .obj, .stl or .off");
  }
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_PreTransformVertices);
  if (scene == nullptr) throw std::runtime_error(path.string() + ": " + importer.GetErrorString());
  if (scene->mNumMeshes != 1) {
    throw std::runtime_error(path.string() + ": " + std::to_string(scene->mNumMeshes) +
                             " meshes, expected 1");
  }
  const aiMesh& mesh = *scene->mMeshes[0];
  std::vector<Vec3> corners;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    corners.push_back(scale * Vec3(v.x, v.y, v.z));
    low = i == 0 ? corners[0] : Vec3(low.cwiseMin(corners.back()));
    high = i == 0 ? corners[0] : Vec3(high.cwiseMax(corners.back()));
  }
  std::vector<Vec3> distinct;
  const std::vector<std::uint32_t> index = weld(corners, 1e-6 * (high - low).norm(), distinct);
  std::vector<std::vector<std::uint32_t>> faces;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    std::vector<std::uint32_t> list;
    for (unsigned k = 0; k < face.mNumIndices; ++k) list.push_back(index[face.mIndices[k]]);
    faces.push_back(std::move(list));
  }
  try {
    return engine::Polyhedron(std::move(distinct), faces);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(path.string() + ": " + e.what());
  }
}

}  // namespace headpin::scene
