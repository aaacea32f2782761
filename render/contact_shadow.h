#pragma once

#include <vector>

#include "render/draw_list.h"

/// Contact shadows: floors are darker beneath and beside bodies. Each body counts as a few balls
/// that take light from patches of the floor.
namespace headpin::render {

constexpr double kFaint = 0.02;  ///< smallest share of light that an occluder must take to be drawn

/// A point on a patch, and the ball that darkens it, in the shader's layout.
struct ContactVertex {
  Eigen::Vector3f p, n;
  Eigen::Vector4f ball;
};

/// Two triangles for each patch and occluder that reach each other.
std::vector<ContactVertex> contact_vertices(const DrawList& list);

}  // namespace headpin::render
