#pragma once

#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// The default scenario with a game of these rules.
inline Scenario with_rules(GameKind rules, int frames, int balls) {
  Scenario scenario;
  scenario.game.rules = rules;
  scenario.game.frames = frames;
  scenario.game.balls = balls;
  return scenario;
}

}  // namespace headpin::scene
