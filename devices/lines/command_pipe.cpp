#include "devices/lines/command_pipe.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/names.h"

namespace headpin::devices {

CommandPipe::CommandPipe(const std::string& path) {
  if (path.empty()) return;
  if (path == "-") {
    // Other programs have it open too, so its flags stay as they are.
    fd_ = STDIN_FILENO;
    return;
  }
  if (mkfifo(path.c_str(), 0600) == 0) {
    made_ = path;
  } else if (errno != EEXIST) {
    throw std::runtime_error(path + ": " + std::strerror(errno));
  }
  struct stat file {};
  // Also open for writing, so that the pipe does not end when the first writer closes it.
  fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0 || fstat(fd_, &file) != 0 || !S_ISFIFO(file.st_mode)) {
    if (fd_ >= 0) ::close(fd_);
    throw std::runtime_error(path + ": exists and is not a named pipe");
  }
  ours_ = true;
}

CommandPipe::~CommandPipe() {
  if (!made_.empty()) base::remove_pipe(made_, fd_);
  if (ours_) ::close(fd_);
}

std::vector<std::string> CommandPipe::lines() {
  std::array<char, 65536> bytes{};
  pollfd there{fd_, POLLIN, 0};
  if (fd_ < 0 || ::poll(&there, 1, 0) <= 0) return {};
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n > 0) text_.append(bytes.data(), static_cast<std::size_t>(n));
  if (n == 0) {  // the end of standard input, and of its last line
    fd_ = -1;
    if (!text_.empty()) text_ += '\n';
  }
  const std::size_t ends = std::min(text_.find('\n'), text_.size());
  if (!skips_ && ends > kLongest) {
    ++ignored_;
    skips_ = true;
  }
  if (skips_) {  // up to the end of the line, which may come later
    skips_ = ends == text_.size();
    text_.erase(0, ends + 1);
  }
  std::vector<std::string> whole;
  for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
    whole.push_back(text_.substr(0, end));
    text_.erase(0, end + 1);
  }
  return whole;
}

}  // namespace headpin::devices
