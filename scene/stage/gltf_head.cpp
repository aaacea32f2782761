#include "scene/stage/gltf_head.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace headpin::scene {

namespace {

using nlohmann::json;

/// The JSON of a file; null if it has none, which the reader of the file reports.
json json_of(std::string_view bytes) {
  // The binary form (glTF 2.0, section 4.4): a head of 12 bytes, the length of the first chunk and
  // "JSON", then so many bytes.
  constexpr std::size_t kHead = 20;
  if (bytes.starts_with("glTF") && bytes.size() >= kHead) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    bytes = bytes.substr(kHead, length);
  }
  json found = json::parse(bytes, nullptr, false);
  return found.is_object() ? found : json(nullptr);
}

// The value of a key in a file, or nothing. A file may have any JSON there.

json value(const json& object, const char* key) {
  return object.is_object() ? object.value(key, json()) : json();
}

json list(const json& object, const char* key) {
  json found = value(object, key);
  return found.is_array() ? found : json::array();
}

json entry(const json& list, const json& index) {
  if (!index.is_number_unsigned() || index.get<std::size_t>() >= list.size()) return {};
  return list[index.get<std::size_t>()];
}

void require_known_extensions(const json& file) {
  for (const json& one : list(file, "extensionsRequired")) {
    const std::string name = one.is_string() ? one.get<std::string>() : one.dump();
    const bool looks = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
                       name.starts_with("EXT_texture_") || name == "KHR_lights_punctual";
    if (!looks)
      throw std::runtime_error(fmt::format("it requires {}, which headpin does not read", name));
  }
}

void require_floats(const json& file) {
  constexpr int kFloat = 5126;
  const json accessors = list(file, "accessors");
  for (const json& mesh : list(file, "meshes")) {
    for (const json& primitive : list(mesh, "primitives")) {
      for (const char* name : {"POSITION", "NORMAL"}) {
        const json type =
            value(entry(accessors, value(value(primitive, "attributes"), name)), "componentType");
        if (!type.is_number_integer() || type == kFloat) continue;
        throw std::runtime_error(
            fmt::format("{} of component type {}, expected {}, floats", name, type.dump(), kFloat));
      }
    }
  }
}

}  // namespace

std::string unseen_of_gltf(std::string_view bytes) {
  const json file = json_of(bytes);
  require_known_extensions(file);
  require_floats(file);
  std::string unseen;
  const std::size_t textures = list(file, "textures").size();
  if (textures > 0) unseen = fmt::format("{} texture{}", textures, textures == 1 ? "" : "s");
  for (const json& material : list(file, "materials")) {
    const json mode = value(material, "alphaMode");
    if (mode.is_null() || mode == "OPAQUE") continue;
    unseen += unseen.empty() ? "alpha" : ", alpha";
    break;
  }
  return unseen;
}

}  // namespace headpin::scene
