#include "files/output_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace headpin::files {

namespace fs = std::filesystem;

namespace {

/// A new file beside `target`, NAME.PROCESS-N.part; -1 and errno when there can be none.
std::pair<int, fs::path> create_part(const fs::path& target) {
  constexpr std::size_t kLongestStem = 200;  // a file system takes 255 bytes
  const fs::path stem = target.parent_path() / target.filename().string().substr(0, kLongestStem);
  for (int n = 0;; ++n) {
    fs::path name = stem;
    std::array<char, 48> end{};
    std::snprintf(end.data(), end.size(), ".%d-%d.part", static_cast<int>(getpid()), n);
    name += end.data();
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return {file, name};
  }
}

}  // namespace

int rename_new(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  if (link(from.c_str(), to.c_str()) != 0) return -1;  // file systems without that kind of rename
  return unlink(from.c_str());
}

bool same_file(const fs::path& a, const fs::path& b) {
  struct stat sa {
  }, sb{};
  return stat(a.c_str(), &sa) == 0 && stat(b.c_str(), &sb) == 0 && sa.st_dev == sb.st_dev &&
         sa.st_ino == sb.st_ino;
}

fs::path follow_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as many as Linux follows
  for (int i = 0; fs::is_symlink(fs::symlink_status(path)); ++i) {
    if (i == kMostLinks) throw std::runtime_error(path.string() + ": links in a circle");
    const fs::path next = fs::read_symlink(path);
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

void OutputFile::fail(const std::string& doing) const {
  const int error = errno;
  throw std::runtime_error(path_ + ": " + doing + ": " + std::strerror(error));
}

OutputFile::OutputFile(std::string path, Options options)
    : path_(std::move(path)), options_(std::move(options)) {
  if (path_.empty()) throw std::runtime_error("'': expected a name for the output, found none");
  if (path_ == "-") {
    if (!options_.standard_output) {
      throw std::runtime_error("-: cannot go to standard output; expected the name of a file");
    }
    if (isatty(STDOUT_FILENO) == 1) {
      throw std::runtime_error("-: standard output is a terminal; expected a pipe or a file");
    }
    std::fflush(stdout);
    descriptor_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    if (descriptor_ < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) fail("standard output");
    return;
  }
  struct stat there {};
  const bool exists = stat(path_.c_str(), &there) == 0;
  if (exists && S_ISDIR(there.st_mode)) {
    throw std::runtime_error(path_ + ": is a folder; expected the name of a file");
  }
  for (const fs::path& input : options_.inputs) {
    if (same_file(path_, input)) {
      throw std::runtime_error(path_ + ": is read by this very command; expected another name");
    }
  }
  if (exists && !S_ISREG(there.st_mode)) {
    open_special();
  } else {
    open_beside(exists);
  }
}

void OutputFile::open_special() {
  if (options_.regular)
    throw std::runtime_error(path_ + ": is no regular file; nothing is written");
  descriptor_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor_ < 0) fail("cannot write");
}

void OutputFile::open_beside(bool exists) {
  target_ = follow_links(path_);
  struct stat old {};
  if (exists) {
    if (!options_.overwrite) {
      throw std::runtime_error(path_ + ": exists already; --force replaces it");
    }
    const int there = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (there < 0) fail("cannot be replaced");
    const bool free = lock(there);
    fstat(there, &old);
    close(there);
    if (!free) throw Busy(path_ + ": is being written by another headpin");
  }
  std::tie(descriptor_, part_) = create_part(target_);
  if (descriptor_ < 0) fail("cannot be created");
  if (exists) {
    // Whose it was and who may read it; only root can give files to others, so failing is fine.
    [[maybe_unused]] const int given = fchown(descriptor_, old.st_uid, old.st_gid);
    fchmod(descriptor_, old.st_mode & 0777);
  }
  if (!options_.live) return;
  lock(descriptor_);
  try {
    rename_to_target();
  } catch (...) {
    close(descriptor_);
    unlink(part_.c_str());
    throw;
  }
}

void OutputFile::rename_to_target() {
  const int failed =
      options_.overwrite ? std::rename(part_.c_str(), target_.c_str()) : rename_new(part_, target_);
  if (failed == 0) {
    part_ = target_;
    return;
  }
  if (errno == EEXIST) {
    throw std::runtime_error(path_ + ": exists by now; --force replaces it");
  }
  fail("cannot be given its name");
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  if (!part_.empty() && !options_.live) unlink(part_.c_str());
}

void OutputFile::write(const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = ::write(descriptor_, bytes, size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot be written");
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
}

void OutputFile::require_kept(std::int64_t size) const {
  struct stat ours {
  }, named{};
  if (!options_.live || part_.empty() || fstat(descriptor_, &ours) != 0) return;
  const auto lost = [&](const std::string& how) {
    throw std::runtime_error(path_ + ": " + how + " while it was written");
  };
  const bool there = stat(target_.c_str(), &named) == 0;
  if (!there || named.st_dev != ours.st_dev || named.st_ino != ours.st_ino) {
    lost(ours.st_nlink > 0 ? "was moved" : there ? "was replaced" : "was deleted");
  }
  if (ours.st_size < size) {
    lost("was cut to " + std::to_string(ours.st_size) + " of " + std::to_string(size) + " bytes");
  }
}

void OutputFile::commit() {
  require_kept(0);
  try {
    if (close(std::exchange(descriptor_, -1)) != 0) fail("cannot be written");
    if (!part_.empty() && !options_.live) rename_to_target();
  } catch (...) {
    if (!part_.empty() && !options_.live) unlink(part_.c_str());
    throw;
  }
}

}  // namespace headpin::files
