#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "devices/base/sample.h"
#include "devices/recordings/catalogue_csv.h"
#include "scene/scenario/scenario.h"

/// A throw made by a model of the arm, for when nobody is there to throw.
///
/// The arm swings about the shoulder from pose to pose, each time with the least jerk (Flash and
/// Hogan 1985: s = 10 t^3 - 15 t^4 + 6 t^5); hand, head and trunk tremble and sway on top. Equal
/// seeds give equal bits on every machine.
namespace headpin::scene {

/// Heights of the ball's centre from which a thrower who stoops lays it down [m].
inline constexpr double kLowestRelease = 0.12, kHighestRelease = 0.5;

struct ThrowPlan {
  std::uint64_t seed = 1;
  double speed = 6.5;  ///< of the ball as it leaves the hand [m/s]; missed by 1 % or so
  double aim = 0.0;    ///< direction of the ball, to the right of the lane [rad]; 0.3 deg
  /// Of the ball's centre as it leaves [m], level: the thrower stoops and lays it down; missed by
  /// 1 cm or so. Without it he stands, and throws it a little upward from 0.58 m.
  std::optional<double> height = {};
  double duration_s = 7.0;  ///< of it all; what follows the throw is standing still
};

/// Values passed one after the other, at rest at each.
class MinimumJerk {
 public:
  struct Key {
    double time, value;
  };
  MinimumJerk(std::initializer_list<Key> keys) : keys_(keys) {}

  double at(double time) const;

 private:
  std::vector<Key> keys_;  // by time
};

/// Where head and hands are at any time of a throw, in the world.
class ThrowMotion {
 public:
  /// @throws std::invalid_argument  for a speed outside 4..9 m/s, an aim beyond 10 degrees, a height
  ///                                outside the above, or a duration that is too short for the
  ///                                throw or beyond 10 minutes
  ThrowMotion(const ThrowPlan& plan, const Hand& hand);

  Pose head(Time time) const;       ///< X_WD
  Pose hand(Time time) const;       ///< X_WH, the right one
  Pose left_hand(Time time) const;  ///< likewise

  Time grab() const { return grab_; }        ///< in the middle of a pause
  Time release() const { return release_; }  ///< in the forward swing, at or past its lowest point
  Time duration() const { return duration_; }
  double ball_speed() const { return speed_; }  ///< at its release [m/s]

 private:
  /// A sum of three sines for each of three axes.
  struct Trembling {
    std::array<Vec3, 3> amplitude, rate, phase;  // [m or rad], [rad/s], [rad]
    Vec3 at(double time) const;
  };
  /// How arm, trunk and head are bent: one scalar each.
  struct Joints {
    MinimumJerk raise;  ///< upper and lower arm against the vertical, forward [rad]
    MinimumJerk reach;  ///< shoulder to hand [m]
    MinimumJerk aside;  ///< of the arm, to the right [rad]
    MinimumJerk lean;   ///< of the trunk, 0 to 1
    // What the head looks at: the hand, and by these shares, one above the other, something else.
    MinimumJerk to_ball;      ///< on its stand
    MinimumJerk to_lane;      ///< where the ball will come down
    MinimumJerk to_skittles;  ///< where they are in the paper's room
    MinimumJerk stoop;        ///< of the trunk, straight down [m]
  };

  static Joints joints(double forward_swing_s, double back_swing, double stoop);
  Vec3 ball_at_release(const Hand& hand) const;  ///< its velocity
  struct Swing {
    double speed, back_swing;  ///< [m/s], arm against the vertical [rad]
    double released, stoop;    ///< where the arm lets go [rad]; how far down the trunk is [m]
  };
  double swing(const Swing& wanted, const Hand& hand);
  Vec3 trunk(double t) const;
  Pose hand_in_model(double t) const;  ///< X_MH
  Vec3 looked_at(double t) const;      ///< in M

  Joints joints_;
  Trembling sway_, hand_shift_, hand_turn_, head_turn_;
  Pose X_WM_;  // M: frame the model is planned in, between the feet, y ahead, z up
  Vec3 p_HB_, p_MB_release_ = Vec3::Zero();  // of the ball in the hand
  Time grab_{}, release_{}, duration_{};
  double speed_ = 0.0;
};

/// How the tracker adds to what it measures; figures of the Fastrak's kind.
struct TrackerNoise {
  double per_range = 2e-4;  ///< standard deviation per metre from the transmitter [m/m]
  double angle = 0.025 * std::numbers::pi / 180.0;  ///< standard deviation [rad]
  Time latency{7830};  ///< 3.75 ms to the output, then 47 bytes at 115200 baud
};

/// A rig as it would be set up: transmitter behind the thrower (x ahead, y right, z down),
/// receivers on top of the helmet and on the back of the hand.
Rig synthetic_rig();

/// Sets up what a scenario leaves at its defaults as the model wants it: its own rig, and the ball
/// where the hand will be when it grabs. What the scenario says otherwise stays.
///
/// @throws std::invalid_argument  when it says to put the ball where the hand cannot reach it
void set_up(Scenario& scenario, const ThrowMotion& motion);

/// What a tracker with two receivers says of the throw: 120 measurements a second, of head and hand
/// in turn; and the trigger.
std::vector<devices::Sample> sense(const ThrowMotion& motion, const Rig& rig, std::uint64_t seed,
                                   const TrackerNoise& noise = {});

/// The throw as a head-mounted display with controllers would have recorded it, without buttons:
/// 72 samples a second, unevenly, in whole milliseconds.
devices::MotionRecording record(const ThrowMotion& motion, std::uint64_t seed);

}  // namespace headpin::scene
