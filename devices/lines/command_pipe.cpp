#include "devices/lines/command_pipe.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/names.h"

namespace headpin::devices {

CommandPipe::CommandPipe(const std::string& path) {
  if (path.empty()) return;
  if (path == "-") {
    fd_ = STDIN_FILENO;
    fcntl(fd_, F_SETFL, fcntl(fd_, F_GETFL) | O_NONBLOCK);
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
}

CommandPipe::~CommandPipe() {
  if (!made_.empty()) base::remove_pipe(made_, fd_);
  if (fd_ > STDIN_FILENO) ::close(fd_);
}

std::vector<std::string> CommandPipe::lines() {
  std::array<char, 65536> bytes{};
  if (fd_ < 0) return {};
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n > 0) text_.append(bytes.data(), static_cast<std::size_t>(n));
  if (n == 0) {  // the end of standard input, and of its last line
    fd_ = -1;
    if (!text_.empty()) text_ += '\n';
  }
  if (text_.size() > kLongest && text_.find('\n') > kLongest) {
    text_.erase(0, std::min(text_.find('\n'), text_.size()));
    ++ignored_;
  }
  std::vector<std::string> whole;
  for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
    whole.push_back(text_.substr(0, end));
    text_.erase(0, end + 1);
  }
  return whole;
}

}  // namespace headpin::devices
