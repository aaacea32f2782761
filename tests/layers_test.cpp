// An include points to a row below: apps > sweep > study > scene > devices | engine | render > base;
// and to a room below within scene and devices (CONTRIBUTING.md, Layers).

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

namespace headpin {
namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file, target;
};

std::vector<Include> includes_of(const std::string& folder) {
  static const std::regex pattern(
      R"(^\s*#\s*include\s*["<]((base|engine|devices|render|scene|study|sweep|apps|tests)/[^">]+)[">])");
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

// Rooms of a folder, the lowest first; those of one row do not know each other.
const std::map<std::string, std::vector<std::set<std::string>>> kRooms = {
    {"scene",
     {{"scenario"},
      {"record"},
      {"stage"},
      {"play"},
      {"looks", "people", "sound"},
      {"watch"},
      {"page", "live"}}},
    {"devices",
     {{"base"}, {"log", "lines"}, {"fastrak"}, {"lcm", "recordings"}, {"live"}, {"emulated"}}},
};

TEST(Layers, IncludesPointDownwards) {
  const std::map<std::string, std::set<std::string>> below = {
      {"base", {"base"}},
      {"engine", {"engine", "base"}},
      {"devices", {"devices", "base"}},
      {"render", {"render", "base"}},
      {"scene", {"scene", "devices", "engine", "render", "base"}},
      {"study", {"study", "scene", "devices", "engine", "render", "base"}},
      {"sweep", {"sweep", "study", "scene", "devices", "engine", "render", "base"}},
      {"apps", {"apps", "sweep", "study", "scene", "devices", "engine", "render", "base"}},
  };
  for (const auto& [folder, allowed] : below) {
    const std::vector<Include> includes = includes_of(folder);
    EXPECT_FALSE(includes.empty()) << folder << ": nothing was read";
    for (const auto& [file, target] : includes) {
      const std::string top = target.substr(0, target.find('/'));
      EXPECT_TRUE(allowed.contains(top)) << file << " includes " << target;
    }
  }
}

std::string room_of(const std::string& file) {
  const std::size_t first = file.find('/'), second = file.find('/', first + 1);
  return second == std::string::npos ? "" : file.substr(first + 1, second - first - 1);
}

int row_of(const std::string& folder, const std::string& room) {
  const auto& rows = kRooms.at(folder);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].contains(room)) return static_cast<int>(i);
  }
  return -1;
}

TEST(Layers, RoomsIncludeTheRoomsBelowThem) {
  for (const auto& [folder, rows] : kRooms) {
    int between = 0;
    for (const auto& [file, target] : includes_of(folder)) {
      ASSERT_GE(row_of(folder, room_of(file)), 0) << file << " is in no room";
      if (!target.starts_with(folder + "/") || room_of(file) == room_of(target)) continue;
      EXPECT_GT(row_of(folder, room_of(file)), row_of(folder, room_of(target)))
          << file << " includes " << target;
      ++between;
    }
    EXPECT_GT(between, 20) << folder;
  }
}

