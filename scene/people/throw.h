#pragma once

#include <string>
#include <vector>

#include "devices/base/sample.h"
#include "devices/recordings/catalogue_csv.h"
#include "scene/scenario/scenario.h"

/// A throw in a recording that has no buttons: whether it is one, where it begins and ends, and how
/// it is stood at the foul line.
///
/// T is the frame of the recording: y up, the floor at y = 0.
namespace headpin::scene {

enum class Side { left, right };

/// Where in a recording the ball is taken and let go, and by which hand.
struct Throw {
  Side side = Side::right;
  std::size_t grab = 0;          ///< sample at which the hand rests lowest before the swing
  std::size_t release = 0;       ///< sample at which the hand rises out of the bottom of its swing
  double peak_hand_speed = 0.0;  ///< between neighbours of a sample [m/s]
  Twist V_TB;                    ///< of the ball as it leaves the hand
};

/// The hand that throws.
const std::vector<Pose>& throwing_hand(const devices::MotionRecording& recording, Side side);

/// Finds the throw of a hand.
///
/// The ball is laid down at the bottom of the swing: it leaves with the first sample at which the
/// hand rises again, just before its forward speed peaks; at the peak itself when the hand does not
/// fall within 0.2 s before.
///
/// @throws std::invalid_argument  with fewer than ten samples
Throw find_throw(const devices::MotionRecording& recording, const Hand& hand,
                 Side side = Side::right);

/// What a body does not allow: each a sentence with what was found and what was expected; none for
/// a person's throw.
///
/// Looks at length and rate, height and uprightness of the head, reach and speed of the hands, the
/// head looking along the throw, the throwing hand on its side.
std::vector<std::string> why_no_throw(const devices::MotionRecording& recording, const Hand& hand,
                                      Side side = Side::right);

/// What makes the release of a throw less sure: few samples a second, long gaps. Sentences, none
/// for a good recording.
std::vector<std::string> doubts(const devices::MotionRecording& recording);

/// The throws of a recording, one after the other: each from where the one before has swung out.
/// The times of each begin at 0. As it is, where there is only one.
std::vector<devices::MotionRecording> split_throws(const devices::MotionRecording& recording,
                                                   Side side);

/// The hand by which it is a person's throw; without one, that which is faster.
Side throwing_side(const devices::MotionRecording& recording, const Hand& hand);

/// Refuses what cannot be a person's throw.
///
/// Where the recording would be one after a single common mistake is undone (unit, axis, order of
/// the quaternion, scale of time, the other hand), the message says which.
///
/// @param where  name of the file, for the message
/// @throws std::invalid_argument
void require_throw(const devices::MotionRecording& recording, const Hand& hand,
                   const std::string& where, Side side = Side::right);

enum class Heading {
  release,  ///< the ball leaves straight down the lane
  gaze,     ///< the head looks straight down the lane in the second before
  keep      ///< -z of the recording is down the lane
};

/// Stands the thrower in the world, by the rig alone.
///
/// The ball's centre is over the middle of the foul line when it is let go, the recording's floor
/// is the lane, the stand holds the ball where the hand takes it. Poses are read 28 ms late, so
/// that there is always a sample on both sides of uneven ones.
Scenario stand_thrower(Scenario scenario, const devices::MotionRecording& recording,
                       const Throw& found, Heading heading);

/// The recording as device samples, in order of time: head, throwing and other hand as stations 1,
/// 2 and 3, and the trigger, down from grab to release.
std::vector<devices::Sample> to_samples(const devices::MotionRecording& recording,
                                        const Throw& found);

}  // namespace headpin::scene
