#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scene/play/game.h"
#include "scene/play/release.h"

/// The details of events as data. An event itself has them as text, as a trial stores it; these
/// functions write it and read it, and nothing else does. Values that a text does not have, as in
/// older or damaged trials, are not there.
namespace headpin::scene {

/// Of a release: when, where and how the body left the hand.
struct Released {
  std::optional<double> trigger_s;       ///< time of the trigger, from its device
  std::optional<Vec3> p_WB, v_WB, w_WB;  ///< [m], [m/s], [rad/s]
  std::optional<Known> known;            ///< how its velocity is known
  std::optional<Time> extrapolated;
  std::optional<int> left_out;
};
std::string to_detail(const Released& released);
Released released(const devices::Event& event);

/// Puts a motion in place of the velocities, and says how it is known.
void set_motion(Released& released, const Motion& motion);
/// Nothing unless the event has all of it.
std::optional<Motion> motion_of(const devices::Event& event);

/// Of a first contact: the velocity of the ball just before it [m/s].
std::string contact_detail(const Vec3& v_WB);
std::optional<Vec3> contact_velocity(const devices::Event& event);

/// Of a skittle that fell: its cause.
std::string to_detail(By by);
By felled_by(const devices::Event& event);

/// Of a live session that ended: how well it kept up with real time.
struct KeptPace {
  std::int64_t ticks = 0, overruns = 0;
  std::int64_t frames = 0, late_frames = 0, drawing_failures = 0;
};
std::string to_detail(const KeptPace& pace);
KeptPace kept_pace(const devices::Event& event);

}  // namespace headpin::scene
