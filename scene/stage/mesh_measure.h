#pragma once

#include <span>
#include <string>

#include "base/math.h"

namespace headpin::scene {

/// Unit and axes of a mesh file.
struct MeshMeasure {
  double unit = 1.0;         ///< metres per unit of the file
  std::string axes = "RAS";  ///< where its +x, +y, +z point: R right, L left, A ahead, P back,
                             ///< S up, I down
};

/// Turns a file's directions into those of the world: x right, y ahead, z up.
///
/// @param where  names the file in messages
/// @throws std::invalid_argument  for axes that are none or left-handed
Mat3 rotation_of(const MeshMeasure& measure, const std::string& where);

/// The unit, the axes or both with which a mesh would stand on its base with the height of a skittle:
/// `; with unit = 0.001 and axes = "RSP" it would be 0.381 m high`. Empty where none of the usual
/// ones makes it so.
///
/// @param points   of the mesh, as read with `measure` [m]
std::string offer_of_measure(std::span<const Vec3> points, const MeshMeasure& measure);

}  // namespace headpin::scene
