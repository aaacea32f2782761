#include "apps/output_name.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin::apps {

namespace {

/// File name endings of known kinds of files.
constexpr std::array<std::string_view, 34> kKindsOfFiles = {
    ".avi", ".bmp",  ".c3d",  ".csv",  ".eps",  ".fbx",    ".gif",  ".glb",  ".gltf",
    ".htm", ".html", ".jpeg", ".jpg",  ".json", ".lcmlog", ".mcap", ".mkv",  ".mov",
    ".mp4", ".pdf",  ".png",  ".ps",   ".svg",  ".tif",    ".tiff", ".toml", ".tsv",
    ".txt", ".wav",  ".webm", ".webp", ".xlsx", ".y4m",    ".zip"};

std::string small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace

std::string either_of(const std::vector<std::string>& words) {
  if (words.size() < 2) return fmt::format("{}", fmt::join(words, ""));
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

std::string wrong_output(const std::string& name, const std::vector<std::string>& endings) {
  if (name.empty()) return "expected a name, found none";
  const std::string ending = std::filesystem::path(name).extension().string();
  const bool kind = std::ranges::count(kKindsOfFiles, small_letters(ending)) > 0;
  if (!kind || std::ranges::count(endings, ending) > 0) return "";
  return endings.empty()
             ? fmt::format("expected the name of a folder, found {}", name)
             : fmt::format("expected a name that ends in {}, found {}", either_of(endings), name);
}

}  // namespace headpin::apps
