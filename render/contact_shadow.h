#pragma once

#include <vector>

#include "render/draw_list.h"

/// Floors darken beneath and beside bodies: each body a ball that takes light from each patch.
namespace headpin::render {

constexpr double kFaint = 0.02;  ///< share of light an occluder must take to be drawn

/// A point on a patch, and the ball that darkens it. As the shader reads it.
struct ContactVertex {
  Eigen::Vector3f p, n;
  Eigen::Vector4f ball;
};

/// Two triangles for each patch and occluder that reach each other.
std::vector<ContactVertex> contact_vertices(const DrawList& list);

}  // namespace headpin::render
