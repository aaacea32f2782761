#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "scene/play/session.h"

/// One throw of a session that continues separately.
namespace headpin::scene {

/// The result of a throw.
struct ThrowResult {
  std::optional<int> felled;  ///< as the rules count; nothing if they count nothing
  std::int64_t skittles_down = 0;
  std::optional<double> release_speed, impact_speed;  ///< [m/s]

  std::int64_t count() const { return felled ? *felled : skittles_down; }
};

/// Whether the event is the release of a ball.
bool is_release_of_ball(const Event& event);

/// A copy of a session that continues under a stage of the same bodies. Its buttons start no other
/// version.
///
/// Under another condition the room is that condition's. Where it has other spots, the skittles that stand
/// on their spots stand on the other ones. What lies, is in the hand, or stands further from its spot than
/// `game.off_spot` stays where it is, and so do the balls.
Session on_its_own(Session session, const std::shared_ptr<const Stage>& stage);

/// A copy of a session that follows one ball.
struct Alone {
  Session session;
  Time let_go{};
  ThrowResult result{};
  /// The rules have counted the ball, or `game.ball_back_s` after the release.
  bool over = false;

  /// Makes one tick with these samples.
  void step(const std::vector<devices::Sample>& samples);
  /// The same with an open hand; nothing if the throw is over.
  void advance(std::vector<devices::Sample> samples);
};

}  // namespace headpin::scene
