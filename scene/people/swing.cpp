#include "scene/people/swing.h"

#include <algorithm>
#include <cmath>

namespace headpin::scene {

Swing plan_swing(const Build& build, const Hand& hand, const Posture& stands, const Vec3& target_P,
                 double speed, double height, double lean) {
  constexpr double kBack = -1.2, kUpward = 0.02, kStretched = 0.97;
  Swing swing;
  const double long_way = kStretched * build.arm() - hand.grip.z(), across = -hand.grip.y();
  const double radius = std::sqrt(long_way * long_way + across * across);
  Posture released = stands;
  released.lean = lean;
  released.aside = 0.0;
  released.crouch = 0.0;
  released.reach = kStretched * build.arm();
  released.raise = kUpward - direction(long_way, across);
  released.crouch =
      std::clamp((palm(build, released) * hand.grip).z() - height, 0.0, build.deepest_crouch());
  for (int i = 0; i < 4; ++i) {  // the shoulder turns with the aim
    const Vec3 way = target_P - palm(build, released) * hand.grip;
    released.facing = direction(way.y(), -way.x());
  }
  swing.back = released;
  swing.back.raise = kBack;
  const double share = (released.raise - kBack) / (swing.through - kBack);
  double low = 0.0, high = 1.0;  // part of the time after which the arm is there
  for (int i = 0; i < 50; ++i) {
    const double s = 0.5 * (low + high);
    (s * s * s * (10.0 + s * (-15.0 + 6.0 * s)) < share ? low : high) = s;
  }
  const double rate = 30.0 * low * low * (1.0 - low) * (1.0 - low);
  swing.forward_s = (swing.through - kBack) * rate * radius / speed;
  swing.release_s = low * swing.forward_s;
  swing.ready = stands;
  swing.ready.facing = released.facing;
  swing.ready.lean = 0.1;
  swing.ready.raise = 1.0;
  swing.ready.aside = 0.0;
  swing.ready.reach = 0.7 * build.arm();
  return swing;
}

}  // namespace headpin::scene
