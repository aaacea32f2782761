#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/data/mesh.h"

namespace headpin::apps {

/// A length as the file stores it.
///
/// @throws std::runtime_error  from 4 GiB on
std::uint32_t glb_length(std::size_t bytes);

/// A binary glTF 2.0 file that is being written: its JSON and its binary chunk.
class Glb {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};

  /// Stores numbers as float32.
  ///
  /// @param width   numbers per element: 1, 3 or 4
  /// @param bounds  whether the accessor says the least and the largest values
  /// @return        number of the accessor
  std::size_t add_floats(std::span<const float> numbers, std::size_t width, bool bounds);

  /// Stores a mesh with normals and vertex colours.
  /// @return  number of the mesh
  std::size_t add_mesh(const render::Mesh& mesh, const std::string& name);

  /// Appends to an array at the top of the JSON.
  /// @return  the position there
  std::size_t add(const char* array, nlohmann::json item);

  /// The whole file.
  /// @throws std::runtime_error  when it is longer than a GLB file can be
  std::string bytes() const;

 private:
  std::size_t add_view(const void* data, std::size_t size);

  std::string binary_;
};

}  // namespace headpin::apps
