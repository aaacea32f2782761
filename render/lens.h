#pragma once

#include <cmath>

#include "base/math.h"
#include "render/data/optics.h"

/// The distortion of a display's lens (render/display.h).
namespace headpin::render {

/// Whether a lens distorts, so that the display is no pinhole camera.
inline bool has_lens(const Optics& optics) {
  return optics.lens_k1 != 0.0 || optics.lens_k2 != 0.0;
}

/// The lens of one eye, along and across its axis.
struct Lens {
  double k1, k2;
  double T;  ///< tangent of the farther of the left and right edge, where s is 1

  Lens(const Optics& optics, double tangent) : k1(optics.lens_k1), k2(optics.lens_k2), T(tangent) {}

  double factor(double square) const {
    return T * (1.0 + square * (k1 + square * k2)) / (1.0 + k1 + k2);
  }
  /// Position on the display of an edge in direction `t`, by bisection; the lens law is increasing.
  double edge(double t) const {
    double low = 0.0, high = 1.0;
    while (high * factor(high * high) < std::abs(t)) high *= 2.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (middle * factor(middle * middle) < std::abs(t) ? low : high) = middle;
    }
    return std::copysign(0.5 * (low + high), t);
  }
  Vec2 direction(const Vec2& s) const { return factor(s.squaredNorm()) * s; }
};

}  // namespace headpin::render
