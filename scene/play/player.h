#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "devices/base/resample.h"
#include "scene/play/tick.h"
#include "scene/play/walk.h"
#include "scene/stage/stage.h"

/// The player: poses of head and hand, and the body in the hand.
namespace headpin::scene {

/// A body in the hand.
struct Held {
  engine::BodyId body = 0;
  Quat q_HB = Quat::Identity();  ///< its orientation in the hand since the grab
};

/// Velocities of the hand at the times of ticks, each found once for all sessions with the same samples, walk, rig
/// and hand.
class HandVelocities {
 public:
  /// V_WH at a time; by `find` where no session has asked for it yet.
  template <typename F>
  Twist at(Time time, F&& find) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = known_.find(time); known != known_.end()) return known->second;
    }
    const Twist found = find();
    const std::lock_guard lock(mutex_);
    known_.emplace(time, found);
    return found;
  }

 private:
  std::mutex mutex_;
  std::map<Time, Twist> known_;
};

/// The state of the player, from the samples.
struct Player {
  Walk walk;                                     ///< X_WP, from walking with the thumb buttons
  devices::PoseTrack head;                       ///< X_PD: display, x right, y up, looking along -z
  devices::PoseTrack hand;                       ///< X_PH
  std::optional<Time> head_arrival;              ///< of its newest sample
  std::vector<devices::MouseSample> buttons;     ///< not processed yet, oldest first
  bool left_thumb = false, right_thumb = false;  ///< walk forward, walk backward
  bool trigger = false;
  std::optional<Held> held;
  std::optional<Time> grip_changed;       ///< tick of the last grab or release
  std::optional<engine::BodyId> leaving;  ///< body that was released and still touches the hand
  ReleaseChange release_change;           ///< of every release, after that of the scenario
  /// Null, or shared by sessions with the same samples.
  std::shared_ptr<HandVelocities> velocities;
};

/// X_PS: pose of a sensor in the tracked space, which is the world until the player walks.
///
/// @throws std::runtime_error  for a sample in a frame other than T and P, naming it
Pose sensor_in_space(const devices::TrackerSample& sample, const Rig& rig);

/// Whether nothing has shown for too long where the hand is: it is nowhere, and what it holds stays
/// where it is.
///
/// @param now  time of the poses, `rig.delay_s` before the tick
bool hand_is_away(const Player& player, const Rig& rig, Time now);

/// X_PH, unless the hand is away or was never seen.
///
/// @param now  as above
std::optional<Pose> present_hand(const Player& player, const Rig& rig, Time now);

/// Takes the new samples and walks for a tick; drive() does this first. It needs no world. Buttons
/// stay in the player.
///
/// @param now      time of the poses, `rig.delay_s` before the tick
/// @throws std::runtime_error  as sensor_in_space
void follow(Player& player, std::span<const devices::Sample> samples, const Scenario& scenario,
            Time now);

/// Removes the buttons up to `now`, and old poses.
void forget(Player& player, Time now);

/// A ball that leaves the hand with a change.
///
/// @param board  width of a board of the lane [m]
engine::State changed(engine::State state, const ReleaseChange& by, double board);

/// Moves head and hand by the samples, and obeys the buttons: walk, grab, carry, release.
///
/// Poses are those of `rig.delay_s` before now; a ball that was released between two ticks flies
/// from then on. A carried body stays outside of fixed bodies when the hand moves through the lane
/// or a wall. A solid hand pushes what it touches, except while it carries a body, and until that
/// body is clear of the hand again. A sample whose position is estimated does not move the hand.
///
/// @param samples  samples that became known at this tick
/// @throws std::runtime_error  as sensor_in_space
void drive(Player& player, std::span<const devices::Sample> samples, const Tick& tick);

}  // namespace headpin::scene
