#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/record/tables.h"
#include "scene/watch/alone.h"

/// A recorded throw, made again with another release.
namespace headpin::sweep {

/// The longest time before and after a release that can be asked for.
inline constexpr Time kMostShift{500'000};

/// A throw that can be made again: the session shortly before it, and the recorded motion from then
/// on.
struct Situation {
  std::shared_ptr<const scene::Session> before;       ///< the ball is in the hand
  std::vector<std::vector<devices::Sample>> samples;  ///< of each tick from then on
  Time trigger{};          ///< device time at which the trigger was released
  scene::ThrowRow thrown;  ///< as in the session
};

/// Another release: at another moment of the recorded motion, and changed.
struct Release {
  Time shift{};  ///< the trigger is released later by this
  scene::ReleaseChange change{};
};

/// The result of a release.
struct Outcome {
  bool released = false;   ///< false: the hand did not hold the ball at that moment
  scene::ThrowRow thrown;  ///< the release, and the first skittle
  std::int64_t down = 0;   ///< skittles, as the rules count; else all that the ball felled
};

/// Simulates the throw with another release. The hand moves as recorded and grabs nothing more, and
/// the simulation ends when the rules have counted the ball, without rules when all balls and skittles
/// are at rest, or else `game.ball_back_s` after the release. Without a shift and a change, the bits are those of the session.
///
/// @throws std::runtime_error  as scene::advance
Outcome throw_again(const Situation& situation, const Release& release);

/// The same for many releases, in the order of the releases.
///
/// @param jobs   threads
/// @param check  called now and then with the number of releases that are done; may throw
/// @throws  what `check` or a simulation throws
std::vector<Outcome> throw_again(const Situation& situation, std::span<const Release> releases,
                                 int jobs, const std::function<void(std::int64_t done)>& check);

/// Collects the throws of a session as it runs.
class Situations : public scene::Observer {
 public:
  /// @param shift  the longest shift before and after a release that will be asked for
  explicit Situations(Time shift) : shift_(shift) {}

  void tick(const scene::Session& session) override;

  /// In order. Complete when the session is over.
  const std::vector<Situation>& all() const { return all_; }

 private:
  std::optional<Time> hand_opened(const scene::Session& session);
  void begin(Time trigger);

  Time shift_;
  std::deque<scene::Session> recent_;          ///< one per tick, while a ball is held
  std::optional<scene::Session> before_;       ///< of the tick before, while none is
  scene::Score score_;                         ///< of the session so far
  std::vector<std::size_t> number_;            ///< of each situation: its throw in the score
  std::vector<devices::MouseSample> buttons_;  ///< that the player has not used yet
  std::vector<Situation> all_;
};

}  // namespace headpin::sweep
