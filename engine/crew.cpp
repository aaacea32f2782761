#include "engine/crew.h"

#include <version>

// The page's engine is built without threads, and its library has none.
#ifdef __cpp_lib_jthread
#include <atomic>
#include <cfenv>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include <unistd.h>
#endif

namespace headpin::engine {

#ifdef __cpp_lib_jthread

namespace {

/// Looks so often for a change before it sleeps: about as long as the parts of a step that one thread does alone.
/// To wake a sleeping thread can take longer than its work.
constexpr int kLooks = 1 << 14, kLooksUntilYield = 1 << 7;

/// Waits until a value is another one. @return  that
template <typename T>
T other_than(const std::atomic<T>& value, T old) {
  for (int k = 1; k <= kLooks; ++k) {
    if (const T now = value.load(); now != old) return now;
    if (k % kLooksUntilYield == 0) std::this_thread::yield();
#ifdef __x86_64__
    __builtin_ia32_pause();
#endif
  }
  value.wait(old);
  return value.load();
}

}  // namespace

struct Crew::Threads {
  ~Threads() {
    ends = true;
    calls.fetch_add(1);
    calls.notify_all();
    for (std::thread& thread : all) thread.join();
  }

  /// Makes as many threads as are missing, if the system can.
  void make(std::size_t wanted) {
    if (refused) return;
    try {
      while (all.size() < wanted) {
        all.emplace_back([this, who = all.size() + 1, seen = calls.load()] { wait(who, seen); });
      }
    } catch (const std::system_error&) {  // a limit on threads or addresses is reached
      refused = true;
    } catch (const std::bad_alloc&) {
      refused = true;
    }
  }

  void wait(std::size_t who, std::uint32_t seen) {
    for (;; ++seen) {
      other_than(calls, seen);
      if (ends) return;
      std::fesetenv(&environment);
      if (who < members) work(who);
      if (busy.fetch_sub(1) == 1) busy.notify_one();
    }
  }

  /// Takes parts until none is left.
  void work(std::size_t who) {
    for (;;) {
      const std::size_t part = next.fetch_add(1, std::memory_order_relaxed);
      if (part >= task.parts) return;
      try {
        task.call(task.work, part, who);
      } catch (...) {
        const std::lock_guard lock(failing);
        if (part < failed) {
          failed = part;
          failure = std::current_exception();
        }
      }
    }
  }

  std::vector<std::thread> all;  ///< who - 1
  const pid_t process = getpid();
  bool refused = false;
  bool ends = false;                     ///< read after the next call
  std::atomic<std::uint32_t> calls = 0;  ///< tasks so far
  std::atomic<std::size_t> busy = 0;     ///< threads that have not ended the task
  std::atomic<std::size_t> next = 0;     ///< part that nobody has taken
  Task task;
  std::fenv_t environment{};  ///< of the caller
  std::size_t members = 0;    ///< threads that work on the task, the caller included
  std::mutex failing;
  std::size_t failed = std::numeric_limits<std::size_t>::max();
  std::exception_ptr failure;
};

/// A child of fork() has none of the threads.
void Crew::forget_if_forked() {
  if (others_ && others_->process != getpid()) static_cast<void>(others_.release());
}

void Crew::run(const Task& task) {
  forget_if_forked();
  if (others_ && others_->all.size() >= threads_) others_ = nullptr;
  if (!others_) others_ = std::make_unique<Threads>();
  Threads& t = *others_;
  t.make(threads_ - 1);
  std::fegetenv(&t.environment);
  t.task = task;
  t.members = threads_;
  t.failed = std::numeric_limits<std::size_t>::max();
  t.failure = nullptr;
  t.next = 0;
  t.busy = t.all.size();
  t.calls.fetch_add(1);
  t.calls.notify_all();
  t.work(0);
  for (std::size_t busy = t.busy; busy != 0;) busy = other_than(t.busy, busy);
  if (t.failure) std::rethrow_exception(t.failure);
}

#else

struct Crew::Threads {};

void Crew::forget_if_forked() {}

void Crew::run(const Task& task) {
  for (std::size_t part = 0; part < task.parts; ++part) task.call(task.work, part, 0);
}

#endif

Crew::Crew() = default;
Crew::Crew(const Crew&) : Crew() {}
Crew::~Crew() {
  forget_if_forked();
}

}  // namespace headpin::engine
