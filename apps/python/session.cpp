#include "scene/play/session.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "apps/python/engine.h"
#include "apps/python/in_use.h"
#include "apps/python/interrupts.h"
#include "apps/python/module.h"
#include "apps/python/reading.h"
#include "apps/python/response.h"
#include "apps/python/samples.h"
#include "apps/python/values.h"
#include "devices/base/sources.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/totals.h"

namespace headpin::python {

namespace {

using namespace pybind11::literals;

/// Samples that were pushed, handed out by the rule of a replay.
class PushedSamples : public devices::Source {
 public:
  void push(devices::Sample sample) { waiting_.push_back(std::move(sample)); }

  void poll(Time now, std::vector<devices::Sample>& out) override {
    std::ranges::stable_sort(waiting_, {}, devices::available);
    const auto later = std::ranges::upper_bound(waiting_, now, {}, devices::available);
    std::move(waiting_.begin(), later, std::back_inserter(out));
    waiting_.erase(waiting_.begin(), later);
  }

  bool exhausted() const override { return false; }

 private:
  std::vector<devices::Sample> waiting_;
};

struct PySession {
  std::shared_ptr<const engine::Response>
      own;  ///< a law of the caller's own, which outlives the rest
  scene::Session session;
  PushedSamples source;
  scene::Totals totals;
  std::vector<scene::Event> events;  ///< of the last call of step()
  bool in_use = false;
  bool broken = false;  ///< a tick was not finished

