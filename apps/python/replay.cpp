#include "apps/python/replay.h"

#include <filesystem>

#include <pybind11/stl/filesystem.h>

#include "apps/output_name.h"
#include "apps/python/errors.h"
#include "apps/python/module.h"
#include "apps/python/table.h"
#include "apps/python/values.h"
#include "base/lock.h"
#include "base/output_file.h"
#include "scene/record/log.h"
#include "scene/watch/counterparts.h"
#include "scene/watch/notes.h"
#include "scene/watch/totals.h"
#include "scene/watch/trial_writer.h"

namespace headpin::python {

namespace {

/// Keeps all events.
struct Events : scene::Observer {
  void tick(const scene::Session& session) override {
    all.insert(all.end(), session.events.begin(), session.events.end());
  }
  std::vector<scene::Event> all;
};

/// Puts the state of every tick into a table.
class States : public scene::Observer {
 public:
  explicit States(scene::TableRows& rows) : rows_(rows) {}
  void tick(const scene::Session& session) override {
    scene::tick_state(session, state_);
    rows_.add(state_);
  }

 private:
  scene::TableRows& rows_;
  scene::TickState state_;
};

/// What goes wrong while a file is written is an OSError.
template <typename Work>
void writing(const Work& work) {
  try {
    work();
  } catch (const std::runtime_error& error) {
    throw NotWritten(error.what());
  }
}

class Writing : public scene::Observer {
 public:
  Writing(const scene::TrialSummary& trial, scene::TrialWriter& writer)
      : notes_(trial, writer), writer_(writer) {}
  void start(const scene::Session& session) override {
    writing([&] { notes_.start(session); });
  }
  void tick(const scene::Session& session) override {
    writing([&] {
      notes_.tick(session);
      writer_.tick(session);
    });
  }
  void close(const scene::Session& session) {
    writing([&] {
      notes_.finish(session);
      writer_.close(session);
    });
  }

