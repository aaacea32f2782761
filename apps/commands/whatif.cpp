#include "apps/whatif.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_folder.h"
#include "base/output_text.h"
#include "sweep/whatif_svg.h"
#include "sweep/whatif_tables.h"

namespace headpin::apps {

namespace {

struct WhatIfOptions {
  WhatIfQuestion question;
  std::optional<std::string> output;
  bool force = false, json = false;
};

void write_file(base::OutputFolder& folder, const std::string& name, const std::string& text) {
  base::OutputText file(folder.file(name));
  file << text;
  file.close();
}

void write_answer(const sweep::WhatIf& whatif, base::OutputFolder& folder) {
  write_file(folder, "moments.csv", sweep::moments_csv(whatif));
  write_file(folder, "moments.svg", sweep::moments_svg(whatif));
  write_file(folder, "releases.csv", sweep::releases_csv(whatif));
  write_file(folder, "map.svg", sweep::map_svg(whatif));
  if (whatif.miss) write_file(folder, "boards.svg", sweep::boards_svg(whatif));
  write_file(folder, "throws.csv", sweep::throws_csv(whatif));
  write_file(folder, "whatif.json", to_json(whatif).dump(2) + "\n");
  check_stop();
  folder.commit("whatif.json");
}

void what_if(const WhatIfOptions& options) {
  watch_stop_signals();
  std::optional<base::OutputFolder> folder;
  if (options.output) {
    base::OutputFolder::Options how{.overwrite = options.force, .others = {}};
    for (const std::string& trial : options.question.trials) how.others.emplace_back(trial);
    folder.emplace(*options.output, how);
  }
  const sweep::WhatIf whatif = ask_what_if(options.question, "whatif");
  if (folder) write_answer(whatif, *folder);
  if (options.json) {
    nlohmann::ordered_json json = to_json(whatif);
    json["output"] = options.output ? nlohmann::ordered_json(*options.output) : nullptr;
    return print_json(json);
  }
  for (const auto& [label, words] : in_lines(whatif)) fmt::print("{:<18}{}\n", label, words);
  if (options.output) fmt::print("{:<18}{}\n", "written", *options.output);
}

}  // namespace

void add_whatif(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "whatif", "Simulate a throw again for other releases: moments, speeds, directions");
  const auto options = std::make_shared<WhatIfOptions>();
  WhatIfQuestion& question = options->question;
  question.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  command
      ->add_option(
          "TRIALS", question.trials,
          "a trial (.lcmlog) with the throw; further trials add their throws; - is standard input")
      ->required();
  add_output(*command, "-o,--output", options->output, "folder for tables and pictures", {});
  command->add_option("--throw", question.number, "number of the throw in its trial")
      ->check(whole_number_from(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--within", question.within_ms, "moments before and after the release [ms]")
      ->check(number_from(0.0, 1e3 * seconds(sweep::kMostShift)))
      ->capture_default_str();
  command->add_option("--step", question.step_ms, "between two moments [ms]")
      ->check(number_from(0.1, 1e3))
      ->capture_default_str();
  command->add_option("--speed", question.speed, "factors of the speed: FROM:TO:STEPS or one")
      ->capture_default_str();
  command->add_option("--direction", question.direction, "turns to the right [degrees]")
      ->capture_default_str();
  command->add_option("--height", question.height, "higher by [m]")->capture_default_str();
  command
      ->add_option("--spin", question.spin,
                   "added spin about the level direction of the throw [rad/s]; positive curves "
                   "to the right")
      ->default_str(WhatIfQuestion::kSpin);
  command->add_option("--board", question.board, "boards to the left")->capture_default_str();
  command->add_option("--revs", question.revs, "factors of the spin, before --spin is added")
      ->capture_default_str();
  command
      ->add_option("--rotation", question.rotation,
                   "turns of the spin's axis to the left, seen from above [degrees]")
      ->capture_default_str();
  command
      ->add_option("--success", options->question.success,
                   "skittles down that are a success; by default, as many as the throw felled")
      ->check(whole_number_from(1, 1000));
  command->add_flag("--costs", question.costs,
                    "also the costs of tolerance, noise and covariation of all throws");
  command->add_option("--jobs", question.jobs, "releases at a time; by default, all cores")
      ->check(whole_number_from(1, 1024));
  add_force(*command, options->force);
  add_longest_gap(*command, question.longest_gap);
  add_json(*command, options->json);
  add_condition_options(*command, question.condition);
  command->footer(
      "The hand moves as recorded; the ball leaves it at another moment, or with another speed, "
      "direction, height,\nspin or board. With several boards it tells the room to miss: the boards "
      "that succeed. The release as it was has the bits of the recorded throw.\n\n"
      "Example:\n  headpin whatif assets/trials/demo.lcmlog -o whatif\n"
      "  headpin whatif session.lcmlog --throw 3 --costs --success 10\n"
      "  headpin whatif hook.lcmlog -o room --board -4:4:17 --direction -3:3:25 --speed 1 --height 0 "
      "--spin 0 \\\n    --success 10");
  command->callback([options] { what_if(*options); });
}

}  // namespace headpin::apps
