#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "apps/info_json.h"
#include "apps/python/condition.h"
#include "apps/python/frames.h"
#include "apps/python/module.h"
#include "apps/python/open_trial.h"
#include "apps/python/replay.h"
#include "apps/python/response.h"
#include "apps/python/table.h"
#include "apps/python/values.h"
#include "scene/play/score.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "scene/watch/verifier.h"

namespace headpin::python {

namespace {

/// The tables of a trial as Python names them, and as the files of `headpin export` are called.
constexpr std::pair<const char*, const char*> kTables[] = {
    {"samples", "trackers"}, {"buttons", "buttons"}, {"events", "events"},
    {"throws", "throws"},    {"states", "states"},   {"frames_table", "frames"}};

struct Trial {
  std::shared_ptr<OpenTrial> open;
  std::map<std::string, py::array> tables;  ///< those that were asked for
};

/// Says what of a trial is not read, as the commands do.
void warn(const OpenTrial& trial) {
  const std::string missing = scene::what_is_missing(trial.summary());
  if (missing.empty()) return;
  const std::string words = trial.path() + ": " + missing;
  if (PyErr_WarnEx(PyExc_UserWarning, words.c_str(), 1) != 0) throw py::error_already_set();
}

Trial open(const std::filesystem::path& path, double longest_gap) {
  if (!(longest_gap >= 0.001 && longest_gap <= 1e6)) {  // as --longest-gap
    throw std::invalid_argument(
        fmt::format("longest_gap: expected 0.001 to 1000000 s, found {}", longest_gap));
  }
  Trial trial;
  {
    const py::gil_scoped_release released;
    trial.open = std::make_shared<OpenTrial>(path.string(), microseconds(longest_gap));
  }
  warn(*trial.open);
  return trial;
}

std::int64_t rows_of(const std::string& csv, const scene::TrialSummary& trial) {
  if (csv == "states") return trial.state_count * static_cast<std::int64_t>(trial.bodies);
  if (csv == "frames") return 2 * trial.frame_count;
  return csv == "trackers" ? trial.sample_count : 0;
}

/// Reads a table; the GIL must be released.
std::unique_ptr<Table> read(OpenTrial& trial, const std::string& csv) {
  const auto lock = trial.lock();
  auto table = std::make_unique<Table>(csv);
  table->reserve(rows_of(csv, trial.summary()));
  scene::TableRows::Walk walk;
  if (csv == "trackers") walk = scene::walk_in_time(trial.file(), trial.path());
  scene::TableRows rows(
      csv, trial.summary().header, [&](auto row) { table->add(row); }, std::move(walk));
  if (csv == "events") {
    for (const scene::Event& event : trial.summary().events) rows.add(event);
    return table;
  }
  if (csv == "throws") {
    for (const auto& one : scene::score(trial.summary()).throws) rows.add(one);
    return table;
  }
  Interrupts interrupts;
  trial.file().walk([&](const scene::TrialFile::Item& item) {
    interrupts.check();
    std::visit([&](const auto& one) { rows.add(one); }, item);
    return true;
  });
  return table;
}

py::array table_of(Trial& trial, const std::string& name, const std::string& csv) {
  if (const auto found = trial.tables.find(name); found != trial.tables.end()) return found->second;
  std::unique_ptr<Table> table;
  {
    const py::gil_scoped_release released;
    table = read(*trial.open, csv);
  }
  py::array view = Table::view(std::move(table));
  return trial.tables.try_emplace(name, std::move(view))
      .first->second;  // another thread's, if first
}

py::object to_pandas(Trial& trial, const std::optional<std::string>& wanted) {
  const py::object frame = py::module_::import("pandas").attr("DataFrame");
  py::dict all;
  for (const auto& [name, csv] : kTables) {
    if (wanted == name) return frame(table_of(trial, name, csv));
    if (!wanted) all[name] = frame(table_of(trial, name, csv));
  }
  if (!wanted) return all;
  throw std::invalid_argument("no table '" + *wanted +
                              "'; expected one of samples, buttons, events, throws, states, "
                              "frames_table");
}

/// What a table says about its columns, by the names of table and column.
py::dict words_of_columns(std::string scene::TableColumn::*words) {
  const std::vector<scene::TableColumn> columns = scene::table_columns();
  py::dict all;
  for (const auto& [name, csv] : kTables) {
    py::dict of_table;
    for (const scene::TableColumn& column : columns) {
      if (column.table == csv) of_table[py::str(column.name)] = column.*words;
    }
    all[name] = of_table;
  }
  return all;
}

/// Takes a law of response of the caller's own out of keyword arguments.
std::shared_ptr<const engine::Response> take_own_response(py::kwargs& words) {
  std::optional<std::string> sliding;
  const py::object given = words.attr("pop")("sliding", py::none());
  if (!given.is_none()) sliding = py::str(given);
  const py::object law =
      words.contains("response") ? py::object(words["response"]) : py::object(py::none());
  auto own = own_response(law, sliding);
  if (own) words.attr("pop")("response");
  return own;
}

std::unique_ptr<Replay> replay_of(const Trial& trial, py::kwargs words) {
  std::shared_ptr<const engine::Response> own = take_own_response(words);
  return replay(trial.open, condition_of(words), std::move(own));
}

std::optional<std::string> verify(Trial& trial) {
  const py::gil_scoped_release released;
  const auto lock = trial.open->lock();
  Run run(*trial.open, trial.open->scenario(), nullptr, {.states = true});
  scene::Verifier verifier(trial.open->path(), run.source, run.session);
  scene::Observer* const seen_by[] = {&verifier};
  try {
    run.go(seen_by);
    verifier.finish(trial.open->summary(), run.session);
  } catch (const scene::Differs& difference) {
    return difference.what();
  }
  return std::nullopt;
}

std::string scenario_text(const OpenTrial& trial) {
  const std::string& text = trial.summary().header.scenario;
  try {
    return scene::whole_scenario(text, trial.path());
  } catch (const std::invalid_argument&) {
    return text;
  }
}

std::vector<std::string> warnings_of(const Trial& trial) {
  const std::string words = scene::what_is_missing(trial.open->summary());
  return words.empty() ? std::vector<std::string>{} : std::vector{words};
}

py::object contents_of(const Trial& trial) {
  nlohmann::ordered_json all;
  {
    const py::gil_scoped_release released;
    const auto lock = trial.open->lock();
    all = apps::info_json(trial.open->path(), trial.open->file());
  }
  return to_python(all);
}

void add_header(py::class_<Trial>& trial) {
  trial
      .def_property_readonly(
          "path", [](const Trial& t) { return t.open->path(); }, "The file, as it was named.")
      .def_property_readonly("_file", [](const Trial& t) { return t.open->file_path(); })
      .def_property_readonly(
          "participant",
          [](const Trial& t) { return to_text(t.open->summary().header.participant); },
          "Who took part, as the header of the trial says.")
      .def_property_readonly(
          "condition", [](const Trial& t) { return to_text(t.open->summary().header.condition); },
          "Name of the condition, as the header says.")
      .def_property_readonly(
          "seed", [](const Trial& t) { return t.open->summary().header.seed; },
          "Seed of what was random.")
      .def_property_readonly(
          "version",
          [](const Trial& t) { return to_text(t.open->summary().header.software_version); },
          "Version of headpin that wrote the trial.")
      .def_property_readonly(
          "scenario", [](const Trial& t) { return to_text(scenario_text(*t.open)); },
          "The trial's scenario, whole, as TOML.")
      .def_property_readonly(
          "complete", [](const Trial& t) { return t.open->summary().complete; },
          "False: the end is missing, or something in it cannot be read.")
      .def_property_readonly(
          "warnings", &warnings_of,
          "What is wrong with the trial, in the words of the commands; empty where "
          "all of it is read.")
      .def_property_readonly("summary", &contents_of,
                             "What the trial contains, with the keys of `headpin info --json`.");
}

void add_tables(py::class_<Trial>& trial) {
  const std::map<std::string, std::string> docs = {
      {"samples", "Samples of the trackers, one row each"},
      {"buttons", "Changes of the 3D mouse's buttons, one row each"},
      {"events", "Events, one row each"},
      {"throws", "Throws, one row each"},
      {"states", "Recorded states, one row per body and tick"},
      {"frames_table", "Recorded frames, one row per eye and frame"}};
  for (const auto& [name, csv] : kTables) {
    const std::string doc =
        docs.at(name) + ": structured array, shape (rows,), read-only, with the columns of " + csv +
        ".csv (docs/tables.md).\n\nIt is read when it is first asked for. "
        "It stays valid when the Trial is gone.";
    trial.def_property_readonly(
        name,
        [name = std::string(name), csv = std::string(csv)](Trial& t) {
          return table_of(t, name, csv);
        },
        doc.c_str());
  }
  trial.def("to_pandas", &to_pandas, py::arg("table") = py::none(),
            "A table as pandas.DataFrame (a copy), or a dict of all tables. table: \"samples\", "
            "\"buttons\",\n\"events\", \"throws\", \"states\" or \"frames_table\".");
  trial.attr("units") = words_of_columns(&scene::TableColumn::unit);
  trial.attr("meanings") = words_of_columns(&scene::TableColumn::meaning);
}

}  // namespace

void add_trial(py::module_& module) {
  py::class_<Trial> trial(module, "Trial", R"(A recorded trial (.lcmlog).

Trial.units["states"]["x_m"] is the unit of a column, Trial.meanings the same with its meaning.
Lengths are in metres, times in seconds on the trial's clock, quaternions are w, x, y, z.
Poses are in the world frame: x right, y to the skittles, z up, from the middle of the foul line.)");
  trial.attr("__module__") = "headpin";
  trial.def(
      py::init(&open), py::arg("path"), py::kw_only(),
      py::arg("longest_gap") = seconds(devices::kLongestGap),
      "Opens a trial. An incomplete one gives a UserWarning.\n\n"
      "longest_gap: longest accepted time without samples [s].\n"
      "Raises FileNotFoundError, PermissionError, and headpin.DamagedTrial for a file that is "
      "no trial.");
  add_header(trial);
  add_tables(trial);
  static const std::string replay_words =
      std::string("Simulates the trial again from its samples; returns a Replay.\n\n") +
      kConditionWords +
      "\nresponse may also be a law of one's own, as for headpin.engine.World. Then sliding "
      "(\"paper\" or \"coulomb\")\nsays how sliding continues at lasting contacts; the replay "
      "has no hashes and cannot be saved.";
  trial.def("replay", &replay_of, replay_words.c_str());
  trial.def(
      "verify", &verify,
      "Simulates the trial again and compares every tick with the recorded states, to the bit.\n\n"
      "Returns None if all are equal, else the first difference in words. Raises RuntimeError "
      "when there\nare no states to compare with.");
  trial.def(
      "frames",
      [](const Trial& t, const py::object& numbers, const std::string& eye, bool depth, bool ids,
         std::optional<std::int64_t> fps, std::optional<std::string> look, const std::string& gl) {
        return frames(t.open, numbers, {eye, depth, ids, fps, look, gl});
      },
      py::arg("numbers"), py::kw_only(), py::arg("eye") = "left", py::arg("depth") = false,
      py::arg("ids") = false, py::arg("fps") = py::none(), py::arg("look") = py::none(),
      py::arg("gl") = "", kFramesWords);
  trial.def("__repr__", [](const Trial& t) {
    const scene::TrialSummary& all = t.open->summary();
    return "<headpin.Trial " + t.open->path() + (all.complete ? "" : ", incomplete") + ", " +
           std::to_string(all.sample_count) + " samples, " + std::to_string(all.state_count) +
           " states>";
  });
}

}  // namespace headpin::python
