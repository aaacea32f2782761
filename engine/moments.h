#pragma once

#include <numbers>
#include <stdexcept>

#include "engine/compound.h"

/// Moments of the shapes in closed form, and their mass properties. Private to the engine.
namespace headpin::engine {

/// Height of the part's furthest point along `n`, signed [m].
inline double top(const Part& part, const Vec3& n) {
  return n.dot(part.X_BG * support(part.shape, part.X_BG.q.conjugate() * n));
}

/// Volume and its first and second moments about the origin: all that mass properties need.
struct Moments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();   // integral of x
  Mat3 second = Mat3::Zero();  // integral of x x'

  void add(const Moments& m, const Pose& X) {
    const Mat3 R = X.q.toRotationMatrix();
    const Vec3 turned = R * m.first;
    first += turned + m.volume * X.p;
    second += R * m.second * R.transpose() + turned * X.p.transpose() + X.p * turned.transpose() +
              m.volume * X.p * X.p.transpose();
    volume += m.volume;
  }
};

inline MassProperties weigh(const Moments& m, double density) {
  MassProperties p;
  p.mass = density * m.volume;
  p.centre = m.first / m.volume;
  const Mat3 about = m.second - m.volume * p.centre * p.centre.transpose();
  p.inertia = density * (about.trace() * Mat3::Identity() - about);
  return p;
}

inline Moments moments(const Ellipsoid& s) {
  Moments m;
  m.volume = 4.0 / 3.0 * std::numbers::pi * s.radii.prod();
  m.second = (m.volume / 5.0 * s.radii.cwiseProduct(s.radii)).asDiagonal();
  return m;
}

inline Moments moments(const Cylinder& s) {
  const double r2 = s.radius * s.radius, h2 = s.half_height * s.half_height;
  Moments m;
  m.volume = 2.0 * std::numbers::pi * r2 * s.half_height;
  m.second = (m.volume * Vec3(r2 / 4.0, r2 / 4.0, h2 / 3.0)).asDiagonal();
  return m;
}

inline Moments moments(const Cone& s) {
  const double r2 = s.radius * s.radius, h = s.height;
  Moments m;
  m.volume = std::numbers::pi / 3.0 * r2 * h;
  m.first = {0.0, 0.0, -0.25 * h * m.volume};
  // Along z: 3/80 h^2 about the centre, which is h/4 below the middle.
  m.second = (m.volume * Vec3(0.15 * r2, 0.15 * r2, 0.1 * h * h)).asDiagonal();
  return m;
}

inline Moments moments(const Polyhedron& s) {
  Moments m;
  for (const Polyhedron::Face& face : s.faces()) {
    const auto c = s.corners(face);
    const Vec3 a = s.vertices()[c[0]] - s.centre();
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      const Vec3 u = s.vertices()[c[k]] - s.centre(), v = s.vertices()[c[k + 1]] - s.centre();
      // Tetrahedron with a corner at the centre.
      const double volume = a.dot(u.cross(v)) / 6.0;
      const Vec3 sum = a + u + v;
      m.volume += volume;
      m.first += volume / 4.0 * sum;
      m.second +=
          volume / 20.0 *
          (a * a.transpose() + u * u.transpose() + v * v.transpose() + sum * sum.transpose());
    }
  }
  Moments moved;
  moved.add(m, {Quat::Identity(), s.centre()});
  return moved;
}

inline Moments moments(const HalfSpace&) {
  throw std::invalid_argument("mass_properties: a half-space has no mass");
}

}  // namespace headpin::engine
