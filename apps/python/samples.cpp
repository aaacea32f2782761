#include "apps/python/samples.h"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "apps/python/engine.h"
#include "apps/python/values.h"
#include "devices/log/sample_messages.h"

namespace headpin::python {

namespace {

using namespace pybind11::literals;
using devices::MouseSample;
using devices::TrackerSample;

void check(const TrackerSample& s) {
  if (!s.X_TS.p.allFinite() || !(std::abs(s.X_TS.q.norm() - 1.0) < 1e-3)) {
    throw std::invalid_argument(
        "sample: expected a finite position and a unit quaternion (w, x, y, z)");
  }
  if (s.station < 1) {
    throw std::invalid_argument("sample: station: expected 1 or more, found " +
                                std::to_string(s.station));
  }
  if (!devices::plausible(devices::Sample(s))) {
    throw std::invalid_argument(
        "sample: sent_time_us: expected at most 1 s from time_us, and both times, the sequence and "
        "the position within the limits of a log");
  }
}

void check(const MouseSample& s) {
  if (!devices::plausible(devices::Sample(s))) {
    throw std::invalid_argument("sample: expected all times within the limits of a log");
  }
}

/// The error letter of a status; a blank for none.
char letter_of(const std::string& status) {
  if (status.size() > 1) {
    throw std::invalid_argument("sample: status: expected one letter or none, found '" + status +
                                "'");
  }
  return status.empty() ? ' ' : status[0];
}

TrackerSample tracker_sample(std::int32_t station, std::int64_t time_us, const Vec3& position,
                             const Quaternion& quaternion, std::uint8_t buttons,
                             const std::string& status, std::int64_t sequence,
                             std::int64_t host_time_us, std::int64_t session_time_us,
                             std::int64_t sent_time_us, bool position_estimated,
                             bool orientation_estimated) {
  TrackerSample s;
  s.device_time = Time{time_us};
  s.host_time = Time{host_time_us};
  s.session_time = Time{session_time_us};
  s.sent_time = Time{sent_time_us};
  s.position_estimated = position_estimated;
  s.orientation_estimated = orientation_estimated;
  s.sequence = sequence;
  s.station = station;
  s.X_TS = pose_of(position, quaternion);
  s.status = letter_of(status);
  s.buttons = buttons;
  check(s);
  return s;
}

MouseSample mouse_sample(std::int64_t time_us, bool left_thumb, bool right_thumb, bool trigger,
                         std::int64_t host_time_us, std::int64_t session_time_us) {
  const MouseSample s{Time{time_us}, Time{host_time_us},   left_thumb, right_thumb,
                      trigger,       Time{session_time_us}};
  check(s);
  return s;
}

template <typename Sample>
std::int64_t session_time_us(const Sample& s) {
  return s.session_time.count();
}

/// Cells of a row of a table, by their names.
struct Cells {
  const py::handle row;

