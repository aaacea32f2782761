#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/run_program.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_people.h"
#include "apps/study_tables.h"
#include "base/input_file.h"
#include "base/left_parts.h"
#include "base/output_file.h"
#include "base/shell_word.h"
#include "base/temporary.h"
#include "study/csv.h"
#include "study/paper_tables.h"
#include "study/script.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLargestOutput = 1'000'000'000;  // longest output of R, in bytes

struct AnalyseOptions {
  std::string study;
  Mixing mixing;
  bool json = false;
};

/// The participants of the model: people, virtual or all.
std::string whom(const study::CsvTable& people, const Mixing& mixing) {
  std::size_t counted = 0, virtuals = 0;
  for (const study::CsvRow& row : people.rows) {
    if (people.cell(row, "counts") != "yes") continue;
    ++counted;
    virtuals += people.cell(row, "virtual") == "yes" ? 1 : 0;
  }
  if (counted == 0) {
    throw std::runtime_error(people.where + ": no participant counts; see the column why_not");
  }
  if (!mixing.only.empty()) {
    const bool of_people = mixing.only == "people";
    if ((of_people ? counted - virtuals : virtuals) == 0) {
      throw std::runtime_error(
          fmt::format("{}: nobody counts with --only {}; expected at least one {}", people.where,
                      mixing.only, of_people ? "person" : "virtual participant"));
    }
    return mixing.only;
  }
  if (virtuals > 0 && virtuals < counted && !mixing.mix) {
    throw UsageError(
        fmt::format("{} of {} participants who count are virtual; expected --only "
                    "people, --only virtual, or --mix for all of them together",
                    virtuals, counted));
  }
  return "all";
}

/// Says so if the table has other participants than the plan has by now, or is older than what it is of.
void say_outdated(const Study& study, const study::CsvTable& people) {
  std::set<std::string> in_plan, in_table;
  for (const study::PlannedParticipant& one : study.plan) in_plan.insert(one.id);
  for (const study::CsvRow& row : people.rows) in_table.insert(people.cell(row, "participant"));
  std::vector<std::string> others;
  std::ranges::set_symmetric_difference(in_plan, in_table, std::back_inserter(others));
  if (others.empty()) {
    if (fs::last_write_time(people.where) >= last_change(study)) return;
    say("{}: is older than the newest of plan, questionnaire, sessions and answers; `headpin "
        "experiment score {}` writes it again\n",
        people.where, base::typed_word(study.at.root.string()));
    return;
  }
  say("{}: expected the participants of {}, found others ({} is only in {}); `headpin experiment "
      "score {}` writes it again\n",
      people.where, study.at.plan().string(), study::shown(others[0]),
      in_plan.contains(others[0]) ? "the plan" : "the table",
      base::typed_word(study.at.root.string()));
}

/// Writes the study's script if there is none, or one of another version that nobody edited. A user
/// may edit it later.
/// @return  whether it is another one: edited, or of a version that wrote no hash
bool require_script(const Study& study, const fs::path& path) {
  const std::string script = study::r_script(study.design);
  if (fs::exists(path)) {
    const std::string found = read_study_file(path);
    if (found == script) return false;
    if (!study::is_unedited_script(found)) return true;
    say("{}: nobody edited it, and this version has another script; it is written again\n",
        path.string());
  }
  base::remove_left_parts(study.at.root.string());
  base::write_text({path.string(), {.overwrite = true}}, script);
  return false;
}

/// Why R stopped, on one line: from its last error on.
std::string last_words(const Ended& ended) {
  constexpr std::size_t kMost = 200;
  std::string text;
  std::istringstream words(ended.says);
  for (std::string word; words >> word;) text += (text.empty() ? "" : " ") + word;
  if (text.empty()) return fmt::format("exit code {}", ended.code);
  if (const std::size_t error = text.rfind("Error"); error != std::string::npos)
    text.erase(0, error);
  return text.size() <= kMost ? text : text.substr(0, text.rfind(' ', kMost)) + " ...";
}

/// @param from  says from which table: the text of kMadeFrom
void run_script(const fs::path& script, const fs::path& people, const std::string& who,
                const fs::path& root, const std::string& from) {
  StudyTables folder(root / "analysis");
  // R gets its own folder. The R of a command that was killed may still write into an older one.
  const base::PrivateFolder output;
  const auto ended = run_program(
      {"Rscript", "--vanilla", script.string(), people.string(), output.path().string(), who});
  check_stop();
  if (!ended) {
    throw std::runtime_error(
        fmt::format("Rscript is not installed; type `apt install r-base-core` "
                    "(the tables of `score` are in {})",
                    people.parent_path().string()));
  }
  if (ended->code != 0) {
    throw std::runtime_error(
        fmt::format("{}: R stopped: {}", script.string(), printable(last_words(*ended))));
  }
  for (const std::string& name : study::r_outputs()) {
    if (!fs::exists(output.path() / name)) {
      throw std::runtime_error(fmt::format("{} did not write {}", script.string(), name));
    }
  }
  for (const auto& entry : fs::directory_iterator(output.path())) {  // a changed script may add one
    const std::string name = entry.path().filename().string();
    if (name[0] == '.' || !entry.is_regular_file()) continue;
    folder.write(name, base::read_text(entry.path().string(), kLargestOutput));
  }
  folder.write(kMadeFrom, from);
  folder.commit("fit.csv");
}

