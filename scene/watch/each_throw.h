#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/watch/alone.h"
#include "scene/watch/counterparts.h"

namespace headpin::scene {

/// One separate throw.
struct ThrowAlone {
  ThrownBall thrown;  ///< as in the session; `felled` as it was counted there
  ThrowResult as_it_was, other;
};

/// Simulates each throw of a session separately, under its own and under another condition, from
/// the state at its release. So a throw does not depend on the results of earlier throws. If the other
/// condition has other spots, the skittles stand on these: see on_its_own().
///
/// It observes a session. The tick of a release is repeated from the state before it, once under
/// the session's condition and once under the other one, and the simulations continue until the
/// rules have counted that ball, or for `game.ball_back_s`. The hand moves as recorded but grabs
/// nothing more, and buttons have no effect. With equal conditions, the bits are equal.
class EachThrow : public Observer {
 public:
  /// @param session  the session to observe, before its first tick
  /// @param other    the other condition, of the same bodies and ticks
  /// @throws std::invalid_argument  if it has other bodies or another tick rate
  EachThrow(const Session& session, const Scenario& other);

  void tick(const Session& session) override;
  /// Finishes running simulations at the end of the session.
  void finish();

  /// In order; complete after finish().
  std::vector<ThrowAlone> throws() const;

 private:
  std::shared_ptr<const Stage> other_stage(std::uint64_t version);
  void begin(const Session& session, const Event& release);

  Scenario other_;
  std::array<std::shared_ptr<const Stage>, 3> stages_;  ///< of the other condition, by version
  std::optional<Session> before_;                       ///< the last tick, while a ball is held
  std::vector<Event> events_;                           ///< of the session, those of throws
  std::vector<std::array<Alone, 2>> alone_;             ///< as it was, under the other condition
};

nlohmann::json to_json(const std::vector<ThrowAlone>& throws);

}  // namespace headpin::scene
