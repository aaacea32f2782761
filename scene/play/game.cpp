#include "scene/play/game.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/play/since.h"
#include "scene/record/details.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

Event event(const engine::World& world, const Moment& moment, std::string_view kind,
            std::initializer_list<engine::BodyId> bodies) {
  Event e;
  e.time = moment.time;
  e.tick = moment.tick;
  e.kind = kind;
  for (const engine::BodyId body : bodies) e.bodies.push_back(world.bodies[body].name);
  return e;
}

/// Whether the game distinguishes the causes of a skittle's fall.
bool tells_apart(const Stage& stage) {
  return stage.scenario.game.hand_fells == HandFells::apart;
}

/// Whether the game distinguishes what a stray ball knocks down.
bool tells_strays_apart(const Stage& stage) {
  const GameRules& game = stage.scenario.game;
  return rules_of(game.rules).counted && game.stray_fells == StrayFells::apart;
}

bool is_free(const engine::World& world, engine::BodyId body) {
  return world.bodies[body].kind == engine::Kind::free;
}

void note_contacts(Game& game, const Tick& tick) {
  for (const engine::ContactEvent& contact : tick.world.events) {
    const Role a = tick.stage.roles[contact.a], b = tick.stage.roles[contact.b];
    const bool of_skittle = a == Role::skittle || b == Role::skittle;
    const bool of_ball = a == Role::ball || b == Role::ball;
    const bool of_hand = a == Role::hand || b == Role::hand;
    const engine::BodyId ball = a == Role::ball ? contact.a : contact.b;
    // A ball in the hand is not thrown. A thrown ball may meet a body that it touched in the hand
    // before.
    const bool thrown = of_ball && (!tells_apart(tick.stage) || is_free(tick.world, ball));
    const bool strikes = of_skittle && thrown && !game.struck;
    const bool met = contact.first || (strikes && tells_apart(tick.stage));
    if (!met || (!of_skittle && !of_ball)) continue;
    const std::string_view what = of_hand      ? kind::hand_touch
                                  : of_skittle ? kind::touch
                                               : kind::ball_touch;
    Event e = event(tick, what, {contact.a, contact.b});
    e.p_W = contact.p_W;
    e.j_W = contact.impulse_W;
    e.value = contact.approach_speed;
    if (strikes) {
      const Vec3& v_WB = game.velocities[ball];
      game.struck = true;
      e.kind = kind::first_contact;
      e.value = v_WB.norm();
      e.detail = FirstContact{v_WB};
    }
    tick.events.push_back(std::move(e));
  }
}

/// The cause when a body meets a skittle: a thrown ball, the hand or a body in it, or the cause
/// that moved the other skittle.
By who(const Game& game, const Stage& stage, const engine::World& world, engine::BodyId body) {
  switch (stage.roles[body]) {
    case Role::hand:
      return By::hand;
    case Role::ball:
      if (!is_free(world, body)) return By::hand;
      return game.stray[body] ? By::stray_ball : By::ball;
    case Role::skittle:
      return is_free(world, body) ? game.moved_by[body] : By::hand;
    default:
      return By::nobody;
  }
}

/// Whether what set a skittle in motion is settled: it is down, so nothing else changes that.
bool is_settled(const Game& game, const Stage& stage, const engine::World& world,
                engine::BodyId skittle) {
  if (game.down[skittle]) return true;
  return keeps_cause_off_spot(world.parameters) && game.moved_by[skittle] != By::nobody &&
         is_off_spot(world, stage, skittle);
}

/// Stores what set each skittle in motion. Skittles that are down are not changed.
void credit(Game& game, const Stage& stage, const engine::World& world) {
  for (const engine::BodyId skittle : stage.skittles) {
    if (is_settled(game, stage, world, skittle) || game.swept[skittle]) continue;
    if (!is_free(world, skittle)) game.moved_by[skittle] = By::hand;
  }
  const auto meets = [&](engine::BodyId skittle, engine::BodyId other) {
    if (stage.roles[skittle] != Role::skittle || !is_free(world, skittle)) return;
    if (is_settled(game, stage, world, skittle)) return;
    const By by = who(game, stage, world, other);
    const bool itself = stage.roles[other] != Role::skittle || !is_free(world, other);
    if (by == By::nobody || (!itself && game.moved_by[skittle] != By::nobody)) return;
    game.moved_by[skittle] = by;
  };
  for (const engine::ContactEvent& contact : world.events) {
    meets(contact.a, contact.b);
    meets(contact.b, contact.a);
  }
}

