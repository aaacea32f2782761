#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/options.h"
#include "apps/progress.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/sweep.h"
#include "base/output_file.h"
#include "study/csv.h"
#include "sweep/report.h"

namespace headpin::apps {

namespace {

struct ReportSweepOptions {
  std::string sweep, x, y;
  std::vector<std::string> at;  ///< KEY=VALUE
  std::optional<std::string> output;
  bool force = false, json = false;
};

using Grid = std::vector<sweep::Axis>;

/// The axis with that key.
std::size_t axis_named(const Grid& grid, const char* option, const std::string& name) {
  const auto found = std::ranges::find(grid, name, &sweep::Axis::key);
  if (found != grid.end()) return static_cast<std::size_t>(found - grid.begin());
  std::vector<std::string> keys;
  for (const sweep::Axis& axis : grid) keys.push_back(axis.key);
  throw UsageError(fmt::format("{}: expected a key of the grid: {}; found '{}'", option,
                               fmt::join(keys, ", "), study::shown(name)));
}

/// The axis of that name, or else the first one that has more than one value and is not `other`.
std::size_t axis_of(const Grid& grid, const char* option, const std::string& name,
                    std::optional<std::size_t> other) {
  if (!name.empty()) return axis_named(grid, option, name);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid[i].values.size() > 1 && i != other) return i;
  }
  return other.value_or(0);
}

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Which value of an axis a text is, also with other digits of the same number.
std::size_t value_of(const sweep::Axis& axis, const std::string& text) {
  auto found = std::ranges::find(axis.values, text);
  if (const std::optional<double> number = number_in(text); number && found == axis.values.end()) {
    found = std::ranges::find_if(
        axis.values, [&](const std::string& value) { return number_in(value) == number; });
  }
  if (found != axis.values.end()) return static_cast<std::size_t>(found - axis.values.begin());
  constexpr std::size_t kNamed = 8;
  const auto end =
      axis.values.begin() + static_cast<std::ptrdiff_t>(std::min(kNamed, axis.values.size()));
  throw UsageError(fmt::format("--at: {}: expected a value of the grid: {}{}; found '{}'", axis.key,
                               fmt::join(axis.values.begin(), end, ", "),
                               axis.values.size() > kNamed ? ", ..." : "", study::shown(text)));
}

sweep::Chosen chosen_of(const Grid& grid, const std::vector<std::string>& at) {
  sweep::Chosen chosen(grid.size());
  for (const std::string& one : at) {
    const std::size_t equals = one.find('=');
    if (equals == std::string::npos) {
      throw UsageError(fmt::format("--at: expected KEY=VALUE, found '{}'", study::shown(one)));
    }
    const std::size_t axis = axis_named(grid, "--at", one.substr(0, equals));
    if (chosen[axis]) {
      throw UsageError(fmt::format("--at: expected one value of {}, found two", grid[axis].key));
    }
    chosen[axis] = value_of(grid[axis], one.substr(equals + 1));
  }
  return chosen;
}

/// Refuses a page that no browser would open, before gigabytes are taken to make it.
void require_few_points(const Grid& grid) {
  const std::int64_t points = sweep::point_count(grid);
  if (points <= sweep::kMostPoints) return;
  throw std::runtime_error(fmt::format(
      "expected at most {} points on a page, found {}: take one value of a key by --at KEY=VALUE, "
      "or write all rows as a table by `headpin sweep merge`",
      sweep::kMostPoints, points));
}

/// Adds all rows that are there.
void add_rows(const sweep::Sweep& sweep, sweep::Averages& averages) {
  std::vector<std::string> lines;
  Progress progress("pieces", sweep.pieces.size());
  for (std::int64_t i = 0; i < sweep.pieces.size(); ++i) {
    check_stop();
    progress.show(i);
    const sweep::Piece piece = sweep.pieces.at(i);
    if (!sweep::piece_of(sweep, piece, &lines)) continue;
    std::string text = sweep.columns;
    for (const std::string& line : lines) text += line;
    const study::CsvTable table = study::parse_csv(text, sweep.at.piece(piece).string());
    for (std::size_t j = 0; j < table.rows.size(); ++j) {
      averages.add(piece.first + static_cast<std::int64_t>(j), table.rows[j].cells);
    }
  }
}