  template <typename T>
  T at(const char* name) const {
    const py::object found = row[py::str(name)].attr("item")();
    try {
      return found.cast<T>();
    } catch (const py::cast_error&) {
      PyErr_Clear();  // the words below are ours
    }
    throw std::invalid_argument(
        std::string("sample: ") + name + ": expected " + std::string(name_of_type<T>()) +
        " within the limits of a log, found " + py::repr(found).cast<std::string>());
  }
  bool has(const char* name) const { return row.attr("dtype").attr("names").contains(name); }
  Time time(const char* name) const {
    constexpr double kMost = 1e12;  // [s]; a Time has room for 9e12
    const double found = at<double>(name);
    if (std::abs(found) <= kMost) return microseconds(found);
    throw std::invalid_argument(std::string("sample: ") + name +
                                ": expected a time within the limits of a log, found " +
                                py::repr(py::float_(found)).cast<std::string>());
  }
  std::string text(const char* name) const { return py::str(row[py::str(name)]); }
};

devices::Sample tracker_in(const Cells& c) {
  TrackerSample s;
  s.device_time = c.time("device_time_s");
  s.host_time = c.time("host_time_s");
  s.session_time = c.time("session_time_s");
  s.sequence = c.at<std::int64_t>("sequence");
  s.station = c.at<std::int32_t>("station");
  s.frame = c.text("frame");
  s.X_TS = {Quat(c.at<double>("qw"), c.at<double>("qx"), c.at<double>("qy"), c.at<double>("qz")),
            Vec3(c.at<double>("x_m"), c.at<double>("y_m"), c.at<double>("z_m"))};
  s.status = letter_of(c.text("status"));
  s.buttons = c.at<bool>("stylus") ? 1 : 0;
  if (c.has("sent_time_s")) {  // not in tables of older versions
    s.sent_time = c.time("sent_time_s");
    s.position_estimated = c.at<bool>("position_estimated");
    s.orientation_estimated = c.at<bool>("orientation_estimated");
  }
  check(s);
  return s;
}

devices::Sample mouse_in(const Cells& c) {
  const MouseSample s{c.time("device_time_s"),   c.time("host_time_s"), c.at<bool>("left_thumb"),
                      c.at<bool>("right_thumb"), c.at<bool>("trigger"), c.time("session_time_s")};
  check(s);
  return s;
}

std::vector<devices::Sample> in_table(const py::object& rows) {
  const py::object names = rows.attr("dtype").attr("names");
  const bool trackers = !names.is_none() && names.contains("station");
  if (!trackers && (names.is_none() || !names.contains("trigger"))) {
    throw std::invalid_argument(
        "samples: expected rows of the table trackers or buttons, found an array of another kind");
  }
  std::vector<devices::Sample> all;
  const py::object each = py::module_::import("numpy").attr("atleast_1d")(rows);
  for (const py::handle row : each) {
    try {
      all.push_back(trackers ? tracker_in({row}) : mouse_in({row}));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("row " + std::to_string(all.size()) + ": " + error.what());
    }
  }
  return all;
}

/// One sample, or a table of them.
std::vector<devices::Sample> samples_in(const py::object& what) {
  if (py::isinstance<TrackerSample>(what)) return {what.cast<TrackerSample>()};
  if (py::isinstance<MouseSample>(what)) return {what.cast<MouseSample>()};
  if (py::hasattr(what, "dtype")) return in_table(what);
  throw std::invalid_argument("sample: expected a TrackerSample or a MouseSample, found " +
                              py::repr(what).cast<std::string>());
}

std::string repr(const TrackerSample& s) {
  return "TrackerSample(station=" + std::to_string(s.station) +
         ", time_us=" + std::to_string(s.device_time.count()) + ")";
}

constexpr const char* kTimeWords = "When it was measured, on the session's clock [microseconds].";
constexpr const char* kSessionTimeWords =
    "When a recorded session used it [microseconds]; 0: at once.";

}  // namespace

std::vector<devices::Sample> samples_of(const py::object& what) {
  if (!py::isinstance<py::list>(what) && !py::isinstance<py::tuple>(what)) return samples_in(what);
  std::vector<devices::Sample> all;
  for (const py::handle one : what) {
    const auto more = samples_in(py::reinterpret_borrow<py::object>(one));
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

void add_samples(py::module_& module) {
  py::class_<TrackerSample> tracker(
      module, "TrackerSample", "A pose that a tracker measured, in the transmitter's frame T.");
  tracker
      .def(
          py::init(&tracker_sample), "station"_a, "time_us"_a, "position"_a, "quaternion"_a,
          "buttons"_a = 0, py::kw_only(), "status"_a = "", "sequence"_a = 0, "host_time_us"_a = 0,
          "session_time_us"_a = 0, "sent_time_us"_a = 0, "position_estimated"_a = false,
          "orientation_estimated"_a = false,
          "station: 1 head, 2 right hand, 3 left hand, or others (a scenario may say otherwise).\n"
          "time_us: when it was measured, or what time it was predicted for, on the session's clock "
          "[microseconds].\n"
          "position: (3,) [m]. quaternion: (4,), w, x, y, z.\nbuttons: 1 while the stylus' switch "
          "is "
          "pressed. status: empty, or the Fastrak's error letter.\nhost_time_us: when it arrived; "
          "session_time_us: when a recorded session used it; 0: at once.\n"
          "sent_time_us: when a device that predicts told it; 0: at time_us. position_estimated: the "
          "device did not track it, the hand is not moved; orientation_estimated likewise.")
      .def_readonly("station", &TrackerSample::station, "Number of the receiver, from 1.")
      .def_property_readonly(
          "time_us", [](const TrackerSample& s) { return s.device_time.count(); }, kTimeWords)
      .def_property_readonly("session_time_us", session_time_us<TrackerSample>, kSessionTimeWords)
      .def("__repr__", repr);
  py::class_<MouseSample> mouse(module, "MouseSample",
                                "The buttons of the 3D mouse, when one changes.");
  mouse
      .def(py::init(&mouse_sample), "time_us"_a, "left_thumb"_a = false, "right_thumb"_a = false,
           "trigger"_a = false, py::kw_only(), "host_time_us"_a = 0, "session_time_us"_a = 0,
           "time_us: on the session's clock [microseconds]. left_thumb walks forward, right_thumb "
           "backward, trigger grabs.")
      .def_property_readonly(
          "time_us", [](const MouseSample& s) { return s.device_time.count(); }, kTimeWords)
      .def_property_readonly("session_time_us", session_time_us<MouseSample>, kSessionTimeWords);
  tracker.attr("__module__") = "headpin";
  mouse.attr("__module__") = "headpin";
}

}  // namespace headpin::python
