#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/stop.h"
#include "apps/sweep.h"

namespace headpin::apps {

CLI::Option* add_sweep_folder(CLI::App& command, std::string& folder) {
  return command.add_option("SWEEP", folder, "the sweep's folder")->required();
}

sweep::Sweep open_planned(const std::string& folder) {
  if (!std::filesystem::exists(sweep::SweepFolder{folder}.rows())) {
    throw std::runtime_error(fmt::format(
        "{0}: expected a sweep, found no rows.csv; `headpin sweep plan SWEEP.toml -o {0}` makes one",
        folder));
  }
  return sweep::open_sweep(folder);
}

double seconds_per_row(const sweep::Sweep& sweep) {
  constexpr std::int64_t kMostRows = 40;
  constexpr std::chrono::seconds kLongest{5};
  const std::int64_t rows = std::min(kMostRows, sweep.rows.size());
  sweep::Runner runner(sweep.rows, sweep.trials);
  const auto begin = std::chrono::steady_clock::now();
  std::int64_t tried = 0;
  while (tried < rows && std::chrono::steady_clock::now() - begin < kLongest) {
    // In steps of the golden ratio, so that rows of all parts are reached soon.
    const double part = std::fmod(0.5 + 0.6180339887498949 * static_cast<double>(tried), 1.0);
    runner.run(
        sweep.rows.at(static_cast<std::int64_t>(part * static_cast<double>(sweep.rows.size()))),
        [] { check_stop(); });
    ++tried;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  return took.count() / static_cast<double>(tried);
}

std::string duration_in_words(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  const std::int64_t minutes = (whole + 59) / 60;
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

SweepProgress progress_of(const sweep::Sweep& sweep) {
  SweepProgress progress{.rows = sweep.rows.size()};
  for (std::int64_t i = 0; i < sweep.pieces.size(); ++i) {
    check_stop();
    if (const auto end = sweep::piece_of(sweep, sweep.pieces.at(i), nullptr)) {
      progress.done += end->rows;
      progress.failed += end->failed;
    }
  }
  return progress;
}

}  // namespace headpin::apps
