#pragma once

#include "apps/python/module.h"
#include "engine/world.h"

/// The module `headpin.engine`, in parts.
namespace headpin::python {

/// w, x, y, z, as Python has them.
using Quaternion = Eigen::Vector4d;
inline const Quaternion kNoTurn{1.0, 0.0, 0.0, 0.0};

Pose pose_of(const Vec3& position, const Quaternion& quaternion);
/// @throws std::invalid_argument  for one that no matter has
double checked_density(double density);

/// Bodies and worlds.
void add_world(py::module_& engine);

}  // namespace headpin::python
