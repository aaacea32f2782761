#pragma once

#include "engine/world.h"

/// What the game does since which number of `collision.rules` (engine/rules.h has what the step does).
///
/// A trial keeps the rules that it was recorded under, so that its replay has the same bits and the same
/// score sheet. All that is done for older rules alone is behind one of these questions.
namespace headpin::scene {

// Since rules 11: whose a skittle is, and where the lane begins.

/// A skittle that stands when a ball starts has no cause of motion that a stray ball before left it, even
/// while it rocks.
inline bool forgets_stray_balls(const engine::Parameters& p) {
  return p.rules >= 11;
}

/// A skittle that stands further from its spot than `game.off_spot` is down: its cause stays.
inline bool keeps_cause_off_spot(const engine::Parameters& p) {
  return p.rules >= 11;
}

/// A ball on the approach is not beside the lane, however far to the side.
inline bool has_approach(const engine::Parameters& p) {
  return p.rules >= 11;
}

/// Within a frame all skittles are set again when none is left, not when the balls' sum is that of a rack.
inline bool sets_when_none_is_left(const engine::Parameters& p) {
  return p.rules >= 11;
}

// Since rules 12: a release that is known late, and a skittle in the hand.

/// A ball whose trigger came more than a tick late has fallen since then.
inline bool falls_until_a_late_release(const engine::Parameters& p) {
  return p.rules >= 12;
}

/// A skittle in the hand is set up with the others, and leaves the hand, also where those that the hand
/// fells count. Else it stayed counted, and the next frame had one less.
inline bool sets_up_what_is_held(const engine::Parameters& p) {
  return p.rules >= 12;
}

}  // namespace headpin::scene
