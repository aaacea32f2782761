#pragma once

#include "engine/stratified_newton.h"

/// Faces, edges and vertices of a hull. A search near one of them uses it in place of the hull.
/// Private to the engine.
namespace headpin::engine {

/// The feature of a hull that is in view along n: a face, an edge or a vertex whose normals are
/// near n.
struct Feature {
  const Polyhedron::Face* face = nullptr;
  std::uint32_t from = 0, to = 0;  ///< ends of an edge; equal for a vertex
};

inline Feature in_view(const posed::Hull& hull, const Vec3& n, double near) {
  const Polyhedron& shape = *hull.shape;
  const std::uint32_t v = hull.last;
  const Vec3 n_G = hull.sign * (hull.R.transpose() * n);
  Feature f{nullptr, v, v};
  double most = 1.0 - 0.5 * near * near;
  for (const std::uint32_t k : shape.faces_at(v)) {
    const double cosine = n_G.dot(shape.faces()[k].normal);
    if (cosine > most) {
      most = cosine;
      f.face = &shape.faces()[k];
    }
  }
  double least = near;
  for (const std::uint32_t w : shape.neighbours(v)) {
    const Vec3 along = shape.vertices()[w] - shape.vertices()[v];
    const double sine = std::abs(n_G.dot(along)) / along.norm();
    if (sine < least) {
      least = sine;
      f.to = w;
    }
  }
  return f;
}

/// Whether a point of the face's plane lies in the face. If not, `beyond` gets the edge that the
/// point is furthest outside of.
inline bool in_face(const posed::Hull& hull, const Polyhedron::Face& face, const Vec3& p,
                    Feature& beyond) {
  const auto corners = hull.shape->corners(face);
  const Vec3 p_G = hull.R.transpose() * (hull.sign * p - hull.p);
  double most = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::uint32_t i = corners[k], j = corners[k + 1 < corners.size() ? k + 1 : 0];
    const Vec3& a = hull.shape->vertices()[i];
    const Vec3 along = hull.shape->vertices()[j] - a;
    const double outside = (p_G - a).dot(along.cross(face.normal)) / along.norm();
    if (outside > most) {
      most = outside;
      beyond.from = i;
      beyond.to = j;
    }
  }
  return most == 0.0;
}

template <typename F>
Descent with_feature(const posed::Hull& hull, const Feature& f, F&& descend_on) {
  if (f.from == f.to) return descend_on(posed::Point{hull.vertex(f.from)});
  return descend_on(posed::edge(hull, f.from, f.to));
}

}  // namespace headpin::engine
