// An include points to a row below: apps > scene > devices | engine | render > engine/math.h,
// engine/hash.h | files.

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gtest/gtest.h>

namespace headpin {
namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file, target;
};

std::vector<Include> includes_of(const std::string& folder) {
  static const std::regex pattern(
      R"(^\s*#\s*include\s*["<]((files|engine|devices|render|scene|apps|tests)/[^">]+)[">])");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/" + folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);) {
      if (std::regex_search(line, match, pattern)) {
        found.push_back({fs::relative(entry.path(), HEADPIN_SOURCE_DIR).string(), match[1]});
      }
    }
  }
  return found;
}

TEST(Layers, IncludesPointDownwards) {
  const std::map<std::string, std::set<std::string>> below = {
      {"files", {"files"}},
      {"engine", {"engine"}},
      {"devices", {"devices", "files"}},
      {"render", {"render", "files"}},
      {"scene", {"scene", "devices", "engine", "render", "files"}},
      {"apps", {"apps", "scene", "devices", "engine", "render", "files"}},
  };
  const std::set<std::string> for_all = {"engine/math.h", "engine/hash.h"};  // headers alone
  for (const auto& [folder, allowed] : below) {
    const std::vector<Include> includes = includes_of(folder);
    EXPECT_FALSE(includes.empty()) << folder << ": nothing was read";
    for (const auto& [file, target] : includes) {
      const std::string top = target.substr(0, target.find('/'));
      EXPECT_TRUE(allowed.contains(top) || for_all.contains(target))
          << file << " includes " << target;
    }
  }
}

}  // namespace
}  // namespace headpin
