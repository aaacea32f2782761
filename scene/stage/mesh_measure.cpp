#include "scene/stage/mesh_measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/recordings/reading.h"

namespace headpin::scene {

Mat3 rotation_of(const MeshMeasure& measure, const std::string& where) {
  const devices::Axes axes(measure.axes, where);
  Mat3 R;
  for (int i = 0; i < 3; ++i) {  // those are in a frame of x right, y up, z back
    const Vec3 p = axes.ours(Vec3(Vec3::Unit(i)));
    R.col(i) = Vec3(p.x(), -p.z(), p.y());
  }
  if (R.determinant() < 0.0) {
    throw std::invalid_argument(fmt::format(
        "{}: axes '{}' are left-handed, expected right-handed ones", where, measure.axes));
  }
  return R;
}

std::string offer_of_measure(std::span<const Vec3> points, const MeshMeasure& measure) {
  constexpr double kLeast = 0.1, kMost = 1.0;  // heights of skittles [m]
  constexpr double kBase = 0.01;               // how far off its base may be, of its height
  const Mat3 to_file = rotation_of(measure, "").transpose();
  // Up is z, y, -y, x, -x or -z of the file.
  for (const char* axes : {measure.axes.c_str(), "RAS", "RSP", "RIA", "SRA", "IRP", "RPI"}) {
    const Vec3 up = (rotation_of({.unit = 1.0, .axes = axes}, "") * to_file).row(2);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : points) {
      low = std::min(low, up.dot(p));
      high = std::max(high, up.dot(p));
    }
    if (!(std::abs(low) < kBase * (high - low))) continue;
    for (const double unit : {measure.unit, 1.0, 0.001, 0.01, 0.0254, 0.3048}) {
      const double height = high * unit / measure.unit;
      if (height < kLeast || height > kMost) continue;
      const std::string other_unit = unit == measure.unit ? "" : fmt::format("unit = {}", unit);
      const std::string other_axes = axes == measure.axes ? "" : fmt::format("axes = \"{}\"", axes);
      if (other_unit.empty() && other_axes.empty()) return "";
      return fmt::format("; with {}{}{} it would be {:.3g} m high", other_unit,
                         other_unit.empty() || other_axes.empty() ? "" : " and ", other_axes,
                         height);
    }
  }
  return "";
}

}  // namespace headpin::scene
