#include "apps/stop.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstring>

#include <signal.h>
#include <time.h>

namespace headpin::apps {

namespace {

/// Signals within this time of the first one count as the same request [ns]. `timeout` sends each
/// signal to the command and to its whole group, and a closed terminal also sends two.
constexpr std::int64_t kSameWish = 1'000'000'000;

volatile std::sig_atomic_t came = 0;
std::atomic<std::int64_t> first_came = 0;  // 0: none yet
static_assert(decltype(first_came)::is_always_lock_free);

/// Records the first signal. A signal much later has its default effect.
void note(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t ns = std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  std::int64_t first = 0;
  if (first_came.compare_exchange_strong(first, ns)) {
    came = signal;
  } else if (ns - first > kSameWish) {
    struct sigaction usual {};
    usual.sa_handler = SIG_DFL;
    sigaction(signal, &usual, nullptr);
    raise(signal);  // delivered when this returns
  }
}

std::string name_of(int number) {
  const char* name = sigabbrev_np(number);
  return name ? std::string("SIG") + name : std::to_string(number);
}

}  // namespace

Stopped::Stopped(int number, const std::string& when)
    : std::runtime_error("stopped by " + name_of(number) + " " + when), signal(number) {}

void watch_stop_signals() {
  came = 0;
  first_came = 0;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {
    }, watch{};
    sigaction(number, nullptr, &old);
    // A shell without job control starts a background command with SIGINT ignored. A SIGINT that is
    // sent to it nevertheless is intended.
    if (number == SIGHUP && old.sa_handler == SIG_IGN) continue;
    watch.sa_handler = note;  // no SA_RESTART, so that it interrupts waiting
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
