#include "base/leftovers.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <fstream>
#include <optional>
#include <string_view>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/lock.h"

namespace headpin::base {
namespace {

/// PROCESS of STEM.PROCESS-N.part; nothing of other names.
std::optional<pid_t> writer_of(std::string_view name, std::string_view stem) {
  constexpr std::string_view kEnd = ".part";
  if (!name.starts_with(stem) || !name.ends_with(kEnd)) return std::nullopt;
  if (name.size() < stem.size() + 1 + kEnd.size()) return std::nullopt;
  const std::string_view between =
      name.substr(stem.size(), name.size() - stem.size() - kEnd.size());
  if (!between.starts_with('.')) return std::nullopt;
  const char* const end = between.data() + between.size();
  pid_t process = 0;
  int n = 0;
  const auto first = std::from_chars(between.data() + 1, end, process);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '-') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, n);
  if (second.ec != std::errc{} || second.ptr != end || process <= 0 || n < 0) return std::nullopt;
  return process;
}

}  // namespace

bool is_left(int folder, const std::string& name) {
  const auto open_for = [&](int access) {
    return openat(folder, name.c_str(), access | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  };
  // For writing, without which NFS locks nothing. A part has the permissions of the file that it shall replace.
  int file = open_for(O_RDWR);
  if (file < 0 && errno == EACCES) file = open_for(O_RDONLY);
  if (file < 0) return false;
  struct stat is {};
  const bool left =
      fstat(file, &is) == 0 && S_ISREG(is.st_mode) && is.st_uid == geteuid() && lock_for_sure(file);
  close(file);
  return left;
}

bool is_gone(int process) {
  if (kill(process, 0) != 0) return errno == ESRCH;
  // PID (NAME) STATE ...; Z and X are dead. In a container often nobody asks for their end.
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_end = line.rfind(") ");  // the name may have brackets too
  if (name_end == std::string::npos || name_end + 2 >= line.size()) return false;
  const char state = line[name_end + 2];
  return state == 'Z' || state == 'X';
}

std::string part_stem(const std::string& target) {
  constexpr std::size_t kLongest = 200;  // a file system takes 255 bytes
  return target.substr(0, kLongest);
}

std::vector<std::string> remove_leftovers(int folder, const std::string& stem) {
  std::vector<std::string> found, removed;
  const int again = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR* const all = again >= 0 ? fdopendir(again) : nullptr;
  if (all == nullptr) {
    if (again >= 0) close(again);
    return removed;
  }
  while (const dirent* one = readdir(all)) {
    const std::optional<pid_t> writer = writer_of(one->d_name, stem);
    if (writer && is_gone(*writer)) found.emplace_back(one->d_name);
  }
  closedir(all);
  for (const std::string& name : found) {
    if (is_left(folder, name) && unlinkat(folder, name.c_str(), 0) == 0) removed.push_back(name);
  }
  return removed;
}

}  // namespace headpin::base