// What collides is not compiled again when it is drawn otherwise.
TEST(Layers, WhatCollidesKnowsOfDrawingPlainDataAlone) {
  const std::set<std::string> collide = {"scenario", "record", "stage", "play", "people", "sound"};
  int data = 0;
  for (const auto& [file, target] : includes_of("scene")) {
    if (!collide.contains(room_of(file)) || !target.starts_with("render/")) continue;
    EXPECT_TRUE(target.starts_with("render/data/")) << file << " includes " << target;
    ++data;
  }
  EXPECT_GT(data, 0);
  for (const auto& [file, target] : includes_of("render/data")) {
    EXPECT_TRUE(target.starts_with("render/data/") || target == "base/math.h")
        << file << " includes " << target;
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

// "  game, referee   what fell": the names of a row, in the folder of the row above that has one.
TEST(TheMap, NamesFilesThatAreThereAndEveryRoom) {
  std::ifstream page(HEADPIN_SOURCE_DIR "/CONTRIBUTING.md");
  std::string line, folder;
  while (std::getline(page, line) && line != "## Map") continue;
  while (std::getline(page, line) && line != "```text") continue;
  std::set<std::string> folders;
  int names = 0;
  for (; std::getline(page, line) && line != "```";) {
    const bool first = line[0] != ' ';
    const std::size_t begin = line.find_first_not_of(' ');
    std::istringstream row(line.substr(begin, line.find("  ", begin) - begin));
    if (begin > 2) continue;  // goes on with what the row above says
    for (std::string name; std::getline(row >> std::ws, name, ',');) {
      if (first && name.find('/') != std::string::npos) {
        folder = name.substr(0, name.rfind('/') + 1);
        folders.insert(folder);
        name = name.substr(folder.size());
      }
      std::regex file(std::regex_replace(name, std::regex(R"(\*)"), ".*") + R"((/|\.h|\.cpp)?)");
      if (name.find('/') != std::string::npos) name = name.substr(0, name.find('/') + 1);
      bool there = name.empty() || fs::exists(HEADPIN_SOURCE_DIR "/" + folder + name);
      if (!there) {
        for (const auto& entry : fs::directory_iterator(HEADPIN_SOURCE_DIR "/" + folder)) {
          there = there || std::regex_match(entry.path().filename().string(), file);
        }
      }
      EXPECT_TRUE(there) << folder << name;
      ++names;
    }
  }
  EXPECT_GT(names, 90);
  for (const auto& [top, rows] : kRooms) {
    for (const auto& row : rows) {
      for (const std::string& room : row) {
        EXPECT_TRUE(folders.contains(top + "/" + room + "/")) << top << "/" << room;
      }
    }
  }
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// The line that the block which ends in `end` begins with: the last before it that is no deeper.
std::size_t begin_of_block(const std::vector<std::string>& lines, std::size_t end) {
  const std::size_t depth = lines[end].find('}');
  std::size_t begin = end;
  while (begin > 0 && lines[--begin].find_first_not_of(' ') > depth) continue;
  return begin;
}

// In formatted sources a function ends in a line that holds nothing but `}`, at the depth of a
// namespace or of a class. A class ends in `};`, a namespace in `}  // namespace`.
TEST(Sources, HaveFunctionsOf70LinesAndFilesOf500AtMost) {
  int functions = 0;
  for (const char* folder :
       {"base", "engine", "devices", "render", "scene", "study", "sweep", "apps", "tests"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/" + std::string(folder))) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      const std::vector<std::string> lines = lines_of(entry.path());
      EXPECT_LE(lines.size(), 500u) << entry.path();
      for (std::size_t i = 1; i < lines.size(); ++i) {
        if (lines[i] != "}" && lines[i] != "  }") continue;
        const std::size_t begin = begin_of_block(lines, i);
        EXPECT_LE(i + 1 - begin, 70u) << entry.path() << ": " << lines[begin];
        ++functions;
      }
    }
  }
  EXPECT_GT(functions, 1000) << "nothing was read";
}

/// Sources that a CMake file lists as `set(parts FOLDER/NAME ...)`, without their endings.
std::set<std::string> parts_in(const std::string& cmake_file) {
  const std::vector<std::string> lines = lines_of(HEADPIN_SOURCE_DIR "/" + cmake_file);
  std::set<std::string> parts;
  bool inside = false;
  for (std::string line : lines) {
    inside |= line == "set(parts";
    if (!inside || line == "set(parts") continue;
    inside = !line.ends_with(')');
    if (!inside) line.pop_back();
    std::istringstream words(line);
    for (std::string word; words >> word;) parts.insert(word);
    if (!inside) break;
  }
  return parts;
}

/// Adds the headers that a file includes, and those that they include, without their endings.
void add_headers_of(const std::string& file, std::set<std::string>& headers) {
  static const std::regex pattern(R"(^#include "([^"]+)\.h")");
  std::smatch match;
  for (const std::string& line : lines_of(HEADPIN_SOURCE_DIR "/" + file)) {
    if (!std::regex_search(line, match, pattern)) continue;
    const std::string name = match[1];
    if (headers.insert(name).second) add_headers_of(name + ".h", headers);
  }
}

// A check that nobody can call checks nothing.
TEST(Dev, RunsEveryCheckThatItHas) {
  const std::vector<std::string> lines = lines_of(HEADPIN_SOURCE_DIR "/dev");
  std::string called;
  bool inside = false;
  for (const std::string& line : lines) {
    if (line == "check() {") inside = true;
    if (inside) called += line + "\n";
    if (line == "}") inside = false;
  }
  const std::regex defined(R"(^check_(\w+)\(\) \{)");
  int checks = 0;
  for (const std::string& line : lines) {
    std::smatch match;
    if (!std::regex_search(line, match, defined)) continue;
    ++checks;
    EXPECT_TRUE(std::regex_search(called, std::regex("\\b" + match[1].str() + "\\b"))) << line;
  }
  EXPECT_GT(checks, 15);
}

// The page and other processors build a part of the sources; no build here would miss one of them.
TEST(Sources, OfAReplayAloneAreListedWithAllThatTheyNeed) {
  // Nothing of these is called, and cmake/no_mesh_files.cpp stands for the last two.
  const std::set<std::string> only_headers = {
      "scene/record/log", "scene/record/tables",   "render/gl_context",       "render/image",
      "render/renderer",  "scene/stage/mesh_file", "scene/stage/mesh_measure"};
  std::set<std::string> listed = parts_in("cmake/replay_alone.cmake");
  EXPECT_GT(listed.size(), 40u);
  const std::set<std::string> of_page = parts_in("apps/report/engine/CMakeLists.txt");
  EXPECT_GT(of_page.size(), 8u);
  listed.insert(of_page.begin(), of_page.end());
  std::set<std::string> headers;
  for (const std::string& name : listed) add_headers_of(name + ".cpp", headers);
  for (const std::string& name : headers) {
    const bool of_step = name.starts_with("engine/") || name == "base/math";
    if (of_step || !fs::exists(HEADPIN_SOURCE_DIR "/" + name + ".cpp")) continue;
    EXPECT_TRUE(listed.contains(name) || only_headers.contains(name))
        << name << ".cpp is not in cmake/replay_alone.cmake";
  }
}

// What removes or replaces a user's files can be read in one place.
TEST(Layers, BaseAloneRemovesRenamesAndCuts) {
  static const std::regex call(
      R"((^|[^\w.])(?:fs::|std::|::)?(unlink|unlinkat|rmdir|rename|renameat|renameat2|remove_all|)"
      R"(truncate|ftruncate|resize_file|linkat)\()"
      R"(|(fs|filesystem)::remove\()");
  int in_base = 0;
  for (const char* folder :
       {"base", "engine", "devices", "render", "scene", "study", "sweep", "apps"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/" + std::string(folder))) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        line = line.substr(0, line.find("//"));
        if (!std::regex_search(line, call)) continue;
        if (std::string(folder) == "base") {
          ++in_base;
        } else {
          ADD_FAILURE() << entry.path() << ": " << line;
        }
      }
    }
  }
  EXPECT_GT(in_base, 10) << "nothing was read";
}

// Options are words of the commands; other programs that use the libraries have no such words.
TEST(Layers, LibrariesDoNotNameOptions) {
  static const std::regex option(R"("(?:[^"\\]|\\.)*--[a-z])");
  const std::set<std::string> may = {
      "base/math.h",       // what a compiler is told
      "sweep/report.cpp",  // the command of each point, for the page of `sweep report`
  };
  int read = 0;
  for (const char* folder : {"base", "engine", "devices", "render", "scene", "study", "sweep"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(HEADPIN_SOURCE_DIR "/" + std::string(folder))) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      ++read;
      if (may.contains(fs::relative(entry.path(), HEADPIN_SOURCE_DIR).string())) continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        if (line.find("///") != std::string::npos) continue;
        EXPECT_FALSE(std::regex_search(line, option)) << entry.path() << ": " << line;
      }
    }
  }
  EXPECT_GT(read, 300) << "too little was read";
}

}  // namespace
}  // namespace headpin
