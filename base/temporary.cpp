#include "base/temporary.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace headpin::base {

namespace {

std::string folder_of_all() {
  const char* told = std::getenv("TMPDIR");
  return told != nullptr && *told != '\0' ? told : "/tmp";
}

[[noreturn]] void fail(const std::string& folder, const std::string& what) {
  throw std::runtime_error("TMPDIR: " + folder + ": no " + what +
                           " can be made there: " + std::strerror(errno));
}

}  // namespace

int nameless_file() {
  const std::string folder = folder_of_all();
  int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  std::string name = folder + "/headpin-XXXXXX";  // for file systems without nameless files
  file = mkostemp(name.data(), O_CLOEXEC);
  if (file < 0) fail(folder, "file");
  unlink(name.c_str());
  return file;
}

PrivateFolder::PrivateFolder() {
  const std::string folder = folder_of_all();
  std::string name = std::filesystem::absolute(folder).string() + "/headpin-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) fail(folder, "folder");
  path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code left;  // what cannot be removed stays there
  std::filesystem::remove_all(path_, left);
}

}  // namespace headpin::base
