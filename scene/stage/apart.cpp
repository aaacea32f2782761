#include "scene/stage/apart.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace headpin::scene {

namespace {

constexpr char kGood = '+', kBad = '-', kMemory = 'm';

/// Private writable memory of this process [bytes].
std::size_t memory_now() {
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;  // size, resident, shared, text, lib, data
  for (int field = 0; field < 6; ++field) statm >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void limit(__rlimit_resource resource, rlim_t most) {
  rlimit now{};
  getrlimit(resource, &now);
  now.rlim_cur = std::min<rlim_t>(most, now.rlim_max);
  setrlimit(resource, &now);
}

bool write_all(int to, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(to, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Never returns. Does not flush buffers or run exit handlers a second time.
[[noreturn]] void work_and_tell(const std::function<std::string()>& work, const Limits& limits,
                                int to) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGXCPU, SIGTERM, SIGINT}) {
    std::signal(signal, SIG_DFL);
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.cpu_s);
  limit(RLIMIT_DATA, memory_now() + limits.memory);
  std::string told;
  try {
    told = kGood + work();
  } catch (const std::bad_alloc&) {
    told = kMemory;
  } catch (const std::exception& e) {
    told = kBad + std::string(e.what());
  } catch (...) {
    told = kBad + std::string("cannot be read");
  }
  _exit(write_all(to, told) ? 0 : 1);
}

std::string read_to_the_end(int from) {
  std::string bytes;
  std::array<char, 65536> some{};
  for (;;) {
    const ssize_t n = read(from, some.data(), some.size());
    if (n == 0 || (n < 0 && errno != EINTR)) return bytes;
    if (n > 0) bytes.append(some.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

std::string apart(const std::function<std::string()>& work, const Limits& limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
  }
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    work_and_tell(work, limits, ends[1]);
  }
  const int error = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw std::runtime_error(fmt::format("no process: {}", std::strerror(error)));
  }
  const std::string told = read_to_the_end(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
    throw std::runtime_error(fmt::format("takes more than {} s of processor time", limits.cpu_s));
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || told.empty()) {
    throw std::runtime_error("reading it crashes");
  }
  if (told[0] == kMemory) {
    throw std::runtime_error(
        fmt::format("takes more than {} MB of memory", limits.memory / 1'000'000));
  }
  if (told[0] == kBad) throw std::runtime_error(told.substr(1));
  return told.substr(1);
}

}  // namespace headpin::scene
