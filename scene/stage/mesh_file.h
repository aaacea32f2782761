#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/shape.h"
#include "scene/stage/mesh_measure.h"

/// Mesh files: glTF (.gltf, .glb), OBJ, PLY, STL and OFF, through assimp.
///
/// Mesh files are untrusted, so they are read in a separate process (scene/stage/apart.h). No other
/// file that they refer to is opened: a glTF must contain its buffers. Materials of an OBJ,
/// textures and alpha are not drawn, which MeshData reports. Errors that assimp would correct, such
/// as an index beyond the vertices, are refused.
namespace headpin::scene {

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
/// @throws std::runtime_error     naming it: broken, without triangles or with more than 200,000, or beyond
///                                the limits of 1 s and 256 MB
/// @throws std::invalid_argument  unit or axes that are none, and points too far away for a mesh, as
///                                where the unit is another one
MeshData mesh_of(std::string_view bytes, const std::filesystem::path& path,
                 const MeshMeasure& measure);

/// All meshes of a file as convex polyhedra: one with the flat polygons of the file if it is convex, or
/// else pieces (see convex_pieces()).
///
/// Corners with a distance below kWelded of the size are merged (STL has no shared corners).
///
/// @param most  number of pieces, 1 or more
/// @throws std::runtime_error     as mesh_of(), beyond 1000 vertices of a polyhedron, beyond 10 s of
///                                cutting, and when the mesh is not closed, is turned inside out or has
///                                no volume
/// @throws std::invalid_argument  as mesh_of()
std::vector<engine::Polyhedron> polyhedra_of(std::string_view bytes,
                                             const std::filesystem::path& path,
                                             const MeshMeasure& measure, std::size_t most);

/// How much volume pieces add to what all meshes of a file enclose, as a part of it; below 0 where they
/// leave out more. What several shells or several pieces enclose counts once: measured there by overlap_of(),
/// else exact.
///
/// @param pieces  convex polyhedra that collide in place of the file
/// @throws std::runtime_error, std::invalid_argument  as mesh_of()
double added_by(std::span<const engine::Polyhedron> pieces, std::string_view bytes,
                const std::filesystem::path& path, const MeshMeasure& measure);

}  // namespace headpin::scene
