#include "sweep/folder.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/input_file.h"
#include "base/left_parts.h"
#include "base/output_file.h"
#include "base/sha256.h"
#include "base/shell_word.h"
#include "base/work_folder.h"
#include "scene/scenario/nearest.h"
#include "scene/stage/read_scenario.h"
#include "study/csv.h"
#include "sweep/result.h"

namespace headpin::sweep {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostText = 4'000'000'000;

/// Writes a file, unless an interrupted plan has written it already.
void write_once(const fs::path& path, const std::string& text) {
  if (fs::exists(path) && base::read_text(path.string(), kMostText) == text) return;
  base::write_text({path.string(), {}}, text);
}

std::string rows_csv(const Rows& rows, const std::function<void()>& check) {
  std::string text = study::csv_line(columns_of(rows));
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    check();
    text += study::csv_line(cells_of(rows, rows.at(i)));
  }
  return text;
}

/// Tries a value on each trial.
/// @param place  of its key in the design, for messages
void try_value(const std::string& key, const std::string& value, const Design& design,
               const std::vector<Trial>& trials, const std::string& place) {
  const std::string begin = place + ": ";
  for (std::size_t i = 0; i < trials.size(); ++i) {
    try {
      scene::Scenario scenario = trials[i].scenario;
      scene::Condition condition = condition_of({key}, {value});
      condition.where = place;
      scene::apply(condition, scenario);
    } catch (const std::invalid_argument& error) {
      std::string what = error.what();
      if (what.starts_with(begin)) what.erase(0, begin.size());
      const std::string_view whole = "collision.";  // of `shape`, as the scenario calls it
      if (what.starts_with(fmt::format("{}{} ", whole, key))) what.erase(0, whole.size());
      if (trials.size() > 1) what += fmt::format(", on {}", design.trials[i]);
      throw std::invalid_argument(begin + what);
    }
  }
}

/// Tries each value alone on each trial, so that errors are found before anything is written.
void try_values(const Design& design, const std::vector<Trial>& trials, const std::string& where) {
  const std::vector<std::string> keys = keys_of_conditions();
  const auto place_of = [&](const std::string& key, int line) {
    const std::string place = fmt::format("{}:{}", where, line);
    if (std::ranges::find(keys, key) != keys.end()) return place;
    throw std::invalid_argument(fmt::format("{}: {}", place, scene::unknown_key(key, keys)));
  };
  for (const Axis& axis : design.grid) {
    const std::string place = place_of(axis.key, axis.line);
    for (const std::string& value : axis.values) try_value(axis.key, value, design, trials, place);
  }
  for (const Range& range : design.drawn) {
    const std::string place = place_of(range.key, range.line);
    // Bounds may be whole numbers, and what is drawn between them is not.
    constexpr double kBetween = 0.123456789;
    for (const double part : {0.0, 1.0, kBetween}) {
      const double value = range.from + part * (range.to - range.from);
      try_value(range.key, fmt::format("{}", value), design, trials, place);
    }
  }
}

/// Whether a row of a trial has the paper's detection, by the design's keys or its own.
bool has_paper_rows(const Design& design, scene::Scenario scenario) {
  std::vector<std::string> keys, values;
  for (const Axis& axis : design.grid) {
    if (axis.key != "detection" && !axis.key.ends_with(".detection")) continue;
    const bool paper = std::ranges::find(axis.values, "paper") != axis.values.end();
    keys.push_back(axis.key);
    values.push_back(paper ? "paper" : axis.values.front());
  }
  scene::apply(condition_of(keys, values), scenario);
  return scene::has_paper_detection(scenario);
}

/// Refuses the option `iterations` where it changes nothing, as replay does.
void require_paper_rows(const Design& design, const std::vector<Trial>& trials,
                        const std::string& where) {
  const auto axis = std::ranges::find(design.grid, "iterations", &Axis::key);
  const auto has_some = [&](const Trial& trial) { return has_paper_rows(design, trial.scenario); };
  if (axis == design.grid.end() || std::ranges::any_of(trials, has_some)) return;
  throw std::invalid_argument(fmt::format(
      "{}:{}: iterations: expected detection = ['paper'] beside it; converged detection "
      "has no cap",
      where, axis->line));
}

/// Whether every row has a red and a blue version, by the design's key or the trials' own.
bool all_have_versions(const Design& design, const std::vector<Trial>& trials) {
  const auto axis = std::ranges::find(design.grid, "version.buttons", &Axis::key);
  if (axis != design.grid.end()) {
    return std::ranges::all_of(axis->values, [](const auto& value) { return value == "true"; });
  }
  return std::ranges::all_of(trials,
                             [](const Trial& trial) { return trial.scenario.version.buttons; });
}

