// An include points to a row below: apps > study > scene > devices | engine | render > engine/math.h,
// engine/hash.h | files.

#include <filesystem>
#include <fstream>
#include <iterator>
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
      R"(^\s*#\s*include\s*["<]((files|engine|devices|render|scene|study|apps|tests)/[^">]+)[">])");
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
      {"study", {"study", "scene", "devices", "engine", "render", "files"}},
      {"apps", {"apps", "study", "scene", "devices", "engine", "render", "files"}},
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

// A name that is the same for everybody is another user's by chance, or another run's.
TEST(Tests, TakeTheirTemporaryFoldersFromSupport) {
  static const std::regex pattern(R"(TempDir\(|"/tmp/|temp_directory_path\()");
  int read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/tests")) {
    const std::string name = entry.path().filename().string();
    const bool source = name.ends_with(".h") || name.ends_with(".cpp");
    if (!source || name == "folder.h" || name == "layers_test.cpp") continue;
    std::ifstream file(entry.path());
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_FALSE(std::regex_search(text, pattern)) << entry.path() << ": expected fresh_folder()";
    ++read;
  }
  EXPECT_GT(read, 100);
}

// docs/paper.md says of each claim of the paper where it is done: by a file and names within it.
TEST(ThePaperPage, PointsAtFilesAndNamesThatAreThere) {
  static const std::regex link(R"(\]\(([^)]+)\)((?:,? `[^`]+`)*))"), name(R"(`([^`]+)`)");
  const fs::path docs = fs::path(HEADPIN_SOURCE_DIR) / "docs";
  std::ifstream page(docs / "paper.md");
  int rows = 0, names = 0;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| ") || line.starts_with("| the paper |")) continue;
    ++rows;
    const std::string where = line.substr(line.rfind(" | "));
    if (line.find("| absent") != std::string::npos) continue;
    std::sregex_iterator found(where.begin(), where.end(), link), none;
    EXPECT_NE(found, none) << "nowhere: " << line;
    for (; found != none; ++found) {
      const fs::path path = docs / (*found)[1].str();
      std::ifstream file(path);
      ASSERT_TRUE(file) << path;
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      const std::string said = (*found)[2];
      for (std::sregex_iterator one(said.begin(), said.end(), name); one != none; ++one) {
        EXPECT_NE(text.find((*one)[1]), std::string::npos) << path << ": " << (*one)[1];
        ++names;
      }
    }
  }
  EXPECT_GT(rows, 30);
  EXPECT_GT(names, 30);
}

// What removes or replaces a user's files can be read in one place.
TEST(Layers, FilesAloneRemoveRenameAndCut) {
  static const std::regex call(
      R"((^|[^\w.])(?:fs::|std::|::)?(unlink|unlinkat|rmdir|rename|renameat|renameat2|remove_all|)"
      R"(truncate|ftruncate|resize_file|linkat)\()"
      R"(|(fs|filesystem)::remove\()");
  int in_files = 0;
  for (const char* folder : {"files", "engine", "devices", "render", "scene", "study", "apps"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/" + std::string(folder))) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        line = line.substr(0, line.find("//"));
        if (!std::regex_search(line, call)) continue;
        if (std::string(folder) == "files") {
          ++in_files;
        } else {
          ADD_FAILURE() << entry.path() << ": " << line;
        }
      }
    }
  }
  EXPECT_GT(in_files, 10) << "nothing was read";
}

}  // namespace
}  // namespace headpin
