#include "devices/recordings/reading.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::devices {
namespace {

constexpr std::string_view kOrder = "wxyz";

double part(const Quat& q, char letter) {
  return letter == 'w' ? q.w() : letter == 'x' ? q.x() : letter == 'y' ? q.y() : q.z();
}

}  // namespace

Axes::Axes(std::string_view letters, std::string_view where) {
  // Right is our x, up our y, back our z.
  constexpr std::string_view kPlus = "RSP", kMinus = "LIA";
  R_.setZero();
  for (std::size_t i = 0; i < letters.size() && i < 3; ++i) {
    const std::size_t plus = kPlus.find(letters[i]), minus = kMinus.find(letters[i]);
    const auto column = static_cast<Eigen::Index>(i);
    if (plus < 3) R_(static_cast<Eigen::Index>(plus), column) = 1.0;
    if (minus < 3) R_(static_cast<Eigen::Index>(minus), column) = -1.0;
  }
  hand_ = R_.determinant();
  if (letters.size() != 3 || std::abs(hand_) != 1.0) {
    throw std::invalid_argument(fmt::format(
        "{}: axes '{}': expected where +x, +y and +z point, one letter each of R or L (right, "
        "left), S or I (up, down), A or P (ahead, back), such as RSP",
        where, letters.substr(0, 20)));
  }
}

Quat quaternion_of(const std::array<double, 4>& numbers, std::string_view letters) {
  const auto number = [&](char letter) { return numbers[letters.find(letter) & 3]; };
  return {number('w'), number('x'), number('y'), number('z')};
}

Reading with(const ToldReading& told, Reading reading, std::string_view where) {
  if (told.unit_m) {
    reading.unit_m = *told.unit_m;
    reading.own_units = false;
    reading.without_unit = {};
    reading.other_units_m.clear();
  }
  if (told.axes) reading.axes = reading.turning = *told.axes;
  if (told.turning) reading.turning = *told.turning;
  if (told.time_unit_s) reading.time_unit_s = *told.time_unit_s;
  if (told.inverted) reading.inverted = *told.inverted;
  if (told.quaternion) {
    if (reading.quaternion.empty()) {
      throw std::invalid_argument(
          fmt::format("{}: expected quaternions to read as {}; found other rotations, or none",
                      where, *told.quaternion));
    }
    reading.quaternion = *told.quaternion;
    reading.own_orders = false;
  }
  return reading;
}

Again::Again(const Reading& was, const Reading& is, std::string_view where)
    : was_(was),
      is_(is),
      was_axes_(was.axes, where),
      is_axes_(is.axes, where),
      was_turning_(was.turning, where),
      is_turning_(is.turning, where) {
  for (std::string* order : {&was_.quaternion, &is_.quaternion}) {
    if (order->empty()) *order = kOrder;
  }
}

Pose Again::operator()(const Pose& pose) const {
  const Vec3 p = is_axes_.ours(Vec3(is_.unit_m / was_.unit_m * was_axes_.theirs(pose.p)));
  Quat q = was_turning_.theirs(pose.q);
  if (was_.inverted) q = q.conjugate();
  q = numbers(q);
  if (is_.inverted) q = q.conjugate();
  return {is_turning_.ours(q), p};
}

Time Again::operator()(Time time) const {
  if (was_.time_unit_s == is_.time_unit_s) return time;
  return microseconds(is_.time_unit_s / was_.time_unit_s * seconds(time));
}

Quat Again::numbers(const Quat& q) const {
  if (was_.quaternion == is_.quaternion) return q;
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < 4; ++i) numbers[i] = part(q, was_.quaternion[i]);
  return quaternion_of(numbers, is_.quaternion);
}

}  // namespace headpin::devices
