#include "base/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/leftovers.h"

namespace headpin::base {

namespace fs = std::filesystem;

namespace {

/// A new file in `folder`, NAME.PROCESS-N.part; -1 and errno when there can be none.
std::pair<int, std::string> create_part(int folder, const std::string& target) {
  const std::string stem = part_stem(target);
  for (int n = 0;; ++n) {
    const std::string name =
        stem + "." + std::to_string(getpid()) + "-" + std::to_string(n) + ".part";
    const int file =
        openat(folder, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return {file, name};
  }
}

fs::path folder_of(const fs::path& path) {
  const fs::path parent = path.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// Like the kernel's protected_symlinks and protected_fifos: in a folder like /tmp, in which
/// everyone may write and only owners may remove, a link or a pipe of another user is used only if
/// that user owns the folder.
void refuse_planted(const fs::path& path) {
  struct stat itself {
  }, folder{};
  if (lstat(path.c_str(), &itself) != 0 || stat(folder_of(path).c_str(), &folder) != 0) {
    throw std::runtime_error(path.string() + ": cannot be followed: " + std::strerror(errno));
  }
  constexpr mode_t kOpenToAll = S_ISVTX | S_IWOTH;
  if ((folder.st_mode & kOpenToAll) == kOpenToAll && itself.st_uid != geteuid() &&
      itself.st_uid != folder.st_uid) {
    const bool link = S_ISLNK(itself.st_mode);
    throw std::runtime_error(path.string() + ": is a " + (link ? "link" : "pipe or device") +
                             " of another user, in a folder that all may write to; it is not " +
                             (link ? "followed" : "written into"));
  }
}

/// The final name of a file in the working folder of an OutputFolder, for messages.
std::string outer_name(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.filename() == kPartFolder ? folder.parent_path() / path.filename() : path;
}

}  // namespace

int rename_new(int from_folder, const std::string& from, int to_folder, const std::string& to) {
  if (renameat2(from_folder, from.c_str(), to_folder, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  // The file system does not have that kind of rename.
  struct stat is {};
  if (fstatat(from_folder, from.c_str(), &is, AT_SYMLINK_NOFOLLOW) == 0 && S_ISDIR(is.st_mode)) {
    return renameat(from_folder, from.c_str(), to_folder, to.c_str());  // only onto an empty one
  }
  if (linkat(from_folder, from.c_str(), to_folder, to.c_str(), 0) != 0) return -1;
  return unlinkat(from_folder, from.c_str(), 0);
}

void write_text(OutputFile file, std::string_view text) {
  file.write(text.data(), text.size());
  file.commit();
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
    refuse_planted(path);
    const fs::path next = fs::read_symlink(path);
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

void OutputFile::fail(const std::string& doing) const {
  const int error = errno;
  throw std::runtime_error(said_ + ": " + doing + ": " + std::strerror(error));
}

OutputFile::OutputFile(std::string path, Options options)
    : path_(std::move(path)), said_(outer_name(path_)), options_(std::move(options)) {
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
  if (!exists && errno != ENOENT && errno != ELOOP)
    fail("cannot be reached");  // a path without access may exist
  if (exists && S_ISDIR(there.st_mode)) {
    throw std::runtime_error(said_ + ": is a folder; expected the name of a file");
  }
  for (const fs::path& input : options_.inputs) {
    if (same_file(path_, input)) {
      throw std::runtime_error(said_ + ": is an input of this command; expected another name");
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
    throw std::runtime_error(said_ + ": is no regular file; nothing is written");
  const fs::path target = follow_links(path_);
  const int how = O_WRONLY | O_CLOEXEC | O_NOCTTY;
  if (fs::exists(target)) {
    refuse_planted(target);
    descriptor_ = open(target.c_str(), how | O_NOFOLLOW);
  } else {  // /dev/stdout leads to a pipe, which has no name
    descriptor_ = open(path_.c_str(), how);
  }
  if (descriptor_ < 0) fail("cannot write");
}

void OutputFile::open_beside(bool exists) {
  const fs::path target = follow_links(path_);
  target_ = target.filename().string();
  const std::string folder = folder_of(target).string();
  folder_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0 && errno == ENOENT) {
    throw std::runtime_error(said_ + ": cannot be created: there is no folder " + folder);
  }
  if (folder_ < 0) fail("cannot be created");
  try {
    open_in_folder(exists, folder);
  } catch (...) {
    close_all();
    throw;
  }
}

void OutputFile::open_in_folder(bool exists, const fs::path& folder) {
  struct stat old {};
  if (exists) {
    if (!options_.overwrite) {
      throw Exists(said_ + ": exists already");
    }
    const int there =
        openat(folder_, target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (there < 0) fail("cannot be replaced");
    const bool free = options_.locked || lock(there);
    fstat(there, &old);
    close(there);
    if (!free) throw Busy(said_ + ": is being written by another headpin");
  }
  if (options_.durable) clear_away(folder);
  std::tie(descriptor_, named_) = create_part(folder_, target_);
  if (descriptor_ < 0) fail("cannot be created");
  part_ = folder / named_;
  lock(descriptor_);
  if (exists) {
    // Keeps owner and permissions. Only root can give files to others, so a failure is accepted.
    [[maybe_unused]] const int given = fchown(descriptor_, old.st_uid, old.st_gid);
    fchmod(descriptor_, old.st_mode & 0777);
  }
  if (!options_.live) return;
  try {
    rename_to_target();
  } catch (...) {
    remove_part();
    throw;
  }
  sync_folder();
}

/// Removes the files of killed runs.
void OutputFile::clear_away(const fs::path& folder) const {
  for (const std::string& name : remove_leftovers(folder_, part_stem(target_))) {
    std::string text = (folder / name).string();
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    std::fprintf(stderr, "headpin: %s: was left by a run that was killed; removed\n", text.c_str());
  }
}

void OutputFile::rename_to_target() {
  const int failed = options_.overwrite
                         ? renameat(folder_, named_.c_str(), folder_, target_.c_str())
                         : rename_new(folder_, named_, folder_, target_);
  if (failed == 0) {
    named_ = target_;
    part_ = part_.parent_path() / target_;
    return;
  }
  if (errno == EEXIST) {
    throw Exists(said_ + ": was created in the meantime");
  }
  fail("cannot be given its name");
}

void OutputFile::remove_part() {
  if (!named_.empty() && named_ != target_) unlinkat(folder_, named_.c_str(), 0);
}

void OutputFile::close_all() {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  if (folder_ >= 0) close(std::exchange(folder_, -1));
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      said_(std::move(other.said_)),
      options_(std::move(other.options_)),
      folder_(std::exchange(other.folder_, -1)),
      target_(std::move(other.target_)),
      named_(std::move(other.named_)),
      part_(std::move(other.part_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0 && !options_.live) remove_part();
  close_all();
}

void OutputFile::sync() const {
  // EINVAL, EROFS: it cannot be synced, for example a pipe.
  if (fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("cannot be written");
}

std::int64_t OutputFile::length() const {
  struct stat now {};
  if (fstat(descriptor_, &now) != 0) fail("cannot be read");
  return now.st_size;
}

bool OutputFile::cut_back(std::int64_t size) const {
  return ftruncate(descriptor_, size) == 0;
}

/// Syncs the name to the disk too.
void OutputFile::sync_folder() const {
  if (options_.durable && fsync(folder_) != 0 && errno != EINVAL) fail("cannot be written");
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
  if (!options_.live || named_.empty() || fstat(descriptor_, &ours) != 0) return;
  const auto lost = [&](const std::string& how) {
    throw std::runtime_error(said_ + ": " + how + " while it was written");
  };
  const bool there = fstatat(folder_, target_.c_str(), &named, 0) == 0;
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
    if (options_.durable && folder_ >= 0) sync();
    if (close(std::exchange(descriptor_, -1)) != 0) fail("cannot be written");
    if (folder_ >= 0 && !options_.live) rename_to_target();
    if (folder_ >= 0) sync_folder();
  } catch (...) {
    if (!options_.live) remove_part();
    throw;
  }
  close_all();  // also the folder: many finished files may live on as objects
}

}  // namespace headpin::base
