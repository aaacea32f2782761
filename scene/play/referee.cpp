#include "scene/play/referee.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/play/since.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

/// A tick, and the game that is played.
struct Field : Tick {
  Game& game;
  std::optional<engine::BodyId> held;

  const GameRules& plan() const { return stage.scenario.game; }
  const Rules& rules() const { return rules_of(plan().rules); }
  int rack() const { return static_cast<int>(stage.skittles.size()); }
  bool tells_apart() const { return plan().hand_fells == HandFells::apart; }
  bool waits_for_rest() const { return plan().ends == BallEnds::rest; }
};

void note(const Field& f, std::string_view kind, double value, Detail detail = {}) {
  Event e = event(f, kind, {});
  e.value = value;
  e.detail = std::move(detail);
  f.events.push_back(std::move(e));
}

bool is_still(const engine::World& world, engine::BodyId body) {
  return world.bodies[body].kind != engine::Kind::free || engine::is_asleep(world, body);
}

bool at_rest(const engine::World& world, engine::BodyId body) {
  constexpr double kSlow = 0.01, kSlowSpin = 0.03;  // [m/s], [rad/s]
  const engine::State& state = world.states[body];
  return is_still(world, body) || (state.v_WB.norm() < kSlow && state.w_WB.norm() < kSlowSpin);
}

/// Whether a ball is too slow to matter. A ball rolls for a long time; at this speed it has a
/// quarter of what tips a skittle.
bool is_spent(const engine::World& world, engine::BodyId ball) {
  constexpr double kSlow = 0.05;  // [m/s]
  return is_still(world, ball) || world.states[ball].v_WB.norm() < kSlow;
}

/// Whether a ball has left the room and cannot come back: beyond a wall, or below the floor.
bool is_gone(const Field& f, engine::BodyId ball) {
  const Room& room = f.stage.scenario.room;
  const Vec3& p_W = f.world.states[ball].X_WB.p;
  return std::abs(p_W.x()) > 0.5 * room.width || p_W.y() > room.ahead || p_W.y() < -room.behind ||
         p_W.z() < -1.0;
}

/// Whether no body moves that could knock down another skittle.
bool all_at_rest(const Field& f) {
  const auto over = [&](engine::BodyId ball) {
    return is_spent(f.world, ball) || (f.waits_for_rest() && is_gone(f, ball));
  };
  return std::ranges::all_of(f.stage.balls, over) &&
         std::ranges::all_of(f.stage.skittles, [&](auto body) { return at_rest(f.world, body); });
}

/// Time for which all bodies must be at rest. A body that was thrown up is slow for 2 v / g at the
/// top of its flight; this is twice as long, plus some ticks.
Time long_enough(const Field& f) {
  constexpr double kSlow = 0.05, kTicks = 0.1;  // [m/s], [s]
  const double gravity = f.stage.scenario.collision.gravity;
  const double longest = f.plan().ball_back_s;
  const double hangs = gravity > 0.0 ? 4.0 * kSlow / gravity : 0.0;
  return microseconds(std::min(longest, hangs + kTicks));
}

/// Whether all bodies have been at rest for long enough at this tick.
bool stays_at_rest(const Field& f) {
  if (!all_at_rest(f)) {
    f.game.quiet.reset();
    return false;
  }
  if (!f.game.quiet) f.game.quiet = f.moment.time;
  return f.moment.time - *f.game.quiet >= long_enough(f);
}

bool is_down(const Field& f, engine::BodyId skittle) {
  return has_fallen(f.world.states[skittle].X_WB) || is_off_spot(f.world, f.stage, skittle);
}

void put_away(const Field& f, engine::BodyId skittle) {
  engine::set_kind(f.world, skittle, engine::Kind::driven);
  engine::set_state(f.world, skittle, {away_pose(f.stage, skittle), Vec3::Zero(), Vec3::Zero()});
}

