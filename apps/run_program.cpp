#include "apps/run_program.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <sys/wait.h>
#include <unistd.h>

#include "apps/child_process.h"
#include "base/temporary.h"

namespace headpin::apps {

namespace {

constexpr std::size_t kMostSaid = 64'000;

std::string read_from_start(int file) {
  std::string text(kMostSaid, '\0');
  const ssize_t n = pread(file, text.data(), text.size(), 0);
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return text;
}

}  // namespace

std::optional<Ended> run_program(const std::vector<std::string>& words) {
  const int said = base::nameless_file();
  const pid_t process = start_child(words[0], words, {.out = said, .err = said}, SIGKILL);
  if (process < 0) {
    const int error = errno;
    close(said);
    if (error == ENOENT) return std::nullopt;
    throw std::runtime_error(words[0] + ": cannot be started: " + std::strerror(error));
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  Ended ended{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
              read_from_start(said)};
  close(said);
  return ended;
}

}  // namespace headpin::apps
