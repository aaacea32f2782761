#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Checks of mesh files that assimp does not make. They stay our own code for that reason.
namespace headpin::scene {

/// An OBJ without the lines that name materials, without comments, a byte order mark and blanks before
/// its lines, and with line feeds where the file has carriage returns alone. Where some vertices have
/// colours, the others are white.
///
/// @throws std::runtime_error  with the reason alone, where a vertex is what assimp would take for 0
std::string plain_obj(std::string_view bytes);

/// Checks a PLY in text form: assimp accepts one with missing lines.
///
/// @throws std::runtime_error  with the reason alone
void require_whole_ply(std::string_view bytes);

/// Checks that faces have existing corners, and corners existing points.
///
/// @param sizes    corners of each face
/// @param corners  of all faces, by the number of their point
/// @throws std::runtime_error  with the reason alone
void require_faces(std::span<const std::uint32_t> sizes, std::span<const std::uint32_t> corners,
                   std::size_t points);

/// The parts of a file that are not drawn: "2 textures, alpha"; empty for none.
///
/// @param kind  its extension, in small letters
/// @throws std::runtime_error  as unseen_of_gltf()
std::string unseen_of_mesh(const std::string& kind, std::string_view bytes);

}  // namespace headpin::scene
