#pragma once

#include <memory>
#include <vector>

#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>

#include "engine/shape.h"

namespace headpin::engine::test {

/// The same shape for FCL.
inline std::shared_ptr<fcl::CollisionGeometryd> to_fcl(const Shape& shape) {
  if (const auto* e = std::get_if<Ellipsoid>(&shape)) {
    return std::make_shared<fcl::Ellipsoidd>(e->radii.x(), e->radii.y(), e->radii.z());
  }
  if (const auto* c = std::get_if<Cylinder>(&shape)) {
    return std::make_shared<fcl::Cylinderd>(c->radius, 2.0 * c->half_height);
  }
  if (const auto* k = std::get_if<Cone>(&shape)) {
    return std::make_shared<fcl::Coned>(k->radius, k->height);
  }
  const Polyhedron& p = std::get<Polyhedron>(shape);
  auto vertices = std::make_shared<std::vector<Vec3>>(p.vertices().begin(), p.vertices().end());
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polyhedron::Face& f : p.faces()) {
    faces->push_back(static_cast<int>(f.count));
    for (const std::uint32_t i : p.corners(f)) faces->push_back(static_cast<int>(i));
  }
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(p.faces().size()), faces);
}

}  // namespace headpin::engine::test
