#include "apps/python/frames.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "apps/python/module.h"
#include "apps/python/values.h"
#include "render/camera.h"
#include "render/display.h"
#include "render/matrices.h"
#include "scene/stage/condition.h"
#include "scene/watch/eye_frames.h"
#include "scene/watch/recorded.h"
#include "scene/watch/verifier.h"

namespace headpin::python {

namespace {

/// One drawn frame of one eye or both.
struct Frame {
  std::int64_t number = 0, tick = 0;
  Time time{};
  std::string eye;
  std::vector<render::View> views;  ///< of the eyes, left first
  bool pinhole = true;              ///< without a lens
  std::vector<std::uint8_t> image;  ///< rows from the top; one eye after the other
  std::vector<float> depth;
  std::vector<std::uint8_t> ids;
};

using FramePtr = std::shared_ptr<Frame>;

std::uint8_t one_byte(std::uint32_t id) {
  if (id <= 255) return static_cast<std::uint8_t>(id);
  throw std::runtime_error(fmt::format(
      "ids: the number {} does not fit into 8 bits; `headpin frames --ids` writes 16 bits", id));
}

/// Keeps the drawn frames, by their numbers.
class Kept : public scene::FrameSink {
 public:
  Kept(const FramesWanted& wanted, bool pinhole) : wanted_(wanted), pinhole_(pinhole) {}

  void add(const scene::EyeFrame& drawn) override {
    auto frame = std::make_shared<Frame>();
    frame->number = drawn.number;
    frame->tick = drawn.tick;
    frame->time = drawn.time;
    frame->eye = wanted_.eye;
    frame->pinhole = pinhole_;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (wanted_.eye == (eye == 0 ? "right" : "left")) continue;
      frame->views.push_back(drawn.views[eye]);
      const std::vector<std::uint8_t>& rgb = drawn.images[eye].rgb;
      frame->image.insert(frame->image.end(), rgb.begin(), rgb.end());
      const render::Labels& labels = drawn.labels[eye];
      if (wanted_.depth) {
        frame->depth.insert(frame->depth.end(), labels.depth.begin(), labels.depth.end());
      }
      if (wanted_.ids) {
        std::ranges::transform(labels.id, std::back_inserter(frame->ids), one_byte);
      }
    }
    frames[drawn.number] = std::move(frame);
  }

  std::map<std::int64_t, FramePtr> frames;

