#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_folder.h"
#include "base/left_parts.h"
#include "base/output_file.h"
#include "base/work_folder.h"
#include "scene/scenario/files.h"
#include "scene/scenario/scenario.h"
#include "scene/scenario/toml_text.h"
#include "scene/stage/read_scenario.h"
#include "study/design_checks.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct PlanOptions {
  std::optional<std::string> output;
  std::string design = "uno-slater-1997";
  std::optional<std::uint64_t> seed;
  std::optional<int> people;
  std::string replace;
  bool design_given = false, json = false;
};

/// Refuses a target of the study that one of these files is already.
void check_not_from(const fs::path& target, const std::vector<fs::path>& sources) {
  for (const fs::path& source : sources) {
    std::error_code unknown;
    if (!fs::equivalent(source, target, unknown)) continue;
    throw std::runtime_error(fmt::format(
        "{}: the study writes a file of this name: give yours another name", target.string()));
  }
}

/// Refuses a target of the study that has other text, before any is written.
void check_target(const fs::path& target, const std::string& text,
                  const std::vector<fs::path>& sources) {
  if (!fs::exists(target) || read_study_file(target) == text) return;
  check_not_from(target, sources);
  throw base::Exists(target.string() + ": exists already");
}

/// Writes a file of a study. An interrupted earlier run may have written it already.
void write_once(const fs::path& path, const std::string& text) {
  if (fs::exists(path) && read_study_file(path) == text) return;
  check_stop();
  base::write_text({path.string(), {}}, text);
}

/// The file of the scenario that a design names.
std::string scenario_named_in(const study::Design& design, const fs::path& design_file) {
  try {
    return scene::scenario_path(path_beside(design_file, design.scenario));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}:{}: scenario: {}", design_file.string(),
                                            design.scenario_line, error.what()));
  }
}

/// Checks that each key of the factors and each level can be set in the scenario.
/// @param called  the scenario, in messages
void check_levels(const study::Design& design, scene::Scenario scenario, const std::string& called,
                  const std::string& where) {
  if (!scenario.version.buttons) {
    throw std::invalid_argument(
        fmt::format("{}:{}: scenario '{}' has no two versions; expected [version] buttons = true",
                    where, design.scenario_line, called));
  }
  for (const study::Factor& factor : design.factors) {
    const std::string place = fmt::format("{}:{}: factor.levels", where, factor.levels_line);
    for (const std::string& level : factor.levels) {
      try {
        scene::set(scenario, study::assignment(factor, "red", level), place);
      } catch (const std::invalid_argument& error) {
        constexpr std::string_view kVersion = "version.red.";  // is not in the design
        std::string what = error.what();
        if (const auto at = what.find(kVersion); at != std::string::npos) {
          what.erase(at, kVersion.size());
        }
        throw std::invalid_argument(what);
      }
    }
  }
}

/// Whether design.toml is a link to a design that the study begins from, and stays one. Once its
/// questions and room are written, or somebody has played or answered, the study has begun.
bool begins_from_link(const StudyFolder& at) {
  return fs::is_symlink(at.design()) && fs::exists(at.design()) && !fs::exists(at.plan()) &&
         !(fs::exists(at.questionnaire()) && fs::exists(at.scenario())) &&
         names_with_data(at).empty();
}

/// The design that a study begins from.
fs::path source_of(const StudyFolder& at, const PlanOptions& options) {
  const bool linked = begins_from_link(at);
  if (linked && !options.design_given) return at.design();
  const fs::path source = bundled("designs", options.design);
  if (linked && !base::same_file(source, at.design())) {
    throw base::Exists(at.design().string() + ": exists already, as a link to another design");
  }
  return source;
}

/// The text of a study's design.toml, with a seed.
std::string with_seed(const std::string& text, const study::Design& design,
                      const PlanOptions& options, const fs::path& source) {
  if (!design.seed) {
    return fmt::format("seed = {}  # of the allotment\n", options.seed.value_or(1)) + text;
  }
  if (options.seed && options.seed != design.seed) {
    throw UsageError(fmt::format("--seed: {} has the seed {}", source.string(), *design.seed));
  }
  return text;
}

/// The files of a new study, before they are written.
struct NewStudy {
  study::Design design;
  std::string design_text, questions, scenario;
  bool linked = false;  ///< design.toml is a link, which stays
};

