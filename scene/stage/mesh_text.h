#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// What a mesh file says that assimp passes over.
namespace headpin::scene {

/// An OBJ without the lines that name materials, and without comments.
///
/// @throws std::runtime_error  with the reason alone, where a vertex is what assimp would take for 0
std::string plain_obj(std::string_view bytes);

/// Of a PLY in text: assimp does not miss the lines that are cut off.
///
/// @throws std::runtime_error  with the reason alone
void require_whole_ply(std::string_view bytes);

/// That faces have the corners that are there, and those the points: what was read may be anything.
///
/// @param sizes    corners of each face
/// @param corners  of all faces, by the number of their point
/// @throws std::runtime_error  with the reason alone
void require_faces(std::span<const std::uint32_t> sizes, std::span<const std::uint32_t> corners,
                   std::size_t points);

/// What of a file is not seen: "2 textures, alpha"; empty for nothing.
///
/// @param kind  its extension, in small letters
/// @throws std::runtime_error  as unseen_of_gltf()
std::string unseen_of_mesh(const std::string& kind, std::string_view bytes);

}  // namespace headpin::scene
