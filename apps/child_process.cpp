#include "apps/child_process.h"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace headpin::apps {

namespace {

/// Runs in the child, which may only make async-signal-safe calls.
[[noreturn]] void become(const char* program, char* const* words, const ChildStreams& streams,
                         int end_signal, pid_t parent, int told) {
  const auto fail = [&] {
    const int error = errno;
    [[maybe_unused]] const ssize_t n = write(told, &error, sizeof(error));
    _exit(127);
  };
  if (prctl(PR_SET_PDEATHSIG, end_signal) != 0) fail();
  if (getppid() != parent) _exit(127);  // the parent has already ended
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  const std::array<int, 3> given{streams.in, streams.out, streams.err};
  for (int i = 0; i < 3; ++i) {
    const int file = given[static_cast<std::size_t>(i)];
    if (dup2(file < 0 ? nothing : file, i) < 0) fail();
  }
  if (close_range(3, ~0U, CLOSE_RANGE_CLOEXEC) != 0) fail();
  execvp(program, words);
  fail();
  _exit(127);
}

}  // namespace

pid_t start_child(const std::string& program, std::vector<std::string> words, ChildStreams streams,
                  int end_signal) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return -1;
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    become(program.c_str(), arguments.data(), streams, end_signal, parent, ends[1]);
  }
  int error = child < 0 ? errno : 0;
  close(ends[1]);
  if (child >= 0) {  // the pipe is empty if the program has started
    while (read(ends[0], &error, sizeof(error)) < 0 && errno == EINTR) {
    }
  }
  close(ends[0]);
  if (error == 0) return child;
  if (child >= 0) {
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  errno = error;
  return -1;
}

}  // namespace headpin::apps
