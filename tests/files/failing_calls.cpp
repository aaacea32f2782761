#include "tests/files/failing_calls.h"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace headpin::files {

namespace {

const char* failing = "";
int failing_number = 0, failing_error = 0, end_number = -1, count = 0;

/// @return  whether the call shall fail; errno is set then
bool fails(const char* name) {
  if (count++ == end_number) raise(SIGKILL);
  if (std::strcmp(name, failing) != 0 || failing_number-- != 0) return false;
  errno = failing_error;
  return true;
}

}  // namespace

void fail_call(const char* name, int number, int error) {
  let_all_succeed();
  failing = name;
  failing_number = number;
  failing_error = error;
}

void end_at_call(int number) {
  let_all_succeed();
  end_number = number;
}

int calls() {
  return count;
}

void let_all_succeed() {
  failing = "";
  end_number = -1;
  count = 0;
}

}  // namespace headpin::files

using headpin::files::fails;

extern "C" {

int renameat2(int from, const char* a, int to, const char* b, unsigned flags) noexcept {
  return fails("renameat2") ? -1 : static_cast<int>(syscall(SYS_renameat2, from, a, to, b, flags));
}

int renameat(int from, const char* a, int to, const char* b) noexcept {
  return fails("renameat") ? -1 : static_cast<int>(syscall(SYS_renameat2, from, a, to, b, 0));
}

int unlinkat(int folder, const char* name, int flags) noexcept {
  return fails("unlinkat") ? -1 : static_cast<int>(syscall(SYS_unlinkat, folder, name, flags));
}

int fsync(int file) {
  return fails("fsync") ? -1 : static_cast<int>(syscall(SYS_fsync, file));
}

int fdatasync(int file) {
  return fails("fdatasync") ? -1 : static_cast<int>(syscall(SYS_fdatasync, file));
}

ssize_t pread(int file, void* out, size_t size, off_t at) {
  return fails("pread") ? -1 : syscall(SYS_pread64, file, out, size, at);
}

ssize_t pwrite(int file, const void* in, size_t size, off_t at) {
  return fails("pwrite") ? -1 : syscall(SYS_pwrite64, file, in, size, at);
}
}
