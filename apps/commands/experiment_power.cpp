#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/plot_file.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "base/output_file.h"
#include "base/threads.h"
#include "study/csv.h"
#include "study/design_checks.h"
#include "study/power.h"
#include "study/power_plot.h"

namespace headpin::apps {

namespace {

struct PowerOptions {
  std::string design = "uno-slater-1997";
  std::vector<int> people = {18, 36, 72, 144};
  int studies = 1000, jobs = 1;
  std::uint64_t seed = 1;
  std::optional<std::string> output;
  bool force = false, json = false;
};

/// The power for each number of people; several are computed in parallel.
std::vector<study::Power> powers(const PowerOptions& options, const study::Design& design,
                                 const study::Questionnaire& questions) {
  std::vector<study::Power> all(options.people.size());
  std::atomic<std::size_t> next = options.people.size();  // the largest first
  std::mutex mutex;
  std::exception_ptr failure;
  base::in_threads(options.jobs, [&] {
    for (std::size_t at = next--; at >= 1 && at <= all.size(); at = next--) {
      try {
        all[at - 1] = study::power_of(design, questions, options.people[at - 1], options.studies,
                                      options.seed, [] { check_stop(); });
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    }
  });
  if (failure) std::rethrow_exception(failure);
  return all;
}

std::string power_csv(const std::vector<study::Power>& all, std::uint64_t seed) {
  std::string text = study::csv_line(
      {"people", "term", "found", "found_without", "separated", "studies", "seed", "virtual"});
  for (const study::Power& power : all) {
    for (const study::TermPower& term : power.terms) {
      text += study::csv_line(
          {fmt::format("{}", power.people), term.term, fmt::format("{:.4f}", term.found),
           fmt::format("{:.4f}", term.found_without), fmt::format("{:.4f}", power.separated),
           fmt::format("{}", power.studies), fmt::format("{}", seed), "yes"});
    }
  }
  return text;
}

void print_power(const std::vector<study::Power>& all) {
  fmt::print(
      "share of {} simulated studies that find each term at the 5 % level; in brackets: if the "
      "term has no effect\n{:<16}",
      all[0].studies, "people");
  for (const study::Power& power : all) fmt::print("{:>16}", power.people);
  fmt::print("\n");
  for (std::size_t i = 0; i < all[0].terms.size(); ++i) {
    fmt::print("{:<16}", all[0].terms[i].term);
    for (const study::Power& power : all) {
      fmt::print("{:>16}", fmt::format("{:.3f} ({:.3f})", power.terms[i].found,
                                       power.terms[i].found_without));
    }
    fmt::print("\n");
  }
  fmt::print("{:<16}", "separated");
  for (const study::Power& power : all) fmt::print("{:>16.3f}", power.separated);
  fmt::print("\n");
}

void tell_power(PowerOptions options) {
  std::ranges::sort(options.people);
  if (options.output) require_plot_library(*options.output);
  watch_stop_signals();
  const auto source = bundled("designs", options.design);
  const study::Design design = study::parse_design(read_study_file(source), source.string());
  const auto asked = questionnaire_of(design, source);
  const study::Questionnaire questions =
      study::parse_questionnaire(read_study_file(asked), asked.string());
  study::check_items(design, questions, source.string());
  std::vector<study::Power> all;
  try {
    all = powers(options, design, questions);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  if (options.output) {
    const std::string text = is_plot(*options.output)
                                 ? plot_file(study::power_svg(all), *options.output)
                                 : power_csv(all, options.seed);
    base::OutputFile file(*options.output, {.overwrite = options.force, .standard_output = true});
    file.write(text.data(), text.size());
    check_stop();
    file.commit();
  }
  if (options.json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const study::Power& power : all) {
      nlohmann::ordered_json terms = nlohmann::ordered_json::array();
      for (const study::TermPower& term : power.terms) {
        terms.push_back(
            {{"term", term.term}, {"found", term.found}, {"found_without", term.found_without}});
      }
      rows.push_back({{"people", power.people}, {"separated", power.separated}, {"terms", terms}});
    }
    return print_json({{"studies", options.studies}, {"seed", options.seed}, {"power", rows}});
  }
  print_power(all);
}

}  // namespace

void add_experiment_power(CLI::App& group) {
  CLI::App* command = group.add_subcommand(
      "power", "Simulate studies: how often would they find the effects of the published model?");
  const auto options = std::make_shared<PowerOptions>();
  command->add_option("--design", options->design, "a bundled design or a TOML file")
      ->capture_default_str();
  command
      ->add_option("--people", options->people,
                   "number of people in a study; several numbers separated by commas")
      ->delimiter(',')
      ->check(whole_number_from(2, 10000))
      ->capture_default_str();
  command
      ->add_option("--studies", options->studies,
                   "number of simulated studies for each number of people")
      ->check(whole_number_from(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of allotment and answers")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--jobs", options->jobs, "numbers of people to simulate in parallel")
      ->check(whole_number_from(1, 64))
      ->capture_default_str();
  add_output(*command, "-o,--output", options->output,
             "table (.csv) or plot (.svg, .png, .pdf) to write; - is standard output, a table",
             {".csv", ".svg", ".png", ".pdf"});
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "People are allotted as by `plan`, and their answers are drawn from the published model. A "
      "term is found\nif the deviance grows by more than 3.84 without it (95 % quantile of "
      "chi-squared). If a term has no\neffect, 5 % of studies would find it by chance; a larger "
      "share shows that the test needs more people.\n\n"
      "Example:\n  headpin experiment power --people 18,72 --studies 200 -o power.csv");
  command->callback([options] { tell_power(*options); });
}

}  // namespace headpin::apps
