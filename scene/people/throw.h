#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "devices/base/sample.h"
#include "devices/recordings/motion_recording.h"
#include "scene/record/details.h"
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
  double peak_hand_speed = 0.0;     ///< between neighbours of a sample [m/s]
  Twist V_TB;                       ///< velocity of the ball at its release
  Known known = Known::impossible;  ///< how that is known; impossible: it is zero
  Time extrapolated{};              ///< by how much it is extrapolated
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

/// Splits a recording into its throws. Each begins after the follow-through of the one before, or
/// after a gap in the samples before its swing, and ends before the swing of the next, or at a gap
/// after its follow-through: what lies between two throws is in both. The times of each begin at 0.
/// A recording with one throw and no such gap is returned unchanged.
std::vector<devices::MotionRecording> split_throws(const devices::MotionRecording& recording,
                                                   Side side);

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
