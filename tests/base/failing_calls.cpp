#include "tests/base/failing_calls.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace headpin::base {

namespace {

const char* failing = "";
int failing_number = 0, failing_error = 0, end_number = -1, count = 0;
bool all_later = false, one_failed = false;
std::function<void()> ahead;
std::size_t shortest = 0, shortest_read = 0;  // 0: they are whole
std::vector<Change>* recorded = nullptr;

/// @return  whether the call shall fail; errno is set then
bool fails(const char* name) {
  if (count++ == end_number) raise(SIGKILL);
  if (std::strcmp(name, failing) != 0) return false;
  const int calls_before = failing_number--;
  if (calls_before > 0 || (calls_before < 0 && !all_later)) return false;
  if (ahead) {
    std::exchange(ahead, {})();
    return false;
  }
  errno = failing_error;
  one_failed = true;
  return true;
}

std::size_t part_of(std::size_t size, std::size_t most) {
  return most > 0 ? std::min(size, most) : size;
}

std::string path_of(int file) {
  char path[PATH_MAX]{};
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t n = readlink(link.c_str(), path, sizeof path - 1);
  return n > 0 ? std::string(path, static_cast<std::size_t>(n)) : "";
}

std::string path_in(int folder, const char* name) {
  return name[0] == '/' || folder == AT_FDCWD ? name : path_of(folder) + "/" + name;
}

off_t size_of(int file) {
  struct stat is {};
  return fstat(file, &is) == 0 ? is.st_size : 0;
}

/// Notes a change if it was made.
template <typename T>
T noted(T result, Change::Kind kind, std::string path, std::string other = "", off_t at = 0) {
  const int error = errno;
  if (recorded != nullptr && result >= 0) {
    recorded->push_back({kind, std::move(path), std::move(other), static_cast<std::size_t>(at)});
  }
  errno = error;
  return result;
}

std::vector<std::string>& without_close_on_exec() {
  static std::vector<std::string> names;
  return names;
}

int open_in(int folder, const char* name, int flags, mode_t mode) {
  if ((flags & O_CLOEXEC) == 0) without_close_on_exec().emplace_back(name);
  struct stat is {};
  const bool is_new =
      recorded != nullptr && (flags & O_CREAT) != 0 && fstatat(folder, name, &is, 0) != 0;
  const int file = static_cast<int>(syscall(SYS_openat, folder, name, flags, mode));
  return is_new ? noted(file, Change::kCreate, path_in(folder, name)) : file;
}

}  // namespace

void fail_call(const char* name, int number, int error) {
  let_all_succeed();
  failing = name;
  failing_number = number;
  failing_error = error;
}

void fail_calls_from(const char* name, int number, int error) {
  fail_call(name, number, error);
  all_later = true;
}

void end_at_call(int number) {
  let_all_succeed();
  end_number = number;
}

void do_before_call(const char* name, int number, std::function<void()> work) {
  fail_call(name, number, 0);
  ahead = std::move(work);
}

void write_at_most(std::size_t bytes) {
  shortest = bytes;
}

void read_at_most(std::size_t bytes) {
  shortest_read = bytes;
}

const std::vector<std::string>& opened_for_others() {
  return without_close_on_exec();
}

bool has_failed() {
  return one_failed;
}

int calls() {
  return count;
}

void let_all_succeed() {
  failing = "";
  all_later = one_failed = false;
  ahead = {};
  end_number = -1;
  count = 0;
  shortest = 0;
  shortest_read = 0;
}

std::vector<Change> changes_of(const std::function<void()>& work) {
  std::vector<Change> changes;
  recorded = &changes;
  try {
    work();
  } catch (...) {
    recorded = nullptr;
    throw;
  }
  recorded = nullptr;
  return changes;
}

}  // namespace headpin::base

using namespace headpin::base;  // NOLINT: the functions below are the C library's

extern "C" {

int open(const char* name, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fails("open") ? -1 : open_in(AT_FDCWD, name, flags, mode);
}

int openat(int folder, const char* name, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fails("openat") ? -1 : open_in(folder, name, flags, mode);
}

int mkdir(const char* name, mode_t mode) noexcept {
  if (fails("mkdir")) return -1;
  return noted(static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, name, mode)), Change::kMakeFolder,
               name);
}

