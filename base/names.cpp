#include "base/names.h"

#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace headpin::base {

namespace {

[[noreturn]] void fail_to_link(const std::string& link, int error) {
  const std::filesystem::path folder = std::filesystem::path(link).parent_path();
  const std::string why = error == ENOENT    ? "there is no folder " + folder.string()
                          : error == ENOTDIR ? folder.string() + " is not a folder"
                                             : std::strerror(error);
  throw std::runtime_error(link + ": cannot be created: " + why);
}

}  // namespace

void place_link(const std::string& target, const std::string& link) {
  struct stat there {};
  if (lstat(link.c_str(), &there) == 0 && !S_ISLNK(there.st_mode)) fail_to_link(link, EEXIST);
  const std::string beside = link + "." + std::to_string(getpid());
  if (symlink(target.c_str(), beside.c_str()) != 0) fail_to_link(link, errno);
  if (rename(beside.c_str(), link.c_str()) != 0) {
    const int why = errno;
    remove_link(target, beside);
    fail_to_link(link, why);
  }
}

void remove_link(const std::string& target, const std::string& link) noexcept {
  std::array<char, PATH_MAX> leads_to{};
  const ssize_t n = readlink(link.c_str(), leads_to.data(), leads_to.size() - 1);
  if (n > 0 && target == leads_to.data()) unlink(link.c_str());
}

void remove_pipe(const std::string& path, int descriptor) noexcept {
  struct stat ours {
  }, named{};
  if (fstat(descriptor, &ours) == 0 && lstat(path.c_str(), &named) == 0 &&
      S_ISFIFO(named.st_mode) && ours.st_dev == named.st_dev && ours.st_ino == named.st_ino) {
    unlink(path.c_str());
  }
}

}  // namespace headpin::base
