#include "scene/session.h"

#include <algorithm>

#include <fmt/format.h>

#include "devices/log.h"
#include "scene/bodies.h"
#include "scene/game.h"
#include "scene/hand.h"

namespace headpin::scene {

namespace {

constexpr Time kMemory{1'000'000};  ///< how long poses are remembered

Time delay(const Session& s) {
  return microseconds(s.scenario.rig.delay_s);
}

bool is_skittle(const Session& s, engine::BodyId body) {
  return body >= s.first_skittle;
}

devices::Event event(const Session& s, std::string kind,
                     const std::vector<engine::BodyId>& bodies) {
  devices::Event e;
  e.time = s.now();
  e.tick = s.world.tick;
  e.kind = std::move(kind);
  for (const engine::BodyId body : bodies) e.bodies.push_back(s.world.bodies[body].name);
  return e;
}

/// Puts a sample where it belongs: tracker frame to world, receiver to head or hand.
void take(Session& s, const devices::TrackerSample& sample) {
  if (!sample.good()) return;
  const Rig& rig = s.scenario.rig;
  const Pose X_WS = rig.X_WT * sample.X_TS;
  if (sample.station == devices::kHeadStation) {
    s.player.head.push(sample.device_time, X_WS * rig.X_SD);
    s.player.head_arrival = devices::available(sample);
  }
  if (sample.station == devices::kHandStation)
    s.player.hand.push(sample.device_time, X_WS * rig.X_SH);
}

void take(Session& s, const devices::MouseSample& sample) {
  s.player.buttons.push_back(sample);
}

/// Pose and velocity of a ball carried by the hand at `time`.
///
/// The velocity is that of the hand over the last samples; a hand that has not been seen to move
/// stands still.
engine::State carried(const Session& s, Time time) {
  const Hand& hand = s.scenario.hand;
  const Pose X_WH = *s.player.hand.at(time);
  const std::vector<Stamped<Pose>>& track = s.player.hand.samples();
  const auto last = std::upper_bound(track.begin(), track.end(), time,
                                     [](Time t, const auto& sample) { return t < sample.time; });
  const std::span<const Stamped<Pose>> seen(track.begin(), last);
  const ReleaseWindow window = release_window(hand);
  Twist V_WB;
  if (seen.size() >= 2 && seen[seen.size() - 2].time >= seen.back().time - window.longest()) {
    V_WB = release_velocity(seen, hand.grip, window);
  }
  return {{X_WH.q * s.player.q_HB, X_WH * hand.grip}, V_WB.v, V_WB.w};
}

void grab(Session& s, Time time) {
  const std::optional<Pose> X_WH = s.player.hand.at(time);
  if (!X_WH) return;
  const engine::State& ball = s.world.states[s.ball];
  const double gap = (ball.X_WB.p - X_WH->p).norm() - s.scenario.ball.radius;
  if (gap > s.scenario.hand.reach) return;
  s.player.grips = true;
  s.player.q_HB = X_WH->q.conjugate() * ball.X_WB.q;
  engine::set_kind(s.world, s.ball, engine::Kind::driven);
  s.events.push_back(event(s, "grab", {s.ball}));
  s.events.back().p_W = ball.X_WB.p;
}

/// Lets go at `time`, and lets the ball fly until now, which is later by less than a tick.
void release(Session& s, Time time, Time now) {
  engine::State ball = carried(s, time);
  ball.X_WB.p += seconds(now - time) * ball.v_WB;
  s.player.grips = false;
  engine::set_kind(s.world, s.ball, engine::Kind::free);
  engine::set_state(s.world, s.ball, ball);
  if (!s.score.release_speed) s.score.release_speed = ball.v_WB.norm();
  s.events.push_back(event(s, "release", {s.ball}));
  s.events.back().p_W = ball.X_WB.p;
  s.events.back().value = ball.v_WB.norm();
}

/// Moves the hand to where it is now, and does what the buttons say on the way.
void drive_hand(Session& s, Time now) {
  Player& player = s.player;
  std::size_t done = 0;
  for (; done < player.buttons.size() && player.buttons[done].device_time <= now; ++done) {
    const devices::MouseSample& button = player.buttons[done];
    if (button.trigger && !player.trigger && !player.grips) grab(s, button.device_time);
    if (!button.trigger && player.grips) release(s, button.device_time, now);
    player.trigger = button.trigger;
  }
  player.buttons.erase(player.buttons.begin(),
                       player.buttons.begin() + static_cast<std::ptrdiff_t>(done));
  if (player.grips) engine::set_state(s.world, s.ball, carried(s, now));
  player.head.forget_before(now - kMemory);
  player.hand.forget_before(now - kMemory);
}

/// What the step's meetings mean for the game.
void note_contacts(Session& s, double ball_speed_before) {
  for (const engine::ContactEvent& contact : s.world.events) {
    if (!contact.first || (!is_skittle(s, contact.a) && !is_skittle(s, contact.b))) continue;
    const bool with_ball = contact.a == s.ball || contact.b == s.ball;
    devices::Event e = event(s, "touch", {contact.a, contact.b});
    e.p_W = contact.p_W;
    e.j_W = contact.impulse_W;
    e.value = contact.approach_speed;
    if (with_ball && !s.score.impact_speed) {
      s.score.impact_speed = ball_speed_before;
      e.kind = "first_contact";
      e.value = ball_speed_before;
    }
    s.events.push_back(std::move(e));
  }
}

void note_fallen(Session& s) {
  for (std::size_t i = 0; i < s.score.down.size(); ++i) {
    const auto body = static_cast<engine::BodyId>(s.first_skittle + i);
    const engine::State& state = s.world.states[body];
    if (s.score.down[i] || !has_fallen(state.X_WB)) continue;
    s.score.down[i] = true;
    s.events.push_back(event(s, "skittle_down", {body}));
    s.events.back().p_W = state.X_WB.p;
    s.events.back().value = s.score.skittles_down();
  }
}

}  // namespace

int Score::skittles_down() const {
  return static_cast<int>(std::count(down.begin(), down.end(), true));
}

Time Session::now() const {
  return tick_time(world.tick, scenario.rates.physics_hz);
}

Session make_session(const Scenario& scenario) {
  Session s;
  s.scenario = scenario;
  s.world = engine::make_world(world_parameters(scenario));
  for (const Fixture& fixture : room_fixtures(scenario)) {
    engine::add_body(s.world, fixture.body, {fixture.X_WB, Vec3::Zero(), Vec3::Zero()});
  }
  s.ball = engine::add_body(s.world, ball_body(scenario),
                            {{Quat::Identity(), scenario.ball.home}, Vec3::Zero(), Vec3::Zero()});
  engine::set_kind(s.world, s.ball, engine::Kind::driven);  // on its stand until it is taken
  s.first_skittle = s.ball + 1;
  engine::Body skittle = skittle_body(scenario);
  for (const Vec2& spot : scenario.rack.spots) {
    skittle.name = fmt::format("skittle {}", s.world.bodies.size() - s.first_skittle + 1);
    const Vec3 p_WB(spot.x(), scenario.lane.head_pin + spot.y(), centre_height(scenario));
    const engine::BodyId body =
        engine::add_body(s.world, skittle, {{Quat::Identity(), p_WB}, Vec3::Zero(), Vec3::Zero()});
    engine::put_to_sleep(s.world, body);  // skittles stand until they are struck
  }
  s.score.down.assign(scenario.rack.spots.size(), false);
  return s;
}

std::vector<std::string> body_names(const Session& session) {
  std::vector<std::string> names;
  for (const engine::Body& body : session.world.bodies) names.push_back(body.name);
  return names;
}

void advance(Session& s, devices::Source& source) {
  const Time now = tick_time(s.world.tick + 1, s.scenario.rates.physics_hz);
  s.samples.clear();
  s.events.clear();
  source.poll(now, s.samples);
  for (const devices::Sample& sample : s.samples) {
    std::visit([&](const auto& one) { take(s, one); }, sample);
  }
  drive_hand(s, now - delay(s));
  const double ball_speed = s.world.states[s.ball].v_WB.norm();
  engine::step(s.world);
  s.statistics += s.world.statistics;
  note_contacts(s, ball_speed);
  note_fallen(s);
}

void tick_state(const Session& s, devices::TickState& out) {
  out.time = s.now();
  out.tick = s.world.tick;
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

std::optional<Pose> head_pose(const Session& s) {
  return s.player.head.at(s.now() - delay(s));
}

std::optional<Pose> hand_pose(const Session& s) {
  return s.player.hand.at(s.now() - delay(s));
}

}  // namespace headpin::scene