void require_different_names(const Design& design, const std::string& where) {
  std::set<std::string> names;
  for (const std::string& trial : design.trials) {
    const std::string name = fs::path(trial).stem().string();
    if (names.insert(name).second) continue;
    throw std::invalid_argument(
        fmt::format("{}: expected trials of different names, found '{}' twice", where, name));
  }
}

/// Two copies of a trial would count twice in all means, and their rows have the same key.
void require_different_trials(const Design& design, const std::vector<Trial>& trials,
                              const std::string& where) {
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto same = std::ranges::find(trials, trials[i].sha256, &Trial::sha256);
    const auto first = static_cast<std::size_t>(same - trials.begin());
    if (first == i) continue;
    throw std::invalid_argument(
        fmt::format("{}: expected different trials, found {} and its copy {}", where,
                    design.trials[first], design.trials[i]));
  }
}

/// The trial's file in the sweep's folder.
fs::path own(const SweepFolder& at, const std::string& trial) {
  return at.trials() / fs::path(trial).filename();
}

std::vector<std::string> hashes_of(const std::vector<Trial>& trials) {
  std::vector<std::string> hashes;
  for (const Trial& trial : trials) hashes.push_back(trial.sha256);
  return hashes;
}

/// The first line of a text.
std::string_view without_line_end(std::string_view text) {
  return text.substr(0, text.find('\n'));
}

/// Whether a byte of UTF-8 goes on with the character of the byte before it.
bool is_inside_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;
}

/// Refuses a line of rows.csv that is another one, by the cells from the first other one on; of a long cell, from
/// a little before the first other letter on.
/// @param rest  of the text, from the line on
[[noreturn]] void refuse_line(const std::string& path, std::int64_t line, std::string_view expected,
                              std::string_view rest) {
  const std::string place = fmt::format("{}:{}", path, line);
  const std::string_view wanted = without_line_end(expected), found = without_line_end(rest);
  constexpr std::size_t kBefore = 20;  // fewer than are shown
  if (found.ends_with('\r') && found.substr(0, found.size() - 1) == wanted) {
    throw std::runtime_error(fmt::format(
        "{}: expected a line that ends with a line feed, found one that ends with a carriage return "
        "and a line feed; `sed -i 's/\\r$//' {}` changes all of them back",
        place, base::typed_word(path)));
  }
  if (rest == wanted) {
    throw std::runtime_error(place + ": expected a line feed at its end, found none");
  }
  const auto same =
      static_cast<std::size_t>(std::ranges::mismatch(wanted, found).in1 - wanted.begin());
  const std::size_t comma = wanted.substr(0, same).rfind(',');
  std::size_t from = comma == std::string_view::npos ? 0 : comma + 1;
  const bool is_late = same - from > kBefore;
  if (is_late) from = same - kBefore;
  while (from < same && is_inside_character(wanted[from])) ++from;
  const auto shown = [&](std::string_view text) {
    return fmt::format("{}{}", is_late ? "..." : "", study::shown(text.substr(from)));
  };
  throw std::runtime_error(fmt::format(
      "{}: expected '{}', as sweep.toml and the trials say, found '{}'; plan a new sweep to have "
      "other rows",
      place, shown(wanted), shown(found)));
}

/// Compares rows.csv with the rows, line by line.
/// @return  its SHA-256
std::string require_rows(const fs::path& path, const Rows& rows) {
  const std::string text = base::read_text(path.string(), kMostText);
  std::size_t at = 0;
  const auto require = [&](std::int64_t line, const std::string& expected) {
    const std::string_view rest = std::string_view(text).substr(at);
    at += expected.size();
    if (!rest.starts_with(expected)) refuse_line(path.string(), line, expected, rest);
  };
  require(1, study::csv_line(columns_of(rows)));
  for (std::int64_t i = 0; i < rows.size(); ++i) {
    require(i + 2, study::csv_line(cells_of(rows, rows.at(i))));
  }
  if (at != text.size()) {
    throw std::runtime_error(fmt::format("{}:{}: expected {} rows, found more", path.string(),
                                         rows.size() + 2, rows.size()));
  }
  return base::sha256(text);
}

}  // namespace

fs::path SweepFolder::piece(const Piece& piece) const {
  return pieces() / fmt::format("{:06}.csv", piece.number);
}

