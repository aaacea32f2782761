#include "scene/game.h"

#include <algorithm>

#include "scene/events.h"

namespace headpin::scene {

devices::Event event(const Moment& moment, std::string_view kind, const engine::World& world,
                     std::initializer_list<engine::BodyId> bodies) {
  devices::Event e;
  e.time = moment.time;
  e.tick = moment.tick;
  e.kind = kind;
  for (const engine::BodyId body : bodies) e.bodies.push_back(world.bodies[body].name);
  return e;
}

namespace {

void note_contacts(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
                   std::vector<devices::Event>& out) {
  for (const engine::ContactEvent& contact : world.events) {
    const Role a = stage.roles[contact.a], b = stage.roles[contact.b];
    const bool of_skittle = a == Role::skittle || b == Role::skittle;
    const bool of_ball = a == Role::ball || b == Role::ball;
    const bool of_hand = a == Role::hand || b == Role::hand;
    if (!contact.first || (!of_skittle && !of_ball)) continue;
    const std::string_view what = of_hand      ? kind::hand_touch
                                  : of_skittle ? kind::touch
                                               : kind::ball_touch;
    devices::Event e = event(moment, what, world, {contact.a, contact.b});
    e.p_W = contact.p_W;
    e.j_W = contact.impulse_W;
    e.value = contact.approach_speed;
    if (of_skittle && of_ball && !game.struck) {
      game.struck = true;
      e.kind = kind::first_contact;
      e.value = game.speeds[a == Role::ball ? contact.a : contact.b];
    }
    out.push_back(std::move(e));
  }
}

void note_fallen(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
                 std::vector<devices::Event>& out) {
  for (const engine::BodyId skittle : stage.skittles) {
    const Pose& X_WB = world.states[skittle].X_WB;
    const bool carried = world.bodies[skittle].kind == engine::Kind::driven;
    if (game.down[skittle] || carried || !has_fallen(X_WB)) continue;
    game.down[skittle] = 1;
    devices::Event e = event(moment, kind::skittle_down, world, {skittle});
    e.p_W = X_WB.p;
    e.value = static_cast<double>(std::count(game.down.begin(), game.down.end(), 1));
    out.push_back(std::move(e));
  }
}

}  // namespace

Game make_game(const Stage& stage) {
  Game game;
  game.down.assign(stage.roles.size(), 0);
  game.swept.assign(stage.roles.size(), 0);
  return game;
}

bool has_fallen(const Pose& X_WB) {
  constexpr double kCos20Degrees = 0.93969262078590838;
  return (X_WB.q * Vec3::UnitZ()).z() < kCos20Degrees;
}

void note_speeds(Game& game, const engine::World& world) {
  game.speeds.clear();
  for (const engine::State& state : world.states) game.speeds.push_back(state.v_WB.norm());
}

void note_step(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
               std::vector<devices::Event>& out) {
  note_contacts(game, stage, world, moment, out);
  note_fallen(game, stage, world, moment, out);
}

}  // namespace headpin::scene