 private:
  const FramesWanted& wanted_;
  bool pinhole_;
};

void check(const FramesWanted& wanted) {
  if (wanted.eye != "left" && wanted.eye != "right" && wanted.eye != "both") {
    throw std::invalid_argument("eye: expected left, right or both, found " + wanted.eye);
  }
  if (wanted.fps && (*wanted.fps < 1 || *wanted.fps > 1000)) {
    throw std::invalid_argument(fmt::format("fps: expected 1 to 1000, found {}", *wanted.fps));
  }
  if (!wanted.look) return;
  std::string names;
  for (const render::Look& look : render::looks()) {
    if (*wanted.look == look.name) return;
    names += (names.empty() ? "" : ", ") + std::string(look.name);
  }
  throw std::invalid_argument(
      fmt::format("look: expected one of {}, found {}", names, *wanted.look));
}

/// @param numbers  sorted
void check_numbers(const std::vector<std::int64_t>& numbers, Time end, std::int64_t fps) {
  std::int64_t last = end.count() / 1'000'000 * fps;
  while (tick_time(last + 1, fps) <= end) ++last;
  for (const std::int64_t number : numbers) {
    if (number >= 0 && number <= last) continue;
    throw std::invalid_argument(
        fmt::format("frame {}: expected frames from 0 to {}", number, last));
  }
}

/// Draws frames; the GIL must be released.
std::map<std::int64_t, FramePtr> drawn(OpenTrial& trial, std::vector<std::int64_t> numbers,
                                       const FramesWanted& wanted) {
  std::ranges::sort(numbers);
  const auto lock = trial.lock();
  const scene::Scenario& scenario = trial.scenario();
  Run run(trial, scenario, nullptr, {.states = true});
  const std::int64_t fps = wanted.fps.value_or(scenario.rates.frame_hz);
  check_numbers(numbers, tick_time(run.ticks, scenario.rates.physics_hz), fps);
  const Pose X_WD_first = scene::first_head_pose(trial.file(), scenario.rig);
  scene::Scenario looked_at = scenario;
  scene::Condition other;
  other.look = wanted.look;
  scene::apply(other, looked_at);
  scene::Eyes eyes = scene::open_eyes(*run.session.stage, looked_at.look, wanted.gl);
  Kept kept(wanted, !render::has_lens(eyes.optics));
  const auto is_wanted = [&](std::int64_t n) { return std::ranges::binary_search(numbers, n); };
  scene::FrameByFrame drawing(eyes,
                              {.fps = fps,
                               .frames = numbers.back() + 1,
                               .wanted = is_wanted,
                               .X_WD_first = X_WD_first,
                               .progress = [](std::int64_t) {},
                               .extras = {.labels = wanted.depth || wanted.ids}},
                              {&kept});
  std::vector<scene::Observer*> seen_by = {&drawing};
  std::optional<scene::Verifier> verifier;  // checks that the simulation is the recorded one
  if (run.source.has_states()) {
    seen_by.insert(seen_by.begin(), &verifier.emplace(trial.path(), run.source, run.session));
  }
  run.go(seen_by, [&] { return kept.frames.contains(numbers.back()); });
  return std::move(kept.frames);
}

/// The shape of an array of one value, or `inner` values, per eye; without the axis of eyes for one eye.
std::vector<py::ssize_t> shape_of(const Frame& frame, std::initializer_list<py::ssize_t> inner) {
  std::vector<py::ssize_t> shape;
  if (frame.eye == "both") shape.push_back(2);
  shape.insert(shape.end(), inner);
  return shape;
}

/// A read-only view of a frame's values, which keeps the frame; None without values.
///
/// @param frame  that Python has
template <typename T>
py::object view(const Frame& frame, const std::vector<T>& values,
                std::initializer_list<py::ssize_t> inner) {
  if (values.empty()) return py::none();
  py::array_t<T> array(shape_of(frame, inner), values.data(),
                       py::cast(frame, py::return_value_policy::reference));
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::ssize_t height(const Frame& f) {
  return f.views[0].height;
}
py::ssize_t width(const Frame& f) {
  return f.views[0].width;
}

/// A matrix per eye.
template <int N, typename Of>
py::array_t<double> matrices(const Frame& frame, const Of& of) {
  py::array_t<double> all(shape_of(frame, {N, N}));
  double* out = all.mutable_data();
  for (const render::View& view : frame.views) {
    const Eigen::Matrix<double, N, N, Eigen::RowMajor> m = of(view);
    out = std::copy(m.data(), m.data() + N * N, out);
  }
  return all;
}

Mat3 camera_matrix(const render::View& view) {
  const render::Camera camera(view);
  Mat3 K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return K;
}

render::Mat4 camera_from_world(const render::View& view) {
  return render::matrix(render::Camera(view).X_CW);
}

render::Mat4 eye_from_world(const render::View& view) {
  return Eigen::Vector4d(1.0, -1.0, -1.0, 1.0).asDiagonal() * camera_from_world(view);
}

void add_cameras(py::class_<Frame, FramePtr>& frame) {
  frame
      .def_property_readonly(
          "K",
          [](const Frame& f) -> py::object {
            if (!f.pinhole) return py::none();
            return matrices<3>(f, camera_matrix);
          },
          "Intrinsics in OpenCV's convention, shape (3, 3) [pixels]: the centre of the first "
          "pixel, top\n"
          "left, is at (0, 0). None for a display with a lens, which no matrix describes.")
      .def_property_readonly(
          "T_cam_world", [](const Frame& f) { return matrices<4>(f, camera_from_world); },
          "Extrinsics in OpenCV's convention, shape (4, 4): takes a point of the world [m] into "
          "the camera\n"
          "[m]; x right, y down, z ahead.")
      .def_property_readonly(
          "gl_view", [](const Frame& f) { return matrices<4>(f, eye_from_world); },
          "Extrinsics in OpenGL's convention, shape (4, 4): takes a point of the world [m] into "
          "the eye [m];\n"
          "x right, y up, it looks along -z. It is diag(1, -1, -1, 1) T_cam_world.")
      .def_property_readonly(
          "gl_projection",
          [](const Frame& f) -> py::object {
            if (!f.pinhole) return py::none();
            return matrices<4>(f,
                               [](const render::View& v) { return render::projection(v.frustum); });
          },
          "Intrinsics in OpenGL's convention, shape (4, 4): takes a point of the eye into clip "
          "space. None\n"
          "for a display with a lens.");
}

}  // namespace

py::object frames(const std::shared_ptr<OpenTrial>& trial, const py::object& numbers,
                  const FramesWanted& wanted) {
  check(wanted);
  const bool one =
      py::hasattr(numbers, "__index__") && !py::hasattr(numbers, "__len__");  // no array
  const auto all = one || !py::hasattr(numbers, "__iter__")
                       ? std::vector{argument<std::int64_t>("frames", numbers)}
                       : argument<std::vector<std::int64_t>>("frames", py::list(numbers));
  if (all.empty()) return py::list();
  std::map<std::int64_t, FramePtr> frames;
  {
    const py::gil_scoped_release released;
    frames = drawn(*trial, all, wanted);
  }
  if (one) return py::cast(frames.at(all[0]));
  py::list in_order;
  for (const std::int64_t number : all) in_order.append(py::cast(frames.at(number)));
  return in_order;
}

void add_frames(py::module_& module) {
  py::class_<Frame, FramePtr> frame(module, "Frame",
                                    "One frame, drawn by Trial.frames(). With both eyes all arrays "
                                    "have a first axis of two, left first.");
  frame.attr("__module__") = "headpin";
  frame.def_readonly("number", &Frame::number, "Number of the frame, from 0.")
      .def_readonly("tick", &Frame::tick, "Last tick that was simulated before it was drawn.")
      .def_property_readonly(
          "time", [](const Frame& f) { return nearest_seconds(f.time); },
          "Time on the trial's clock [s].")
      .def_readonly("eye", &Frame::eye, "\"left\", \"right\" or \"both\".")
      .def_property_readonly(
          "image",
          [](const Frame& f) {
            return view(f, f.image, {height(f), width(f), 3});
          },
          "The picture: uint8, shape (height, width, 3), sRGB, rows from the top, read-only.")
      .def_property_readonly(
          "depth",
          [](const Frame& f) {
            return view(f, f.depth, {height(f), width(f)});
          },
          "Distance of each pixel's centre along the viewing axis: float32 [m], shape (height, "
          "width),\n"
          "infinite without an object. None unless it was asked for.")
      .def_property_readonly(
          "ids",
          [](const Frame& f) {
            return view(f, f.ids, {height(f), width(f)});
          },
          "What each pixel's centre shows: uint8, shape (height, width). 0 nothing, 1 room, 2 "
          "hand, 3 stand,\n"
          "4 button, 5 head, 6 score board, from 10 balls, from 100 skittles; a picture with a 157th "
          "skittle (256)\n"
          "is refused. None unless it was asked for.");
  add_cameras(frame);
}

}  // namespace headpin::python
