#include <algorithm>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "apps/python/interrupts.h"
#include "apps/python/module.h"
#include "apps/python/reading.h"
#include "base/threads.h"
#include "sweep/result.h"
#include "sweep/runner.h"

namespace headpin::python {

namespace {

using namespace pybind11::literals;
using Values = std::vector<std::string>;

/// Every trial under every condition; the trial changes fastest.
struct Plan {
  std::vector<sweep::Trial> trials;
  std::vector<std::string> keys;
  std::vector<Values> conditions;

  std::size_t size() const { return trials.size() * conditions.size(); }
};

struct Ended {};  ///< a thread is asked to end

/// Threads that replay, block by block, and what each replay comes to.
class Replays {
 public:
  explicit Replays(const Plan& plan) : plan_(plan), cells_(plan.size()) {}

  /// Runs without the interpreter's lock.
  ///
  /// @param poll  called ten times a second with the number of finished replays; may throw
  /// @throws  what `poll` throws, after all threads have ended; or the first exception of a thread
  /// @throws std::runtime_error  when no thread can be made
  void run(std::size_t threads, const std::function<void(std::size_t)>& poll) {
    block_ = std::clamp<std::size_t>(plan_.size() / (8 * threads), 1, 16);
    const int most = static_cast<int>(std::min(threads, plan_.size()));
    std::vector<std::jthread> all = base::begin_threads(most, [this] { work(); });
    if (all.empty() && most > 0) throw std::runtime_error("threads: none could be made");
    try {
      std::unique_lock lock(mutex_);
      while (over_ < all.size()) {
        ended_.wait_for(lock, std::chrono::milliseconds(100));
        lock.unlock();
        poll(done_);
        lock.lock();
      }
    } catch (...) {
      end_with(std::current_exception());
    }
    all.clear();
    if (failure_) std::rethrow_exception(failure_);
  }

  /// Of every replay, those of sweep::result_columns().
  const std::vector<Values>& cells() const { return cells_; }

 private:
  void work() {
    try {
      sweep::Replayer replayer(plan_.keys, plan_.trials);
      for (std::size_t first = next_.fetch_add(block_); first < cells_.size();
           first = next_.fetch_add(block_)) {
        const std::size_t end = std::min(first + block_, cells_.size());
        for (std::size_t i = first; i < end; ++i, ++done_) cells_[i] = replay(replayer, i);
      }
    } catch (const Ended&) {
    } catch (...) {
      end_with(std::current_exception());
    }
    const std::lock_guard lock(mutex_);
    ++over_;
    ended_.notify_all();
  }

  Values replay(sweep::Replayer& replayer, std::size_t i) {
    const std::size_t count = plan_.trials.size();
    return replayer.run(i % count, plan_.conditions[i / count], [this] {
      if (end_) throw Ended();
    });
  }

  void end_with(std::exception_ptr why) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(why);
    end_ = true;
  }

  const Plan& plan_;
  std::vector<Values> cells_;
  std::size_t block_ = 1;
  std::atomic<std::size_t> next_{0}, done_{0};
  std::atomic<bool> end_{false};
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t over_ = 0;  ///< threads that have ended
  std::exception_ptr failure_;
};

void check_keys(const std::vector<std::string>& keys) {
  const std::vector<std::string> known = sweep::keys_of_conditions();
  const std::set<std::string> all(known.begin(), known.end());
  for (const std::string& key : keys) {
    if (all.contains(key) || key.find('[') != std::string::npos) continue;
    throw std::invalid_argument("table: '" + key +
                                "' is no key; expected elasticity, friction, shape, response, "
                                "detection, iterations or a key of the scenario");
  }
}

double number(const std::string& cell) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  double value = 0.0;
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

/// A column of results: text as a list, numbers as an array.
py::object column(const std::vector<Values>& cells, std::size_t which, const std::string& name) {
  if (name == "state_hash" || name == "error") {
    py::list all;
    for (const Values& row : cells) all.append(row[which]);
    return all;
  }
  py::array_t<double> all(static_cast<py::ssize_t>(cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    all.mutable_at(static_cast<py::ssize_t>(i)) = number(cells[i][which]);
  }
  return all;
}

py::dict replay_many(const std::vector<std::string>& trials, const std::vector<std::string>& keys,
                     const std::vector<Values>& conditions, int threads,
                     const py::object& progress) {
  check_keys(keys);
  if (threads < 0 || threads > 1024) {
    throw std::invalid_argument("threads: expected 0 to 1024, found " + std::to_string(threads));
  }
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  Plan plan{{}, keys, conditions};
  std::optional<Replays> replays;
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    for (const std::string& path : trials) {
      interrupts.check();
      plan.trials.push_back(reading<DamagedTrial>(path, [&] { return sweep::read_trial(path); }));
    }
    replays.emplace(plan);
    replays->run(threads == 0 ? cores : static_cast<std::size_t>(threads), [&](std::size_t done) {
      interrupts.check();
      if (progress.is_none()) return;
      const py::gil_scoped_acquire lock;
      progress(done, plan.size());
    });
  }
  py::dict columns;
  for (std::size_t i = 0; i < sweep::result_columns().size(); ++i) {
    const std::string name = sweep::result_columns()[i].name;
    columns[py::str(name)] = column(replays->cells(), i, name);
  }
  return columns;
}

}  // namespace

void add_many(py::module_& module) {
  module.def("_replay_many", replay_many, "trials"_a, "keys"_a, "conditions"_a, "threads"_a,
             "progress"_a);
}

}  // namespace headpin::python
