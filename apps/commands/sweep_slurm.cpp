#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/sweep.h"
#include "base/output_file.h"
#include "base/shell_word.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct SlurmOptions {
  std::string sweep;
  std::optional<int> tasks;
  std::optional<double> minutes;
  bool force = false, json = false;
};

constexpr int kMostTasks = 1000;  // Slurm's MaxArraySize is 1001 unless a site has another

/// Each task of the array simulates its part. Slurm sends SIGTERM a minute before the end of the
/// time, and the finished rows are kept.
std::string array_script(const fs::path& sweep, const std::string& program, int tasks,
                         std::int64_t minutes) {
  return fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=headpin-sweep\n"
      "#SBATCH --array=1-{}\n"
      "#SBATCH --cpus-per-task=1\n"
      "#SBATCH --time={}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --signal=B:TERM@60\n"
      "#SBATCH --output={}/slurm-%A_%a.txt\n"
      "#SBATCH --open-mode=append\n"
      "exec {} sweep run {} --shard \"$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT\" --jobs 1\n",
      tasks, minutes, sweep.string(), base::shell_word(program), base::shell_word(sweep.string()));
}

std::string merge_script(const fs::path& sweep, const std::string& program) {
  return fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=headpin-merge\n"
      "#SBATCH --time=60\n"
      "#SBATCH --output={}/slurm-merge-%j.txt\n"
      "exec {} sweep merge {} -o {} --force\n",
      sweep.string(), base::shell_word(program), base::shell_word(sweep.string()),
      base::shell_word((sweep / "results.csv").string()));
}

void write_slurm(const SlurmOptions& options) {
  watch_stop_signals();
  const sweep::Sweep sweep = open_planned(options.sweep);
  const int most = static_cast<int>(std::min<std::int64_t>(kMostTasks, sweep.pieces.size()));
  const int tasks = options.tasks.value_or(most);
  if (tasks > most) {
    throw UsageError(fmt::format(
        "--tasks: expected at most {}, as many as there are pieces, found {}", most, tasks));
  }
  const fs::path folder = fs::absolute(options.sweep).lexically_normal();
  const std::string text = folder.string();
  if (text.find_first_of("\n %") != std::string::npos) {
    throw UsageError(
        fmt::format("{}: expected a folder without spaces and %, which Slurm's options "
                    "cannot have",
                    text));
  }
  double minutes = options.minutes.value_or(0.0);
  if (!options.minutes) {  // other machines are slower, and some rows take longer
    const double rows = static_cast<double>(sweep.rows.size()) / tasks;
    minutes = 10.0 + 3.0 * rows * seconds_per_row(sweep) / 60.0;
  }
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  const fs::path array = folder / "sweep.sbatch", merge = folder / "merge.sbatch";
  const base::OutputFile::Options how{.overwrite = options.force};
  const std::string run =
      array_script(folder, program, tasks, static_cast<std::int64_t>(std::ceil(minutes)));
  base::write_text({array.string(), how}, run);
  base::write_text({merge.string(), how}, merge_script(folder, program));
  const std::string submit =
      fmt::format("sbatch --dependency=afterok:$(sbatch --parsable {}) {}",
                  base::typed_word(array.string()), base::typed_word(merge.string()));
  if (options.json) {
    return print_json({{"array", array.string()},
                       {"merge", merge.string()},
                       {"tasks", tasks},
                       {"minutes", std::ceil(minutes)},
                       {"submit", submit}});
  }
  fmt::print("{}: {} tasks of at most {}\n{}\nsubmit both:\n  {}\n", array.string(), tasks,
             duration_in_words(60.0 * std::ceil(minutes)), merge.string(), submit);
}

}  // namespace

void add_sweep_slurm(CLI::App& group) {
  CLI::App* command =
      group.add_subcommand("slurm", "Write the scripts that run the sweep on Slurm");
  const auto options = std::make_shared<SlurmOptions>();
  add_sweep_folder(*command, options->sweep);
  command
      ->add_option("--tasks", options->tasks,
                   "of the array; as many as there are pieces, at most 1000, when not given")
      ->check(whole_number_from(1, kMostTasks));
  command
      ->add_option("--minutes", options->minutes,
                   "time limit of a task; when not given, three times what this machine would "
                   "take and ten minutes")
      ->check(number_from(1, 100000));
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Writes sweep.sbatch (an array job) and merge.sbatch into the folder. The folder must be on "
      "a "
      "file system\nthat all nodes share.\n\n"
      "Example:\n  headpin sweep slurm sweep --tasks 100");
  command->callback([options] { write_slurm(*options); });
}

}  // namespace headpin::apps
