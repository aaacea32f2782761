#include "apps/stop.h"

#include <csignal>
#include <cstring>

#include <signal.h>

namespace headpin::apps {

namespace {

volatile std::sig_atomic_t came = 0;

std::string name_of(int number) {
  const char* name = sigabbrev_np(number);
  return name ? std::string("SIG") + name : std::to_string(number);
}

}  // namespace

Stopped::Stopped(int number, const std::string& when)
    : std::runtime_error("stopped by " + name_of(number) + " " + when), signal(number) {}

void watch_stop_signals() {
  came = 0;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {
    }, watch{};
    sigaction(number, nullptr, &old);
    // A shell without job control starts what is behind an & with SIGINT ignored; whoever sends one
    // to it all the same means it.
    if (number == SIGHUP && old.sa_handler == SIG_IGN) continue;
    // No SA_RESTART, so that who waits is woken; the second one takes its usual course.
    watch.sa_handler = [](int signal) { came = signal; };
    watch.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(number, &watch, nullptr);
  }
}

int stop_signal() {
  return came;
}

void heed_stop() {
  came = 0;
}

void check_stop(const std::string& when) {
  if (came != 0) throw Stopped(came, when);
}

}  // namespace headpin::apps
