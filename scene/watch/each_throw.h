#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/watch/counterparts.h"

namespace headpin::scene {

/// What a ball came to.
struct ThrowResult {
  std::optional<int> felled;  ///< as the rules count; nothing where they count nothing
  std::int64_t skittles_down = 0;
  std::optional<double> release_speed, impact_speed;  ///< [m/s]
};

/// One throw, on its own.
struct ThrowAlone {
  ThrownBall thrown;  ///< as in the session; `felled` as it was counted there
  ThrowResult as_it_was, other;
};

/// Each throw of a session on its own, as it was and under another condition: from the state of the
/// moment in which it was let go, so that none of them hangs on what became of those before it.
///
/// Looks on at a session. The tick in which a ball is let go is made again from the state before it,
/// once as the session is and once under the other condition, and then goes on until the rules have
/// counted that ball, or for `game.ball_back_s`. The hand goes on as it did but takes nothing more,
/// and no button begins another version. Where the conditions are the same, so are the bits.
class EachThrow : public Observer {
 public:
  /// @param session  the one to look on at, before its first tick
  /// @param other    the other condition, of the same bodies and ticks
  /// @throws std::invalid_argument  where it has other bodies or other ticks
  EachThrow(const Session& session, const Scenario& other);
  ~EachThrow() override;

  void tick(const Session& session) override;
  /// Ends what is under way when the session is over.
  void finish();

  /// In their order; whole once finish() was called.
  std::vector<ThrowAlone> throws() const;

 private:
  struct Alone;

  std::shared_ptr<const Stage> other_stage(std::uint64_t version);
  void begin(const Session& session, const devices::Event& release);

  Scenario other_;
  std::array<std::shared_ptr<const Stage>, 3> stages_;  ///< of the other condition, by version
  std::optional<Session> before_;                       ///< the last tick, while a ball is held
  std::vector<devices::Event> events_;                  ///< of the session, those of throws
  std::vector<std::array<std::unique_ptr<Alone>, 2>> alone_;
};

nlohmann::json to_json(const std::vector<ThrowAlone>& throws);

}  // namespace headpin::scene