void note_fallen(Game& game, const Tick& tick) {
  for (const engine::BodyId skittle : tick.stage.skittles) {
    const Pose& X_WB = tick.world.states[skittle].X_WB;
    const bool carried = tick.world.bodies[skittle].kind == engine::Kind::driven;
    if (game.down[skittle] || carried || !has_fallen(X_WB)) continue;
    game.down[skittle] = 1;
    Event e = event(tick, kind::skittle_down, {skittle});
    e.p_W = X_WB.p;
    e.value = static_cast<double>(std::count(game.down.begin(), game.down.end(), 1));
    const By by = game.moved_by[skittle];
    if (tells_apart(tick.stage) || by == By::stray_ball) e.detail = by;
    tick.events.push_back(std::move(e));
  }
}

/// Whether a ball lies beside the lane: not on the approach, nor beside the skittles.
bool is_beside_lane(const RoomMeasures& room, double radius, const engine::State& ball) {
  const Vec3& p = ball.X_WB.p;
  const bool before = p.y() > 0.0 && p.y() < room.head_pin;
  return before && std::abs(p.x()) > 0.5 * room.lane_width && is_on_lane(radius, ball);
}

/// Whether a ball moves towards the player from behind the last row.
bool comes_back(const RoomMeasures& room, const engine::State& ball) {
  double last_row = 0.0;
  for (const Vec2& spot : room.spots) last_row = std::max(last_row, spot.y());
  return ball.X_WB.p.y() > room.head_pin + last_row && ball.v_WB.y() < 0.0;
}

/// Stores which balls are stray after this step.
void note_strays(Game& game, const Tick& tick) {
  const RoomMeasures& room = tick.stage.room;
  const double radius = tick.stage.scenario.ball.radius;
  for (const engine::BodyId ball : tick.stage.balls) {
    const engine::State& now = tick.world.states[ball];
    const bool left = !game.struck && is_beside_lane(room, radius, now);
    if (!is_free(tick.world, ball)) {
      game.stray[ball] = 0;
    } else if (left || comes_back(room, now)) {
      game.stray[ball] = 1;
    }
  }
}

/// The first of this tick's events that belongs to the game: those before its version began are
/// another game's.
std::size_t first_of_game(const std::vector<Event>& events) {
  std::size_t first = events.size();
  while (first > 0 && events[first - 1].kind != kind::version) --first;
  return first;
}

/// For each ball that was released in this tick: stores that it has not struck a skittle yet, and
/// checks for a foul.
void note_releases(Game& game, const Tick& tick) {
  const std::size_t first = first_of_game(tick.events), before = tick.events.size();
  for (const engine::BodyId ball : tick.stage.balls) {
    for (std::size_t i = first; i < before; ++i) {
      if (tick.events[i].kind != kind::release ||
          tick.events[i].bodies.front() != tick.world.bodies[ball].name)
        continue;
      if (tells_apart(tick.stage)) game.struck = false;
      const Vec3 p_WB =
          tick.events[i].detail.value_or(Released{}).p_WB.value_or(tick.events[i].p_W);
      if (tick.stage.scenario.game.foul == FoulBall::count || p_WB.y() <= kOnLine) continue;
      game.foul = true;
      Event e = event(tick, kind::foul, {ball});
      e.p_W = p_WB;
      e.value = p_WB.y();
      tick.events.push_back(std::move(e));
    }
  }
}

/// The state of a ball when the hand let it go, as far as its event tells; else its present one.
engine::State state_at_release(const Event& release, const engine::State& now) {
  engine::State state = now;
  const auto* told = release.detail.get_if<Released>();
  if (!told || !told->p_WB || !told->v_WB || !told->w_WB) return state;
  state.X_WB.p = *told->p_WB;
  state.v_WB = *told->v_WB;
  state.w_WB = *told->w_WB;
  return state;
}

bool touches_skittle(const Tick& tick, engine::BodyId ball) {
  return std::ranges::any_of(tick.world.events, [&](const engine::ContactEvent& contact) {
    const engine::BodyId other = contact.a == ball ? contact.b : contact.a;
    return (contact.a == ball || contact.b == ball) && tick.stage.roles[other] == Role::skittle;
  });
}

/// Whether a ball met its first skittle in this step; it may have passed the head pin's spot before.
bool strikes_first(const Game& game, const Tick& tick) {
  const WatchedBall& watched = *game.watched;
  if (!watched.watch.path.entry) return touches_skittle(tick, watched.body);
  const std::string& name = tick.world.bodies[watched.body].name;
  return std::ranges::any_of(tick.events, [&](const Event& e) {
    return e.kind == kind::first_contact && (e.bodies[0] == name || e.bodies[1] == name);
  });
}

/// Begins to watch the balls that were released in this tick; of two, the second.
/// @return whether there was one
bool watch_released(Game& game, const Tick& tick) {
  bool found = false;
  const std::size_t before = tick.events.size();
  for (std::size_t i = first_of_game(tick.events); i < before; ++i) {
    if (tick.events[i].kind != kind::release) continue;
    for (const engine::BodyId ball : tick.stage.balls) {
      if (tick.events[i].bodies.front() != tick.world.bodies[ball].name) continue;
      end_ball_path(game, tick);
      const engine::State at = state_at_release(tick.events[i], tick.world.states[ball]);
      game.watched = {ball, watch_ball(tick.stage.room, at), {}, {}};
      if (tick.stage.scenario.ball.rings) game.ringed = {ball, {}};
      found = true;
    }
  }
  return found;
}

