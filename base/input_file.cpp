#include "base/input_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temporary.h"

namespace headpin::base {

namespace {

template <typename Content>
Content read_all(const std::string& path, std::size_t most) {
  const InputFile file(path);
  if (file.size() > most) {
    throw std::runtime_error(path + ": of " + std::to_string(file.size()) + " bytes; expected " +
                             std::to_string(most) + " at most");
  }
  Content content(file.size(), {});
  content.resize(file.read(0, {reinterpret_cast<std::uint8_t*>(content.data()), content.size()}));
  return content;
}

/// What is not a regular file: "a folder".
const char* kind_of(mode_t mode) {
  return S_ISDIR(mode)    ? "a folder"
         : S_ISFIFO(mode) ? "a named pipe"
         : S_ISCHR(mode)  ? "a device"
         : S_ISBLK(mode)  ? "a device"
         : S_ISSOCK(mode) ? "a socket"
                          : "something else";
}

/// @return  standard input itself if it is a file at its start, else a nameless copy of its bytes
int keep_standard_input() {
  struct stat status {};
  const bool file = fstat(STDIN_FILENO, &status) == 0 && S_ISREG(status.st_mode);
  if (file && lseek(STDIN_FILENO, 0, SEEK_CUR) == 0) return STDIN_FILENO;
  const int kept = nameless_file();
  const auto fail = [&](const std::string& doing) {
    const int error = errno;
    close(kept);
    throw std::runtime_error("-: " + doing + ": " + std::strerror(error));
  };
  std::vector<std::uint8_t> some(1 << 16);
  for (off_t at = 0;;) {
    const ssize_t n = ::read(STDIN_FILENO, some.data(), some.size());
    if (n == 0) break;
    if (n < 0) fail("cannot be read");  // also after a signal: the command can be stopped here
    for (ssize_t done = 0; done < n;) {
      const ssize_t wrote =
          pwrite(kept, some.data() + done, static_cast<std::size_t>(n - done), at);
      if (wrote < 0 && errno == EINTR) continue;
      if (wrote < 0) fail("cannot be kept in TMPDIR");
      done += wrote;
      at += wrote;
    }
  }
  return kept;
}

}  // namespace

int standard_input() {
  static const int kept = keep_standard_input();
  const int again = fcntl(kept, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (again < 0) throw std::runtime_error(std::string("-: cannot open: ") + std::strerror(errno));
  return again;
}

InputFile::InputFile(std::string path) : path_(std::move(path)) {
  file_ = path_ == "-" ? standard_input()
                       : open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file_ < 0) throw std::runtime_error(path_ + ": cannot open: " + std::strerror(errno));
  struct stat status {};
  if (fstat(file_, &status) == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::size_t>(status.st_size);
    return;
  }
  close(file_);
  throw std::runtime_error(path_ + ": expected a file, found " + kind_of(status.st_mode));
}

InputFile::~InputFile() {
  close(file_);
}

std::size_t InputFile::read(std::size_t at, std::span<std::uint8_t> out) const {
  std::size_t got = 0;
  while (got < out.size()) {
    const ssize_t n =
        pread(file_, out.data() + got, out.size() - got, static_cast<off_t>(at + got));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error(path_ + ": cannot be read: " + std::strerror(errno));
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  return got;
}

std::size_t read_some(int descriptor, std::span<std::uint8_t> out, const std::string& name) {
  for (;;) {
    const ssize_t n = ::read(descriptor, out.data(), out.size());
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EINTR)
      throw std::runtime_error(name + ": cannot be read: " + std::strerror(errno));
  }
}

std::vector<std::uint8_t> read_bytes(const std::string& path, std::size_t most) {
  return read_all<std::vector<std::uint8_t>>(path, most);
}

std::string read_text(const std::string& path, std::size_t most) {
  return read_all<std::string>(path, most);
}

}  // namespace headpin::base
