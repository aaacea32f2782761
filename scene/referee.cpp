#include <algorithm>

#include <fmt/format.h>

#include "scene/events.h"
#include "scene/game.h"

namespace headpin::scene {

namespace {

/// What one call of `referee` works on.
struct Field {
  Game& game;
  const Stage& stage;
  engine::World& world;
  const Moment& moment;
  std::optional<engine::BodyId> held;
  std::vector<devices::Event>& out;

  const GameRules& plan() const { return stage.scenario.game; }
  const Rules& rules() const { return rules_named(plan().rules); }
  int rack() const { return static_cast<int>(stage.skittles.size()); }
};

void note(const Field& f, std::string_view kind, double value, std::string detail = {}) {
  devices::Event e = event(f.moment, kind, f.world, {});
  e.value = value;
  e.detail = std::move(detail);
  f.out.push_back(std::move(e));
}

bool is_still(const engine::World& world, engine::BodyId body) {
  return world.bodies[body].kind != engine::Kind::free || engine::is_asleep(world, body);
}

bool at_rest(const engine::World& world, engine::BodyId body) {
  constexpr double kSlow = 0.01, kSlowSpin = 0.03;  // [m/s], [rad/s]
  const engine::State& state = world.states[body];
  return is_still(world, body) || (state.v_WB.norm() < kSlow && state.w_WB.norm() < kSlowSpin);
}

/// A ball rolls on for long: at this speed it has a quarter of what tips a skittle.
bool is_spent(const engine::World& world, engine::BodyId ball) {
  constexpr double kSlow = 0.05;  // [m/s]
  return is_still(world, ball) || world.states[ball].v_WB.norm() < kSlow;
}

/// Whether nothing moves any more that could fell another skittle.
bool all_at_rest(const Field& f) {
  return std::ranges::all_of(f.stage.balls, [&](auto ball) { return is_spent(f.world, ball); }) &&
         std::ranges::all_of(f.stage.skittles, [&](auto body) { return at_rest(f.world, body); });
}

bool is_down(const Field& f, engine::BodyId skittle) {
  const Pose& X_WB = f.world.states[skittle].X_WB;
  const Vec3& spot = f.stage.world.states[skittle].X_WB.p;
  return has_fallen(X_WB) || (X_WB.p - spot).head<2>().norm() > f.plan().off_spot;
}

/// Puts a skittle away: upright beside the others behind the wall ahead, where nobody comes or sees.
void put_away(const Field& f, engine::BodyId skittle) {
  constexpr double kBehind = 1.0, kApart = 0.3;
  engine::set_kind(f.world, skittle, engine::Kind::driven);
  engine::State away;
  away.X_WB.p = Vec3(kApart * static_cast<double>(skittle), f.stage.scenario.room.ahead + kBehind,
                     f.stage.skittle_centre);
  engine::set_state(f.world, skittle, away);
}

/// Puts a body back to where the stage has it, as if nothing had happened to it.
void put_back(const Field& f, engine::BodyId body) {
  engine::set_kind(f.world, body, f.stage.world.bodies[body].kind);
  engine::set_state(f.world, body, f.stage.world.states[body]);
  if (f.world.bodies[body].kind == engine::Kind::free) engine::put_to_sleep(f.world, body);
  engine::forget_meetings(f.world, body);
}

/// @return  skittles down by the ball that was thrown
int count(const Field& f) {
  devices::Event delivery = event(f.moment, kind::delivery, f.world, {});
  int felled = 0;
  for (const engine::BodyId skittle : f.stage.skittles) {
    if (f.game.swept[skittle] || !is_down(f, skittle)) continue;
    ++felled;
    delivery.bodies.push_back(f.world.bodies[skittle].name);
    f.game.swept[skittle] = 1;
    if (skittle != f.held) put_away(f, skittle);
  }
  delivery.value = felled;
  delivery.detail =
      fmt::format("frame {} ball {}", f.game.frames.size(), f.game.frames.back().size() + 1);
  f.out.push_back(std::move(delivery));
  return felled;
}

void set_rack(const Field& f) {
  for (const engine::BodyId skittle : f.stage.skittles) {
    if (skittle == f.held) continue;
    put_back(f, skittle);
    f.game.down[skittle] = f.game.swept[skittle] = 0;
  }
  f.game.struck = false;
}

void bring_balls_back(const Field& f) {
  for (const engine::BodyId ball : f.stage.balls) {
    if (f.world.bodies[ball].kind != engine::Kind::free) continue;  // waits or is carried
    put_back(f, ball);
    devices::Event back = event(f.moment, kind::ball_back, f.world, {ball});
    back.p_W = f.world.states[ball].X_WB.p;
    f.out.push_back(std::move(back));
  }
  f.game.struck = false;
}

void end_delivery(const Field& f) {
  const Rules& rules = f.rules();
  std::vector<Frame>& frames = f.game.frames;
  frames.back().push_back(count(f));
  bring_balls_back(f);
  const bool last = static_cast<std::int64_t>(frames.size()) == f.plan().frames;
  if (!is_over(rules, frames.back(), f.rack(), static_cast<int>(f.plan().balls), last)) {
    if (is_set_again(rules, frames.back(), f.rack())) set_rack(f);
    return;
  }
  note(f, kind::frame, static_cast<double>(frames.size()));
  if (last) {
    f.game.over = true;
    note(f, kind::game_over, points(rules, frames, f.rack()), in_words(rules, frames, f.rack()));
    return;
  }
  frames.emplace_back();
  set_rack(f);
}

}  // namespace

void referee(Game& game, const Stage& stage, engine::World& world, const Moment& moment,
             std::optional<engine::BodyId> held, std::vector<devices::Event>& out) {
  const Field f{game, stage, world, moment, held, out};
  if (!f.rules().counted || game.over) return;
  if (!game.begun) {
    game.begun = true;
    game.frames.assign(1, {});
    note(f, kind::game, f.rack(), f.plan().rules);
  }
  const bool under_way = std::ranges::any_of(stage.balls, [&](engine::BodyId ball) {
    return world.bodies[ball].kind == engine::Kind::free;
  });
  if (under_way && !game.thrown) game.thrown = moment.time;
  if (!game.thrown) return;
  constexpr Time kFirst{500'000};  // a ball let go at rest has not fallen yet
  const Time since = moment.time - *game.thrown;
  if (since < microseconds(f.plan().ball_back_s) && (since < kFirst || !all_at_rest(f))) return;
  game.thrown.reset();
  end_delivery(f);
}

}  // namespace headpin::scene