/// Prints a table from R, with rounded numbers, without the column that is equal in all rows.
void print_table(const Study& study, const std::string& name, const std::string& title) {
  const fs::path path = study.at.root / "analysis" / (name + ".csv");
  const study::CsvTable table = study::parse_csv(read_study_file(path), path.string());
  study::Table shown{name, title, {}, {}};
  for (const std::string& column : table.columns) {
    if (column != "virtual") shown.columns.push_back({column, "", "", ""});
  }
  for (const study::CsvRow& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      if (table.columns[i] == "virtual") continue;
      const auto number = study::number_in(table, row.cells[i]);
      cells.push_back(number ? fmt::format("{:.4g}", *number) : row.cells[i]);
    }
    shown.rows.push_back(cells);
  }
  fmt::print("\n{}: {}", name, study::in_words(shown));
  print_notes(study, name);
}

/// One number of fit.csv.
double quality(const Study& study, const std::string& quantity) {
  const fs::path path = study.at.root / "analysis" / "fit.csv";
  const study::CsvTable table = study::parse_csv(read_study_file(path), path.string());
  for (const study::CsvRow& row : table.rows) {
    if (table.cell(row, "quantity") != quantity) continue;
    if (const auto number = study::number_in(table, table.cell(row, "value"))) return *number;
  }
  throw std::runtime_error(
      fmt::format("{}: expected a number for {}, found none", path.string(), quantity));
}

/// Terms whose estimate goes to infinity.
std::vector<std::string> endless_terms(const Study& study) {
  const fs::path path = study.at.root / "analysis" / "table-6.csv";
  const study::CsvTable table = study::parse_csv(read_study_file(path), path.string());
  std::vector<std::string> terms;
  for (const study::CsvRow& row : table.rows) {
    if (table.cell(row, "endless") == "yes") terms.push_back(table.cell(row, "term"));
  }
  return terms;
}

void analyse(const AnalyseOptions& options) {
  watch_stop_signals();
  const Study study = open_study(options.study);
  const fs::path people = study.at.root / "tables" / "participants.csv";
  if (!fs::exists(people)) {
    throw std::runtime_error(
        fmt::format("{}: expected the tables, found none; `headpin experiment "
                    "score {}` writes them",
                    people.string(), study.at.root.string()));
  }
  const std::string table = read_study_file(people);
  const study::CsvTable rows = study::parse_csv(table, people.string());
  say_outdated(study, rows);
  const std::string who = whom(rows, options.mixing);
  const fs::path script = study.at.root / "model.R";
  // Not the study's folder, which those who plan lock; and a questionnaire may be a link that studies share.
  const StudyLock lock(people.parent_path(), "analysing this study");
  bool changed = false;
  try {
    changed = require_script(study, script);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  run_script(script, people, who, study.at.root, made_from(table));
  if (options.json) {
    return print_json({{"output", (study.at.root / "analysis").string()},
                       {"script_changed", changed},
                       {"deviance", quality(study, "deviance")},
                       {"degrees_of_freedom", quality(study, "degrees_of_freedom")},
                       {"endless_terms", endless_terms(study)}});
  }
  if (changed) {
    fmt::print(
        "{} is not the script of this version, or was edited; delete it to have this version's\n",
        script.string());
  }
  print_table(study, "table-6", "estimates of the model");
  print_table(study, "table-5", "linear predictors");
  print_table(study, "drop", "increase of the deviance without each term");
  print_table(study, "fit", "how well the model fits");
}

}  // namespace

void add_experiment_analyse(CLI::App& group) {
  CLI::App* command = group.add_subcommand("analyse", "Fit the design's model with glm of R");
  const auto options = std::make_shared<AnalyseOptions>();
  add_study(*command, options->study);
  add_mixing(*command, options->mixing);
  add_json(*command, options->json);
  command->footer(
      "The R script is model.R in the study's folder. You may edit it, and the command runs it as it "
      "is. One of\nanother version that nobody edited is written again. The estimates are in analysis/table-6.csv; for terms with "
      "separation, whose estimates\nare infinite, there are bias-reduced estimates too (R package "
      "brglm2). The same folder has the\npredictors, the fit, the models without one term, "
      "leverages and plots.\n\n"
      "Example:\n  headpin experiment analyse study");
  command->callback([options] { analyse(*options); });
}

}  // namespace headpin::apps
