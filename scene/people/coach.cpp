#include "scene/people/coach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/random.h"
#include "scene/play/ball_path.h"
#include "scene/play/player.h"

namespace headpin::scene {

namespace {

constexpr std::uint64_t kCoachedThrow = 401;  // purpose of random numbers
constexpr double kDegreeInRad = std::numbers::pi / 180.0;

/// Which number of a throw is drawn.
enum class Word : std::uint64_t { speed, revs, rotation, tilt, board, angle, loft };

double draw_one(const Wanted& wanted, std::uint64_t seed, Word word) {
  Random random(seed, kCoachedThrow, static_cast<std::uint64_t>(word));
  return wanted.mean + wanted.deviation.value_or(0.0) * random.normal();
}

double draw_one(const Wanted& wanted, std::uint64_t seed, Word word, double least, double most) {
  return std::clamp(draw_one(wanted, seed, word), least, most);
}

/// The same direction, above -180 and up to 180.
double turned_back(double degrees) {
  const double least = std::remainder(degrees, 360.0);
  return least == -180.0 ? 180.0 : least;
}

Delivered draw_spin(const CoachedThrow& wanted, std::uint64_t seed) {
  Delivered spin;
  spin.revs_per_min = draw_one(*wanted.revs_per_min, seed, Word::revs, 0.0, kMostRevs);
  spin.rotation_deg = turned_back(draw_one(wanted.rotation_deg, seed, Word::rotation));
  spin.tilt_deg = draw_one(wanted.tilt_deg, seed, Word::tilt, -90.0, 90.0);
  return spin;
}

constexpr double kBeforeLine = 0.05;  // a coached ball leaves so far before the foul line [m]

/// Height from which a ball that leaves level, before the line, first touches the lane so far beyond
/// it.
double height_for(double loft, double speed, const Scenario& scenario) {
  const double time = (kBeforeLine + loft) / speed;
  const double height = scenario.ball.radius + 0.5 * scenario.collision.gravity * time * time;
  if (height >= kLowestRelease && height <= kHighestRelease) return height;
  throw std::invalid_argument(
      fmt::format("loft: expected that of a ball released {} to {} m up, found {:.3g} m: at "
                  "{:.3g} m/s the ball would have to be {:.3g} m up",
                  kLowestRelease, kHighestRelease, loft, speed, height));
}

}  // namespace

TriedThrow draw(const CoachedThrow& wanted, ThrowPlan plan, const Scenario& scenario) {
  const std::uint64_t seed = plan.seed;
  if (wanted.speed) {
    plan.speed = draw_one(*wanted.speed, seed, Word::speed, kSlowestPlan, kFastestPlan);
    if (wanted.speed->deviation) plan.errors.speed = 0.0;
  }
  if (wanted.angle_deg) {
    const double most = kWidestAim_deg;
    plan.aim = kDegreeInRad * draw_one(*wanted.angle_deg, seed, Word::angle, -most, most);
    if (wanted.angle_deg->deviation) plan.errors.aim = 0.0;
  }
  if (wanted.board || wanted.loft) {
    constexpr double kMiddle = 0.5 * (kBoards + 1);
    const double board =
        draw_one(wanted.board.value_or(Wanted{kMiddle}), seed, Word::board, 1.0, kBoards);
    plan.p_WB = Vec2((kMiddle - board) * scenario.lane.width / kBoards, -kBeforeLine);
  }
  if (wanted.loft) {
    const double loft = draw_one(*wanted.loft, seed, Word::loft, 0.0, kFurthestLoft);
    plan.height = height_for(loft, plan.speed, scenario);
    plan.errors.height = 0.0;
  }
  TriedThrow tried{plan, std::nullopt};
  if (wanted.revs_per_min) tried.spin = draw_spin(wanted, seed);
  return tried;
}

Vec3 fingers_spin(const ThrowMotion& motion, const Hand& hand, const Delivered& spin) {
  const Twist released = motion.ball_and_hand(hand);
  const Vec2 along = released.v.head<2>().normalized(), right(along.y(), -along.x());
  const SinCos turned = sin_cos(spin.rotation_deg * kDegreeInRad);
  const SinCos tilted = sin_cos(spin.tilt_deg * kDegreeInRad);
  const Vec2 level = -tilted.cos * (turned.cos * right + turned.sin * along);
  const double rate = spin.revs_per_min * std::numbers::pi / 30.0;
  const Vec3 w_WB = rate * Vec3(level.x(), level.y(), tilted.sin);
  return motion.hand(motion.release()).q.conjugate() * (w_WB - released.w);
}

Delivered delivered_by(const ThrowMotion& motion, const Scenario& scenario) {
  const Pose X_WH = motion.hand(motion.release());
  const Twist released = motion.ball_and_hand(scenario.hand);
  engine::State ball;
  ball.X_WB.p = X_WH * scenario.hand.grip;
  ball.v_WB = released.v;
  ball.w_WB = released.w + X_WH.q * scenario.hand.spin;
  ball = changed(ball, scenario.release, scenario.lane.width / kBoards);
  return delivered(room_measures(scenario), ball);
}

}  // namespace headpin::scene
