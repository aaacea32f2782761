#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/data/mesh.h"
#include "scene/scenario/scenario.h"

/// A scenario's mesh files: finds and hashes them, and makes collision shapes and meshes.
///
/// The scenario stores the corners of colliding meshes, so a trial can be replayed anywhere. Of
/// meshes that are only drawn, it stores path and hash.
namespace headpin::scene {

/// Allowed distance of a mesh's farthest point from its origin [m].
struct Reach {
  double least, most;
};

/// Half to twice that of the shape that it replaces; arms and rooms have fixed limits.
Reach reach_of_ball(const Ball& ball);
Reach reach_of_skittle(const Skittle& skittle);
inline constexpr Reach kReachOfHand{0.05, 1.5}, kReachOfRoom{0.5, 1e3};

/// Reads the file that a scenario names: `file` becomes an absolute path, `sha256` its hash.
///
/// @param folder  that a relative path is from
/// @throws std::runtime_error, std::invalid_argument  as mesh_of(), for another hash than given, and
///                                for what is of no area or reaches elsewhere
void take_seen(MeshFile& mesh, const std::filesystem::path& folder, const Reach& reach);

/// Whether the file of a mesh can be read and has its hash.
bool is_still_there(const MeshFile& mesh);

/// The parts of the scenario's mesh files that are not drawn (textures, alpha), one sentence per
/// file.
///
/// @throws std::runtime_error  as seen_mesh()
std::vector<std::string> not_drawn(const Scenario& scenario);

/// The mesh files of skittles that are not convex, with the convex pieces that collide in their place,
/// one sentence per file with its unit and axes. A file that cannot be read, or has another hash, is left
/// out: the scenario has its corners.
///
/// @throws std::runtime_error  for a file that encloses nothing
std::vector<std::string> not_convex(const Scenario& scenario);

/// A polyhedron with its corners, faces and measures. Without corners it is read from its file, and
/// becomes several where the mesh is not convex.
///
/// @param most  number of parts, 1 or more
/// @throws std::runtime_error, std::invalid_argument  as polyhedra_of(), and for another hash
std::vector<SkittlePart> polyhedra_of_part(const SkittlePart& part,
                                           const std::filesystem::path& folder, std::size_t most);

/// Finds a trial's mesh: at its path, next to the trial, or among the bundled ones; the first file
/// with its hash. Otherwise it keeps its path, and seen_mesh() throws.
void find_again(MeshFile& mesh, const std::filesystem::path& trial);

/// The mesh of a file that take_seen() read; x right, y ahead, z up.
///
/// @param colour  where the file has none; linear light
/// @return        none where no file is named
/// @throws std::runtime_error  naming the file: not there, with another hash, or no mesh
std::optional<render::Mesh> seen_mesh(const MeshFile& mesh, const Vec3& colour, double gloss);

}  // namespace headpin::scene
