#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_people.h"
#include "apps/study_tables.h"
#include "apps/trial_page.h"
#include "base/output_file.h"
#include "study/csv.h"
#include "study/paper_tables.h"
#include "study/report.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct ReportStudyOptions {
  std::string study;
  std::optional<std::string> output, page;
  Mixing mixing;
  int jobs = 1;
  bool pages = false, force = false, json = false;
};

/// The path of the page of the session that counts; nothing if no session counts.
std::optional<fs::path> page_of(const Study& study, const study::Person& person) {
  if (person.played.run.empty()) return std::nullopt;
  return study.at.sessions(person.planned.id) / (person.played.run + ".html");
}

/// Writes the missing pages of sessions.
void write_pages(const Study& study, const std::vector<study::Person>& people,
                 const std::optional<std::string>& page_to_fill) {
  const StudyLock lock(study.at.root, "writing the pages of this study");
  Progress progress("participants", static_cast<std::int64_t>(people.size()));
  for (std::size_t i = 0; i < people.size(); ++i) {
    progress.show(static_cast<std::int64_t>(i));
    const std::optional<fs::path> page = page_of(study, people[i]);
    if (!page || fs::exists(*page)) continue;
    TrialPage one;
    one.trial = fs::path(*page).replace_extension(".lcmlog").string();
    one.output = page->string();
    one.page = page_to_fill;
    write_page(one);
  }
}

/// A table from the analysis; nothing if it does not exist.
std::optional<study::CsvTable> analysed(const Study& study, const std::string& name) {
  const fs::path path = study.at.root / "analysis" / (name + ".csv");
  if (!fs::exists(path)) return std::nullopt;
  return study::parse_csv(read_study_file(path), path.string());
}

/// With rounded numbers.
study::Table shown(const study::CsvTable& csv, const std::string& name, const std::string& title) {
  study::Table table{name, title, {}, {}};
  for (const std::string& column : csv.columns) table.columns.push_back({column, "", "", ""});
  for (const study::CsvRow& row : csv.rows) {
    std::vector<std::string> cells;
    for (const std::string& cell : row.cells) {
      const auto number = study::number_in(csv, cell);
      cells.push_back(number ? fmt::format("{:.4g}", *number) : cell);
    }
    table.rows.push_back(cells);
  }
  return table;
}

/// Why the analysis does not belong to the tables of this page: it is of other participants, or of
/// other data. Empty if it belongs to them. An analysis of an older headpin does not say of which data
/// it is.
///
/// @param table  tables/participants.csv as `score` would write it now
std::string why_left_out(const Study& study, const Counted& counted, const std::string& table) {
  const fs::path from = study.at.root / "analysis" / kMadeFrom;
  const bool known = fs::exists(from);
  if (known && read_study_file(from) != made_from(table)) {
    return "The analysis is of other data than the tables above: plan, sessions or answers have changed since. So "
           "Tables 5 and 6 and their pictures are left out; `headpin experiment score` and then `headpin experiment "
           "analyse` write them anew.";
  }
  const std::optional<study::CsvTable> fit = analysed(study, "fit");
  if (!fit) return "";
  for (const char* column :
       {"quantity", "value", "virtual"}) {  // a changed script may write others
    if (!fit->find(column)) return "";
  }
  for (const study::CsvRow& row : fit->rows) {
    if (fit->cell(row, "quantity") != "participants") continue;
    const std::string number = fit->cell(row, "value"), of = fit->cell(row, "virtual");
    // Of the same table, a changed script may leave out whom it will.
    const bool of_all = known || number == fmt::format("{}", counted.people.size());
    if (of_all && of == counted.of) return "";
    return fmt::format(
        "The analysis is of {} participants (virtual: {}), the tables above are of {} (virtual: {}). So Tables "
        "5 and 6 and their pictures are left out; `headpin experiment analyse` writes them anew.",
        number, of, counted.people.size(), counted.of);
  }
  return "";
}

