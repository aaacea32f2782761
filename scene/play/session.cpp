#include "scene/play/session.h"

#include <algorithm>
#include <span>
#include <utility>

#include "scene/play/referee.h"
#include "scene/play/score.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

Tick tick_at(Session& s, const Moment& moment) {
  return {*s.stage, s.world, moment, s.events};
}

/// A pose of the tracked space at `now`, in the world.
std::optional<Pose> in_room(const Session& s, const devices::PoseTrack& track, Time now) {
  const std::optional<Pose> X_PX = track.at(now - microseconds(s.scenario().rig.delay_s));
  if (!X_PX) return std::nullopt;
  return s.player.walk.X_WP() * *X_PX;
}

/// X_WH; nothing while it is away.
std::optional<Pose> hand_at(const Session& s, Time now) {
  const Rig& rig = s.scenario().rig;
  const auto X_PH = present_hand(s.player, rig, now - microseconds(rig.delay_s));
  return X_PH ? std::optional(s.player.walk.X_WP() * *X_PH) : std::nullopt;
}

bool has_buttons(const Session& s) {
  return s.versions[0] != nullptr;
}

/// The button that the hand touches, from wrist to fingertips.
std::optional<std::size_t> button_at_hand(const Session& s, Time now) {
  const std::optional<Pose> X_WH = hand_at(s, now);
  if (!X_WH) return std::nullopt;
  constexpr double kToFingertips = 0.12, kThick = 0.015;
  const Versions& v = s.scenario().version;
  const std::array<Vec3, 2> buttons = {v.red.button, v.blue.button};
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    const Vec3 p_H = X_WH->inverse() * buttons[i];
    const Vec3 nearest(0.0, 0.0, std::clamp(p_H.z(), -kToFingertips, 0.0));
    if ((p_H - nearest).norm() <= v.radius + kThick) return i;
  }
  return std::nullopt;
}

/// Counts the moving ball, or one that is let go now, for the version in which it was thrown. A copy
/// of its world continues without the player until the ball is counted; the resulting events happen
/// now.
///
/// @return  the world after that
engine::World count_ahead(const Session& s, const Moment& moment, std::vector<Event>& out) {
  engine::World world = s.world;
  std::vector<Event> now;
  for (const Event& e : s.events) {
    if (e.kind == kind::release && is_of_ball(e)) now.push_back(e);
  }
  if (s.scenario().game.ends != BallEnds::rest || (!s.game.thrown && now.empty())) {
    if (auto path = ball_path_so_far(s.game, world, moment)) out.push_back(std::move(*path));
    return world;
  }
  Game game = s.game;
  if (s.stage->hand) {
    engine::set_state(world, *s.stage->hand, {kAway, Vec3::Zero(), Vec3::Zero()});
  }
  std::optional<engine::BodyId> held;
  if (s.player.held) {
    held = s.player.held->body;
    engine::set_state(world, *held, {world.states[*held].X_WB, Vec3::Zero(), Vec3::Zero()});
  }
  engine::Workspace workspace;
  std::size_t told = now.size();  // the releases
  Tick tick{*s.stage, world, moment, now};
  do {
    note_velocities(game, world);
    engine::step(world, workspace);
    note_step(game, tick);
    referee(game, tick, held);
    for (Event& e : std::span(now).subspan(told)) {
      if (e.kind == kind::ball_back) continue;
      e.time = moment.time;
      e.tick = moment.tick;
      out.push_back(std::move(e));
    }
    now.clear();
    told = 0;
    const std::int64_t next = tick.moment.tick + 1;
    tick.moment = {tick_time(next, s.scenario().rates.physics_hz), next};
  } while (game.thrown);
  // Where no ball is counted, as after the last frame, it is still on its way.
  if (auto path = ball_path_so_far(game, world, moment)) out.push_back(std::move(*path));
  return world;
}

/// Sets up the world of a version. Tick and ledger continue.
void start_version(Session& s, std::size_t version, const Moment& moment) {
  const engine::World ahead = count_ahead(s, moment, s.events);
  const engine::World before = std::move(s.world);
  const std::shared_ptr<const Stage> last = std::exchange(s.stage, s.versions[version]);
  s.world = s.stage->world;
  take_over_wear(s.world, *s.stage, ahead, *last);
  s.world.tick = before.tick;
  s.world.ledger = before.ledger;
  s.world.memory.balance = before.memory.balance;  // the next step books the difference
  s.player.held.reset();
  s.player.leaving.reset();
  s.game = make_game(*s.stage);
  s.presence = {};
  s.version_begun = true;
  s.version = version + 1;
  Event e = event(tick_at(s, moment), kind::version, {});
  const Versions& v = s.scenario().version;
  e.p_W = version == 0 ? v.red.button : v.blue.button;
  e.value = static_cast<double>(version);
  e.detail = version == 0 ? Colour::red : Colour::blue;
  s.events.push_back(std::move(e));
}

