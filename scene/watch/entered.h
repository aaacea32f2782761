#pragma once

#include <memory>

#include "scene/play/session.h"
#include "scene/watch/recorded.h"

namespace headpin::scene {

/// A session in the middle of a recorded trial, and the samples that follow.
struct Entered {
  Session session;
  std::unique_ptr<TrialPlayer> source;
};

/// The session at the last usable snapshot of a trial, with the bits of one that is simulated from the
/// first tick; a new session if there is none before that time.
///
/// A snapshot is not usable if it is damaged, of another scenario or of another version of headpin.
///
/// @param trial   must outlive the result
/// @param at      latest time of the session
/// @param beside  what the source will be asked for, besides samples
/// @throws std::runtime_error  when the file was changed or cannot be read
Entered enter(const Recorded& trial, Time at, TrialPlayer::Beside beside);

/// The same session under another scenario from now on: its bodies stay where they are, and its
/// buttons start the other scenario's versions.
///
/// @param own    scenario of the session
/// @param other  of the same bodies and spots, with the same tick rate, rules, frames and balls
/// @throws std::invalid_argument  for another one, naming the keys
Session under_from_now_on(Session session, const Scenario& own, const Scenario& other);

}  // namespace headpin::scene
