#pragma once

#include <array>

#include "base/math.h"
#include "render/data/optics.h"

namespace headpin::render {

/// The frustum of one eye: tangents of the four edges, and the depth range [m].
struct Frustum {
  double left, right, bottom, top;  ///< x/-z and y/-z at the edges of the picture
  double near = 0.05;
  double far = 40.0;
};

/// One camera: x right, y up, looking along -z.
struct View {
  Pose X_WE;
  Frustum frustum;
  int width = 360;   ///< pixels
  int height = 240;  ///< pixels
};

/// The two views of a head: left first.
///
/// @param X_WD  head display: x right, y up, looking along -z, origin midway between the eyes
std::array<View, 2> eyes(const Pose& X_WD, const Optics& optics);

}  // namespace headpin::render
