#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "devices/base/sample.h"
#include "devices/recordings/motion_recording.h"
#include "scene/scenario/scenario.h"

/// A throw by a model of the arm, without a person.
///
/// The arm swings about the shoulder from pose to pose with minimum jerk (Flash and Hogan 1985: s =
/// 10 t^3 - 15 t^4 + 6 t^5); tremor and sway of hand, head and trunk are added. Equal seeds give
/// equal bits on every computer.
namespace headpin::scene {

/// Range of heights of the ball's centre at the release of a thrower who bends down [m].
inline constexpr double kLowestRelease = 0.06, kHighestRelease = 0.5;
inline constexpr double kSlowestPlan = 4.0, kFastestPlan = 9.0;  ///< speeds of the ball [m/s]
inline constexpr double kWidestAim_deg = 10.0;                   ///< to each side

/// How far a thrower misses the plan: standard deviations.
struct ThrowErrors {
  double speed = 0.01;                            ///< of the speed
  double aim = 0.3 * (std::numbers::pi / 180.0);  ///< [rad]
  double height = 0.01;                           ///< [m]
};

struct ThrowPlan {
  std::uint64_t seed = 1;
  double speed = 6.5;  ///< of the ball at its release [m/s]
  double aim = 0.0;    ///< direction of the ball, to the right of the lane's axis [rad]
  /// Where the ball is at its release, seen from above [m]. Without it, it is over the middle of the
  /// foul line, to about a centimetre.
  std::optional<Vec2> p_WB = {};
  /// Height of the ball's centre at its release with a level velocity [m]: the thrower bends down.
  /// Without it the thrower stands upright, and releases the ball slightly upward from 0.58 m.
  std::optional<double> height = {};
  double duration_s = 7.0;  ///< total duration; after the throw the thrower stands still
  ThrowErrors errors = {};
};

/// Values that are reached one after the other, with a rest at each.
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

/// Poses of head and hands at any time of a throw, in the world.
class ThrowMotion {
 public:
  /// @throws std::invalid_argument  for a speed outside 4..9 m/s, an aim beyond 10 degrees, a
  ///                                height outside that range, or a duration that is too short for
  ///                                the throw or above 10 minutes
  ThrowMotion(const ThrowPlan& plan, const Hand& hand);

  Pose head(Time time) const;       ///< X_WD
  Pose hand(Time time) const;       ///< X_WH, the right one
  Pose left_hand(Time time) const;  ///< likewise

  Time grab() const { return grab_; }        ///< in the middle of a pause
  Time release() const { return release_; }  ///< in the forward swing, at or past its lowest point
  Time duration() const { return duration_; }
  double ball_speed() const { return speed_; }  ///< at its release [m/s]

  /// Velocity of the ball and angular velocity of the hand at the release, in the world.
  Twist ball_and_hand(const Hand& hand) const;

 private:
  /// A sum of three sines for each of three axes.
  struct Trembling {
    std::array<Vec3, 3> amplitude, rate, phase;  // [m or rad], [rad/s], [rad]
    Vec3 at(double time) const;
  };
  /// The posture: one number for each joint.
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
  struct WantedRelease {
    double speed, back_swing;  ///< [m/s], arm against the vertical [rad]
    /// Angle of the arm at the release [rad]; how far the trunk is lowered [m].
    double released, stoop;
  };
  double fit_joints(const WantedRelease& wanted, const Hand& hand);
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

/// Noise and latency of the tracker, as for a Fastrak.
struct TrackerNoise {
  double per_range = 2e-4;  ///< standard deviation per metre from the transmitter [m/m]
  double angle = 0.025 * std::numbers::pi / 180.0;  ///< standard deviation [rad]
  Time latency{7830};  ///< 3.75 ms to the output, then 47 bytes at 115200 baud
};

/// A usual rig: the transmitter is behind the thrower (x ahead, y right, z down), the receivers are
/// on top of the helmet and on the back of the hand.
Rig synthetic_rig();

/// Replaces default values of a scenario by those of the model: its rig, and the place of the ball
/// where the hand grabs it. Other values of the scenario stay.
///
/// @throws std::invalid_argument  when the scenario's place of the ball is out of reach
void set_up(Scenario& scenario, const ThrowMotion& motion);

/// The samples of a tracker with two receivers: 120 measurements per second, of head and hand in
/// turn; and the trigger.
std::vector<devices::Sample> sense(const ThrowMotion& motion, const Rig& rig, std::uint64_t seed,
                                   const TrackerNoise& noise = {});

/// The throw as a recording of a head-mounted display with controllers, without buttons: 72 samples
/// per second, at uneven times in whole milliseconds.
devices::MotionRecording record(const ThrowMotion& motion, std::uint64_t seed);

}  // namespace headpin::scene
