#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/data/mesh.h"
#include "scene/scenario/scenario.h"

/// A scenario's mesh files: found, hashed, and made into what collides and what is seen.
///
/// What collides is kept in the scenario corner by corner, so a trial replays anywhere. What is
/// only seen stays a file; the scenario has its place and its hash.
namespace headpin::scene {

/// How far from its origin a mesh may reach [m].
struct Reach {
  double least, most;
};

/// Half to double of what a mesh is seen in place of; arms and rooms are as they are.
Reach reach_of_ball(const Ball& ball);
Reach reach_of_skittle(const Skittle& skittle);
inline constexpr Reach kReachOfHand{0.05, 1.5}, kReachOfRoom{0.5, 1e3};

/// Reads the file that a scenario names: `file` becomes an absolute path, `sha256` its hash.
///
/// @param folder  that a relative path is from
/// @throws std::runtime_error, std::invalid_argument  as mesh_of(), for another hash than given, and
///                                for what is of no area or reaches elsewhere
void take_seen(MeshFile& mesh, const std::filesystem::path& folder, const Reach& reach);

/// What the scenario's mesh files have that is not drawn, a sentence a file: textures, alpha.
///
/// @throws std::runtime_error  as seen_mesh()
std::vector<std::string> not_drawn(const Scenario& scenario);

/// Makes a polyhedron whole: corners and faces from its file where it has none yet, and its measures.
///
/// @throws std::runtime_error, std::invalid_argument  as polyhedron_of(), and for another hash
void take_polyhedron(SkittlePart& part, const std::filesystem::path& folder);

/// Where a trial's mesh is now: at its path, beside the trial, or among the program's own; the
/// first that has its hash. Else it keeps its path, and seen_mesh() complains.
void find_again(MeshFile& mesh, const std::filesystem::path& trial);

/// What is seen of a file that take_seen() took; x right, y ahead, z up.
///
/// @param colour  where the file has none; linear light
/// @return        none where no file is named
/// @throws std::runtime_error  naming the file: not there, with another hash, or no mesh
std::optional<render::Mesh> seen_mesh(const MeshFile& mesh, const Vec3& colour, double gloss);

}  // namespace headpin::scene
