#pragma once

#include <string>
#include <string_view>

namespace headpin::scene {

/// The parts of a glTF that are not drawn, from its JSON: "2 textures, alpha"; empty for none.
///
/// @param bytes  of a .gltf or a .glb
/// @throws std::runtime_error  with the reason alone, where it requires an extension that says
///   other than how surfaces look, or where its points or normals are no floats
std::string unseen_of_gltf(std::string_view bytes);

}  // namespace headpin::scene