/// Why rows failed, as JSON.
nlohmann::ordered_json json_of(const std::vector<sweep::Failure>& failures) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const sweep::Failure& one : failures) {
    all.push_back({{"error", one.reason}, {"failed", one.rows}, {"first_row", one.first + 1}});
  }
  return all;
}

/// Why rows failed, a line for each of the most frequent reasons.
void print_failures(const std::vector<sweep::Failure>& failures) {
  constexpr std::size_t kMost = 5;
  for (std::size_t i = 0; i < std::min(kMost, failures.size()); ++i) {
    const sweep::Failure& one = failures[i];
    fmt::print("{} failed, the first is row {}: {}\n", one.rows, one.first + 1,
               printable(one.reason));
  }
  if (failures.size() > kMost) fmt::print("and for {} more reasons\n", failures.size() - kMost);
}

void report_sweep(const ReportSweepOptions& options) {
  watch_stop_signals();
  const sweep::Sweep sweep = open_planned(options.sweep);
  if (sweep.rows.design().grid.empty()) {
    throw std::runtime_error(sweep.at.design().string() +
                             ": expected a [grid] to draw maps over, found none");
  }
  const sweep::Chosen chosen = chosen_of(sweep.rows.design().grid, options.at);
  const Grid grid = sweep::with_chosen(sweep.rows.design().grid, chosen);
  std::optional<std::size_t> given_y;
  if (!options.y.empty()) given_y = axis_of(grid, "--y", options.y, std::nullopt);
  const std::size_t x = axis_of(grid, "--x", options.x, given_y);
  const std::size_t y = given_y ? *given_y : axis_of(grid, "--y", "", x);
  require_few_points(grid);
  sweep::Averages averages(sweep.rows, chosen);
  add_rows(sweep, averages);
  const std::string html = sweep::html_report(sweep.rows, averages, x, y, options.sweep);
  base::OutputFile file(*options.output, {.overwrite = options.force, .standard_output = true});
  file.write(html.data(), html.size());
  check_stop();
  file.commit();
  const std::vector<sweep::Failure> failures = averages.failures();
  std::int64_t failed = 0;
  for (const sweep::Failure& one : failures) failed += one.rows;
  if (options.json) {
    return print_json({{"output", *options.output},
                       {"planned", averages.planned()},
                       {"done", averages.done()},
                       {"failed", failed},
                       {"failures", json_of(failures)}});
  }
  const std::string &of_x = grid[x].key, &of_y = grid[y].key, with = averages.chosen_in_words();
  fmt::print("{}: {} of {} rows{}, over {}{}\n", *options.output, averages.done(),
             averages.planned(), with.empty() ? "" : fmt::format(" with {}", printable(with)), of_x,
             x == y ? "" : " and " + of_y);
  print_failures(failures);
}

}  // namespace

void add_sweep_report(CLI::App& group) {
  CLI::App* command = group.add_subcommand("report", "Write maps of the results as one HTML page");
  const auto options = std::make_shared<ReportSweepOptions>();
  add_sweep_folder(*command, options->sweep);
  add_output(*command, "-o,--output", options->output, "page to write (.html)", {".html", ".htm"})
      ->required();
  command->add_option(
      "--x", options->x,
      "key of the grid along the map; the first one with several values when not given");
  command->add_option(
      "--y", options->y,
      "key of the grid up the map; the second one with several values when not given");
  command
      ->add_option("--at", options->at,
                   "take only the rows with this value of a key of the grid, KEY=VALUE; may be "
                   "repeated")
      ->allow_extra_args(false);
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "For each result a map, slices and a table, for every combination of the other keys of the "
      "grid. A point is\nthe mean over trials and draws. A click on a point shows the command that "
      "simulates it.\nOf rows that failed, page and command say for each reason how many there are, and "
      "which is the first.\n\n"
      "Example:\n  headpin sweep report sweep -o maps.html --x friction --y elasticity");
  command->callback([options] { report_sweep(*options); });
}

}  // namespace headpin::apps