/// Puts a body back to its initial state in the stage.
void put_back(const Field& f, engine::BodyId body) {
  engine::set_kind(f.world, body, f.stage.world.bodies[body].kind);
  engine::set_state(f.world, body, f.stage.world.states[body]);
  if (f.world.bodies[body].kind == engine::Kind::free) engine::put_to_sleep(f.world, body);
  engine::forget_meetings(f.world, body);
}

/// Sets a skittle up on its spot.
void set_up(const Field& f, engine::BodyId skittle) {
  put_back(f, skittle);
  f.game.down[skittle] = f.game.swept[skittle] = 0;
  f.game.moved_by[skittle] = By::nobody;
}

/// Whether a skittle that is down is dead wood. If the cause is not known, the ball counts as the
/// cause if it has struck a skittle.
bool is_dead_wood(const Field& f, engine::BodyId skittle) {
  if (!f.tells_apart()) return false;
  const By by = f.game.moved_by[skittle];
  return by == By::hand || (by == By::nobody && !f.game.struck);
}

/// Removes the skittles that are down. Those of a stray ball, and after a foul with which the ball
/// does not count, its own, are set up again.
///
/// @return  skittles down that count for the ball that was thrown
int count(const Field& f) {
  end_ball_path(f.game, f);
  Event delivery = event(f, kind::delivery, {});
  Event dead = event(f, kind::dead_wood, {});
  Event set_again = event(f, kind::set_again, {});
  const bool costs = f.game.foul && f.plan().foul == FoulBall::zero;
  for (const engine::BodyId skittle : f.stage.skittles) {
    if (f.game.swept[skittle] || !is_down(f, skittle)) continue;
    const bool is_dead = is_dead_wood(f, skittle);
    const bool by_stray = f.game.moved_by[skittle] == By::stray_ball;
    (is_dead    ? dead
     : by_stray ? set_again
                : delivery)
        .bodies.push_back(f.world.bodies[skittle].name);
    if ((by_stray || (costs && !is_dead)) && skittle != f.held) {
      set_up(f, skittle);
      continue;
    }
    f.game.swept[skittle] = 1;
    if (skittle != f.held) put_away(f, skittle);
  }
  const std::size_t felled = costs ? 0 : delivery.bodies.size();
  delivery.value = static_cast<double>(felled);
  delivery.detail = BallOfFrame{f.game.frames.size(), f.game.frames.back().size() + 1};
  dead.value = static_cast<double>(dead.bodies.size());
  dead.detail = delivery.detail;
  set_again.value = static_cast<double>(set_again.bodies.size());
  set_again.detail = delivery.detail;
  if (!dead.bodies.empty()) f.events.push_back(std::move(dead));
  if (!set_again.bodies.empty()) f.events.push_back(std::move(set_again));
  f.events.push_back(std::move(delivery));
  return static_cast<int>(felled);
}

/// Sets up all skittles. @return  whether one of them was in the hand
bool set_rack(const Field& f) {
  bool taken = false;
  for (const engine::BodyId skittle : f.stage.skittles) {
    const bool in_hand = skittle == f.held;
    if (in_hand && !f.tells_apart() && !sets_up_what_is_held(f.world.parameters)) continue;
    taken |= in_hand;
    set_up(f, skittle);
  }
  f.game.struck = false;
  return taken;
}

void bring_balls_back(const Field& f) {
  for (const engine::BodyId ball : f.stage.balls) {
    if (f.world.bodies[ball].kind != engine::Kind::free) continue;  // on its stand or carried
    put_back(f, ball);
    f.game.stray[ball] = 0;
    Event back = event(f, kind::ball_back, {ball});
    back.p_W = f.world.states[ball].X_WB.p;
    f.events.push_back(std::move(back));
  }
  f.game.struck = false;
}

/// Whether a frame is over if no skittle is left to throw at.
bool ends_empty(const Field& f, bool last) {
  const Rules& rules = f.rules();
  if (rules.full_rack || rules.set_again) return false;
  const Frame& frame = f.game.frames.back();
  return !(last && rules.bonuses && std::accumulate(frame.begin(), frame.end(), 0) >= f.rack());
}

