#pragma once

#include <memory>
#include <string>

/// The bowling scene of tests/support/bowling.h in other people's engines, set fairly.
namespace headpin::bench {

struct Scene {
  int racks = 1;
  bool ball = true;
  bool sleep = false;
  double ball_offset = 0.04;  ///< [m]
};

/// An engine with a scene in it, 240 steps a second.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual void step() = 0;
  /// Skittles that lean by more than 30 degrees.
  virtual int skittles_down() const = 0;
};

// Skittles of two cylinders, an ellipsoid and a sphere, 1.5 kg; ball 7 kg at 6 m/s; lane a plane.
// Coulomb friction .3, restitution .64 between skittles and .2 on the lane where an engine has one.

/// Bullet: 10 iterations; ellipsoid as a hull of 42 corners; margins of 1 mm, breaking at 5 mm.
std::unique_ptr<Contender> make_bullet(const Scene& scene);
/// ODE: QuickStep, 20 iterations; ellipsoid as a hull of 42 corners.
std::unique_ptr<Contender> make_ode(const Scene& scene);
/// MuJoCo: Newton's method, pyramidal cones, real ellipsoids. It cannot sleep.
std::unique_ptr<Contender> make_mujoco(const Scene& scene);

}  // namespace headpin::bench
