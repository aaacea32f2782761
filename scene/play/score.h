#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/trial/tables.h"
#include "devices/trial/trial.h"
#include "scene/scenario/rules.h"

namespace headpin::scene {

/// One game of a session.
struct Sheet {
  std::string version;  ///< red or blue; empty where there are none
  std::string rules;
  int rack = 0;               ///< skittles that are set
  std::vector<Frame> frames;  ///< the last one may be empty or not over
  bool over = false;
  std::vector<std::string> marks = {};  ///< fouls and dead wood: "foul (frame 2 ball 1)"
};

int points(const Sheet& sheet);
/// "red ten-pin: X | 7 / | 9 - = 48", its marks, and whether it was played to its end.
std::string in_words(const Sheet& sheet);

/// What the events of a session come to. A function of the events, and the only one: whoever shows
/// a result reads it from here.
struct Score {
  std::int64_t skittles_down = 0;         ///< by balls; of games, what their sheets count
  std::int64_t felled_by_hand = 0;        ///< or by what it carried
  std::int64_t touches = 0;               ///< pairs of bodies that met, one of them a skittle
  std::optional<double> release_speed;    ///< of the first ball as it left the hand [m/s]
  std::optional<double> impact_speed;     ///< of the same ball just before its first skittle [m/s]
  std::vector<Sheet> games;               ///< in their order; none of a single throw
  std::vector<devices::ThrowRow> throws;  ///< in their order; the sums above are sums of them

  void add(const devices::Event& event);

 private:
  void add_to_game(const devices::Event& event);
  void add_to_throw(const devices::Event& event);

  std::string version_;
};

Score score(std::span<const devices::Event> events);

}  // namespace headpin::scene
