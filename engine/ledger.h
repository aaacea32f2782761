#pragma once

#include "engine/math.h"

/// Where energy and momentum come from and go to.
namespace headpin::engine {

/// Energy (kinetic and of height) [J], momentum [kg m/s] and angular momentum about the origin of W
/// [kg m^2/s] of the free bodies.
struct Balance {
  double energy = 0.0;
  Vec3 momentum = Vec3::Zero();
  Vec3 angular_momentum = Vec3::Zero();

  Balance& operator+=(const Balance& other) {
    energy += other.energy;
    momentum += other.momentum;
    angular_momentum += other.angular_momentum;
    return *this;
  }
  Balance operator-(const Balance& other) const {
    return {energy - other.energy, momentum - other.momentum,
            angular_momentum - other.angular_momentum};
  }
  Balance operator+(const Balance& other) const { return Balance(*this) += other; }
};

/// What each phase has added since the start; their sum is the change of the whole.
struct Ledger {
  /// Free motion. A free body neither gains nor loses here; one that is carried gains the fall of a
  /// step, which `sustained` takes away again.
  Balance gravity;
  Balance hand;        ///< driven bodies, and bodies that were put, thrown, taken or let go
  Balance impact;      ///< impulses between free bodies and on what is fixed: energy never above 0
  Balance sustained;   ///< lasting contacts, friction, rolling resistance, falling asleep
  Balance correction;  ///< pushing overlaps apart

  Balance sum() const { return gravity + hand + impact + sustained + correction; }
};

}  // namespace headpin::engine
