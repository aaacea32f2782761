// Rows of a sweep per second on one core, beside a process per row, as a shell loop would have it; and what two threads make
// of two cores.

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "sweep/runner.h"
#include "tests/bench/report.h"
#include "tests/support/folder.h"

namespace {

using namespace headpin;
namespace fs = std::filesystem;

constexpr int kRounds = 5;
constexpr double kSeconds = 5.0;  // of the game that the goal is of

/// A grid of elasticity and friction.
sweep::Design design_of(const std::string& trial) {
  return sweep::parse_design("trials = ['" + trial +
                                 "']\n[grid]\nelasticity = {from = 0, to = 1, steps = 8}\n"
                                 "friction = {from = 0, to = 1, steps = 8}\n",
                             "sweep.toml");
}

/// Simulates every `of`-th row from `first` on.
double run_rows(const sweep::Rows& rows, const std::vector<sweep::Trial>& trials,
                std::int64_t first, std::int64_t of) {
  sweep::Runner runner(rows, trials);
  double size = 0.0;
  for (std::int64_t i = first; i < rows.size(); i += of) {
    size += static_cast<double>(runner.run(rows.at(i), [] {}).size());
  }
  return size;
}

double run_processes(const sweep::Rows& rows, const std::string& trial, std::int64_t every) {
  double size = 0.0;
  for (std::int64_t i = 0; i < rows.size(); i += every) {
    const sweep::Row row = rows.at(i);
    const std::string command =
        fmt::format("'{}' replay '{}' --json --elasticity {} --friction {} >/dev/null",
                    HEADPIN_PROGRAM, trial, row.values[0], row.values[1]);
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command + " has failed");
    size += 1.0;
  }
  return size;
}

}  // namespace

int main() {
  const std::string trial = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  const std::vector<sweep::Trial> trials = {sweep::read_trial(trial)};
  const sweep::Rows rows(design_of(trial), {trials[0].sha256});
  constexpr std::int64_t kEvery = 4;  // of the processes
  const std::vector<double> best =
      bench::interleaved({{"one thread", [&] { return run_rows(rows, trials, 0, 1); }},
                          {"two threads",
                           [&] {
                             std::thread other([&] { run_rows(rows, trials, 1, 2); });
                             const double size = run_rows(rows, trials, 0, 2);
                             other.join();
                             return size;
                           }},
                          {"processes", [&] { return run_processes(rows, trial, kEvery); }}},
                         kRounds);
  const auto count = static_cast<double>(rows.size());
  const double simulated = seconds(trials[0].summary.end);
  const double each = best[0] / count, process = best[2] * kEvery / count;
  fmt::print(
      "{} rows of a throw of {:.1f} s: {:.0f} rows a second and core; scaled to a game of {:.0f} "
      "s, {:.0f}\n",
      rows.size(), simulated, 1.0 / each, kSeconds, simulated / kSeconds / each);
  bench::publish("sweep", {{"one row", "ms", 1e3 * each, "a process per row", 1e3 * process},
                           {"64 rows by two threads", "s", best[1], "by one", best[0]}});
}
