#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

/// Threads that share the work of a step. A part of `Workspace`; users need nothing inside it.
namespace headpin::engine {

/// Threads that wait between their tasks. They are made when the first work is shared.
class Crew {
 public:
  Crew();
  Crew(const Crew&);  ///< a copy makes threads of its own
  Crew& operator=(const Crew&) { return *this; }
  ~Crew();

  /// From now on work is shared by so many threads at most, this one included. They compute with the
  /// floating-point environment of the thread that shares its work.
  void use(int threads) { threads_ = static_cast<std::size_t>(threads); }
  std::size_t threads() const { return threads_; }

  /// Calls `work(part, who)` for each part from 0 on; returns when all have ended. Where the system makes no
  /// threads, this one does the work.
  ///
  /// @param work  gets the number of the thread that calls it, from 0; what it does for a part must not depend
  ///   on that, nor on other parts. Of its exceptions, that of the first part is thrown.
  template <typename F>
  void share(std::size_t parts, F&& work) {
    if (threads_ < 2 || parts < 2) {
      for (std::size_t part = 0; part < parts; ++part) work(part, std::size_t{0});
      return;
    }
    const auto call = [](void* f, std::size_t part, std::size_t who) {
      (*static_cast<std::remove_reference_t<F>*>(f))(part, who);
    };
    run({call, &work, parts});
  }

  /// Calls `work(begin, end)` for ranges that together are 0 to `count`.
  template <typename F>
  void share_range(std::size_t count, F&& work) {
    if (threads_ < 2 || count <= kRange) return work(std::size_t{0}, count);
    share((count + kRange - 1) / kRange, [&](std::size_t part, std::size_t) {
      work(part * kRange, std::min(count, (part + 1) * kRange));
    });
  }

  static constexpr std::size_t kRange = 512;  ///< bodies or touches that are worth a thread

 private:
  struct Task {
    void (*call)(void*, std::size_t, std::size_t) = nullptr;
    void* work = nullptr;
    std::size_t parts = 0;
  };
  struct Threads;

  void run(const Task& task);
  void forget_if_forked();

  std::size_t threads_ = 1;
  std::unique_ptr<Threads> others_;
};

}  // namespace headpin::engine
