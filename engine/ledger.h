#pragma once

#include "base/math.h"

/// Balance of energy and momentum by cause.
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

/// What each phase of the steps has added since the start. The sum is the total change.
struct Ledger {
  /// Free motion. Free bodies neither gain nor lose energy. A supported body gains the fall of one
  /// step, which `sustained` takes away again.
  Balance gravity;
  Balance hand;        ///< driven bodies, and bodies whose state or kind was set
  Balance impact;      ///< impulses between free bodies and on fixed ones: energy never above 0
  Balance sustained;   ///< lasting contacts, friction, rolling resistance, falling asleep
  Balance correction;  ///< correction of overlaps

  Balance sum() const { return gravity + hand + impact + sustained + correction; }
};

}  // namespace headpin::engine
