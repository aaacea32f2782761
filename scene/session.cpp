#include "scene/session.h"

namespace headpin::scene {

Session make_session(std::shared_ptr<const Stage> stage) {
  Session s;
  s.stage = std::move(stage);
  s.world = s.stage->world;
  s.game = make_game(*s.stage);
  return s;
}

Session make_session(const Scenario& scenario) {
  return make_session(std::make_shared<const Stage>(make_stage(scenario)));
}

void advance(Session& s, devices::Source& source) {
  const Moment moment{s.next_tick(), s.tick + 1};
  s.samples.clear();
  s.events.clear();
  source.poll(moment.time, s.samples);
  for (devices::Sample& sample : s.samples) {
    std::visit([&](auto& one) { one.session_time = moment.time; }, sample);
  }
  drive(s.player, s.samples, *s.stage, s.world, moment, s.events);
  note_speeds(s.game, s.world);
  engine::step(s.world);
  s.tick = moment.tick;
  s.statistics += s.world.statistics;
  play(s.game, *s.stage, s.world, moment, s.events);
}

void tick_state(const Session& s, devices::TickState& out) {
  out.time = s.now();
  out.tick = s.tick;
  out.hash = engine::state_hash(s.world);
  out.contacts = static_cast<std::int32_t>(s.world.statistics.contacts);
  out.bodies.resize(s.world.states.size());
  for (std::size_t i = 0; i < out.bodies.size(); ++i) {
    const engine::State& state = s.world.states[i];
    out.bodies[i] = {state.X_WB,
                     {state.v_WB, state.w_WB},
                     engine::is_asleep(s.world, static_cast<engine::BodyId>(i))};
  }
}

namespace {

/// A pose of the tracked space now, in the world.
std::optional<Pose> in_room(const Session& s, const devices::PoseTrack& track) {
  const std::optional<Pose> X_PX = track.at(s.now() - microseconds(s.scenario().rig.delay_s));
  if (!X_PX) return std::nullopt;
  return s.player.walk.X_WP() * *X_PX;
}

}  // namespace

std::optional<Pose> head_pose(const Session& s) {
  return in_room(s, s.player.head);
}

std::optional<Pose> hand_pose(const Session& s) {
  return in_room(s, s.player.hand);
}

}  // namespace headpin::scene
