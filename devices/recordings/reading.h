#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"

/// How the numbers of a recording are read: what its format says, or what the user says.
namespace headpin::devices {

/// A frame, given by the directions of +x, +y and +z: R right, L left, S up, I down, A ahead, P
/// back. Ours is RSP.
class Axes {
 public:
  /// @throws std::invalid_argument  naming `where`, unless there is one of each pair
  Axes(std::string_view letters, std::string_view where);

  bool left_handed() const { return hand_ < 0.0; }

  /// Coordinates in that frame, in ours.
  Vec3 ours(const Vec3& theirs) const { return R_ * theirs; }
  /// A mirror reverses the direction of rotations.
  Quat ours(const Quat& theirs) const { return turned(R_, theirs); }
  Pose ours(const Pose& theirs) const { return {ours(theirs.q), ours(theirs.p)}; }

  Vec3 theirs(const Vec3& ours) const { return R_.transpose() * ours; }
  Quat theirs(const Quat& ours) const { return turned(R_.transpose(), ours); }

 private:
  Quat turned(const Mat3& R, const Quat& q) const {
    const Vec3 v = hand_ * (R * q.vec());
    return {q.w(), v.x(), v.y(), v.z()};
  }

  Mat3 R_;       // ours from theirs; a mirror when theirs is left-handed
  double hand_;  // its determinant
};

struct Reading {
  double unit_m = 1.0;          ///< of a position's number [m]
  std::string axes = "RSP";     ///< of positions, as Axes has them
  std::string turning = "RSP";  ///< axes of rotations
  double time_unit_s = 1.0;     ///< of a time's number [s]
  /// What the four numbers of a quaternion are, as they stand in the file: "wxyz", "xyzw"; empty where
  /// rotations are no quaternions.
  std::string quaternion = {};
  /// Order and unit of angles, such as "YXZ,deg", or "vector,deg"; without the unit where that of the head is
  /// not that of a hand; "none" where a user said that
  /// rotations are not to be read; else empty where they are no angles.
  std::string angles = {};
  bool inverted = false;    ///< rotations are from the room to the head or hand
  bool own_orders = false;  ///< quaternions have several orders; `quaternion` is one of them
  bool own_units = false;   ///< the file says several units of positions; unit_m is one of them
  /// Of head, left and right hand: its positions are read in unit_m, which other parts of the file say, and it does
  /// not; they may be in one of other_units_m [m].
  std::array<bool, 3> without_unit = {};
  std::vector<double> other_units_m = {};

  bool operator==(const Reading&) const = default;
};

/// Parts of a reading that a user said.
struct ToldReading {
  std::optional<double> unit_m = {};
  std::optional<std::string> axes = {}, turning = {};
  std::optional<double> time_unit_s = {};
  std::optional<std::string> quaternion = {};
  std::optional<bool> inverted = {};
};

/// The reading of a format with what the user said in its place. Rotations have the axes of positions
/// unless they were told.
/// @throws std::invalid_argument  naming `where`: axes that are none, an order of quaternions for a
///                                recording that has none
Reading with(const ToldReading& told, Reading reading, std::string_view where);

/// Reads a pose or a time again in another way: the numbers of the file stay.
class Again {
 public:
  /// @throws std::invalid_argument  as Axes
  Again(const Reading& was, const Reading& is, std::string_view where);

  Pose operator()(const Pose& pose) const;
  Time operator()(Time time) const;

 private:
  Quat numbers(const Quat& q) const;

  Reading was_, is_;
  Axes was_axes_, is_axes_, was_turning_, is_turning_;
};

/// A quaternion of four numbers, in the order of letters such as "xyzw".
Quat quaternion_of(const std::array<double, 4>& numbers, std::string_view letters);

}  // namespace headpin::devices
