#include "base/left_parts.h"

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <vector>

#include <fcntl.h>

#include "base/leftovers.h"

namespace headpin::base {

void remove_left_parts(const std::string& folder) {
  static const std::regex part(R"(.+\.([0-9]{1,9})-[0-9]+\.part)");
  std::vector<std::filesystem::path> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, part) || !entry.is_regular_file()) continue;
    if (is_gone(std::atoi(match[1].str().c_str()))) left.push_back(entry.path());
  }
  for (const auto& path : left) {
    if (is_left(AT_FDCWD, path.string())) std::filesystem::remove(path);
  }
}

}  // namespace headpin::base