/// A button acts when the hand begins to touch it, not while the hand stays there.
void touch_buttons(Session& s, const Moment& moment) {
  if (!has_buttons(s)) return;
  const std::optional<std::size_t> now = button_at_hand(s, moment.time);
  if (now && now != s.touched) start_version(s, *now, moment);
  s.touched = now;
}

}  // namespace

Session make_session(std::shared_ptr<const Stage> stage) {
  Session s;
  s.stage = std::move(stage);
  const Versions& v = s.stage->scenario.version;
  if (v.buttons) {
    s.versions = {std::make_shared<const Stage>(make_stage(under(s.stage->scenario, v.red))),
                  std::make_shared<const Stage>(make_stage(under(s.stage->scenario, v.blue)))};
    s.unbegun = s.stage;
  }
  s.world = s.stage->world;
  s.state_hash = engine::state_hash(s.world);
  s.game = make_game(*s.stage);
  return s;
}

Session make_session(const Scenario& scenario) {
  return make_session(std::make_shared<const Stage>(make_stage(scenario)));
}

void set_response(Session& s, const engine::Response& response) {
  for (std::shared_ptr<const Stage>* of : {&s.stage, &s.versions[0], &s.versions[1]}) {
    if (!*of) continue;
    auto stage = std::make_shared<Stage>(**of);
    engine::set_response(stage->world, response);
    *of = std::move(stage);
  }
  engine::set_response(s.world, response);
  s.hashes = false;
}

void advance(Session& s, devices::Source& source) {
  const Moment moment{s.next_tick(), s.tick + 1};
  s.samples.clear();
  s.events.clear();
  source.poll(moment.time, s.samples);
  for (devices::Sample& sample : s.samples) {
    std::visit([&](auto& one) { one.session_time = moment.time; }, sample);
  }
  drive(s.player, s.samples, tick_at(s, moment));
  watch_tracking(s.tracking, s.player, moment.time - microseconds(s.scenario().rig.delay_s),
                 tick_at(s, moment));
  touch_buttons(s, moment);  // may begin a version, which has a stage of its own
  const Tick tick = tick_at(s, moment);
  note_velocities(s.game, s.world);
  engine::step(s.world, s.workspace);
  s.tick = moment.tick;
  s.statistics += s.world.statistics;
  note_step(s.game, tick);
  watch(s.presence, s.player, tick);
  const std::optional<engine::BodyId> held =
      s.player.held ? std::optional(s.player.held->body) : std::nullopt;
  const bool counts = !has_buttons(s) || s.version_begun;
  if (counts && referee(s.game, tick, held)) {
    s.player.held.reset();
    s.player.grip_changed = moment.time;
  }
  if (!s.hashes) return;
  s.state_hash = engine::state_hash(s.world);
  s.game_hash.add(s.state_hash, s.version);
}

std::optional<Event> last_ball_path(const Session& s) {
  return ball_path_so_far(s.game, s.world, {s.now(), s.tick});
}

void tick_state(const Session& s, TickState& out) {
  out.time = s.now();
  out.tick = s.tick;
  out.hash = s.state_hash;
  out.contacts = static_cast<std::int32_t>(s.world.statistics.contacts);
  out.bodies.resize(s.world.states.size());
  for (std::size_t i = 0; i < out.bodies.size(); ++i) {
    const engine::State& state = s.world.states[i];
    out.bodies[i] = {state.X_WB,
                     {state.v_WB, state.w_WB},
                     engine::is_asleep(s.world, static_cast<engine::BodyId>(i))};
  }
}

std::optional<Pose> head_pose(const Session& s) {
  return in_room(s, s.player.head, s.now());
}

std::optional<Pose> head_pose(const Session& s, Time at) {
  const std::optional<Pose> X_PD = s.player.head.at(at - microseconds(s.scenario().rig.delay_s));
  if (!X_PD) return std::nullopt;
  return s.player.walk.X_WP(seconds(s.now() - at)) * *X_PD;
}

std::optional<Pose> hand_pose(const Session& s) {
  return hand_at(s, s.now());
}

}  // namespace headpin::scene