 private:
  scene::Notes notes_;
  scene::TrialWriter& writer_;
};

/// The value of that name, made when it is first asked for.
template <typename Make>
py::object once(Replay& replay, const char* name, const Make& make) {
  if (const auto found = replay.made.find(name); found != replay.made.end()) return found->second;
  py::object made = make();
  return replay.made.try_emplace(name, std::move(made)).first->second;
}

template <typename Row>
py::array table_of(const char* name, const scene::TrialHeader& header,
                   const std::vector<Row>& rows) {
  auto table = std::make_unique<Table>(name);
  scene::TableRows maker(name, header, [&](auto row) { table->add(row); });
  for (const Row& row : rows) maker.add(row);
  return Table::view(std::move(table));
}

py::array states_of(const Replay& replay) {
  auto table = std::make_unique<Table>("states");
  {
    const py::gil_scoped_release released;
    const auto lock = replay.trial->lock();
    Run run(*replay.trial, replay.scenario, replay.own.get());
    table->reserve(run.ticks * static_cast<std::int64_t>(replay.header.body_names.size()));
    scene::TableRows rows("states", replay.header, [&](auto row) { table->add(row); });
    States states(rows);
    scene::Observer* const seen_by[] = {&states};
    run.go(seen_by);
  }
  return Table::view(std::move(table));
}

py::object summary_of(const Replay& replay) {
  nlohmann::json all = replay.result;
  {
    const py::gil_scoped_release released;
    const auto lock = replay.trial->lock();
    Interrupts interrupts;
    all.update(scene::whose(replay.trial->path(), replay.trial->summary(), replay.condition.set));
    const bool same =
        !replay.own && scene::differences(replay.trial->scenario(), replay.scenario).empty();
    all.update(scene::compared_throws(replay.trial->file(), replay.trial->scenario(), same,
                                      replay.events, [&] { interrupts.check(); }));
  }
  return to_python(all);
}

py::dict score_of(const Replay& replay) {
  py::dict score;
  for (const char* key : {"skittles", "skittles_down", "felled_by_hand", "games", "throws"}) {
    score[key] = to_python(replay.result.at(key));
  }
  return score;
}

scene::TrialWriter open_writer(const Replay& replay, const std::string& path,
                               const scene::Session& session, bool overwrite, bool changes) {
  try {
    base::OutputFile file(
        path,
        {.overwrite = overwrite, .standard_output = true, .inputs = {replay.trial->file_path()}});
    return scene::TrialWriter(std::make_unique<scene::Recorder>(
        std::move(file), scene::header_of(replay.trial->summary().header, session),
        scene::Recorder::Options{.states = changes ? scene::States::changes : scene::States::all}));
  } catch (const base::Exists& error) {
    throw FileIsThere(std::string(error.what()) + "; overwrite=True replaces it");
  } catch (const std::runtime_error& error) {
    throw NotWritten(error.what());
  }
}

void save(const Replay& replay, const std::filesystem::path& path, bool overwrite,
          const std::string& states) {
  if (replay.own) {
    throw std::invalid_argument(
        "save: nobody could replay the trial of a response of one's own; expected a response by its "
        "name");
  }
  if (const std::string wrong = apps::wrong_output(path.string(), {".lcmlog"}); !wrong.empty()) {
    throw std::invalid_argument("path: " + wrong);
  }
  if (states != "changes" && states != "all") {
    throw std::invalid_argument("states: expected changes or all, found " + states);
  }
  const py::gil_scoped_release released;
  const auto lock = replay.trial->lock();
  Run run(*replay.trial, replay.scenario, nullptr);
  scene::TrialWriter writer =
      open_writer(replay, path.string(), run.session, overwrite, states == "changes");
  Writing observer(replay.trial->summary(), writer);
  scene::Observer* const seen_by[] = {&observer};
  run.go(seen_by);
  observer.close(run.session);
}

}  // namespace

std::unique_ptr<Replay> replay(const std::shared_ptr<OpenTrial>& trial,
                               const scene::Condition& condition,
                               std::shared_ptr<const engine::Response> own) {
  const py::gil_scoped_release released;
  const auto lock = trial->lock();
  scene::Scenario scenario = trial->scenario();
  scene::apply(condition, scenario);
  Run run(*trial, scenario, own.get());
  scene::Totals totals;
  Events events;
  scene::Observer* const seen_by[] = {&totals, &events};
  run.go(seen_by);
  auto done = std::make_unique<Replay>();
  done->trial = trial;
  done->condition = condition;
  done->scenario = std::move(scenario);
  done->own = std::move(own);
  const scene::Score score = totals.score_at_end(run.session);
  done->result = scene::summary(run.session, score);
  if (const std::string why = totals.why_nothing_fell(); !why.empty()) {
    done->result["why_nothing_fell"] = why;
  }
  done->header = scene::header_of(trial->summary().header, run.session);
  done->events = std::move(events.all);
  if (auto path = scene::last_ball_path(run.session)) done->events.push_back(std::move(*path));
  done->throws = score.throws;
  return done;
}

void add_replay(py::module_& module) {
  py::class_<Replay> replay(module, "Replay",
                            "A trial that was simulated again, made by Trial.replay().");
  replay.attr("__module__") = "headpin";
  replay
      .def_property_readonly(
          "state_hash", [](const Replay& r) { return to_python(r.result.at("state_hash")); },
          "Hash of the last state, 16 hexadecimal digits (docs/hash-and-ledger.md). None with a "
          "response of\none's own.")
      .def_property_readonly(
          "game_hash", [](const Replay& r) { return to_python(r.result.at("game_hash")); },
          "Hash of all ticks: two replays with the same one had bit-identical games. None with a "
          "response\nof one's own.")
      .def_property_readonly(
          "summary", [](Replay& r) { return once(r, "summary", [&] { return summary_of(r); }); },
          "The result as a dict, with the keys of `headpin replay --json` except realtime_factor "
          "and "
          "output.")
      .def_property_readonly(
          "score", [](Replay& r) { return once(r, "score", [&] { return score_of(r); }); },
          "dict of skittles, skittles_down, felled_by_hand, games (score sheets) and throws.")
      .def_property_readonly(
          "events",
          [](Replay& r) {
            return once(r, "events", [&] { return table_of("events", r.header, r.events); });
          },
          "Structured array with the columns of events.csv, read-only.")
      .def_property_readonly(
          "throws",
          [](Replay& r) {
            return once(r, "throws", [&] { return table_of("throws", r.header, r.throws); });
          },
          "Structured array with the columns of throws.csv, one row per throw, read-only.")
      .def_property_readonly(
          "states", [](Replay& r) { return once(r, "states", [&] { return states_of(r); }); },
          "Structured array with the columns of states.csv, one row per body and tick, "
          "read-only.\n\n"
          "The trial is simulated once more when this is first asked for.")
      .def(
          "save", &save, py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
          py::arg("states") = "changes",
          "Writes the replay as a new trial with its states and events, as `headpin replay -o`.\n\n"
          "The file is complete or absent. states: \"changes\" (smaller) or \"all\".\n"
          "Raises ValueError for a name of another kind of file, such as x.csv; FileExistsError for a file "
          "that is\n"
          "there, unless overwrite is True; and OSError when it cannot be written.")
      .def("__repr__", [](const Replay& r) {
        return "<headpin.Replay of " + r.trial->path() +
               (r.own ? ", response of one's own"
                      : ", game hash " + r.result.at("game_hash").get<std::string>()) +
               ">";
      });
}

}  // namespace headpin::python
