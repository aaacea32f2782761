#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sweep/throw_again.h"

/// Results of other releases of a throw: at each moment around the real one, and on a grid of
/// speed, direction, height and spin.
namespace headpin::sweep {

/// Simulates releases in their order; throw_again() with its threads and progress.
using Simulate = std::function<std::vector<Outcome>(std::span<const Release>)>;

/// The axes of a grid of releases: changes of the recorded release, as scene::ReleaseChange.
struct ReleaseGrid {
  std::vector<double> speed;                 ///< factors
  std::vector<double> direction_deg;         ///< to the right
  std::vector<double> height;                ///< [m]
  std::vector<double> spin;                  ///< [rad/s]
  std::vector<double> boards = {0.0};        ///< to the left
  std::vector<double> revs = {1.0};          ///< factors
  std::vector<double> rotation_deg = {0.0};  ///< to the left

  /// The order of axes().
  enum : std::size_t {
    kSpeedAxis,
    kDirectionAxis,
    kHeightAxis,
    kSpinAxis,
    kBoardsAxis,
    kRevsAxis,
    kRotationAxis
  };
  /// The values that change nothing.
  static constexpr std::array<double, 7> kUnchanged = {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0};

  /// All axes; the first one changes fastest from a release to the next.
  std::array<const std::vector<double>*, 7> axes() const {
    return {&speed, &direction_deg, &height, &spin, &boards, &revs, &rotation_deg};
  }
  std::size_t size() const;
  /// The number of a point, by its place on each axis.
  std::size_t number(const std::array<std::size_t, 7>& places) const;
  /// The places of the point that changes least.
  std::array<std::size_t, 7> unchanged() const;
};

/// Values from `from` to `to` at even distances.
std::vector<double> evenly(double from, double to, int steps);

std::vector<Release> releases_of(const ReleaseGrid& grid);

/// Every `step` from -`reach` to `reach`; 0 is among them.
std::vector<Release> moments(Time reach, Time step);

/// A time window around the real release in which the throw succeeds.
struct Window {
  Time from{}, to{};  ///< the first and the last moment that succeeds
  bool cut = false;   ///< it may go on beyond the simulated moments
};

/// The longest run of neighbouring moments that fell at least `success` skittles and contains the
/// real one. Nothing if the real one fells fewer.
std::optional<Window> window_of_success(std::span<const Release> moments,
                                        std::span<const Outcome> outcomes, std::int64_t success);

/// The boards over which a throw succeeds, in one direction: the room to miss, as coaches say.
struct MissRoom {
  double direction_deg = 0.0;   ///< change of the direction, to the right
  double from = 0.0, to = 0.0;  ///< changes of the board: the first and the last that succeed
  bool cut = false;             ///< it may go on beyond the simulated boards

  double boards() const { return to - from; }
  bool operator==(const MissRoom&) const = default;
};

/// The miss rooms of a grid, all else as near to the throw as the grid has it. Both are nothing where no release succeeds.
struct MissRooms {
  std::optional<MissRoom> own;     ///< of the direction of the throw, around its board
  std::optional<MissRoom> widest;  ///< of all directions; of equal ones, the one nearest to its own
  bool in_grid = true;             ///< the grid has the direction and the board of the throw
};

/// @param success  so many skittles down are a success
MissRooms miss_rooms(const ReleaseGrid& grid, std::span<const Outcome> outcomes,
                     std::int64_t success);

/// One throw as two variables: those of the tolerance, noise and covariation costs.
struct Execution {
  double speed = 0.0;          ///< of the ball at its release [m/s]
  double direction_deg = 0.0;  ///< to the right
};

/// Nothing for a throw of a trial that is too old to tell its velocity.
std::optional<Execution> execution_of(const scene::ThrowRow& thrown);

/// The release that gives the situation's ball this speed and direction.
Release release_of(const Execution& execution, const Execution& recorded);

/// Possible improvements of a set of throws (Cohen and Sternad 2009, after Mueller and Sternad
/// 2004), in skittles, each 0 or more.
struct Costs {
  double mean = 0.0;               ///< skittles down, of the throws in this situation
  double tolerance = 0.0;          ///< gained at the best place of the set, as a whole
  double noise = 0.0;              ///< gained at the best size of the set, around its own mean
  double covariation = 0.0;        ///< gained by the best pairing of its speeds and directions
  Execution best_shift;            ///< the shift of the best place
  double best_size = 1.0;          ///< the factor of the best size
  std::vector<std::int64_t> down;  ///< of each throw in this situation
};

/// @param recorded  the execution of the situation's own throw
/// @param grid      its speeds and directions, as changes of `recorded`, are the places that are tried
/// @throws std::invalid_argument  with fewer than two throws
Costs costs_of(std::span<const Execution> throws, const Execution& recorded,
               const ReleaseGrid& grid, const Simulate& simulate);

/// The assignment of columns to rows with the largest sum.
///
/// @param gain  square
/// @return      the column of each row
std::vector<std::size_t> best_assignment(const std::vector<std::vector<double>>& gain);

}  // namespace headpin::sweep
