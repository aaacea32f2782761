#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/record/tables.h"
#include "scene/record/trial.h"
#include "scene/scenario/rules.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// One game of a session.
struct Sheet {
  std::string version;  ///< red or blue; empty without versions
  GameKind rules = GameKind::plain;
  int rack = 0;               ///< skittles that are set
  std::vector<Frame> frames;  ///< the last one may be empty or not over
  bool over = false;
  std::vector<std::string> marks = {};  ///< fouls and dead wood: "foul (frame 2 ball 1)"
};

int points(const Sheet& sheet);
/// "red ten-pin: X | 7 / | 9 - = 48", its marks, and whether it was played to its end.
std::string in_words(const Sheet& sheet);

/// The result of a session, computed from its events. All results that are shown come from here.
struct Score {
  /// Knocked down by balls; with games: those that the score sheets count.
  std::int64_t skittles_down = 0;
  std::int64_t felled_by_hand = 0;  ///< knocked down by the hand or what it carried
  /// Pairs of bodies that touched, at least one of them a skittle; each once until one of them is set up again.
  std::int64_t touches = 0;
  std::optional<double> release_speed;  ///< speed of the first ball at its release [m/s]
  std::optional<double> impact_speed;   ///< of the same ball just before its first skittle [m/s]
  std::vector<Sheet> games;             ///< in order; none for a single throw
  std::vector<ThrowRow> throws;         ///< in their order; the sums above are sums of them

  /// @param scenario  of the session; its rules say when a ball is taken back
  void add(const Event& event, const Scenario& scenario);

 private:
  void add_to_game(const Event& event, const Scenario& scenario);
  void follow_ball(const Event& event, const Scenario& scenario, Sheet& game);
  void mark_foul(Sheet& game);
  void take_back(Sheet& game, Time now);
  void add_entry(const Event& event);
  void add_to_throw(const Event& event);
  void add_to_way(const Event& event);
  void add_to_leave(const Event& event);
  void add_to_touches(const Event& event);

  /// The throw that is not counted yet, as the referee has it.
  struct Current {
    std::optional<Time> thrown;  ///< tick of the release
    bool foul = false, struck = false;
    std::set<std::string> under_way;  ///< balls that the hand has let go
  };
  /// What a throw was before its ball was taken back.
  struct TakenBack {
    Time at{};      ///< tick
    Time thrown{};  ///< tick of its release
    bool foul = false;
  };

  std::string version_;
  Current current_;
  std::optional<TakenBack> taken_back_;
  std::set<std::string> down_;                 ///< skittles counted since the rack was set
  std::set<std::string> in_hand_;              ///< balls that were taken up and not thrown since
  std::set<std::pair<std::string, int>> met_;  ///< balls and skittles since they were set up
};

/// @param scenario  of the session
Score score(std::span<const Event> events, const Scenario& scenario = {});

/// The score of a trial by its own events and scenario; of one whose scenario cannot be read, by the rules
/// of today's default.
Score score(const TrialSummary& trial);

/// The number of skittles that an event's value says; 0 if it is none that a scenario may have, as in a
/// damaged log.
int skittles_in(const Event& event);

/// Whether an event tells of a ball, which it names first.
bool is_of_ball(const Event& event);

/// The direction of a velocity's level part: the angle from the y axis, positive to the right, in
/// [-180, 180] degrees; 0 without a level part. It has the same bits on every machine.
double degrees_from_y(const Vec3& v);

}  // namespace headpin::scene
