#pragma once

#include <string>
#include <string_view>

#include "engine/math.h"

namespace headpin::devices {

/// A frame, given by the directions of +x, +y and +z: R right, L left, S up, I down, A ahead, P
/// back. Ours is RSP.
class Axes {
 public:
  /// @throws std::invalid_argument  naming `where`, unless there is one of each pair
  Axes(const std::string& letters, std::string_view where);

  /// A pose in that frame, in ours.
  Pose ours(const Pose& theirs) const;

 private:
  Mat3 R_;       // ours from theirs; a mirror when theirs is left-handed
  double hand_;  // its determinant
};

}  // namespace headpin::devices
