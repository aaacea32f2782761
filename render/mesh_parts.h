#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "render/data/mesh.h"
#include "render/matrices.h"

/// Large meshes in parts, so that what nobody looks at costs nothing.
namespace headpin::render {

/// Triangles of a mesh that are near each other: drawn or left out as one.
struct MeshPart {
  std::size_t first = 0, count = 0;  ///< of the indices
  Eigen::AlignedBox3d box;           ///< in the mesh frame G [m]
};

struct MeshParts {
  std::vector<std::uint32_t> indices;  ///< of the mesh, part by part
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3d box;  ///< of all
};

/// Parts of a mesh of more than `whole` triangles by the cells of a grid that their middles lie in;
/// a smaller mesh is one part.
///
/// @param cell  edge of a cell [m]
MeshParts part_by_place(const Mesh& mesh, double cell = 1.5, std::size_t whole = 1024);

/// Whether a box lies beyond one side of the frustum, so that nothing in it is seen.
bool is_outside(const Eigen::AlignedBox3d& box, const Mat4& box_to_clip);

}  // namespace headpin::render
