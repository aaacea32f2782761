#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "devices/base/sample.h"
#include "devices/recordings/motion_recording.h"
#include "scene/scenario/scenario.h"

/// Throws in recordings without buttons: finding grab and release, checking that it is a person's
/// throw, and placing it at the foul line.
///
/// T is the frame of the recording: y up, the floor at y = 0.
namespace headpin::scene {

enum class Side { left, right };

/// Grab and release in a recording, and the hand that throws.
struct Throw {
  Side side = Side::right;
  std::size_t grab = 0;     ///< sample at which the hand rests lowest before the swing
  std::size_t release = 0;  ///< sample at which the hand rises out of the bottom of its swing
  Time grab_time{};         ///< of that sample, or when the trigger was pressed
  Time release_time{};
  bool by_trigger = false;  ///< the recording has a trigger: samples are the last before its times
  double peak_hand_speed = 0.0;  ///< between neighbours of a sample [m/s]
  Twist V_TB;                    ///< velocity of the ball at its release
};

/// The hand that throws.
const std::vector<Pose>& throwing_hand(const devices::MotionRecording& recording, Side side);

/// Finds the throw of a hand. A trigger says grab and release; of several presses, the one that ends
/// nearest to the fastest level motion. Without a trigger they are found in the motion:
///
/// The release is at the bottom of the swing: at the first sample at which the hand rises again,
/// just before its highest forward speed; at the highest speed itself if the hand does not fall in
/// the 0.2 s before.
///
/// @throws std::invalid_argument  with fewer than ten samples
Throw find_throw(const devices::MotionRecording& recording, const Hand& hand,
                 Side side = Side::right);

/// The reasons why a recording is not a person's throw: sentences with what was found and what was
/// expected. Empty for a person's throw.
///
/// Checks length and rate, height and tilt of the head, reach and speed of the hands, the direction
/// of the gaze, and the side of the throwing hand.
std::vector<std::string> why_no_throw(const devices::MotionRecording& recording, const Hand& hand,
                                      Side side = Side::right);

/// Reasons why the release is less accurate: a low sample rate, long gaps, repeated poses. Sentences; empty for a
/// good recording.
std::vector<std::string> doubts(const devices::MotionRecording& recording);

/// Splits a recording into its throws; each begins after the follow-through of the one before. The
/// times of each begin at 0. A recording with one throw is returned unchanged.
std::vector<devices::MotionRecording> split_throws(const devices::MotionRecording& recording,
                                                   Side side);

/// The hand with which the recording is a person's throw; or else the faster hand.
Side throwing_side(const devices::MotionRecording& recording, const Hand& hand);

/// A recording of which the rotation of the head was not measured, with a head that looks level along
/// the throw. Others are returned unchanged.
devices::MotionRecording looking_along(devices::MotionRecording recording, const Hand& hand,
                                       Side side);

/// A recording that cannot be a person's throw.
struct NoThrow : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
  /// How the file's numbers would be a person's throw, if there is such a way.
  std::optional<devices::Reading> would_be = {};
};

/// Throws an exception if the recording cannot be a person's throw.
///
/// If it would be one with other units, axes, times or quaternions, or by the other hand, the message
/// says so.
///
/// @param where  name of the file, for the message
/// @throws NoThrow
void require_throw(const devices::MotionRecording& recording, const Hand& hand,
                   const std::string& where, Side side = Side::right);

/// How the file's numbers would be a person's throw: one change of unit, of time, of the quaternion's
/// order, of axes (of positions and rotations, or of one of them), or of unit and axes together.
/// @param what  in words, such as "in centimetres"
std::optional<devices::Reading> reading_of_a_throw(const devices::MotionRecording& recording,
                                                   const Hand& hand, Side side, std::string& what);

/// A reading in other axes, units and so on, of the same recording.
devices::MotionRecording read_again(devices::MotionRecording recording,
                                    const devices::Reading& reading);

enum class Heading {
  release,  ///< the ball leaves straight down the lane
  gaze,     ///< the head looks straight down the lane in the second before
  keep      ///< -z of the recording is down the lane
};

/// Places the thrower in the world, by changing only the rig.
///
/// At the release, the ball's centre is above the middle of the foul line. The recording's floor is
/// the lane, and the ball's stand is where the hand grabs the ball. Poses are read 28 ms late, so
/// that there are samples before and after them even at an uneven rate.
Scenario stand_thrower(Scenario scenario, const devices::MotionRecording& recording,
                       const Throw& found, Heading heading);

/// Places a person who was recorded without hands: the first sample of the head is above the middle of
/// the foul line. The ball stays where the scenario has it.
/// @param heading  gaze, of the head's first second, or keep
Scenario stand_onlooker(Scenario scenario, const devices::MotionRecording& recording,
                        Heading heading);

/// The recording as device samples, in order of time: head, throwing and other hand as stations 1,
/// 2 and 3, and the trigger, down from grab to release.
std::vector<devices::Sample> to_samples(const devices::MotionRecording& recording,
                                        const Throw& found);
/// The same of a recording without hands: the head alone.
std::vector<devices::Sample> head_samples(const devices::MotionRecording& recording);

}  // namespace headpin::scene
