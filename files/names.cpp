#include "files/names.h"

#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace headpin::files {

void place_link(const std::string& target, const std::string& link) {
  const auto fail = [](const std::string& name, int error) {
    throw std::runtime_error(name + ": " + std::strerror(error));
  };
  struct stat there {};
  if (lstat(link.c_str(), &there) == 0 && !S_ISLNK(there.st_mode)) fail(link, EEXIST);
  const std::string beside = link + "." + std::to_string(getpid());
  if (symlink(target.c_str(), beside.c_str()) != 0) fail(beside, errno);
  if (rename(beside.c_str(), link.c_str()) != 0) {
    const int why = errno;
    remove_link(target, beside);
    fail(link, why);
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

}  // namespace headpin::files
