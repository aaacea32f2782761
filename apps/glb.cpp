#include "apps/glb.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::apps {

namespace {

// Numbers of the specification, section 5.1.3 and 4.4.
constexpr int kFloat = 5126, kUnsignedInt = 5125;
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;

static_assert(std::endian::native == std::endian::little, "a GLB file is little-endian");

void append_number(std::string& to, std::uint32_t number) {
  to.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void append_chunk(std::string& to, std::uint32_t type, std::string data, char filler) {
  data.resize((data.size() + 3) / 4 * 4, filler);
  append_number(to, glb_length(data.size()));
  append_number(to, type);
  to += data;
}

void append_vector(std::vector<float>& to, const Eigen::Vector3f& v) {
  to.insert(to.end(), {v.x(), v.y(), v.z()});
}

}  // namespace

std::uint32_t glb_length(std::size_t bytes) {
  constexpr std::size_t kMost = 0xffff'ffff;
  if (bytes <= kMost) return static_cast<std::uint32_t>(bytes);
  throw std::runtime_error(fmt::format(
      "glTF: {} bytes are more than a GLB file can have, 4 GiB; --tolerance leaves out keys",
      bytes));
}

std::size_t Glb::add(const char* array, nlohmann::json item) {
  json[array].push_back(std::move(item));
  return json[array].size() - 1;
}

std::size_t Glb::add_view(const void* data, std::size_t size) {
  const std::size_t begin = binary_.size();
  binary_.append(static_cast<const char*>(data), size);
  return add("bufferViews", {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", size}});
}

std::size_t Glb::add_floats(std::span<const float> numbers, std::size_t width, bool bounds) {
  const char* type = width == 1 ? "SCALAR" : width == 3 ? "VEC3" : "VEC4";
  nlohmann::json accessor = {{"bufferView", add_view(numbers.data(), numbers.size_bytes())},
                             {"componentType", kFloat},
                             {"count", numbers.size() / width},
                             {"type", type}};
  if (bounds) {
    std::vector<float> low(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(width));
    std::vector<float> high = low;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      low[i % width] = std::min(low[i % width], numbers[i]);
      high[i % width] = std::max(high[i % width], numbers[i]);
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }
  return add("accessors", accessor);
}

std::size_t Glb::add_mesh(const render::Mesh& mesh, const std::string& name) {
  std::vector<float> places, normals, colours;
  for (const render::Vertex& vertex : mesh.vertices) {
    append_vector(places, vertex.p);
    const bool has_normal = vertex.n.norm() > 0.0f;
    append_vector(normals, has_normal ? vertex.n.normalized() : Eigen::Vector3f::UnitZ());
    append_vector(colours, vertex.colour.cwiseMax(0.0f).cwiseMin(1.0f));
  }
  const std::size_t indices =
      add("accessors", {{"bufferView", add_view(mesh.indices.data(), mesh.indices.size() * 4)},
                        {"componentType", kUnsignedInt},
                        {"count", mesh.indices.size()},
                        {"type", "SCALAR"}});
  const nlohmann::json attributes = {{"POSITION", add_floats(places, 3, true)},
                                     {"NORMAL", add_floats(normals, 3, false)},
                                     {"COLOR_0", add_floats(colours, 3, false)}};
  const int material = mesh.surface == render::Surface::lit ? 0 : 1;
  const nlohmann::json part = {
      {"attributes", attributes}, {"indices", indices}, {"material", material}};
  return add("meshes", {{"name", name}, {"primitives", nlohmann::json::array({part})}});
}

std::string Glb::bytes() const {
  nlohmann::json whole = json;
  whole["buffers"][0]["byteLength"] = (binary_.size() + 3) / 4 * 4;
  std::string chunks;
  const auto replace = nlohmann::json::error_handler_t::replace;
  append_chunk(chunks, kJson, whole.dump(-1, ' ', false, replace), ' ');
  append_chunk(chunks, kBin, binary_, '\0');
  std::string file;
  append_number(file, kMagic);
  append_number(file, kVersion);
  append_number(file, glb_length(12 + chunks.size()));
  return file + chunks;
}

}  // namespace headpin::apps
