#pragma once

#include <cstdint>

/// Virtual participants as plain data, drawn from a seed.
namespace headpin::scene {

/// A virtual participant. Random values differ from throw to throw by normal deviations.
struct Person {
  std::uint64_t seed = 1;
  bool left_handed = false;     ///< the 3D mouse is in that hand
  double height = 1.75;         ///< [m]
  double skill = 0.5;           ///< 0 has never thrown, 1 throws every week
  double speed = 6.5;           ///< highest speed of the ball at its release [m/s]
  double speed_spread = 0.03;   ///< of a throw, as a share
  double aim_bias = 0.0;        ///< initial error of the aim, to the right [rad]
  double aim_spread = 0.02;     ///< of a throw [rad]
  double timing_spread = 0.01;  ///< of the time of the trigger [s]
  double release_height = 0.3;  ///< of the ball's centre at its release [m]
  double mending = 0.5;         ///< share of a miss that the next throw corrects
  double lean = 0.8;            ///< of the trunk as the ball is laid down [rad]
  double tremor = 2e-4;         ///< of the hand, at 7 to 11 Hz [m]
  double sway = 4e-3;           ///< of the trunk, below 1 Hz [m]
  double reaction_s = 0.25;     ///< from seeing to beginning to move
  bool draws_back = true;       ///< moves away from bodies that fly at it
  double pace = 1.0;            ///< factor of the usual durations of movements, except swings
};

/// The same seed gives the same person on every computer.
///
/// Our choice. Of the paper's 18 participants we know that 10 were students, 3 research workers, 3
/// office staff and 2 others, that 12 were men and that 7 had met virtual reality before, and
/// nothing of bodies. Every tenth is left-handed; heights are those of adults, 1.70 m with a
/// deviation of 0.09; speeds are around the 6.5 m/s of the one throw in virtual reality that was
/// measured, and seldom reach the 8.0 to 9.4 of good players with a real ball.
///
/// The spreads of speed, aim and timing correlate by 0.3 in pairs, and each by 0.55 with skill: an
/// assumption. It is what other motor tasks of one person do: 0.3 and less (three fine motor tasks of
/// 305 adults, Percept Mot Skills 2012, 115:171), under 0.45 (twelve tasks of 80 children, Front
/// Psychol 2021, 12:631175). Nobody has measured these three of throws together.
Person draw_person(std::uint64_t seed);

}  // namespace headpin::scene
