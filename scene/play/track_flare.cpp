#include "scene/play/track_flare.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/play/score.h"

namespace headpin::scene {

namespace {

constexpr double kRadian = std::numbers::pi / 180.0;

/// The angle of the right triangle with these sides [rad]. The same bits on every machine.
double angle_rad(double opposite, double adjacent) {
  return kRadian * degrees_from_y(Vec3(opposite, adjacent, 0.0));
}

/// From the axis of a ring to the circle, seen from the ball's centre [rad].
double opening(const OilRing& ring) {
  return angle_rad(std::sqrt(std::max(0.0, 1.0 - ring.height * ring.height)), ring.height);
}

void begin_revolution(OilRings& rings) {
  rings.begin_B.reset();
  rings.last_B = rings.area_B = rings.sum_B = Vec3::Zero();
  rings.places = 0;
  rings.turned = 0.0;
}

/// The ring of the places of a revolution; nothing if they are no circle.
std::optional<OilRing> ring_of(const OilRings& rings) {
  const Vec3 closed_B = rings.area_B + rings.last_B.cross(*rings.begin_B);
  const double area = closed_B.norm();
  if (!(area > 0.0)) return std::nullopt;
  const Vec3 n_B = closed_B / area;
  return OilRing{n_B, n_B.dot(rings.sum_B) / static_cast<double>(rings.places)};
}

}  // namespace

double rings_apart(const OilRing& a, const OilRing& b, double radius) {
  const double axes = angle_rad(a.n_B.cross(b.n_B).norm(), a.n_B.dot(b.n_B));
  return radius * (axes + std::abs(opening(a) - opening(b)));
}

void add_contact(OilRings& rings, const engine::State& now, bool leaves_oil, double radius,
                 double dt) {
  rings.newest.reset();
  if (!leaves_oil) return begin_revolution(rings);
  const Vec3 p_B = now.X_WB.q.conjugate() * Vec3(0.0, 0.0, -1.0);
  if (rings.begin_B) rings.area_B += rings.last_B.cross(p_B);
  if (!rings.begin_B) rings.begin_B = p_B;
  rings.last_B = p_B;
  rings.sum_B += p_B;
  ++rings.places;
  rings.turned += now.w_WB.norm() * dt;
  if (rings.turned < 2.0 * std::numbers::pi) return;
  rings.newest = ring_of(rings);
  begin_revolution(rings);
  if (!rings.newest) return;
  if (!rings.first) {
    rings.first = rings.newest;
  } else {
    rings.flare =
        std::max(rings.flare.value_or(0.0), rings_apart(*rings.first, *rings.newest, radius));
  }
}

bool leaves_rings(const RoomMeasures& room, const Vec3& p_WB) {
  const Vec3& p = p_WB;
  const bool before = p.y() > 0.0 && p.y() < room.deck_begin();
  if (room.oil.empty()) return before && std::abs(p.x()) <= 0.5 * room.lane_width;
  return std::ranges::any_of(room.oil, [&](const OiledArea& oil) {
    return oil.friction < room.dry && p.x() >= oil.low.x() && p.x() < oil.high.x() &&
           p.y() >= oil.low.y() && p.y() < oil.high.y();
  });
}

}  // namespace headpin::scene
