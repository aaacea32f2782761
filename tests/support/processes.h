#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

/// Processes that are not our children.
namespace headpin {

/// State and parent of a process, as the kernel tells them; `Z` where it has ended.
struct ProcessState {
  char state = 'Z';
  pid_t parent = 0;
};

inline ProcessState state_of(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  std::stringstream text;
  text << file.rdbuf();
  const std::size_t name_ends = text.str().rfind(')');
  ProcessState is;
  if (name_ends == std::string::npos) return is;
  std::istringstream(text.str().substr(name_ends + 1)) >> is.state >> is.parent;
  return is;
}

/// Waits for a process to end, or to be a zombie: where nobody reaps, it stays one.
inline void wait_for_end(pid_t process) {
  while (state_of(std::to_string(process)).state != 'Z') usleep(1000);
}

/// The children of a process that have not ended.
inline std::vector<pid_t> children_of(pid_t process) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const ProcessState is = state_of(name);
    if (is.parent == process && is.state != 'Z') children.push_back(std::stoi(name));
  }
  return children;
}

}  // namespace headpin