int renameat2(int from, const char* a, int to, const char* b, unsigned flags) noexcept {
  if (fails("renameat2")) return -1;
  return noted(static_cast<int>(syscall(SYS_renameat2, from, a, to, b, flags)), Change::kRename,
               path_in(from, a), path_in(to, b));
}

int renameat(int from, const char* a, int to, const char* b) noexcept {
  if (fails("renameat")) return -1;
  return noted(static_cast<int>(syscall(SYS_renameat2, from, a, to, b, 0)), Change::kRename,
               path_in(from, a), path_in(to, b));
}

int rename(const char* a, const char* b) noexcept {
  if (fails("rename")) return -1;
  return noted(static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, a, AT_FDCWD, b, 0)),
               Change::kRename, a, b);
}

int unlinkat(int folder, const char* name, int flags) noexcept {
  if (fails("unlinkat")) return -1;
  return noted(static_cast<int>(syscall(SYS_unlinkat, folder, name, flags)), Change::kRemove,
               path_in(folder, name));
}

int rmdir(const char* name) noexcept {
  if (fails("rmdir")) return -1;
  return noted(static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, name, AT_REMOVEDIR)),
               Change::kRemove, name);
}

int ftruncate(int file, off_t size) noexcept {
  if (fails("ftruncate")) return -1;
  return noted(static_cast<int>(syscall(SYS_ftruncate, file, size)), Change::kCut, path_of(file),
               "", size);
}

int fsync(int file) {
  if (fails("fsync")) return -1;
  return noted(static_cast<int>(syscall(SYS_fsync, file)), Change::kSync, path_of(file));
}

int fdatasync(int file) {
  if (fails("fdatasync")) return -1;
  return noted(static_cast<int>(syscall(SYS_fdatasync, file)), Change::kSync, path_of(file));
}

int syncfs(int file) noexcept {
  if (fails("syncfs")) return -1;
  return noted(static_cast<int>(syscall(SYS_syncfs, file)), Change::kSyncAll, "");
}

int flock(int file, int how) noexcept {
  return fails("flock") ? -1 : static_cast<int>(syscall(SYS_flock, file, how));
}

DIR* fdopendir(int folder) {
  static const auto real = reinterpret_cast<DIR* (*)(int)>(dlsym(RTLD_NEXT, "fdopendir"));
  return fails("fdopendir") ? nullptr : real(folder);
}

dirent* readdir(DIR* folder) {
  static const auto real = reinterpret_cast<dirent* (*)(DIR*)>(dlsym(RTLD_NEXT, "readdir"));
  return fails("readdir") ? nullptr : real(folder);
}

ssize_t read(int file, void* out, size_t size) {
  return fails("read") ? -1 : syscall(SYS_read, file, out, part_of(size, shortest_read));
}

ssize_t pread(int file, void* out, size_t size, off_t at) {
  return fails("pread") ? -1 : syscall(SYS_pread64, file, out, part_of(size, shortest_read), at);
}

ssize_t write(int file, const void* in, size_t size) {
  if (fails("write")) return -1;
  const off_t at = recorded != nullptr ? size_of(file) : 0;  // all that is recorded is appended
  const ssize_t n = syscall(SYS_write, file, in, part_of(size, shortest));
  if (recorded == nullptr || n < 0) return n;
  return noted(n, Change::kWrite, path_of(file),
               std::string(static_cast<const char*>(in), static_cast<std::size_t>(n)), at);
}

ssize_t pwrite(int file, const void* in, size_t size, off_t at) {
  if (fails("pwrite")) return -1;
  const ssize_t n = syscall(SYS_pwrite64, file, in, part_of(size, shortest), at);
  if (recorded == nullptr || n < 0) return n;
  return noted(n, Change::kWrite, path_of(file),
               std::string(static_cast<const char*>(in), static_cast<std::size_t>(n)), at);
}
}
