#include "apps/streams.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

namespace headpin::apps {

namespace {

bool reader_is_gone() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

}  // namespace

void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // open() returns the lowest free number. The opposite access mode makes any use fail.
    [[maybe_unused]] const int taken =
        open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // then a file size limit is an error, like a full disk
}

int close_standard_output(const std::string& command, int code) {
  std::cout.flush();
  const bool failed_before = std::ferror(stdout) != 0;
  const bool failed_now = std::fflush(stdout) != 0;
  // The reason of an earlier failure is not known any more; another write gives it.
  const bool failed_again = failed_before && !failed_now && ::write(STDOUT_FILENO, "\n", 1) < 0;
  const int error = failed_now || failed_again ? errno : EIO;
  const bool gone = reader_is_gone();
  const bool failed_closing = std::fclose(stdout) != 0;
  if (!failed_before && !failed_now && !failed_closing) return code;
  if (gone) return 128 + SIGPIPE;
  say("{}: standard output: {}\n", command, std::strerror(error));
  return code != 0 ? code : 1;
}

void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void print_json(const nlohmann::ordered_json& object) {
  fmt::print("{}\n", object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return text;
}

}  // namespace headpin::apps
