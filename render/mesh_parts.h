#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "render/data/mesh.h"
#include "render/matrices.h"

/// Splits large meshes into parts, so that parts outside of the view are not drawn.
namespace headpin::render {

/// Nearby triangles of a mesh, which are drawn or left out together.
struct MeshPart {
  std::size_t first = 0, count = 0;  ///< of the indices
  Eigen::AlignedBox3d box;           ///< in the mesh frame G [m]
};

struct MeshParts {
  std::vector<std::uint32_t> indices;  ///< of the mesh, part by part
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3d box;  ///< of all
};

/// Splits a mesh of more than `whole` triangles by the cells of a grid that contain their centres;
/// a smaller mesh is one part.
///
/// @param cell  edge of a cell [m]
MeshParts part_by_place(const Mesh& mesh, double cell = 1.5, std::size_t whole = 1024);

/// Whether a box is completely outside one side of the frustum.
bool is_outside(const Eigen::AlignedBox3d& box, const Mat4& box_to_clip);

}  // namespace headpin::render
