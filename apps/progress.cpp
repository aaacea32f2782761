#include "apps/progress.h"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/streams.h"

namespace headpin::apps {

Progress::Progress(std::string what, std::int64_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      shown_(start_) {}

Progress::~Progress() {
  erase();
}

void Progress::erase() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::int64_t done) {
  if (done >= total_) return erase();
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || done == 0 || now - shown_ < std::chrono::milliseconds(200)) return;
  shown_ = now;
  const double spent = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done) / spent;
  const double left = static_cast<double>(total_ - done) / rate;
  say("\r\033[K{} of {} {}, {:.0f} a second, {:.0f} s left", done, total_, what_, rate, left);
  std::fflush(stderr);
}

}  // namespace headpin::apps