/// Reads what a new study is made from.
NewStudy new_study(const StudyFolder& at, const PlanOptions& options) {
  const fs::path source = source_of(at, options);
  const std::string text = read_study_file(source);
  NewStudy made;
  made.linked = begins_from_link(at);
  study::Design& design = made.design = study::parse_design(text, source.string());
  const fs::path asked = questionnaire_of(design, source);
  made.questions = read_study_file(asked);
  study::check_items(design, study::parse_questionnaire(made.questions, asked.string()),
                     source.string());
  const std::string played = scenario_named_in(design, source);
  const scene::Scenario scenario = scene::parse_scenario(scene::read_scenario_file(played), played);
  check_levels(design, scenario, design.scenario, source.string());
  made.design_text = with_seed(text, design, options, source);
  if (!design.seed) design.seed = options.seed.value_or(1);
  if (made.linked && *design.seed != 1 && made.design_text != text) {
    throw UsageError(fmt::format(
        "--seed: {} is a link, and no seed is written into the file that it leads to; write it there",
        at.design().string()));
  }
  const std::vector<fs::path> sources = {source, asked, played};
  // A killed plan leaves the first of these, and a study that lost its design has all of them.
  base::require_no_foreign(at.root,
                           {"design.toml", "questionnaire.toml", "scenario.toml", "plan.csv",
                            "sessions/", "answers/", "tables/", "analysis/", "model.R"},
                           sources);
  made.scenario = scene::to_toml(scenario);
  check_target(at.questionnaire(), made.questions, sources);
  check_target(at.scenario(), made.scenario, sources);
  return made;
}

/// Makes the folder of a study with its files. design.toml is the last one; it makes the study
/// complete. A link of that name stays as it is.
void begin_study(const StudyFolder& at, const NewStudy& made) {
  fs::create_directories(at.root);
  base::remove_left_parts(at.root.string());
  write_once(at.questionnaire(), made.questions);
  write_once(at.scenario(), made.scenario);
  if (made.linked) return;
  check_stop();
  base::write_text({at.design().string(), {}}, made.design_text);
}

void refuse_other_design(const Study& study, const PlanOptions& options) {
  const std::string place = study.at.design().string();
  const std::uint64_t seed = study.design.seed.value_or(1);
  if (options.seed.value_or(seed) != seed) {
    throw UsageError(
        fmt::format("--seed: {} has the seed {}, which cannot be changed", place, seed));
  }
  if (!options.design_given) return;
  const fs::path source = bundled("designs", options.design);
  if (study::parse_design(read_study_file(source), source.string()).name != study.design.name) {
    throw UsageError(fmt::format("--design: {} uses the design '{}', which cannot be changed",
                                 place, study.design.name));
  }
}

/// Refuses to make a lost plan again without somebody who has played or answered.
void check_made_again(const Study& study) {
  const std::set<std::string> others = not_in_plan(study);
  if (others.empty()) return;
  throw std::runtime_error(fmt::format(
      "{}: has no participants, and {} has sessions or answers but would not be in a new plan of {}; "
      "expected a copy of the plan that was lost",
      study.at.plan().string(), study::shown(*others.begin()), study.plan.size()));
}

/// Says what of a lost plan the one that was made again cannot have.
void say_made_again(const Study& study) {
  if (names_with_data(study.at).empty()) return;
  say("{}: is made again for the sessions or answers that are there; it does not have what a plan that was lost "
      "had of replacements and changes by hand\n",
      study.at.plan().string());
}

/// Refuses to add participants to a study of which no session can be played: its scenario is not
/// there, cannot be read, or does not have what the design changes.
void check_playable(const Study& study) {
  const std::string path = study.at.scenario().string();
  check_levels(study.design, scene::parse_scenario(scene::read_scenario_file(path), path), path,
               study.at.design().string());
}

/// Adds the participants that the options ask for, in memory.
void extend_plan(Study& study, const PlanOptions& options) {
  const std::size_t before = study.plan.size();
  try {
    // A plan that was lost is made again, with the names that it had.
    const std::set<std::string> taken =
        before > 0 ? names_with_data(study.at) : std::set<std::string>();
    if (!options.replace.empty()) study::replace(study.plan, options.replace, taken);
    const auto there = static_cast<int>(study.plan.size() - study::replaced(study.plan).size());
    const int wanted = before == 0 ? study.design.block() : there;
    study::extend(study.plan, study.design, study.design.seed.value_or(1),
                  options.people.value_or(wanted), taken);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: {}", study.at.plan().string(), error.what()));
  }
  if (before == 0) check_made_again(study);
}

