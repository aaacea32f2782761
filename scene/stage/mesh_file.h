#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/shape.h"

/// Mesh files: glTF (.gltf, .glb), OBJ, PLY, STL and OFF, through assimp.
///
/// Such a file comes from anywhere. It is read in a process of its own (scene/stage/apart.h), alone: no
/// other file that it names is opened, so a glTF holds its buffers, and materials of an OBJ are not
/// seen, nor are textures and alpha: MeshData says so. What assimp would mend, such as an index beyond
/// the vertices, is refused.
namespace headpin::scene {

/// How a file is to be understood.
struct MeshMeasure {
  double unit = 1.0;         ///< metres per unit of the file
  std::string axes = "RAS";  ///< where its +x, +y, +z point: R right, L left, A ahead, P back,
                             ///< S up, I down
};

/// A mesh in metres, x right, y ahead, z up. Of corners that are alike there is one.
struct MeshData {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< of the points, unit
  std::vector<Vec3> colours;  ///< of the points, linear light; empty where the file has none
  std::vector<std::uint32_t> triangles;  ///< three points each, counterclockwise from outside; of a
                                         ///< surface that is seen from both sides, each twice
  std::string unseen;  ///< what the file has besides: "2 textures, alpha"; empty for nothing
};

/// The bytes of a mesh file.
///
/// @throws std::runtime_error  naming it: not there, no regular file, empty, above 16 MB, or of a
///                             kind that is not read
std::string read_mesh_file(const std::filesystem::path& path);

/// The triangles of all meshes in a file, with the transforms of their nodes.
///
/// @param bytes  of the file
/// @param path   its name, for its kind and for messages
/// @throws std::runtime_error     naming it: broken, without triangles or with more than 200,000, beyond
///                                the limits of 1 s and 256 MB, or with numbers that no mesh has
/// @throws std::invalid_argument  unit or axes that are none
MeshData mesh_of(std::string_view bytes, const std::filesystem::path& path,
                 const MeshMeasure& measure);

/// The meshes of a file together as one convex polyhedron.
///
/// Corners within 1e-6 of the size of each other become one (STL has no shared corners), flat
/// polygons of several corners stay whole.
///
/// @throws std::runtime_error      as mesh_of(), and beyond 1000 vertices
/// @throws std::invalid_argument   naming the file, when unit or axes are none or the mesh is not a
///   closed convex polyhedron (see engine::Polyhedron)
engine::Polyhedron polyhedron_of(std::string_view bytes, const std::filesystem::path& path,
                                 const MeshMeasure& measure);

/// polyhedron_of() what read_mesh_file() reads.
engine::Polyhedron load_polyhedron(const std::filesystem::path& path,
                                   const MeshMeasure& measure = {});

}  // namespace headpin::scene