std::int64_t plan(const fs::path& file, const SweepFolder& at, const std::function<void()>& check) {
  if (fs::exists(at.rows())) {
    throw std::runtime_error(at.root.string() +
                             ": a sweep is there already; expected a new folder");
  }
  const std::string text = base::read_text(file.string(), 16'000'000);
  const Design design = parse_design(text, file.string());
  require_different_names(design, file.string());
  std::vector<fs::path> given{file};
  for (const std::string& trial : design.trials) given.push_back(file.parent_path() / trial);
  base::require_no_foreign(at.root, {"sweep.toml", "rows.csv", "trials/", "pieces/"}, given);
  std::vector<Trial> trials;
  for (const std::string& trial : design.trials) {
    trials.push_back(read_trial((file.parent_path() / trial).string()));
    check();
  }
  require_different_trials(design, trials, file.string());
  try_values(design, trials, file.string());
  require_effects(design, all_have_versions(design, trials), file.string());
  require_paper_rows(design, trials, file.string());
  const Rows rows(design, hashes_of(trials));
  const std::string table = rows_csv(rows, check);
  fs::create_directories(at.trials());
  base::remove_left_parts(at.root.string());
  base::remove_left_parts(at.trials().string());
  for (const std::string& trial : design.trials) {
    write_once(own(at, trial), base::read_text((file.parent_path() / trial).string(), kMostText));
  }
  write_once(at.design(), text);
  fs::create_directories(at.pieces());
  base::write_text({at.rows().string(), {}}, table);
  return rows.size();
}

Sweep open_sweep(const fs::path& root) {
  const SweepFolder at{root};
  if (!fs::exists(at.rows())) {
    throw std::runtime_error(root.string() + ": expected a sweep, found no rows.csv");
  }
  const std::string design_text = base::read_text(at.design().string(), 16'000'000);
  const Design design = parse_design(design_text, at.design().string(), DesignOf::planned_sweep);
  std::vector<Trial> trials;
  for (const std::string& trial : design.trials) {
    trials.push_back(read_trial(own(at, trial).string()));
  }
  Rows rows(design, hashes_of(trials));
  const std::string plan = require_rows(at.rows(), rows);
  std::vector<std::string> columns = columns_of(rows);
  for (const ResultColumn& column : result_columns()) columns.emplace_back(column.name);
  const Pieces pieces(rows.size());
  return {at, std::move(rows), std::move(trials), plan, study::csv_line(columns), pieces};
}

std::optional<PieceEnd> piece_of(const Sweep& sweep, const Piece& piece,
                                 std::vector<std::string>* lines) {
  const fs::path path = sweep.at.piece(piece);
  if (!fs::exists(path)) return std::nullopt;
  const std::string text = base::read_text(path.string(), kMostText);
  return read_piece(text, path.string(), sweep.plan, piece, sweep.columns, lines);
}

PieceClaim::PieceClaim(const Sweep& sweep, const Piece& piece)
    : descriptor_(
          open((sweep.at.pieces() / ".claims").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) return;  // writing the piece will report the error of the folder
  struct flock byte {};
  byte.l_type = F_WRLCK;
  byte.l_whence = SEEK_SET;
  byte.l_start = piece.number;
  byte.l_len = 1;
  ours_ = fcntl(descriptor_, F_OFD_SETLK, &byte) == 0 || (errno != EAGAIN && errno != EACCES);
}

PieceClaim::~PieceClaim() {
  if (descriptor_ >= 0) close(descriptor_);
}

void run_piece(const Sweep& sweep, const Piece& piece, Runner& runner,
               const std::function<void()>& check, const std::function<void()>& done) {
  std::vector<std::string> lines;
  const std::optional<PieceEnd> before = piece_of(sweep, piece, &lines);
  std::int64_t failed = before ? before->failed : 0;
  const auto had = std::ssize(lines);
  std::exception_ptr stopped;
  while (std::ssize(lines) < piece.rows && !stopped) {
    try {
      const std::vector<std::string> cells =
          runner.run(sweep.rows.at(piece.first + std::ssize(lines)), check);
      failed += cells.back().empty() ? 0 : 1;
      lines.push_back(study::csv_line(cells));
      done();
    } catch (...) {
      stopped = std::current_exception();
    }
  }
  if (std::ssize(lines) > had) {
    const std::string text = piece_text(sweep.plan, piece, sweep.columns, lines, failed);
    base::write_text({sweep.at.piece(piece).string(), {.overwrite = true}}, text);
  }
  if (stopped) std::rethrow_exception(stopped);
}

}  // namespace headpin::sweep