  scene::Session& get() {
    require_free(in_use, "session");
    return session;
  }
};

scene::Scenario load(const std::string& path) {
  return reading<std::runtime_error>(path, [&] { return scene::load_scenario(path); });
}

/// @param given  a path object; or a text: the path of a file, a bundled name, or a scenario
scene::Scenario scenario_of(const py::object& given) {
  if (py::hasattr(given, "__fspath__")) return load(given.cast<std::filesystem::path>().string());
  const std::string name = py::str(given);
  if (name.find_first_of("\n=") == std::string::npos) return load(scene::scenario_path(name));
  std::error_code none;
  const bool is_path = name.find('\n') == std::string::npos && std::filesystem::exists(name, none);
  return is_path ? load(name) : scene::parse_scenario(name, "scenario");
}

std::unique_ptr<PySession> session_of(const py::object& scenario, const py::object& response,
                                      const std::optional<std::string>& sliding) {
  scene::Scenario read = scenario_of(scenario);
  if (py::isinstance<py::str>(response)) {
    scene::set(read, "collision.response='" + response.cast<std::string>() + "'", "response");
  }
  auto made = std::make_unique<PySession>();
  made->own = own_response(response, sliding);
  made->session = scene::make_session(read);
  if (made->own) scene::set_response(made->session, *made->own);
  return made;
}

void push(PySession& s, const py::object& what) {
  std::vector<devices::Sample> samples = samples_of(what);
  s.get();  // only now: while Python reads the samples, another thread may have begun a step
  for (devices::Sample& sample : samples) s.source.push(std::move(sample));
}

void make_ticks(PySession& s, std::int64_t count) {
  if (count < 0) {
    throw std::invalid_argument("count: expected 0 or more, found " + std::to_string(count));
  }
  scene::Session& session = s.get();
  if (s.broken) {
    throw std::runtime_error("session: tick " + std::to_string(session.tick + 1) +
                             " was not finished, so it cannot go on");
  }
  const InUse use(s.in_use);
  const py::gil_scoped_release unlocked;
  s.events.clear();
  Interrupts interrupts;
  for (std::int64_t i = 0; i < count; ++i) {
    interrupts.check();
    s.broken = true;
    scene::advance(session, s.source);
    s.broken = false;
    s.totals.tick(session);
    s.events.insert(s.events.end(), session.events.begin(), session.events.end());
  }
}

struct BodyRow {
  double x_m, y_m, z_m, qw, qx, qy, qz, vx_mps, vy_mps, vz_mps, wx_radps, wy_radps, wz_radps;
  bool asleep;
};

py::array_t<BodyRow> bodies(PySession& s) {
  scene::TickState state;
  scene::tick_state(s.get(), state);
  std::vector<BodyRow> rows;
  for (const scene::BodyState& body : state.bodies) {
    const Vec3 &p = body.X_WB.p, &v = body.V_WB.v, &w = body.V_WB.w;
    const Quat& q = body.X_WB.q;
    rows.push_back({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(),
                    w.y(), w.z(), body.asleep});
  }
  return py::array_t<BodyRow>(static_cast<py::ssize_t>(rows.size()), rows.data());
}

py::list events(PySession& s) {
  s.get();
  py::list all;
  const std::vector<scene::Event> made =
      s.events;  // Python may make a step while it makes the list
  for (const scene::Event& e : made) {
    all.append(py::dict("time_s"_a = nearest_seconds(e.time), "tick"_a = e.tick, "kind"_a = e.kind,
                        "bodies"_a = py::tuple(py::cast(e.bodies)), "x_m"_a = e.p_W.x(),
                        "y_m"_a = e.p_W.y(), "z_m"_a = e.p_W.z(), "impulse_x_ns"_a = e.j_W.x(),
                        "impulse_y_ns"_a = e.j_W.y(), "impulse_z_ns"_a = e.j_W.z(),
                        "value"_a = e.value, "detail"_a = e.detail.text()));
  }
  return all;
}

py::object summary(PySession& s) {
  return to_python(scene::summary(s.get(), s.totals.score_at_end(s.get())));
}

py::dict score(PySession& s) {
  const py::object all = summary(s);
  py::dict of;
  for (const char* key : {"skittles", "skittles_down", "felled_by_hand", "games", "throws"}) {
    of[key] = all[key];
  }
  return of;
}

py::object hash_in_python(PySession& s, std::uint64_t hash) {
  return s.session.hashes ? py::cast(scene::in_hex(hash)) : py::none();
}

void add_what_it_is(py::class_<PySession>& c) {
  c.def_property_readonly(
       "tick", [](PySession& s) { return s.get().tick; }, "Ticks so far.")
      .def_property_readonly(
          "time_s", [](PySession& s) { return nearest_seconds(s.get().now()); },
          "The session's time [s].")
      .def_property_readonly(
          "names", [](PySession& s) { return scene::body_names(*s.get().stage); },
          "Names of the bodies, in the order of `bodies`.")
      .def_property_readonly("bodies", bodies,
                             "Bodies after the last tick: structured array (bodies,) with the "
                             "columns x_m to asleep of "
                             "states.csv (docs/tables.md),\nin the world frame. A copy.")
      .def_property_readonly(
          "events", events,
          "Events of the last call of step(): list of dicts with the columns of events.csv "
          "(docs/tables.md).")
      .def_property_readonly("score", score,
                             "Dict of skittles, skittles_down, felled_by_hand, games (score "
                             "sheets) and throws, so far.")
      .def_property_readonly("summary", summary,
                             "Dict with the keys of `headpin replay --json` (docs/json.md), of the "
                             "session so far.")
      .def_property_readonly(
          "response", [](PySession& s) { return std::string(s.get().world.parameters.response); },
          "Name of the law of response; custom for one's own.")
      .def_property_readonly(
          "state_hash", [](PySession& s) { return hash_in_python(s, s.get().state_hash); },
          "16 hexadecimal digits, of the bodies after the last tick; None with a response of one's "
          "own.")
      .def_property_readonly(
          "game_hash", [](PySession& s) { return hash_in_python(s, s.get().game_hash.value()); },
          "16 hexadecimal digits, of all ticks so far; None with a response of one's own.");
}

}  // namespace

void add_session(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(BodyRow, x_m, y_m, z_m, qw, qx, qy, qz, vx_mps, vy_mps, vz_mps, wx_radps,
                       wy_radps, wz_radps, asleep);
  add_samples(module);
  py::class_<PySession> session(module, "Session",
                                "A session, tick by tick: push samples, step, look.\n\n"
                                "The ticks are those of `headpin replay`: the samples of a trial "
                                "give the hashes of the trial.");
  session
      .def(
          py::init(&session_of), "scenario"_a, py::kw_only(), "response"_a = py::none(),
          "sliding"_a = py::none(),
          "scenario: a path, the name of a bundled scenario, or the text of one (TOML). A text with "
          "= that names a file is its path.\n"
          "response: None, the scenario's; paper, coulomb; or a law of one's own, as for "
          "headpin.engine.World.\nsliding: only with such a law, paper (as without it) or coulomb: "
          "how sliding continues at lasting contacts.")
      .def(
          "push", push, "sample"_a,
          "Hands samples to the session: a TrackerSample, a MouseSample, a list of them, or rows "
          "of "
          "the tables\ntrackers or buttons of a trial.\n\nA sample is used in the first tick at or "
          "after its time. Samples that come late are used in the next tick.")
      .def(
          "step", make_ticks, "count"_a = 1,
          "Makes ticks. Other threads go on meanwhile; Ctrl-C stops between two ticks.\n\nAn error "
          "in a response of one's own is raised from here; the session cannot go on after it.");
  session.attr("__module__") = "headpin";
  add_what_it_is(session);
}

}  // namespace headpin::python
