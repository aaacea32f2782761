#include "scene/stage/mesh_text.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/stage/gltf_head.h"

namespace headpin::scene {

std::string plain_obj(std::string_view bytes) {
  std::string text(bytes);
  std::size_t number = 0;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    ++number;
    std::string_view line = std::string_view(text).substr(at, end - at);
    if (line.starts_with("mtllib") || line.starts_with("usemtl")) text[at] = '#';
    const std::size_t comment = std::min(line.find('#'), line.size());
    std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(at + comment), line.size() - comment,
                ' ');
    line = line.substr(0, comment);
    if (line.starts_with("v ") &&
        line.find_first_not_of("0123456789+-.eE \t\r", 1) != std::string_view::npos) {
      throw std::runtime_error(fmt::format("line {}: a vertex is not a number", number));
    }
  }
  return text;
}

void require_faces(std::span<const std::uint32_t> sizes, std::span<const std::uint32_t> corners,
                   std::size_t points) {
  if (corners.empty()) throw std::runtime_error("no faces");
  const std::size_t told = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  if (told != corners.size()) {
    throw std::runtime_error(
        fmt::format("expected faces with {} corners, found {}", told, corners.size()));
  }
  const std::uint32_t last = *std::ranges::max_element(corners);
  if (last >= points) {
    throw std::runtime_error(fmt::format("a face has point {}, expected one of {}", last, points));
  }
}

std::string unseen_of_mesh(const std::string& kind, std::string_view bytes) {
  if (kind == ".gltf" || kind == ".glb") return unseen_of_gltf(bytes);
  const bool has_library = bytes.starts_with("mtllib") || bytes.find("\nmtllib") != bytes.npos;
  return kind == ".obj" && has_library ? "materials" : "";
}

void require_whole_ply(std::string_view bytes) {
  const std::size_t head = bytes.find("end_header");
  if (head == std::string_view::npos || bytes.find("format ascii") > head) return;
  std::istringstream lines{std::string(bytes)};
  std::string line, word, name;
  unsigned long long said = 0, found = 0, number = 0;
  while (std::getline(lines, line) && !line.starts_with("end_header")) {
    if (std::istringstream words(line); words >> word >> name >> number && word == "element") {
      said += number;
    }
  }
  while (std::getline(lines, line)) found += line.find_first_not_of(" \t\r") != std::string::npos;
  if (found < said) {
    throw std::runtime_error(
        fmt::format("found {} lines of data, expected {} as in the header", found, said));
  }
}

}  // namespace headpin::scene
