#include "apps/sweep.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "base/shell_word.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct PlanSweepOptions {
  std::string design;
  std::optional<std::string> output;
  bool estimate = false, json = false;
};

void plan_sweep(const PlanSweepOptions& options) {
  watch_stop_signals();
  const sweep::SweepFolder at{*options.output};
  const std::int64_t rows = sweep::plan(options.design, at, [] { check_stop(); });
  nlohmann::ordered_json result = {{"output", *options.output}, {"planned", rows}};
  double each = 0.0;
  if (options.estimate) {
    each = seconds_per_row(sweep::open_sweep(at.root));
    result["seconds_per_row"] = each;
    result["core_seconds"] = each * static_cast<double>(rows);
  }
  if (options.json) return print_json(result);
  fmt::print("{}: {} rows\n", at.rows().string(), rows);
  if (options.estimate) {
    fmt::print("{:.1f} ms a row: about {} on one core of this machine\n", 1000.0 * each,
               duration_in_words(each * static_cast<double>(rows)));
  }
  fmt::print("next: headpin sweep run {}\n", base::typed_word(*options.output));
}

struct StatusSweepOptions {
  std::string sweep;
  bool json = false;
};

void tell_status(const StatusSweepOptions& options) {
  watch_stop_signals();
  const sweep::Sweep sweep = open_planned(options.sweep);
  const SweepProgress progress = progress_of(sweep);
  if (options.json) {
    return print_json(
        {{"planned", progress.rows}, {"done", progress.done}, {"failed", progress.failed}});
  }
  fmt::print("{} of {} rows are done, {} of them failed\n", progress.done, progress.rows,
             progress.failed);
  const std::string folder = base::typed_word(options.sweep);
  fmt::print("next: headpin sweep {}\n", progress.done < progress.rows
                                             ? fmt::format("run {}", folder)
                                             : fmt::format("merge {} -o FILE.csv", folder));
}

struct MergeOptions {
  std::string sweep;
  std::optional<std::string> output;
  bool partial = false, force = false, json = false;
};

/// Refuses an output that is part of the sweep itself.
void require_outside(const sweep::SweepFolder& at, const std::string& output) {
  const fs::path path = fs::weakly_canonical(output), root = fs::weakly_canonical(at.root);
  const fs::path inside = path.lexically_relative(root);
  const std::string first = inside.empty() ? "" : inside.begin()->string();
  const bool is_folder = first == at.pieces().filename() || first == at.trials().filename();
  if (!is_folder && inside != at.rows().filename()) return;
  throw UsageError(
      fmt::format("--output: {} is part of the sweep; expected another file, such as {}", output,
                  (at.root / "results.csv").string()));
}

void merge(const MergeOptions& options) {
  watch_stop_signals();
  const sweep::Sweep sweep = open_planned(options.sweep);
  require_outside(sweep.at, *options.output);
  base::OutputFile file(*options.output, {.overwrite = options.force, .standard_output = true});
  file.write(sweep.columns.data(), sweep.columns.size());
  SweepProgress progress{.rows = sweep.rows.size()};
  std::int64_t first_missing = 0;  // from 1
  Progress bar("pieces", sweep.pieces.size());
  std::vector<std::string> lines;
  for (std::int64_t i = 0; i < sweep.pieces.size(); ++i) {
    check_stop();
    bar.show(i);
    const sweep::Piece piece = sweep.pieces.at(i);
    const auto end = sweep::piece_of(sweep, piece, &lines);
    const std::int64_t done = end ? end->rows : 0;
    if (done < piece.rows && first_missing == 0) first_missing = piece.first + done + 1;
    progress.done += done;
    progress.failed += end ? end->failed : 0;
    if (!end || (first_missing > 0 && !options.partial)) continue;
    std::string text;
    for (const std::string& line : lines) text += line;
    file.write(text.data(), text.size());
  }
  if (first_missing > 0 && !options.partial) {
    const std::int64_t missing = progress.rows - progress.done;
    throw std::runtime_error(fmt::format(
        "{}: {} of {} rows {} not done, the first is row {}; `headpin sweep run {}` goes on, "
        "--partial merges those that are there",
        options.sweep, missing, progress.rows, missing == 1 ? "is" : "are", first_missing,
        options.sweep));
  }
  file.commit();
  if (options.json) {
    return print_json({{"output", *options.output},
                       {"planned", progress.rows},
                       {"merged", progress.done},
                       {"failed", progress.failed}});
  }
  fmt::print("{}: {} of {} rows, {} of them failed\n", *options.output, progress.done,
             progress.rows, progress.failed);
}

}  // namespace

void add_sweep_plan(CLI::App& group) {
  CLI::App* command = group.add_subcommand("plan", "Make a sweep from a design in TOML");
  const auto options = std::make_shared<PlanSweepOptions>();
  command->add_option("DESIGN", options->design, "trials, grid and random values (.toml)")
      ->required();
  add_output(*command, "-o,--output", options->output, "folder to make", {})->required();
  command->add_flag("--estimate", options->estimate,
                    "simulate a few rows and say how long all of them take on this machine");
  add_json(*command, options->json);
  command->footer(
      "A design:\n"
      "  trials = ['throw.lcmlog']  # from the folder of the design\n"
      "  [grid]  # every combination\n"
      "  elasticity = {from = 0, to = 1, steps = 21}\n"
      "  friction = [0, 0.35, 0.7]\n"
      "  [random]  # so many draws for every combination\n"
      "  draws = 10\n"
      "  ball.mass = {from = 5, to = 7}\n\n"
      "Keys are elasticity, friction, shape, response, detection, iterations, and all of a "
      "scenario.\nThe folder has the design, copies of the trials, and rows.csv: one row a "
      "replay.\n\n"
      "Example:\n  headpin sweep plan sweep.toml -o sweep --estimate");
  command->callback([options] { plan_sweep(*options); });
}

void add_sweep_status(CLI::App& group) {
  CLI::App* command = group.add_subcommand("status", "How many rows are done, and what comes next");
  const auto options = std::make_shared<StatusSweepOptions>();
  add_sweep_folder(*command, options->sweep);
  add_json(*command, options->json);
  command->footer("Example:\n  headpin sweep status sweep");
  command->callback([options] { tell_status(*options); });
}

void add_sweep_merge(CLI::App& group) {
  CLI::App* command = group.add_subcommand("merge", "Write all results as one table");
  const auto options = std::make_shared<MergeOptions>();
  add_sweep_folder(*command, options->sweep);
  add_output(*command, "-o,--output", options->output,
             "table to write (.csv); - is standard output", {".csv"})
      ->required();
  command->add_flag("--partial", options->partial, "leave out rows that are not done");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Rows are in the order of rows.csv: the file has the same bytes whoever simulated which row. "
      "Every piece\nis checked.\n\n"
      "Example:\n  headpin sweep merge sweep -o results.csv");
  command->callback([options] { merge(*options); });
}

void add_sweep(CLI::App& app) {
  CLI::App* group =
      app.add_subcommand("sweep", "Many replays under many conditions: a sweep is a folder");
  group->require_subcommand(1);
  add_sweep_plan(*group);
  add_sweep_run(*group);
  add_sweep_status(*group);
  add_sweep_merge(*group);
  add_sweep_report(*group);
  add_sweep_slurm(*group);
  group->footer(
      "Example:\n  headpin sweep plan sweep.toml -o sweep\n  headpin sweep run sweep\n"
      "  headpin sweep merge sweep -o results.csv");
}

}  // namespace headpin::apps
