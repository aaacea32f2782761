#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/compound.h"
#include "engine/friction_table.h"

/// Bodies: properties and state.
namespace headpin::engine {

/// Surface of a body. A pair's elasticity and friction are the products of the two bodies' values.
struct Material {
  double elasticity = 0.7;  ///< 0 to 1
  double friction = 0.7;    ///< 0 to 1: a rate (paper 2.2 b), or Coulomb's coefficient
  /// Rolling resistance: distance of the supporting force from the foot of the normal [m]. Those of
  /// a pair are added. Zero rolls freely; with some millimetres a body comes to rest.
  double rolling_arm = 0.0;
};

/// An area of a fixed body with a friction of its own, as oil on a lane: between it and whatever
/// touches it, in place of the product of both materials. A body that crosses the edge of an area
/// within a step has the mean of both over its way.
struct FrictionArea {
  Vec2 low, high;         ///< opposite corners, in the body's x and y [m]; without `high` itself
  double friction = 0.0;  ///< as Material::friction
};

/// Pose and velocity of a body. The origin of B is the centre of mass.
struct State {
  Pose X_WB = {};
  Vec3 v_WB = Vec3::Zero();  ///< of the centre of mass [m/s]
  Vec3 w_WB = Vec3::Zero();  ///< [rad/s]
};

/// Velocity of the point of a body that is at r from its centre of mass.
inline Vec3 velocity_at(const State& s, const Vec3& r_W) {
  return s.v_WB + s.w_WB.cross(r_W);
}

enum class Kind {
  fixed,   ///< floor, wall: never moves
  driven,  ///< moves as set, with infinite mass: a hand, a carried ball
  free,    ///< moved by forces
};

/// An immutable compound that a body shares with all its copies, so that the shape of many equal
/// bodies is in the processor's cache once.
class SharedCompound {
 public:
  SharedCompound() : SharedCompound(Compound{}) {}
  SharedCompound(Compound compound) : shared_(std::make_shared<Compound>(std::move(compound))) {}

  const Compound* operator->() const { return shared_.get(); }
  const Compound& operator*() const { return *shared_; }

 private:
  std::shared_ptr<const Compound> shared_;
};

struct Body {
  std::string name = {};            ///< for messages
  SharedCompound shape = {};        ///< in B
  double mass = 1.0;                ///< [kg]; fixed and driven bodies use it when they become free
  Mat3 inertia = Mat3::Identity();  ///< about the centre of mass, along the axes of B [kg m^2]
  Material material = {};
  Kind kind = Kind::free;
  bool exact = false;  ///< detection of what touches it converges, whatever `Query::mode` says
  std::vector<FrictionArea> areas = {};  ///< of a fixed body; of two that overlap, the first counts
  std::shared_ptr<const FrictionTable> table = {};  ///< of a fixed body; counts before its areas
};

}  // namespace headpin::engine
