#include "base/left_parts.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <vector>

#include <sys/types.h>

namespace headpin::base {

void remove_left_parts(const std::string& folder) {
  static const std::regex part(R"(.+\.([0-9]{1,9})-[0-9]+\.part)");
  std::vector<std::filesystem::path> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, part) || !entry.is_regular_file()) continue;
    const auto process = static_cast<pid_t>(std::atoi(match[1].str().c_str()));
    if (kill(process, 0) != 0 && errno == ESRCH) left.push_back(entry.path());
  }
  for (const auto& path : left) std::filesystem::remove(path);
}

}  // namespace headpin::base
