#pragma once

#include <filesystem>

#include "engine/shape.h"

/// Convex polyhedra from mesh files.
namespace headpin::scene {

/// Reads the one mesh of a file (OBJ, PLY, STL, OFF, glTF ...: whatever assimp reads) as a
/// polyhedron.
///
/// Corners within 1e-6 of the size of each other become one (STL has no shared corners), flat
/// polygons of several corners stay whole. Node transforms in the file are applied.
///
/// @param scale  metres per unit of the file
/// @throws std::runtime_error      naming the file, when it cannot be read or holds no or several
///                                 meshes
/// @throws std::invalid_argument   naming the file, when scale is not positive or the mesh is not a
///   closed convex polyhedron (see engine::Polyhedron)
engine::Polyhedron load_polyhedron(const std::filesystem::path& path, double scale = 1.0);

}  // namespace headpin::scene
