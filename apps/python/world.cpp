#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "apps/python/engine.h"
#include "apps/python/in_use.h"
#include "apps/python/interrupts.h"
#include "apps/python/module.h"
#include "apps/python/response.h"
#include "engine/save.h"
#include "engine/workspace.h"
#include "scene/scenario/choices.h"

namespace headpin::python {

namespace {

using namespace engine;
using namespace pybind11::literals;

/// A world in Python, with what its steps borrow.
struct PyWorld {
  World world;
  std::shared_ptr<const Response> own;  ///< a law of the caller's own, which the world uses
  Workspace workspace;
  bool in_use = false;

  World& get() {
    require_free(in_use, "world");
    return world;
  }
};

using Three = std::array<double, 3>;

struct StateRow {
  Three position;
  std::array<double, 4> quaternion;
  Three velocity, angular_velocity;
  bool asleep;
};

struct EventRow {
  std::uint32_t a, b;
  Three position, normal, impulse;
  double approach_speed;
  bool first;
};

struct ContactRow {
  std::uint32_t a, b;
  Three position, normal;
  double depth;
};

Three three(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

template <typename Row>
py::array_t<Row> array_of(const std::vector<Row>& rows) {
  return py::array_t<Row>(static_cast<py::ssize_t>(rows.size()), rows.data());
}

py::array_t<StateRow> states(PyWorld& w) {
  const World& world = w.get();
  std::vector<StateRow> rows;
  for (std::size_t i = 0; i < world.states.size(); ++i) {
    const State& s = world.states[i];
    const Quat& q = s.X_WB.q;
    rows.push_back({three(s.X_WB.p),
                    {q.w(), q.x(), q.y(), q.z()},
                    three(s.v_WB),
                    three(s.w_WB),
                    world.asleep[i] != 0});
  }
  return array_of(rows);
}

py::array_t<EventRow> events_of_step(PyWorld& w) {
  std::vector<EventRow> rows;
  for (const ContactEvent& e : w.get().events) {
    rows.push_back(
        {e.a, e.b, three(e.p_W), three(e.n_AB_W), three(e.impulse_W), e.approach_speed, e.first});
  }
  return array_of(rows);
}

py::array_t<ContactRow> contacts(PyWorld& w, double margin) {
  if (!(margin >= 0.0) || !std::isfinite(margin)) {
    throw std::invalid_argument("margin: expected finite and 0 m or above");
  }
  World& world = w.get();
  std::vector<ContactRow> rows;
  std::vector<ContactPoint> points;
  for (BodyId b = 1; b < world.bodies.size(); ++b) {
    for (BodyId a = 0; a < b; ++a) {
      if (world.bodies[a].kind == Kind::fixed && world.bodies[b].kind == Kind::fixed) continue;
      points.clear();
      contacts_now(world, a, b, margin, points);
      for (const ContactPoint& p : points) {
        rows.push_back({a, b, three(p.p_W), three(p.n_AB_W), p.depth});
      }
    }
  }
  return array_of(rows);
}

/// Where a call in Python leaves the inertia out: that of a uniform solid of that mass.
Mat3 uniform_inertia(const SharedCompound& shape, double mass) {
  const MassProperties p = mass_properties(*shape, 1.0);
  if (p.centre.norm() > 1e-6 * shape->bounding_radius) {
    throw std::invalid_argument(
        "body: expected its centre of mass at the origin of its shape, or an inertia; see "
        "about_centre");
  }
  return mass / p.mass * p.inertia;
}

Kind kind_named(const std::string& name) {
  if (name == "fixed") return Kind::fixed;
  if (name == "driven") return Kind::driven;
  if (name == "free") return Kind::free;
  throw std::invalid_argument("kind: expected one of fixed, driven, free, found '" + name + "'");
}

const char* name_of(Kind kind) {
  return kind == Kind::fixed ? "fixed" : kind == Kind::driven ? "driven" : "free";
}

/// No solid has a moment of inertia that is larger than the sum of its two others.
void expect_solid(const Mat3& inertia) {
  const Vec3 moments = principal_inertia(inertia).moments;
  if (2.0 * moments.maxCoeff() <= (1.0 + 1e-9) * moments.sum()) return;
  throw std::invalid_argument(fmt::format(
      "inertia: expected no principal moment above the sum of the two others, found {:g}, {:g}, {:g} kg m^2",
      moments[0], moments[1], moments[2]));
}

Body body_of(const SharedCompound& shape, const std::string& name, double mass,
             const std::optional<Mat3>& inertia, double elasticity, double friction,
             double rolling_arm, const std::string& kind, bool exact) {
  Body body;
  body.name = name;
  body.shape = shape;
  body.mass = mass;
  body.kind = kind_named(kind);
  if (inertia) {
    expect_solid(*inertia);
    body.inertia = *inertia;
  } else if (body.kind != Kind::fixed) {
    body.inertia = uniform_inertia(shape, mass);
  }
  body.material = {elasticity, friction, rolling_arm};
  body.exact = exact;
  return body;
}

py::dict about_its_centre(const SharedCompound& compound, double density) {
  const Centred c = about_centre(*compound, mass_properties(*compound, checked_density(density)));
  const Quat& q = c.X_BC.q;
  return py::dict("compound"_a = SharedCompound(c.compound), "position"_a = c.X_BC.p,
                  "quaternion"_a = Quaternion(q.w(), q.x(), q.y(), q.z()), "mass"_a = c.mass,
                  "inertia"_a = Mat3(c.inertia.asDiagonal()));
}

State state_of(const Vec3& position, const Quaternion& quaternion, const Vec3& velocity,
               const Vec3& angular_velocity) {
  return {pose_of(position, quaternion), velocity, angular_velocity};
}

std::string hash_of(PyWorld& w) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  const std::uint64_t hash = state_hash(w.get());
  for (int bit = 60; bit >= 0; bit -= 4) text += kDigits[hash >> bit & 15];
  return text;
}

/// Makes steps. With a law of one's own, a step that it stops is undone.
void make_steps(PyWorld& w, std::int64_t count) {
  if (count < 0)
    throw std::invalid_argument(fmt::format("count: expected 0 or more, found {}", count));
  World& world = w.get();
  const InUse use(w.in_use);
  const py::gil_scoped_release unlocked;
  Interrupts interrupts;
  for (std::int64_t i = 0; i < count; ++i) {
    interrupts.check();
    if (!w.own) {
      step(world, w.workspace);
      continue;
    }
    World before = world;
    try {
      step(world, w.workspace);
    } catch (...) {
      world = std::move(before);
      throw;
    }
  }
}

std::unique_ptr<PyWorld> world_of(int rate_hz, const Vec3& gravity, const py::object& response,
                                  const std::optional<std::string>& sliding,
                                  const std::string& detection, int cap, bool warm, bool sleep,
                                  bool ledger, int threads) {
  Parameters p;
  p.rate_hz = rate_hz;
  p.gravity_W = gravity;
  const auto mode = scene::value_named<scene::Detection>(detection);
  if (!mode) {
    throw std::invalid_argument(fmt::format("detection: expected one of {}, found '{}'",
                                            fmt::join(scene::names_of<scene::Detection>(), ", "),
                                            detection));
  }
  p.query.mode = *mode;
  p.query.cap = cap;
  p.query.warm = warm;
  p.sleep = sleep;
  p.keep_ledger = ledger;
  p.threads = threads;
  auto made = std::make_unique<PyWorld>();
  if (py::isinstance<py::str>(response)) {
    p.response = response_named(response.cast<std::string>()).name;
  } else if (response.is_none()) {
    throw std::invalid_argument("response: expected a name or a law, found None");
  }
  made->own = own_response(response, sliding);
  made->world = make_world(p);
  if (made->own) set_response(made->world, *made->own);
  return made;
}

py::dict statistics(PyWorld& w) {
  const Statistics s = w.get().statistics;  // a step may be made while Python makes the dict
  return py::dict("pairs"_a = s.pairs, "contacts"_a = s.contacts, "queries"_a = s.queries.queries,
                  "query_iterations"_a = s.queries.iterations,
                  "capped_queries"_a = s.queries.capped, "impacts"_a = s.impacts,
                  "unfinished_impacts"_a = s.unfinished_impacts, "pulling_impulses"_a = s.pulls,
                  "islands"_a = s.islands, "solver_iterations"_a = s.solver_iterations,
                  "unsolved_islands"_a = s.unsolved, "largest_residual_mps"_a = s.residual,
                  "deepest_overlap_m"_a = s.deepest_overlap, "awake"_a = s.awake);
}

py::dict in_python(const Balance& b) {
  return py::dict("energy"_a = b.energy, "momentum"_a = b.momentum,
                  "angular_momentum"_a = b.angular_momentum);
}

py::dict ledger(PyWorld& w) {
  const Ledger l = w.get().ledger;
  return py::dict("gravity"_a = in_python(l.gravity), "hand"_a = in_python(l.hand),
                  "impact"_a = in_python(l.impact), "sustained"_a = in_python(l.sustained),
                  "correction"_a = in_python(l.correction));
}

void add_body_class(py::module_& m) {
  py::class_<Body>(m, "Body", "What a body is made of; a world has its state.")
      .def(
          py::init(&body_of), "shape"_a, "name"_a = "", "mass"_a = 1.0, "inertia"_a = py::none(),
          "elasticity"_a = 0.7, "friction"_a = 0.7, "rolling_arm"_a = 0.0, "kind"_a = "free",
          "exact"_a = false,
          "shape: in the frame B of the body, whose origin is the centre of mass.\n"
          "mass [kg].\ninertia: (3, 3), about the centre of mass [kg m^2]; None: of a uniform "
          "solid.\nelasticity, friction: 0 to 1; those of two bodies are multiplied.\n"
          "rolling_arm: rolling resistance as a length [m].\n"
          "kind: fixed (never moves), driven (moves as set, with infinite mass) or free.\n"
          "exact: what touches it is detected as in converged mode, also with detection='paper', under which "
          "balls\npass through polyhedra much larger than they are.")
      .def_readonly("name", &Body::name)
      .def_readonly("mass", &Body::mass, "[kg]")
      .def_readonly("inertia", &Body::inertia, "(3, 3) [kg m^2].")
      .def_property_readonly("kind", [](const Body& b) { return name_of(b.kind); });
  m.def(
      "about_centre", about_its_centre, "compound"_a, "density"_a,
      "A solid of one density [kg/m^3] in the frame of its centre of mass and principal axes, as a "
      "Body wants it.\n\nReturns a dict: compound, mass, inertia; position and quaternion of the "
      "new frame in the old one.");
}

void add_world_changes(py::class_<PyWorld>& c) {
  c.def(
       "add",
       [](PyWorld& w, const Body& body, const Vec3& p, const Quaternion& q, const Vec3& v,
          const Vec3& turn) { return add_body(w.get(), body, state_of(p, q, v, turn)); },
       "body"_a, "position"_a = Vec3(Vec3::Zero()), "quaternion"_a = kNoTurn,
       "velocity"_a = Vec3(Vec3::Zero()), "angular_velocity"_a = Vec3(Vec3::Zero()),
       "Adds a body and returns its number, from 0.\n\nposition, velocity: of its centre of mass "
       "[m, "
       "m/s]. angular_velocity [rad/s].\nRaises ValueError that names the body and the value that "
       "is "
       "wrong.")
      .def(
          "set_state",
          [](PyWorld& w, BodyId body, const Vec3& p, const Quaternion& q, const Vec3& v,
             const Vec3& turn) { set_state(w.get(), body, state_of(p, q, v, turn)); },
          "body"_a, "position"_a, "quaternion"_a = kNoTurn, "velocity"_a = Vec3(Vec3::Zero()),
          "angular_velocity"_a = Vec3(Vec3::Zero()),
          "Sets pose and velocity of a body that is not fixed. It wakes up, with what rests on it.")
      .def(
          "set_kind",
          [](PyWorld& w, BodyId body, const std::string& kind) {
            set_kind(w.get(), body, kind_named(kind));
          },
          "body"_a, "kind"_a, "Makes a free body driven, or a driven one free.")
      .def(
          "wake", [](PyWorld& w, BodyId body) { wake(w.get(), body); }, "body"_a)
      .def(
          "put_to_sleep", [](PyWorld& w, BodyId body) { put_to_sleep(w.get(), body); }, "body"_a,
          "Puts a free body to sleep until a moving body touches it.")
      .def("step", make_steps, "count"_a = 1,
           "Makes steps of 1 / rate_hz.\n\nOther threads go on meanwhile; Ctrl-C stops between two "
           "steps. An error in a response of one's own is\nraised from here; the world is then as "
           "it was before that step.");
}

void add_world_copies(py::class_<PyWorld>& c) {
  const auto copy = [](PyWorld& w) {
    auto other = std::make_unique<PyWorld>();
    other->world = w.get();
    other->own = w.own;
    return other;
  };
  c.def("copy", copy, "An equal world, which goes on with the same bits.")
      .def("__copy__", copy)
      .def(
          "save",
          [](PyWorld& w) {
            const std::vector<std::uint8_t> bytes = save(w.get());
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          },
          "Everything that changes, as bytes; bodies, parameters and a law of one's own are not among "
          "them.")
      .def(
          "restore",
          [](PyWorld& w, const py::bytes& bytes) {
            const std::string_view view = bytes;
            w.world =
                restore(w.get(), {reinterpret_cast<const std::uint8_t*>(view.data()), view.size()});
          },
          "saved"_a,
          "Takes over a saved state, then goes on with the same bits.\n\nRaises ValueError for "
          "bytes of a world with other bodies or parameters, and for damaged ones. A law\nof one's "
          "own is not compared: the world goes on by its own, so it must be that of the saved one.");
}

void add_world_views(py::class_<PyWorld>& c) {
  c.def_property_readonly(
       "tick", [](PyWorld& w) { return w.get().tick; }, "Steps so far.")
      .def_property_readonly(
          "response", [](PyWorld& w) { return std::string(w.get().parameters.response); },
          "Name of the law of response; custom for one's own.")
      .def_property_readonly(
          "bodies", [](PyWorld& w) { return w.get().bodies; },
          "List of Body, by their numbers; a copy.")
      .def_property_readonly(
          "states", states,
          "States by the bodies' numbers: structured array (bodies,) of position (3,) [m], "
          "quaternion "
          "(4,),\nvelocity (3,) [m/s], angular_velocity (3,) [rad/s], asleep. A copy.")
      .def_property_readonly("events", &events_of_step,
                             "What met in the last step, in order: structured array of a, b "
                             "(numbers of bodies), position "
                             "(3,) [m],\nnormal (3,) from a to b, impulse (3,) on a [N s], "
                             "approach_speed [m/s], first "
                             "(they had not met before).")
      .def(
          "contacts", contacts, "margin"_a = 0.0,
          "Contact points now, as a step finds them: structured array of a, b, position (3,) [m], normal (3,) from a to "
          "b, "
          "depth [m].\n\nmargin: gaps up to this are included, with negative depth [m]. Under the paper's detection, bodies that\nare apart have no points, except on a half-space or an exact body.")
      .def_property_readonly("statistics", statistics, "Dict of counts of the last step.")
      .def_property_readonly(
          "balance", [](PyWorld& w) { return in_python(balance(w.get())); },
          "Dict: energy [J], momentum (3,), angular_momentum (3,) of the free "
          "bodies.")
      .def_property_readonly("ledger", ledger,
                             "What each phase of the steps has added so far, where the ledger is "
                             "kept: dict of balances. Zeros where it is not.")
      .def_property_readonly(
          "state_hash", hash_of,
          "16 hexadecimal digits, of tick, poses, velocities and sleep. Equal runs "
          "have equal hashes.");
}

}  // namespace

void add_world(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(StateRow, position, quaternion, velocity, angular_velocity, asleep);
  PYBIND11_NUMPY_DTYPE(EventRow, a, b, position, normal, impulse, approach_speed, first);
  PYBIND11_NUMPY_DTYPE(ContactRow, a, b, position, normal, depth);
  add_body_class(m);
  const Parameters p;
  py::class_<PyWorld> world(m, "World", "Bodies, their states, and what the next step needs.");
  world.def(
      py::init(&world_of), py::kw_only(), "rate_hz"_a = p.rate_hz, "gravity"_a = p.gravity_W,
      "response"_a = "paper", "sliding"_a = py::none(), "detection"_a = "converged",
      "cap"_a = p.query.cap, "warm"_a = p.query.warm, "sleep"_a = p.sleep,
      "keep_ledger"_a = p.keep_ledger, "threads"_a = p.threads,
      "An empty world.\n\nrate_hz: steps a second. gravity: (3,) [m/s^2].\n"
      "response: paper, coulomb, or a law of one's own: a function (u, K, N, elasticity, "
      "friction) -> impulse,\n  or the address (int) of a C function `void (const double u[3], "
      "const double K[9], const double N[3],\n  double elasticity, double friction, double "
      "impulse[3])`. N is the unit normal from A to B, u the velocity\n  of A's point minus that "
      "of B's before [m/s], K gives u' = u + K F [1/kg], and F is the impulse on A [N s].\n  It "
      "is called for fast approaches; where it pulls, the step uses the inelastic smooth "
      "impulse.\nsliding: only with such a law, paper (as without it) or coulomb: how sliding "
      "continues at lasting contacts.\n"
      "detection: converged, or paper with its cap on iterations, 1 to 1000 (the paper: 5 to 20), and a warm start.\n"
      "sleep: bodies at rest sleep. keep_ledger: `ledger` is kept, for a tenth of the time.\n"
      "threads: that share a step where hundreds of bodies are near each other; the bits are the same.");
  add_world_changes(world);
  add_world_copies(world);
  add_world_views(world);
}

}  // namespace headpin::python
