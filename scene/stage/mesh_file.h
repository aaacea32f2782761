#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/shape.h"

/// Mesh files: glTF (.gltf, .glb), OBJ, PLY, STL and OFF, through assimp.
///
/// Mesh files are untrusted, so they are read in a separate process (scene/stage/apart.h). No other
/// file that they refer to is opened: a glTF must contain its buffers. Materials of an OBJ,
/// textures and alpha are not drawn, which MeshData reports. Errors that assimp would correct, such
/// as an index beyond the vertices, are refused.
namespace headpin::scene {

/// Unit and axes of a file.
struct MeshMeasure {
  double unit = 1.0;         ///< metres per unit of the file
  std::string axes = "RAS";  ///< where its +x, +y, +z point: R right, L left, A ahead, P back,
                             ///< S up, I down
};

/// A mesh in metres, x right, y ahead, z up. Equal corners are stored once.
struct MeshData {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< of the points, unit
  std::vector<Vec3> colours;  ///< of the points, linear light; empty where the file has none
  std::vector<std::uint32_t> triangles;  ///< three points each, counterclockwise from outside; of a
                                         ///< surface that is seen from both sides, each twice
  std::string unseen;  ///< parts that are not drawn: "2 textures, alpha"; empty for none
};

/// The bytes of a mesh file.
///
/// @throws std::runtime_error  naming it: it is missing, not a regular file, empty, above 16 MB, or
///                             of an unknown kind
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

/// All meshes of a file as one convex polyhedron.
///
/// Corners with a distance below 1e-6 of the size are merged (STL has no shared corners); flat
/// polygons are not split.
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
