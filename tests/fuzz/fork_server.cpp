// Makes a program a server of its own runs, for campaigns whose runs are shorter than its start: under
// sanitizers that is a tenth of a second. Preloaded, built by mutated_logs.py:
//
//   c++ -shared -fPIC -o fork_server.so fork_server.cpp -ldl
//   LD_PRELOAD=./fork_server.so ASAN_OPTIONS=verify_asan_link_order=0 PROGRAM
//
// The program is loaded and stops before its main(). Each request on standard input is the number of
// bytes that follow, in ASCII, a newline, and then words that end in 0: a folder, a file for what is
// said, the arguments. A child runs main() with them. Answered on standard output by two lines: the
// child's process, and, when it has ended, its status as of wait4 and its peak of memory in KB.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;

/// The words of the next request; none at the end.
std::vector<std::string> next_request() {
  std::size_t size = 0;
  char newline = 0;
  if (std::scanf("%zu%c", &size, &newline) != 2) return {};
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, size, stdin) != size) return {};
  std::vector<std::string> words;
  for (std::size_t at = 0; at < size; at += words.back().size() + 1) {
    words.emplace_back(bytes.c_str() + at);
  }
  return words;
}

[[noreturn]] void run(std::vector<std::string>& words, char* program, char** environment) {
  const int nothing = open("/dev/null", O_RDONLY);
  const int said = open(words[1].c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (chdir(words[0].c_str()) != 0 || nothing < 0 || said < 0) _exit(99);
  dup2(nothing, STDIN_FILENO);
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
  std::vector<char*> arguments = {program};
  for (std::size_t i = 2; i < words.size(); ++i) arguments.push_back(words[i].data());
  arguments.push_back(nullptr);
  std::exit(real_main(static_cast<int>(arguments.size()) - 1, arguments.data(), environment));
}

int serve(int, char** argv, char** environment) {
  for (std::vector<std::string> words = next_request(); words.size() >= 2; words = next_request()) {
    const pid_t child = fork();
    if (child == 0) run(words, argv[0], environment);
    std::printf("%d\n", child);
    std::fflush(stdout);
    int status = 0;
    rusage used{};
    wait4(child, &status, 0, &used);
    std::printf("%d %ld\n", status, used.ru_maxrss);
    std::fflush(stdout);
  }
  _exit(0);
}

}  // namespace

extern "C" int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(),
                                 void (*rtld_fini)(), void* stack_end) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  real_main = main;
  unsetenv("LD_PRELOAD");
  return start(serve, argc, argv, init, fini, rtld_fini, stack_end);
}
