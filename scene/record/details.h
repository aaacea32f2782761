#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scene/record/trial.h"

/// The details of events as data. An event itself has them as text, as a trial stores it; these
/// functions write it and read it, and nothing else does. Values that a text does not have, as in
/// older or damaged trials, are not there.
namespace headpin::scene {

/// How the velocity of a hand at a time is known.
enum class Known {
  tracked,       ///< there are samples before and after
  extrapolated,  ///< the motion is extrapolated from the nearest sample
  impossible     ///< no plausible sample is near enough
};

/// "tracked", "extrapolated", "impossible".
std::string_view name_of(Known known);

struct Motion {
  Twist V_WB;  ///< [m/s], [rad/s]; zero if impossible
  Known known = Known::impossible;
  Time extrapolated{};  ///< time of the extrapolation
  int left_out = 0;     ///< samples that disagree with the others
};

/// "tracked"; "extrapolated by 12 ms, 1 sample left out".
std::string in_words(const Motion& motion);

/// What set a skittle in motion.
enum class By : std::uint8_t {
  nobody,
  ball,  ///< one that was thrown
  hand   ///< or what it carries
};

/// Of a release: when, where and how the body left the hand.
struct Released {
  std::optional<double> trigger_s;       ///< time of the trigger, from its device
  std::optional<Vec3> p_WB, v_WB, w_WB;  ///< [m], [m/s], [rad/s]
  std::optional<Known> known;            ///< how its velocity is known
  std::optional<Time> extrapolated;
  std::optional<int> left_out;
  std::string other_known = {};  ///< the word in place of a Known, which is then `impossible`
};
/// How its velocity is known, in the word of the text; empty where nothing tells.
std::string known_word(const Released& released);
std::string to_detail(const Released& released);
Released released(const Event& event);

/// Puts a motion in place of the velocities, and says how it is known.
void set_motion(Released& released, const Motion& motion);
/// Nothing unless the event has all of it.
std::optional<Motion> motion_of(const Event& event);

/// Of a first contact: the velocity of the ball just before it [m/s].
std::string contact_detail(const Vec3& v_WB);
std::optional<Vec3> contact_velocity(const Event& event);

// The way of a thrown ball, in the words of coaches. Boards count from the right gutter, 1 to 39; 20 is
// the middle of the lane. Distances are from the foul line [m], angles to the right of the lane's axis.

/// How a ball moves at a place.
struct Delivered {
  double board = 0.0;         ///< of its centre
  double angle_deg = 0.0;     ///< of its level velocity
  double speed = 0.0;         ///< level [m/s]
  double revs_per_min = 0.0;  ///< of its spin about any axis
  /// Of the spin's level part: 0 rolls ahead, 90 hooks to the left with all of it, -90 to the right.
  double rotation_deg = 0.0;
  double tilt_deg = 0.0;  ///< of the spin's axis out of the level: 90 spins like a top
};

/// A place on the lane.
struct LanePlace {
  double board = 0.0, distance = 0.0;
};

/// What is not there did not happen.
struct BallPath {
  Delivered release;
  std::optional<double> loft_end;  ///< distance at which it first touches the lane
  /// Distance at which its direction has changed by a degree since then: until here it skids, and
  /// then hooks.
  std::optional<double> skid_end;
  /// Distance at which its lowest point slips by less than a fiftieth of its speed: from here it rolls.
  std::optional<double> hook_end;
  std::optional<LanePlace> breakpoint;  ///< where its velocity turns to the other side of the lane
  std::optional<Delivered> entry;    ///< before its first skittle, or where it passes the head pin
  std::optional<double> exit_board;  ///< where it leaves the lane behind the skittles
  std::optional<double> gutter;      ///< distance at which it leaves the lane sideways
};
std::string to_detail(const BallPath& path);
/// Nothing unless the event has a release.
std::optional<BallPath> ball_path(const Event& event);

/// Of a skittle that fell: its cause.
std::string to_detail(By by);
By felled_by(const Event& event);

/// Of a live session that ended: how well it kept up with real time.
struct KeptPace {
  std::int64_t ticks = 0, overruns = 0;
  std::int64_t frames = 0, late_frames = 0, drawing_failures = 0;
};
std::string to_detail(const KeptPace& pace);
KeptPace kept_pace(const Event& event);

}  // namespace headpin::scene