/// Notes where the watched ball touched a lane with wear in this step.
void note_touched(WatchedBall& watched, const Tick& tick) {
  if (!tick.stage.fresh_lane || watched.watch.over) return;
  const double radius = tick.stage.scenario.ball.radius;
  const engine::State& now = tick.world.states[watched.body];
  if (!is_on_lane(radius, now)) return;
  const engine::State& from = is_on_lane(radius, watched.watch.last) ? watched.watch.last : now;
  add_way(watched.touched, *tick.stage.fresh_lane, from.X_WB.p.head<2>(), now.X_WB.p.head<2>());
}

/// Adds to the rings of the watched ball until it meets the skittles.
void note_rings(Game& game, const Tick& tick) {
  WatchedBall& watched = *game.watched;
  if (watched.watch.over || watched.watch.path.entry) return;
  const double radius = tick.stage.scenario.ball.radius;
  const engine::State& now = tick.world.states[watched.body];
  const bool leaves = is_on_lane(radius, now) && leaves_rings(tick.stage.room, now.X_WB.p);
  add_contact(watched.rings, now, leaves, radius, engine::step_seconds(tick.world));
  if (watched.rings.newest && game.ringed) game.ringed->rings.push_back(*watched.rings.newest);
}

/// Follows the watched ball until it leaves the lane, rests or is taken.
void follow_ball(Game& game, const Tick& tick) {
  const bool was_released = watch_released(game, tick);
  if (!game.watched) return;
  const engine::BodyId ball = game.watched->body;
  const bool free = is_free(tick.world, ball);
  if (free) {
    note_touched(*game.watched, tick);
    note_rings(game, tick);
    see(game.watched->watch, tick.stage.room, tick.stage.scenario.ball.radius, tick.world,
        tick.world.states[ball], strikes_first(game, tick), was_released);
  }
  if (!free || game.watched->watch.over || engine::is_asleep(tick.world, ball)) {
    end_ball_path(game, tick);
  }
}

}  // namespace

Event event(const Tick& tick, std::string_view kind, std::initializer_list<engine::BodyId> bodies) {
  return event(tick.world, tick.moment, kind, bodies);
}

Game make_game(const Stage& stage) {
  Game game;
  game.down.assign(stage.roles.size(), 0);
  game.swept.assign(stage.roles.size(), 0);
  game.stray.assign(stage.roles.size(), 0);
  game.moved_by.assign(stage.roles.size(), By::nobody);
  return game;
}

bool is_taken_back(const GameRules& rules, const CaughtBall& ball) {
  if (rules.ends != BallEnds::rest || ball.struck) return false;
  return !ball.beyond || ball.since_release < kThrownAfter;
}

bool has_fallen(const Pose& X_WB) {
  constexpr double kCos20Degrees = 0.93969262078590838;
  return (X_WB.q * Vec3::UnitZ()).z() < kCos20Degrees;
}

bool is_off_spot(const engine::World& world, const Stage& stage, engine::BodyId skittle) {
  const Vec3 &p = world.states[skittle].X_WB.p, &spot = stage.world.states[skittle].X_WB.p;
  return (p - spot).head<2>().norm() > stage.scenario.game.off_spot;
}

void note_velocities(Game& game, const engine::World& world) {
  game.velocities.clear();
  for (const engine::State& state : world.states) game.velocities.push_back(state.v_WB);
}

std::optional<Event> ball_path_so_far(const Game& game, const engine::World& world,
                                      const Moment& moment) {
  if (!game.watched) return std::nullopt;
  BallPath path = game.watched->watch.path;
  if (game.watched->rings.flare) path.flare_mm = 1e3 * *game.watched->rings.flare;
  Event e = event(world, moment, kind::ball_path, {game.watched->body});
  e.p_W = game.watched->watch.last.X_WB.p;
  e.detail = path;
  return e;
}

void end_ball_path(Game& game, const Tick& tick) {
  std::optional<Event> path = ball_path_so_far(game, tick.world, tick.moment);
  if (!path) return;
  wear_lane(tick.world, tick.stage, game.watched->touched);
  game.watched.reset();
  tick.events.push_back(std::move(*path));
}

void note_step(Game& game, const Tick& tick) {
  note_releases(game, tick);
  note_contacts(game, tick);
  const bool strays = tells_strays_apart(tick.stage);
  if (tells_apart(tick.stage) || strays) credit(game, tick.stage, tick.world);
  if (strays) note_strays(game, tick);
  note_fallen(game, tick);
  follow_ball(game, tick);
}

}  // namespace headpin::scene