/// Tables 5 and 6 and the pictures of the analysis.
void add_analysis(const Study& study, study::ReportParts& parts) {
  for (const auto& [name, title] : {std::pair("table-5", "Linear predictors"),
                                    {"table-6", "Parameter estimates and standard errors"},
                                    {"drop", "What the deviance grows by without each term"},
                                    {"fit", "How well the model fits"}}) {
    if (const auto csv = analysed(study, name)) parts.tables.push_back(shown(*csv, name, title));
  }
  for (const char* name : {"effects.svg", "scores.svg"}) {
    const fs::path path = study.at.root / "analysis" / name;
    if (fs::exists(path)) parts.pictures.push_back(read_study_file(path));
  }
}

study::ReportParts parts_of(const Study& study, const std::vector<study::Person>& people,
                            const Counted& counted, const std::string& table,
                            const fs::path& output) {
  study::ReportParts parts;
  parts.tables = study::paper_tables(study.design, study.questions, counted.people, counted.of);
  parts.left_out = why_left_out(study, counted, table);
  if (parts.left_out.empty()) add_analysis(study, parts);
  const fs::path here = fs::absolute(output).parent_path();
  for (const study::Person& person : people) {
    const std::optional<fs::path> page = page_of(study, person);
    if (page && fs::exists(*page)) {
      parts.pages[person.planned.id] = fs::absolute(*page).lexically_relative(here).string();
    }
  }
  return parts;
}

void report_study(const ReportStudyOptions& options) {
  watch_stop_signals();
  const Study study = open_study(options.study);
  std::vector<study::Person> people = people_of(study, options.jobs);
  const std::string table = study::people_csv(study.design, study.questions, people);
  if (!options.mixing.only.empty()) {
    std::erase_if(people, [&](const study::Person& one) {
      return one.is_virtual() != (options.mixing.only == "virtual");
    });
  }
  const Counted counted = counted_of(study, people, options.mixing);
  if (options.pages) write_pages(study, people, options.page);
  const study::ReportParts parts = parts_of(study, people, counted, table, *options.output);
  const std::string html = study::html_report(study.design, study.questions, people, parts);
  base::OutputFile file(*options.output, {.overwrite = options.force, .standard_output = true});
  file.write(html.data(), html.size());
  check_stop();
  file.commit();
  if (options.json) {
    return print_json({{"output", *options.output},
                       {"participants", people.size()},
                       {"counted", counted.people.size()}});
  }
  fmt::print("{}: {} participants, {} count\n", *options.output, people.size(),
             counted.people.size());
  if (!parts.left_out.empty()) {
    fmt::print("{}\n", parts.left_out);
  } else if (!fs::exists(study.at.root / "analysis")) {
    fmt::print("without Tables 5 and 6: `headpin experiment analyse {}` makes them\n",
               study.at.root.string());
  }
}

}  // namespace

void add_experiment_report(CLI::App& group) {
  CLI::App* command = group.add_subcommand("report", "Write the study as one HTML page");
  const auto options = std::make_shared<ReportStudyOptions>();
  add_study(*command, options->study);
  add_output(*command, "-o,--output", options->output, "page to write (.html)", {".html", ".htm"})
      ->required();
  add_mixing(*command, options->mixing);
  command->add_option("--jobs", options->jobs, "number of sessions to process in parallel")
      ->check(whole_number_from(1, 256))
      ->capture_default_str();
  command->add_flag("--pages", options->pages,
                    "write the missing pages of trials, sessions/NAME/RUN.html");
  command->add_option(
      "--page", options->page,
      "page template for --pages; default: the one that is installed with the program");
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "The page shows the design, the tables next to the published ones, plots, answers, and a "
      "small picture of\nevery throw. The picture links to the page of its trial, "
      "sessions/NAME/RUN.html, if that file exists;\n--pages or `headpin report` writes it.\n\n"
      "Example:\n  headpin experiment report study -o study.html --pages");
  command->callback([options] { report_study(*options); });
}

}  // namespace headpin::apps
