// Rows of a sweep per second on one core, beside a process per row, as a shell loop would have it; and what two threads make
// of two cores.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>

#include "devices/base/sources.h"
#include "study/csv.h"
#include "sweep/folder.h"
#include "sweep/runner.h"
#include "sweep/throw_again.h"
#include "tests/bench/report.h"
#include "tests/support/folder.h"

namespace {

using namespace headpin;
namespace fs = std::filesystem;

constexpr int kRounds = 5;
const std::int64_t kTodaysRules = scene::Scenario{}.collision.rules;  // the trial has older ones
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
    const std::string command = fmt::format(
        "'{}' replay '{}' --json --elasticity {} --friction {} --set collision.rules={} >/dev/null",
        HEADPIN_PROGRAM, trial, row.values[0], row.values[1], kTodaysRules);
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command + " has failed");
    size += 1.0;
  }
  return size;
}

/// Releases of the bundled throw at 120 moments.
double run_releases(const sweep::Situation& situation) {
  double down = 0.0;
  for (int i = 0; i < 120; ++i) {
    down +=
        static_cast<double>(sweep::throw_again(situation, {.shift = Time{1000 * (i - 60)}}).down);
  }
  return down;
}

sweep::Situation situation_of(const sweep::Trial& trial) {
  scene::Session session = scene::make_session(trial.scenario);
  devices::ReplaySource source(trial.samples);
  sweep::Situations situations(Time{100'000});
  while (session.now() < trial.summary.end) {
    scene::advance(session, source);
    situations.tick(session);
  }
  return situations.all().front();
}

/// A sweep of a million rows, all with the same result, merged by the program.
void merge_a_million(const std::string& trial) {
  const fs::path folder = fresh_folder("merge");
  spit(folder / "sweep.toml", "trials = ['" + trial +
                                  "']\n[grid]\nelasticity = {from = 0, to = 1, steps = 1000}\n"
                                  "friction = {from = 0, to = 1, steps = 1000}\n");
  sweep::plan(folder / "sweep.toml", {folder / "sweep"}, [] {});
  const sweep::Sweep sweep = sweep::open_sweep(folder / "sweep");
  sweep::Runner runner(sweep.rows, sweep.trials);
  std::vector<std::string> cells = runner.run(sweep.rows.at(0), [] {});
  for (std::int64_t i = 0; i < sweep.pieces.size(); ++i) {
    const sweep::Piece piece = sweep.pieces.at(i);
    std::vector<std::string> lines;
    for (std::int64_t row = piece.first; row < piece.first + piece.rows; ++row) {
      const std::vector<std::string> own = sweep::cells_of(sweep.rows, sweep.rows.at(row));
      std::ranges::copy(own, cells.begin());
      lines.push_back(study::csv_line(cells));
    }
    spit(sweep.at.piece(piece), sweep::piece_text(sweep.plan, piece, sweep.columns, lines, 0));
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::string command =
      fmt::format("'{}' sweep merge '{}' -o '{}' >/dev/null", HEADPIN_PROGRAM,
                  (folder / "sweep").string(), (folder / "all.csv").string());
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command + " has failed");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  fmt::print("{} rows merged in {:.1f} s and {:.0f} MB\n", sweep.rows.size(), took.count(),
             static_cast<double>(used.ru_maxrss) / 1024.0);
  fs::remove_all(folder);
}

}  // namespace

int main() {
  const std::string trial = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  std::vector<sweep::Trial> trials = {sweep::read_trial(trial)};
  trials[0].scenario.collision.rules = kTodaysRules;
  const sweep::Rows rows(design_of(trial), {trials[0].sha256});
  constexpr std::int64_t kEvery = 4;  // of the processes
  const sweep::Situation situation = situation_of(trials[0]);
  const std::vector<double> best =
      bench::interleaved({{"120 releases", [&] { return run_releases(situation); }},
                          {"one thread", [&] { return run_rows(rows, trials, 0, 1); }},
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
  const double each = best[1] / count, process = best[3] * kEvery / count;
  fmt::print(
      "{} rows of a throw of {:.1f} s: {:.0f} rows a second and core; scaled to a game of {:.0f} "
      "s, {:.0f}\n",
      rows.size(), simulated, 1.0 / each, kSeconds, simulated / kSeconds / each);
  bench::publish("sweep", {{"120 releases", "s", best[0], "a process each", 120 * process},
                           {"one row", "ms", 1e3 * each, "a process per row", 1e3 * process},
                           {"64 rows by two threads", "s", best[2], "by one", best[1]}});
  merge_a_million(trial);
}
