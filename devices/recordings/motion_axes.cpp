#include "devices/recordings/motion_axes.h"

#include <stdexcept>

#include <fmt/format.h>

namespace headpin::devices {

Axes::Axes(const std::string& letters, std::string_view where) {
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

Pose Axes::ours(const Pose& theirs) const {
  // A mirror reverses the direction of rotations.
  const Vec3 turned = hand_ * (R_ * theirs.q.vec());
  return {Quat(theirs.q.w(), turned.x(), turned.y(), turned.z()), R_ * theirs.p};
}

}  // namespace headpin::devices
