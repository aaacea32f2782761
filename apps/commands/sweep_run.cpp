#include <algorithm>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/sweep.h"
#include "base/left_parts.h"
#include "base/threads.h"

namespace headpin::apps {

namespace {

struct RunSweepOptions {
  std::string sweep, shard;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool json = false;
};

/// The pieces of this process: those with number mod `of` = `rest`.
struct Shard {
  std::int64_t rest = 0, of = 1;
};

constexpr std::int64_t kMostShards = 1'000'000'000;  // numbers of pieces stay far below an overflow

/// "3/8" is the third of eight.
Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  std::int64_t k = 0, n = 0;
  const char* const end = text.data() + text.size();
  const char* const slash = text.data() + std::min(text.find('/'), text.size());
  const bool good = slash != end && std::from_chars(text.data(), slash, k).ptr == slash &&
                    std::from_chars(slash + 1, end, n).ptr == end && 1 <= k && k <= n &&
                    n <= kMostShards;
  if (!good) {
    throw UsageError(
        fmt::format("--shard: expected K/N with K from 1 to N, and N at most {}, found '{}'",
                    kMostShards, text));
  }
  return {k - 1, n};
}

/// Threads that process one piece after the other, and their progress.
class Workers {
 public:
  Workers(const sweep::Sweep& sweep, Shard shard) : sweep_(sweep), shard_(shard) {}

  /// @throws  the first exception of a thread
  void run(int count, std::int64_t rows) {
    const std::vector<std::jthread> threads = base::begin_threads(count, [this] { work(); });
    if (threads.empty()) work();
    Progress progress("rows", rows);
    std::unique_lock lock(mutex_);
    const auto all = static_cast<int>(std::max(threads.size(), std::size_t{1}));
    while (ended_ < all) {
      one_ended_.wait_for(lock, std::chrono::milliseconds(100));
      progress.show(done_);
    }
    if (failure_) std::rethrow_exception(failure_);
  }

  std::int64_t done() const { return done_; }
  std::int64_t elsewhere() const { return elsewhere_; }  ///< pieces that another process works on

 private:
  void work() {
    try {
      sweep::Runner runner(sweep_.rows, sweep_.trials);
      while (const auto piece = next()) {
        const sweep::PieceClaim claim(sweep_, *piece);
        if (!claim.is_ours()) {
          ++elsewhere_;
          continue;
        }
        sweep::run_piece(
            sweep_, *piece, runner,
            [this] {
              check_stop();
              if (failed_) throw Stopped(0);
            },
            [this] { ++done_; });
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failed_.exchange(true)) failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    one_ended_.notify_all();
  }

  std::optional<sweep::Piece> next() {
    const std::int64_t number = shard_.rest + shard_.of * taken_++;
    if (number >= sweep_.pieces.size()) return std::nullopt;
    return sweep_.pieces.at(number);
  }

  const sweep::Sweep& sweep_;
  Shard shard_;
  std::atomic<std::int64_t> taken_{0}, done_{0}, elsewhere_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::condition_variable one_ended_;
  int ended_ = 0;
  std::exception_ptr failure_;
};

void run_sweep(const RunSweepOptions& options) {
  const Shard shard = parse_shard(options.shard);
  watch_stop_signals();
  const sweep::Sweep sweep = open_planned(options.sweep);
  std::filesystem::create_directories(sweep.at.pieces());  // a copy may lack it while it is empty
  base::remove_left_parts(sweep.at.pieces().string());
  std::int64_t rows = 0, missing = 0;
  for (std::int64_t i = shard.rest; i < sweep.pieces.size(); i += shard.of) {
    check_stop();
    const sweep::Piece piece = sweep.pieces.at(i);
    const auto end = sweep::piece_of(sweep, piece, nullptr);
    rows += piece.rows;
    missing += piece.rows - (end ? end->rows : 0);
  }
  Workers workers(sweep, shard);
  const auto begin = std::chrono::steady_clock::now();
  workers.run(options.jobs, missing);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const SweepProgress progress = progress_of(sweep);
  if (options.json) {
    return print_json({{"planned", rows},
                       {"simulated", workers.done()},
                       {"failed", progress.failed},
                       {"of_another", workers.elsewhere()},
                       {"rows_per_second", static_cast<double>(workers.done()) / took.count()}});
  }
  fmt::print("{} of {} rows simulated", workers.done(), rows);
  if (workers.done() > 0) {
    fmt::print(", {:.0f} a second", static_cast<double>(workers.done()) / took.count());
  }
  fmt::print("; {} of the sweep's {} are done, {} failed\n", progress.done, progress.rows,
             progress.failed);
  if (workers.elsewhere() > 0) {
    fmt::print("{} pieces are being simulated by another headpin\n", workers.elsewhere());
  }
}

}  // namespace

void add_sweep_run(CLI::App& group) {
  CLI::App* command = group.add_subcommand("run", "Simulate the rows that are not done yet");
  const auto options = std::make_shared<RunSweepOptions>();
  add_sweep_folder(*command, options->sweep);
  command->add_option("--jobs", options->jobs, "rows at a time; all cores when not given")
      ->check(whole_number_from(1, 1024));
  command->add_option("--shard", options->shard,
                      "K/N: the K-th of N parts of the sweep, for N processes or machines");
  add_json(*command, options->json);
  command->footer(
      "Results are in pieces/, up to 1000 rows each, and each piece is written when it is done. A "
      "run that was\nstopped or killed goes on where it was; several may run on one folder. A row "
      "that fails has its reason\nin the column error.\n\n"
      "Example:\n  headpin sweep run sweep\n  headpin sweep run sweep --shard 1/8 --jobs 1");
  command->callback([options] { run_sweep(*options); });
}

}  // namespace headpin::apps
