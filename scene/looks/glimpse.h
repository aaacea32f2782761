#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/play/session.h"

/// What is visible at one moment of a session, independent of the renderer.
namespace headpin::scene {

/// All data to draw one moment of a session, now, later or in another process.
struct Glimpse {
  Pose X_WD = {};  ///< head display
  std::vector<Pose> X_WB_skittles = {}, X_WB_balls = {};
  std::size_t ringed = 0;             ///< of the balls, the one with rings of oil
  std::vector<Pose> X_BG_rings = {};  ///< each about its z axis, with its centre in its plane
  bool ellipsoids = false;            ///< skittles are drawn as ellipsoids
  double skittle_centre =
      0.0;  ///< of their bodies above their base: a version may have its own [m]
  std::optional<Pose> X_WH = {};        ///< without it no hand is drawn
  double closed = 0.0;                  ///< the hand: 0 is open, 1 around the ball
  std::optional<Pose> X_WC = {};        ///< another camera, which shows the head too
  std::vector<std::string> board = {};  ///< rows of the score board, as board_text
};

Glimpse glimpse(const Session& session, const Pose& X_WD);

/// The radius of a ring of oil on a ball.
///
/// @param X_BG  of Glimpse::X_BG_rings
double ring_radius(double ball_radius, const Pose& X_BG);

/// How closed the hand is, 0 to 1. Closing and opening take equally long.
///
/// @param since  time since the tick of the grab or release [s]
double how_closed(bool holds, double since);

/// Whether skittles are drawn as the ellipsoids that collide.
bool shows_ellipsoids(const Scenario& scenario);

/// What is visible between two ticks: poses of bodies and hand are interpolated.
class BetweenTicks {
 public:
  /// To be called after every tick, once its pictures are taken.
  void keep(const Session& session);

  /// The glimpse at a time between the stored tick and the session's last tick. A body that was
  /// moved to another place within the tick, as by a new rack, stays at its old place until the
  /// tick is over. Without a stored tick, the glimpse is that of the last tick.
  Glimpse glimpse(const Session& session, Time at, const Pose& X_WD) const;

 private:
  std::shared_ptr<const Stage> stage_;
  Time time_{};
  Glimpse seen_;
  std::vector<engine::State> states_;
};

}  // namespace headpin::scene
