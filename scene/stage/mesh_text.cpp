#include "scene/stage/mesh_text.h"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "scene/stage/gltf_head.h"

namespace headpin::scene {

namespace {

/// Takes the first line off a text, with its line feed.
std::string_view take_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, std::min(rest.find('\n'), rest.size() - 1) + 1);
  rest.remove_prefix(line.size());
  return line;
}

/// An OBJ whose lines begin without blanks and end with a line feed, without a byte order mark: other
/// programs read it all the same, assimp does not. A line that goes on from the one before keeps its
/// blanks.
std::string evened_obj(std::string_view bytes) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  std::string text(bytes);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && text.compare(i, 2, "\r\n") != 0) text[i] = '\n';
  }
  std::string evened;
  evened.reserve(text.size());
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = take_line(rest);
    const bool goes_on = evened.ends_with("\\\n") || evened.ends_with("\\\r\n");
    if (!goes_on) line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    evened += line;
  }
  return evened;
}

bool is_vertex(std::string_view line) {
  return line.starts_with("v ") || line.starts_with("v\t");
}

/// How many numbers a line has that is a vertex; 0 of other lines.
std::size_t numbers_of_vertex(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::size_t numbers = 0;
  if (!is_vertex(line)) return numbers;
  for (std::size_t at = 1; (at = line.find_first_not_of(kBlank, at)) != line.npos; ++numbers) {
    at = std::min(line.find_first_of(kBlank, at), line.size());
  }
  return numbers;
}

bool has_colours(std::string_view text) {
  while (!text.empty()) {
    if (numbers_of_vertex(take_line(text)) == 6) return true;
  }
  return false;
}

/// A vertex x y z, or x y z w, that is white. As it is where w is 0, which assimp refuses.
std::string white(std::string_view vertex, bool has_w) {
  if (!has_w) return fmt::format("{} 1 1 1", vertex);
  float x = 0.0F, y = 0.0F, z = 0.0F, w = 0.0F;
  std::istringstream numbers{std::string(vertex.substr(1))};
  if (!(numbers >> x >> y >> z >> w) || w == 0.0F) return std::string(vertex);
  return fmt::format("v {} {} {} 1 1 1", x / w, y / w, z / w);
}

/// An OBJ in which all vertices have a colour if one has. Assimp would give the colours, in their order,
/// to the first vertices, and black to the others.
std::string with_all_colours(std::string text) {
  if (!has_colours(text)) return text;
  std::string all;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = take_line(rest);
    const std::size_t numbers = numbers_of_vertex(line);
    if (numbers != 3 && numbers != 4) {
      all += line;
      continue;
    }
    const std::size_t last = line.find_last_not_of(" \t\r\n") + 1;
    all += white(line.substr(0, last), numbers == 4);
    all += line.substr(last);
  }
  return all;
}

}  // namespace

std::string plain_obj(std::string_view bytes) {
  std::string text = evened_obj(bytes);
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
    if (is_vertex(line) &&
        line.find_first_not_of("0123456789+-.eE \t\r", 1) != std::string_view::npos) {
      throw std::runtime_error(fmt::format("line {}: a vertex is not a number", number));
    }
  }
  return with_all_colours(std::move(text));
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
  if (kind != ".obj") return "";
  const std::string text = evened_obj(bytes);
  const bool has_library = text.starts_with("mtllib") || text.find("\nmtllib") != text.npos;
  return has_library ? "materials" : "";
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