/// Whether all skittles are set before the next ball of a frame that is not over.
///
/// @param empty  no skittle is left
bool is_rack_set(const Field& f, bool empty) {
  if (empty) return true;
  const bool sees = f.tells_apart() && sets_when_none_is_left(f.world.parameters);
  return sees ? f.rules().full_rack : is_set_again(f.rules(), f.game.frames.back(), f.rack());
}

/// @return  whether the body in the hand was taken from it
bool end_delivery(const Field& f) {
  const Rules& rules = f.rules();
  std::vector<Frame>& frames = f.game.frames;
  frames.back().push_back(count(f));
  f.game.fouls.push_back(f.game.foul ? 1 : 0);
  bring_balls_back(f);
  f.game.foul = false;
  const bool last = static_cast<std::int64_t>(frames.size()) == f.plan().frames;
  const bool empty = f.tells_apart() && std::ranges::all_of(f.stage.skittles, [&](auto body) {
                       return f.game.swept[body] == 1;
                     });
  if (!is_over(rules, frames.back(), f.rack(), static_cast<int>(f.plan().balls), last) &&
      !(empty && ends_empty(f, last))) {
    return is_rack_set(f, empty) && set_rack(f);
  }
  note(f, kind::frame, static_cast<double>(frames.size()));
  if (last) {
    f.game.over = true;
    note(f, kind::game_over, points(rules, frames, f.rack()), in_words(rules, frames, f.rack()));
    return false;
  }
  frames.emplace_back();
  return set_rack(f);
}

/// A ball starts: skittles that stand still now have no cause of motion, and no skittle that stands has that
/// of a stray ball before.
void begin_delivery(const Field& f) {
  f.game.thrown = f.moment.time;
  f.game.quiet.reset();
  f.game.beyond = false;
  const bool forgets = forgets_stray_balls(f.world.parameters);
  for (const engine::BodyId skittle : f.stage.skittles) {
    By& by = f.game.moved_by[skittle];
    const bool ends = at_rest(f.world, skittle) || (forgets && by == By::stray_ball);
    if (ends && !is_down(f, skittle)) by = By::nobody;
  }
}

/// Puts away a counted skittle when the hand has released it. A skittle that stands on its spot
/// again has no cause of motion.
void tidy(const Field& f) {
  for (const engine::BodyId skittle : f.stage.skittles) {
    if (f.world.bodies[skittle].kind != engine::Kind::free) continue;
    if (f.game.swept[skittle]) {
      put_away(f, skittle);
    } else if (engine::is_asleep(f.world, skittle) && !is_down(f, skittle)) {
      f.game.moved_by[skittle] = By::nobody;
      f.game.down[skittle] = 0;
    }
  }
}

}  // namespace

bool referee(Game& game, const Tick& tick, std::optional<engine::BodyId> held) {
  const Field f{tick, game, held};
  if (!f.rules().counted || game.over) return false;
  if (!game.begun) {
    game.begun = true;
    game.frames.assign(1, {});
    note(f, kind::game, f.rack(), f.plan().rules);
  }
  if (f.tells_apart()) tidy(f);
  bool under_way = false;
  for (const engine::BodyId ball : f.stage.balls) {
    if (f.world.bodies[ball].kind != engine::Kind::free) continue;
    under_way = true;
    game.beyond |= game.thrown && f.world.states[ball].X_WB.p.y() > 0.0;
  }
  if (under_way && !game.thrown) begin_delivery(f);
  if (!game.thrown) return false;
  const Time since = f.moment.time - *game.thrown;
  if (!under_way && is_taken_back(f.plan(), {game.struck, game.beyond, since})) {
    game.thrown.reset();
    game.foul = false;
    return false;
  }
  const bool rests = f.waits_for_rest() ? stays_at_rest(f) : all_at_rest(f);
  if (since < microseconds(f.plan().ball_back_s) && (since < kThrownAfter || !rests)) return false;
  game.thrown.reset();
  return end_delivery(f);
}

}  // namespace headpin::scene
