#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "scene/record/details.h"
#include "scene/record/trial.h"

/// A throw as a row of a table.
namespace headpin::scene {

/// One throw of a session, from its events: a ball that the hand released.
struct ThrowRow {
  std::string version;                   ///< red or blue; empty where there are none
  int frame = 0, ball = 0;               ///< from 1; 0 where it was not counted
  std::string body;                      ///< which ball
  Time release{};                        ///< when it left the hand, in the session
  std::optional<double> trigger_s;       ///< when the trigger was let go, as its device tells it
  std::optional<Vec3> p_WB, v_WB, w_WB;  ///< of the ball then, in the world
  double speed = 0.0;                    ///< [m/s]
  std::string known;                     ///< how the release was known; empty where nothing tells
  std::optional<double> extrapolated_s;  ///< by so long from the nearest sample
  std::optional<int> left_out;           ///< samples that lie off what the others say
  std::optional<Time> entry;             ///< when it met its first skittle
  std::optional<double> entry_speed;     ///< just before [m/s]
  std::optional<double>
      entry_angle_deg;  ///< of its level velocity then, to the right of straight on
  std::optional<int> felled_by_ball, felled_by_hand;  ///< until the next ball
  std::optional<int> counted;     ///< in the sheet; other than felled by the ball after a foul
  std::optional<bool> foul;       ///< let go beyond the foul line
  std::optional<BallPath> path;   ///< of the ball; nothing in older trials
  std::vector<int> touched = {};  ///< numbers of the skittles that the ball touched, in this order
  std::optional<std::string> leave = {};  ///< the skittles that stand when it was counted: "4-7"
};

/// A value of a row: a number, a whole number, a hash, yes or no, a time, or a text. Nothing: it is
/// not known.
using TableValue =
    std::variant<std::monostate, double, std::int64_t, std::uint64_t, bool, Time, std::string>;

/// The columns about the way of a ball, each with its value in a row.
std::vector<std::pair<std::string, TableValue>> lane_values(const ThrowRow& row);

}  // namespace headpin::scene
