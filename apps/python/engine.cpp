#include "apps/python/engine.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "engine/non_colliding.h"

namespace headpin::python {

namespace {

using namespace engine;
using namespace pybind11::literals;

/// A shape, if its measures are those of one.
/// @throws std::invalid_argument  naming the measure
template <typename T>
T checked(const T& shape) {
  check(shape);
  return shape;
}

void add_shapes(py::module_& m) {
  py::class_<Ellipsoid>(m, "Ellipsoid", "An ellipsoid about the origin of its frame.")
      .def(py::init([](const Vec3& radii) { return checked(Ellipsoid{radii}); }), "radii"_a,
           "radii: semi-axes along x, y, z [m]; a ball has three equal ones.")
      .def_readonly("radii", &Ellipsoid::radii);
  py::class_<Cylinder>(m, "Cylinder", "A cylinder about the origin of its frame, with axis z.")
      .def(py::init([](double r, double h) {
             return checked(Cylinder{r, h});
           }),
           "radius"_a, "half_height"_a, "Measures in metres.")
      .def_readonly("radius", &Cylinder::radius)
      .def_readonly("half_height", &Cylinder::half_height);
  py::class_<Cone>(m, "Cone", "A cone with axis z: base at z = -height/2, apex at z = +height/2.")
      .def(py::init([](double r, double h) {
             return checked(Cone{r, h});
           }),
           "radius"_a, "height"_a, "Measures in metres.")
      .def_readonly("radius", &Cone::radius)
      .def_readonly("height", &Cone::height);
  py::class_<HalfSpace>(m, "HalfSpace", "All points with z <= 0: floors and walls.")
      .def(py::init<>());
  py::class_<Polyhedron>(m, "Polyhedron", "A convex polyhedron.")
      .def(py::init<std::vector<Vec3>, const std::vector<std::vector<std::uint32_t>>&>(),
           "vertices"_a, "faces"_a,
           "vertices: corners [m]. faces: numbers of the corners of each face, counterclockwise "
           "from outside.\n\nRaises ValueError that names the face, edge or vertex that is wrong.")
      .def_property_readonly("vertices", [](const Polyhedron& p) {
        return std::vector<Vec3>(p.vertices().begin(), p.vertices().end());
      });
}

void add_compounds(py::module_& m) {
  py::class_<Part>(m, "Part", "A shape at its place in a compound.")
      .def(py::init([](const Shape& shape, const Vec3& position, const Quaternion& quaternion) {
             return Part{shape, pose_of(position, quaternion)};
           }),
           "shape"_a, "position"_a = Vec3(Vec3::Zero()), "quaternion"_a = kNoTurn,
           "position [m] and unit quaternion (w, x, y, z) of the shape in the frame of the "
           "compound.");
  py::class_<SharedCompound>(
      m, "Compound",
      "A solid of convex parts, which may overlap. A shape stands for a compound of it.")
      .def(py::init([](std::vector<Part> parts) {
             return SharedCompound(make_compound(std::move(parts)));
           }),
           "parts"_a)
      .def(py::init([](const Shape& shape) {
             return SharedCompound(make_compound({{shape, {}}}));
           }),
           "shape"_a)
      .def_property_readonly(
          "bounding_radius", [](const SharedCompound& c) { return c->bounding_radius; },
          "Of the sphere about the origin that holds it [m].");
  py::implicitly_convertible<Ellipsoid, SharedCompound>();
  py::implicitly_convertible<Cylinder, SharedCompound>();
  py::implicitly_convertible<Cone, SharedCompound>();
  py::implicitly_convertible<HalfSpace, SharedCompound>();
  py::implicitly_convertible<Polyhedron, SharedCompound>();
  py::class_<MassProperties>(m, "MassProperties")
      .def_readonly("mass", &MassProperties::mass, "[kg]")
      .def_readonly("centre", &MassProperties::centre, "Of mass [m].")
      .def_readonly("inertia", &MassProperties::inertia,
                    "(3, 3), about the centre, along the axes of the frame [kg m^2].");
  m.def(
      "mass_properties",
      [](const SharedCompound& compound, double density) {
        return mass_properties(*compound, checked_density(density));
      },
      "compound"_a, "density"_a,
      "Mass, centre and inertia of a solid of one density [kg/m^3]; matter where parts overlap "
      "counts once.\n\nUnder collision.rules 13 and older, skittles whose thin parts overlap were weighed up to a fifth otherwise.");
}

py::dict closest(const Shape& a, const Shape& b, const Vec3& position, const Quaternion& quaternion,
                 double margin) {
  const Pose X_AB = pose_of(position, quaternion);
  if (!X_AB.p.allFinite() || !(std::abs(X_AB.q.norm() - 1.0) < 1e-9)) {
    throw std::invalid_argument("closest_points: position is not finite or quaternion not unit");
  }
  if (!(margin >= 0.0)) {
    throw std::invalid_argument(fmt::format("margin: expected 0 or more, found {}", margin));
  }
  KeptNormal kept;
  Query query;
  query.margin = margin;
  const Closest c = closest_points(a, b, X_AB, kept, query);
  return py::dict("separated"_a = c.separated, "distance"_a = c.distance, "point_a"_a = c.p_A,
                  "point_b"_a = c.p_B, "normal"_a = c.n_AB, "iterations"_a = c.iterations);
}

}  // namespace

double checked_density(double density) {
  if (density > 0.0 && std::isfinite(density)) return density;
  throw std::invalid_argument(
      fmt::format("density: expected finite and above 0, found {}", density));
}

Pose pose_of(const Vec3& position, const Quaternion& q) {
  return {Quat(q[0], q[1], q[2], q[3]), position};
}

void add_engine(py::module_& module) {
  py::module_ m = module.def_submodule(
      "_engine",
      "Rigid bodies that stand, roll, fall and collide, and repeat to the bit.\n\n"
      "Metre, kilogram, second, radian; vectors are in the world frame W, quaternions are (w, x, "
      "y, "
      "z).\nEvery array is a copy.");
  add_shapes(m);
  add_compounds(m);
  add_world(m);
  m.def(
      "closest_points", closest, "a"_a, "b"_a, "position"_a, "quaternion"_a = kNoTurn,
      "margin"_a = 0.0,
      "Whether two shapes are apart; or where, in which direction and how deep they meet.\n\n"
      "position, quaternion: of the frame of b in the frame of a; so are all results.\n"
      "margin: up to this gap the search goes on to the closest points [m].\n\n"
      "Returns a dict: separated; distance, a gap or minus the depth [m]; point_a and point_b on "
      "the surfaces;\nnormal from a to b; iterations, evaluations of the support functions.\n"
      "Of a gap beyond the margin, distance is only that of two planes across normal, which is the gap or "
      "less, and the points\nare where those planes touch: margin=float('inf') gives the gap, to 1 %, and the closest "
      "points of any pair.");
  for (const auto& [name, what] : py::dict(m.attr("__dict__"))) {
    if (py::isinstance<py::type>(what)) what.attr("__module__") = "headpin.engine";
  }
}

}  // namespace headpin::python
