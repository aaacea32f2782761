#include "base/line_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/input_file.h"
#include "base/lock.h"

namespace headpin::base {

namespace {

constexpr std::size_t kMostLines = 16'000'000;  // largest size in bytes

/// Syncs the folder of a new file, so that its name is on the disk.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const int folder =
      open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  fsync(folder);
  close(folder);
}

/// Whether the open file still has this name; another one has it where the file was replaced.
bool has_name(int descriptor, const std::string& path) {
  struct stat ours {
  }, named{};
  return fstat(descriptor, &ours) == 0 && stat(path.c_str(), &named) == 0 &&
         ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

bool is_end(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

void LineFile::fail(const std::string& doing) const {
  throw std::runtime_error(path_ + ": " + doing + ": " + std::strerror(errno));
}

void LineFile::open_locked() {
  constexpr int kMostTries = 100;  // as many files of that name in the time of opening one
  for (int i = 0; i < kMostTries; ++i) {
    descriptor_ = open(path_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("cannot be opened");
    const bool free = lock(descriptor_);
    if (free && has_name(descriptor_, path_)) return;
    close(descriptor_);
    if (!free) break;
  }
  throw Busy(path_ + ": another headpin is writing it");
}

LineFile::LineFile(std::string path) : path_(std::move(path)) {
  open_locked();
  try {
    text_ = read_text(path_, kMostLines);
    size_ = static_cast<std::int64_t>(text_.size());
    ended_ = text_.empty() || is_end(text_.back());
    sync_folder_of(path_);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

LineFile::~LineFile() {
  close(descriptor_);
}

std::string LineFile::whole_lines() const {
  return text_.substr(0, text_.find_last_of("\n\r") + 1);  // npos + 1 is 0
}

void LineFile::cut_last_line() {
  text_ = whole_lines();
  size_ = static_cast<std::int64_t>(text_.size());
  if (ftruncate(descriptor_, size_) != 0) fail("cannot be written");
  ended_ = true;
}

void LineFile::append(const std::string& more) {
  const std::string lines = ended_ ? more : '\n' + more;
  std::size_t done = 0;
  while (done < lines.size()) {
    const ssize_t n = write(descriptor_, lines.data() + done, lines.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    done += static_cast<std::size_t>(n);
  }
  if (done < lines.size() || fdatasync(descriptor_) != 0) {
    const int error = errno;
    [[maybe_unused]] const int cut = ftruncate(descriptor_, size_);
    errno = error;
    fail("cannot be written");
  }
  size_ += static_cast<std::int64_t>(lines.size());
  ended_ = true;
}

}  // namespace headpin::base
