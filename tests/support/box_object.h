#pragma once

#include <array>
#include <string>

#include <fmt/format.h>

#include "base/math.h"

namespace headpin {

/// A box as an object of an OBJ file whose corners are numbered from `first`.
inline std::string box_object(const Vec3& low, const Vec3& high, int first = 1) {
  std::string text = "o box\n";
  for (int k = 0; k < 8; ++k) {
    text += fmt::format("v {} {} {}\n", (k & 1) != 0 ? high.x() : low.x(),
                        (k & 2) != 0 ? high.y() : low.y(), (k & 4) != 0 ? high.z() : low.z());
  }
  for (const auto& [a, b, c, d] : {std::array{0, 2, 3, 1},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {2, 6, 7, 3},
                                   {0, 4, 6, 2},
                                   {1, 3, 7, 5}}) {
    text += fmt::format("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
  }
  return text;
}

}  // namespace headpin