void write_plan(const Study& study) {
  const std::string path = study.at.plan().string();
  const std::string text =
      fs::exists(path)
          ? study::to_csv(study.plan, study.design, study::parse_csv(read_study_file(path), path))
          : study::to_csv(study.plan, study.design);
  check_stop();
  base::write_text({path, {.overwrite = true}}, text);
}

void print_plan(const Study& study, std::size_t before) {
  std::map<std::pair<std::string, std::string>, int> rows;
  const auto replaced = study::replaced(study.plan);
  for (const study::PlannedParticipant& one : study.plan) {
    if (replaced.contains(one.id)) continue;  // the one in their place has the same conditions
    ++rows[{study::changed_key_of(study.design, one), study::cell_of(study.design, one)}];
  }
  fmt::print("{}: {} participants", study.at.plan().string(), study.plan.size());
  if (before > 0) fmt::print(", {} of them new", study.plan.size() - before);
  if (!replaced.empty()) fmt::print(", {} replaced", replaced.size());
  fmt::print("\n{:<6}{:<20}{}\n", study.design.letters(), "changed parameter", "participants");
  for (const auto& [row, count] : rows) fmt::print("{:<6}{:<20}{}\n", row.second, row.first, count);
}

void plan_study(const PlanOptions& options) {
  const StudyFolder at{*options.output};
  const bool new_one = !fs::exists(at.design()) || begins_from_link(at);
  if (new_one && fs::exists(at.plan())) {
    throw std::runtime_error(
        fmt::format("{}: contains plan.csv but no design.toml; expected a new folder or a study",
                    at.root.string()));
  }
  if (new_one) {
    const NewStudy made = new_study(at, options);
    Study planned{at, made.design, {}, {}};
    extend_plan(planned, options);  // what cannot be planned is refused before anything is written
    begin_study(at, made);
  }
  if (options.design_given && !fs::exists(at.plan()) && !fs::is_symlink(at.design())) {
    check_not_from(at.design(), {bundled("designs", options.design)});  // not a study's own
  }
  const StudyLock lock(at.root, "planning this study");
  base::remove_left_parts(at.root.string());
  Study study = open_study(at.root.string(), IfNoPlan::empty);
  refuse_other_design(study, options);
  const std::size_t before = study.plan.size();
  extend_plan(study, options);
  if (!new_one && study.plan.size() != before) check_playable(study);
  if (before == 0) say_made_again(study);
  if (study.plan.size() != before) write_plan(study);
  say_not_in_plan(study);
  if (options.json) {
    return print_json({{"output", at.root.string()},
                       {"participants", study.plan.size()},
                       {"new_participants", study.plan.size() - before},
                       {"seed", study.design.seed.value_or(1)}});
  }
  print_plan(study, before);
}

}  // namespace

void add_experiment_plan(CLI::App& group) {
  CLI::App* command =
      group.add_subcommand("plan", "Create a study, or add participants to its plan");
  const auto options = std::make_shared<PlanOptions>();
  add_output(*command, "-o,--output", options->output, "folder of the study", {})->required();
  CLI::Option* design =
      command
          ->add_option(
              "--design", options->design,
              "a bundled design (uno-slater-1997 or elasticity-friction-shape) or a TOML file")
          ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of the random allotment; default: 1")
      ->check(seed());
  command
      ->add_option("--people", options->people,
                   "total number of participants; default: one block of the design")
      ->check(whole_number_from(1, 100000));
  command->add_option("--replace", options->replace,
                      "add a participant who gets the conditions of this one, who dropped out");
  add_json(*command, options->json);
  command->footer(
      "Participants are allotted to conditions at random within blocks. Each block has every row "
      "of the design\nas often as the design says. Of those with the same changed parameter, half "
      "play the changed version\nfirst, and for half it is behind the red button. A larger "
      "--people adds participants later; those in\nthe plan keep their conditions.\n\n"
      "Example:\n  headpin experiment plan -o study --design uno-slater-1997 --seed 7\n"
      "  headpin experiment plan -o study --people 36");
  command->callback([options, design] {
    options->design_given = design->count() > 0;
    plan_study(*options);
  });
}

}  // namespace headpin::apps
