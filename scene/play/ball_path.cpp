#include "scene/play/ball_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/play/score.h"
#include "scene/play/since.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

namespace {

constexpr double kHooked = 1.0;       // turned by this [degrees]
constexpr double kRollsAlong = 0.02;  // slip, of the speed
constexpr double kLeast = 0.1;        // slower than this, a ball has no direction [m/s]

/// The angle between two directions, in [-180, 180] degrees.
double turned_deg(double from_deg, double to_deg) {
  return std::remainder(to_deg - from_deg, 360.0);
}

/// The angle of the right triangle with these sides, in [-180, 180] degrees. The same bits on every
/// machine.
double angle_deg(double opposite, double adjacent) {
  return degrees_from_y(Vec3(opposite, adjacent, 0.0));
}

void find_hook(BallWatch& watch, const engine::State& now, double radius) {
  BallPath& path = watch.path;
  const double speed = now.v_WB.head<2>().norm(), distance = now.X_WB.p.y();
  if (speed < kLeast) return;
  const double direction = degrees_from_y(now.v_WB);
  if (!path.skid_end && std::abs(turned_deg(watch.landed_deg, direction)) >= kHooked) {
    path.skid_end = distance;
  }
  const Vec3 slip = engine::velocity_at(now, Vec3(0.0, 0.0, -radius));
  if (!path.hook_end && slip.head<2>().norm() < kRollsAlong * speed) path.hook_end = distance;
}

/// A step of a ball that falls.
struct Fall {
  double gravity, dt;  // [m/s2], [s]
  bool was_released;   // in this step: it fell for a part of it
  bool approach;  // older rules have none: a ball before the foul line could be beside the lane
};

/// Whether a ball has touched the lane in the last step: near the lane, it was held up.
bool has_touched_lane(const engine::State& last, const engine::State& now, double radius,
                      const Fall& fall) {
  constexpr double kNear = 1e-3, kOn = 1e-4;  // [m]
  constexpr double kHeldUp = 1e-6;            // [m/s]
  if (fall.was_released && last.X_WB.p.z() - radius <= kOn) return true;
  const double gained = fall.gravity * fall.dt;
  const double held_up = now.v_WB.z() - last.v_WB.z() + (fall.was_released ? 0.0 : gained);
  const double rebound = std::max(0.0, now.v_WB.z()) * fall.dt;
  return held_up > kHeldUp && now.X_WB.p.z() - radius < kNear + rebound;
}

/// Distance at which a ball touched the lane in the last step, from its fall before.
double touched_at(const engine::State& last, double radius, const Fall& fall) {
  const double height = last.X_WB.p.z() - radius, falls = -last.v_WB.z();
  if (height <= 0.0) return last.X_WB.p.y();
  const double speed = std::sqrt(falls * falls + 2.0 * fall.gravity * height);
  const double time = speed + falls > 0.0 ? 2.0 * height / (speed + falls) : fall.dt;
  return last.X_WB.p.y() + std::min(time, fall.dt) * last.v_WB.y();
}

/// Whether a ball is beside the lane, on which it lies. On the approach, nothing is.
bool is_beside(const RoomMeasures& room, const Vec3& p, const Fall& fall) {
  if (fall.approach && p.y() <= 0.0) return false;
  return std::abs(p.x()) > 0.5 * room.lane_width;
}

/// The part of the way before the skittles.
void find_on_lane(BallWatch& watch, const RoomMeasures& room, double radius, const Fall& fall,
                  const engine::State& now) {
  BallPath& path = watch.path;
  const Vec3& p = now.X_WB.p;
  if (!path.loft_end && has_touched_lane(watch.last, now, radius, fall)) {
    path.loft_end = touched_at(watch.last, radius, fall);
    watch.landed_deg = degrees_from_y(now.v_WB);
  }
  if (!path.breakpoint && watch.last.v_WB.x() * now.v_WB.x() < 0.0) {
    path.breakpoint = LanePlace{board_at(room, p.x()), p.y()};
  }
  if (!path.loft_end) return;
  find_hook(watch, now, radius);
  if (!is_beside(room, p, fall)) return;
  path.gutter = p.y();
  watch.over = true;
}

}  // namespace

double board_at(const RoomMeasures& room, double x) {
  return (0.5 * room.lane_width - x) / (room.lane_width / kBoards) + 0.5;
}

Delivered delivered(const RoomMeasures& room, const engine::State& s) {
  Delivered d;
  d.board = board_at(room, s.X_WB.p.x());
  d.angle_deg = degrees_from_y(s.v_WB);
  const Vec2 level = s.v_WB.head<2>();
  d.speed = level.norm();
  d.revs_per_min = s.w_WB.norm() * 30.0 / std::numbers::pi;
  if (d.speed <= 0.0 || s.w_WB.isZero(0.0)) return d;
  const Vec2 along = level / d.speed, right(along.y(), -along.x());
  const double ahead = -s.w_WB.head<2>().dot(right);  // rolls ahead
  const double side = -s.w_WB.head<2>().dot(along);   // hooks to the left
  if (ahead != 0.0 || side != 0.0) d.rotation_deg = angle_deg(side, ahead);
  if (std::abs(d.rotation_deg) >= 180.0) d.rotation_deg = 180.0;  // rounding goes beyond it
  d.tilt_deg = angle_deg(s.w_WB.z(), s.w_WB.head<2>().norm());
  return d;
}

BallWatch watch_ball(const RoomMeasures& room, const engine::State& release) {
  BallWatch watch;
  watch.path.release = delivered(room, release);
  watch.last = release;
  return watch;
}

void see(BallWatch& watch, const RoomMeasures& room, double radius, const engine::World& world,
         const engine::State& now, bool strikes, bool was_released) {
  if (watch.over) return;
  BallPath& path = watch.path;
  const Vec3& p = now.X_WB.p;
  if (strikes || (!path.entry && p.y() > room.head_pin)) {
    path.entry = delivered(room, watch.last);
  }
  const Fall fall{-world.parameters.gravity_W.z(), engine::step_seconds(world), was_released,
                  has_approach(world.parameters)};
  if (!path.entry) find_on_lane(watch, room, radius, fall, now);
  if (p.y() > room.deck_end) {
    if (std::abs(p.x()) <= 0.5 * room.lane_width) path.exit_board = board_at(room, p.x());
    watch.over = true;
  }
  watch.last = now;
}

}  // namespace headpin::scene
