#include "scene/play/player.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/base/sources.h"
#include "scene/play/hand.h"
#include "scene/play/release.h"
#include "scene/play/since.h"
#include "scene/record/details.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

constexpr Time kMemory{1'000'000};  ///< how long poses are stored

Event& note(const Tick& tick, std::string_view kind, engine::BodyId body, double value = 0.0) {
  Event e = event(tick, kind, {body});
  e.p_W = tick.world.states[body].X_WB.p;
  e.value = value;
  return tick.events.emplace_back(std::move(e));
}

/// Whether a release uses the hand's velocity at the time of the trigger.
bool at_trigger(const Hand& hand) {
  return hand.release_at == ReleaseAt::trigger;
}

/// Adds a sample to the track of head or hand, in the tracked space.
void take(Player& player, const Rig& rig, const devices::TrackerSample& sample) {
  const bool on_head = sample.station == rig.head_station;
  const bool in_hand = sample.station == rig.hand_station && sample.places_hand();
  if (!sample.good() || (!on_head && !in_hand)) return;
  const Pose X_PS = sensor_in_space(sample, rig);
  if (on_head) {
    const bool newer = player.head.push(sample.device_time, X_PS * rig.X_SD);
    if (newer) player.head_arrival = devices::arrival(sample);
  } else {
    player.hand.push(sample.device_time, X_PS * rig.X_SH);
  }
}

void take(Player& player, const Rig&, const devices::MouseSample& sample) {
  player.buttons.push_back(sample);
}

/// X_WH at `time`, not later than `now`.
std::optional<Pose> hand_at(const Player& player, Time time, Time now) {
  const std::optional<Pose> X_PH = player.hand.at(time);
  if (!X_PH) return std::nullopt;
  return player.walk.X_WP(seconds(now - time)) * *X_PH;
}

/// Velocity in the tracked space of a point of the hand at its last sample before `time`; zero
/// without enough samples.
Twist velocity_at_sample(const Player& player, const Hand& hand, const Vec3& p_HB, Time time) {
  const std::vector<Stamped<Pose>>& track = player.hand.samples();
  const auto last = std::upper_bound(track.begin(), track.end(), time,
                                     [](Time t, const auto& sample) { return t < sample.time; });
  const auto seen = std::span(track).first(static_cast<std::size_t>(last - track.begin()));
  const ReleaseWindow window = release_window(hand);
  if (seen.size() < 2 || seen[seen.size() - 2].time < seen.back().time - window.longest())
    return {};
  return release_velocity(seen, p_HB, window);
}

/// Motion of a point of the hand at `time`. Its velocity includes that of the walk.
Motion hand_motion(const Player& player, const Scenario& scenario, const Vec3& p_HB, Time time) {
  const Hand& hand = scenario.hand;
  Motion motion;
  if (at_trigger(hand)) {
    const Time last = told_until(time, scenario.rig.delay_s + scenario.rig.predicted_s);
    const std::vector<Stamped<Pose>>& track = player.hand.samples();
    const auto end = std::ranges::upper_bound(track, last, {}, &Stamped<Pose>::time);
    const auto told = std::span(track).first(static_cast<std::size_t>(end - track.begin()));
    motion = motion_at(told, time, p_HB, release_window(hand));
  } else {
    motion.V_WB = velocity_at_sample(player, hand, p_HB, time);
  }
  motion.V_WB.v += player.walk.v_WP;
  return motion;
}

/// State of the carried body at a time, and how its motion is known.
struct Carried {
  engine::State state;
  Motion motion;
};

/// The carried body in a hand with this pose and motion.
Carried in_hand(const Player& player, const Hand& hand, const Pose& X_WH, const Motion& motion) {
  return {{{X_WH.q * player.held->q_HB, X_WH * hand.grip}, motion.V_WB.v, motion.V_WB.w}, motion};
}

/// The carried body at `time`, not later than `now`.
Carried carried(const Player& player, const Scenario& scenario, Time time, Time now) {
  const Hand& hand = scenario.hand;
  const Pose X_WH = *hand_at(player, time, now);
  return in_hand(player, hand, X_WH, hand_motion(player, scenario, hand.grip, time));
}

/// Rules 1 to 10 left impossible samples out of the velocity alone: the body left from where such a
/// sample showed the hand.
bool places_by_possible_samples(const Scenario& scenario) {
  return scenario.collision.rules >= 11;
}

/// The carried body at the time of its release, where samples that are left out do not count.
Carried at_release(const Player& player, const Scenario& scenario, Time time, Time now) {
  const Carried held = carried(player, scenario, time, now);
  const Motion& motion = held.motion;
  if (motion.left_out == 0 || !motion.X_PH || !places_by_possible_samples(scenario)) return held;
  const Pose X_WH = player.walk.X_WP(seconds(now - time)) * *motion.X_PH;
  return in_hand(player, scenario.hand, X_WH, motion);
}

/// The state from which a driven body reaches this pose at the end of the tick.
engine::State ending_at(engine::State state, double dt) {
  state.X_WB.p -= dt * state.v_WB;
  state.X_WB.q = (rotation(-dt * state.w_WB) * state.X_WB.q).normalized();
  return state;
}

/// Distance from a point to the surface of a ball, or to the cylinder around a skittle [m].
double gap_to(const Stage& stage, const engine::World& world, engine::BodyId body,
              const Vec3& p_W) {
  const Pose& X_WB = world.states[body].X_WB;
  if (stage.roles[body] == Role::ball) {
    return (X_WB.p - p_W).norm() - stage.scenario.ball.radius;
  }
  const Vec3 p_B = X_WB.inverse() * p_W;
  const double low = -stage.skittle_centre, high = low + stage.scenario.skittle.height;
  return (p_B - Vec3(0.0, 0.0, std::clamp(p_B.z(), low, high))).norm() - stage.widest_skittle;
}

/// Grabs the nearest ball or skittle, if it is within reach.
void grab(Player& player, const Tick& tick, Time time, Time now) {
  const std::optional<Pose> X_WH = hand_at(player, time, now);
  if (!X_WH || hand_is_away(player, tick.stage.scenario.rig, now)) return;
  std::optional<engine::BodyId> nearest;
  double least = std::numeric_limits<double>::max();
  const auto consider = [&](engine::BodyId body) {
    const double gap = gap_to(tick.stage, tick.world, body, X_WH->p);
    if (gap > least) return;
    nearest = body;
    least = gap;
  };
  for (const engine::BodyId ball : tick.stage.balls) consider(ball);
  if (tick.stage.scenario.hand.takes_skittles) {
    for (const engine::BodyId skittle : tick.stage.skittles) consider(skittle);
  }
  if (!nearest) return;
  if (least > tick.stage.scenario.hand.reach) {
    note(tick, kind::missed_grab, *nearest, least);
    return;
  }
  const Quat& q_WB = tick.world.states[*nearest].X_WB.q;
  player.held = {*nearest, X_WH->q.conjugate() * q_WB};
  player.grip_changed = tick.moment.time;
  engine::set_kind(tick.world, *nearest, engine::Kind::driven);
  Event& e = note(tick, kind::grab, *nearest);
  if (at_trigger(tick.stage.scenario.hand)) e.time -= now - time;
}

/// A ball as it leaves the fingers, which turn it more than the hand does.
Carried from_fingers(Carried carried, const Player& player, const Hand& hand) {
  const bool at_rest = at_trigger(hand) && carried.motion.known == Known::impossible;
  if (at_rest || hand.spin.isZero(0.0)) return carried;
  const Quat q_WH = carried.state.X_WB.q * player.held->q_HB.conjugate();
  carried.state.w_WB += q_WH * hand.spin;
  carried.motion.V_WB.w = carried.state.w_WB;
  return carried;
}

Carried changed(Carried carried, const ReleaseChange& by, double board) {
  if (by == ReleaseChange{}) return carried;
  carried.state = changed(carried.state, by, board);
  carried.motion.V_WB = {carried.state.v_WB, carried.state.w_WB};
  return carried;
}

/// The body as it leaves the hand, with all that the scenario and the player change.
Carried let_go(const Player& player, const Tick& tick, Time time, Time now) {
  const Scenario& scenario = tick.stage.scenario;
  const Carried held = at_release(player, scenario, time, now);
  if (tick.stage.roles[player.held->body] != Role::ball) return held;
  const double board = scenario.lane.width / kBoards;
  const Carried own = from_fingers(held, player, scenario.hand);
  return changed(changed(own, scenario.release, board), player.release_change, board);
}

/// For how long a ball that left the hand `flown` before the step has fallen by itself [s].
double fall_before_step(const Tick& tick, double flown) {
  const Hand& hand = tick.stage.scenario.hand;
  if (!falls_until_a_late_release(tick.world.parameters)) return 0.0;
  if (!at_trigger(hand) && !hand.falls_at_once) flown -= engine::step_seconds(tick.world);
  return std::max(0.0, flown);
}

/// A ball after a fall of `time` [s]. It lies on what is fixed, and does not bounce.
engine::State fallen(const Tick& tick, engine::BodyId body, engine::State state, double time) {
  constexpr double kMostPieces = 240.0;  // however late it is
  const Vec3& gravity = tick.world.parameters.gravity_W;
  const double pieces =
      std::clamp(std::ceil(time / engine::step_seconds(tick.world)), 1.0, kMostPieces);
  const double dt = time / pieces;
  for (int i = 0; i < static_cast<int>(pieces); ++i) {
    engine::set_state(tick.world, body, state);
    state.X_WB.p += dt * (state.v_WB + 0.5 * dt * gravity);
    state.X_WB.q = (rotation(dt * state.w_WB) * state.X_WB.q).normalized();
    state.v_WB += dt * gravity;
    state = engine::outside_fixed(tick.world, body, state);
  }
  return state;
}

/// Releases the ball at `time` and lets it fly until `now`, which is less than a tick later unless the
/// trigger came late. With release at the trigger, it flies only until the start of the tick that the
/// step will make; this may be before the release.
void release(Player& player, const Tick& tick, Time time, Time now) {
  const engine::BodyId body = player.held->body;
  const Hand& hand = tick.stage.scenario.hand;
  auto [state, motion] = let_go(player, tick, time, now);
  Released told{.trigger_s = nearest_seconds(time),
                .p_WB = state.X_WB.p,
                .v_WB = state.v_WB,
                .w_WB = state.w_WB,
                .known = {},
                .extrapolated = {},
                .left_out = {}};
  double flown = seconds(now - time);
  if (at_trigger(hand)) flown -= engine::step_seconds(tick.world);
  const double fall = fall_before_step(tick, flown);
  flown -= fall;
  const Vec3 gained = flown * tick.world.parameters.gravity_W;
  state.X_WB.p += flown * state.v_WB;
  if (at_trigger(hand)) {
    state.X_WB.q = (rotation(flown * state.w_WB) * state.X_WB.q).normalized();
  }
  if (hand.falls_at_once) state.X_WB.p += 0.5 * flown * gained;
  const Vec3 p_in_hand = state.X_WB.p;
  state = engine::outside_fixed(tick.world, body, state);
  *told.p_WB += state.X_WB.p - p_in_hand;
  const double speed = state.v_WB.norm();
  if (hand.falls_at_once) state.v_WB += gained;
  if (fall > 0.0) state = fallen(tick, body, state, fall);
  player.held.reset();
  player.grip_changed = tick.moment.time;
  player.leaving = body;
  engine::set_kind(tick.world, body, engine::Kind::free);
  engine::set_state(tick.world, body, state);
  Event& e = note(tick, kind::release, body, speed);
  e.p_W = *told.p_WB;
  if (at_trigger(hand)) {
    e.time -= now - time;
    set_motion(told, motion);
  }
  e.detail = told;
}

/// Moves the held body with the hand, outside of fixed bodies now and at the end of the tick.
void carry(const Player& player, const Tick& tick, Time now) {
  const engine::BodyId body = player.held->body;
  engine::World& world = tick.world;
  const Hand& hand = tick.stage.scenario.hand;
  const double dt = engine::step_seconds(world);
  engine::State state = carried(player, tick.stage.scenario, now, now).state;
  const engine::State there = state;
  if (at_trigger(hand)) state = ending_at(state, dt);
  state = engine::outside_fixed(world, body, state);
  engine::set_state(world, body, state);
  engine::State ahead = state;
  ahead.X_WB.p += dt * state.v_WB;
  const Vec3 p_WB = engine::outside_fixed(world, body, at_trigger(hand) ? there : ahead).X_WB.p;
  if (p_WB == ahead.X_WB.p) return;  // no fixed body is in its way
  state.v_WB = (p_WB - state.X_WB.p) / dt;
  engine::set_state(world, body, state);
}

/// Whether the released body is clear of the hand.
bool clear_of(const Player& player, const engine::World& world, const Pose& X_WH,
              double hand_radius) {
  if (!player.leaving) return true;
  const double apart = (world.states[*player.leaving].X_WB.p - X_WH.p).norm();
  return apart > world.bodies[*player.leaving].shape->bounding_radius + hand_radius;
}

/// Moves the hand's body to the hand, or away.
void place_hand(Player& player, const Tick& tick, Time now) {
  constexpr double kOpenHand = 0.13;  // from the palm's middle to the fingertips [m]
  const bool away = hand_is_away(player, tick.stage.scenario.rig, now);
  const std::optional<Pose> X_WH = away ? std::nullopt : hand_at(player, now, now);
  const double hand_radius =
      tick.stage.hand ? tick.world.bodies[*tick.stage.hand].shape->bounding_radius : kOpenHand;
  if (X_WH && clear_of(player, tick.world, *X_WH, hand_radius)) player.leaving.reset();
  if (!tick.stage.hand) return;
  const engine::BodyId body = *tick.stage.hand;
  if (!X_WH || player.held || player.leaving) {
    if (tick.world.states[body].X_WB.p == kAway.p) return;
    return engine::set_state(tick.world, body, {kAway, Vec3::Zero(), Vec3::Zero()});
  }
  const Hand& hand = tick.stage.scenario.hand;
  const auto find = [&] {
    return hand_motion(player, tick.stage.scenario, Vec3::Zero(), now).V_WB;
  };
  const Twist V_WH = player.velocities ? player.velocities->at(now, find) : find();
  const engine::State state{*X_WH, V_WH.v, V_WH.w};
  const double dt = engine::step_seconds(tick.world);
  engine::set_state(tick.world, body, at_trigger(hand) ? ending_at(state, dt) : state);
}

}  // namespace

bool hand_is_away(const Player& player, const Rig& rig, Time now) {
  if (rig.away_after_s == 0.0) return false;
  const std::optional<devices::KnownPose> known = player.hand.read(now);
  return known && now - known->last > microseconds(rig.away_after_s);
}

std::optional<Pose> present_hand(const Player& player, const Rig& rig, Time now) {
  return hand_is_away(player, rig, now) ? std::nullopt : player.hand.at(now);
}

Pose sensor_in_space(const devices::TrackerSample& sample, const Rig& rig) {
  if (sample.in_transmitters_frame()) return rig.X_WT * sample.X_TS;
  throw std::runtime_error(
      fmt::format("a sample of station {} at {:.6f} s is in frame '{}'; expected T, the "
                  "transmitter's",
                  sample.station, seconds(sample.device_time), sample.frame));
}

void follow(Player& player, std::span<const devices::Sample> samples, const Scenario& scenario,
            Time now) {
  for (const devices::Sample& sample : samples) {
    std::visit([&](const auto& one) { take(player, scenario.rig, one); }, sample);
  }
  for (const devices::MouseSample& button : player.buttons) {
    if (button.device_time > now) break;
    player.left_thumb = button.left_thumb;
    player.right_thumb = button.right_thumb;
  }
  const int thumbs = static_cast<int>(player.left_thumb) - static_cast<int>(player.right_thumb);
  const double dt = 1.0 / static_cast<double>(scenario.rates.physics_hz);
  const std::optional<Pose> X_PD = player.head.at(now);
  if (!X_PD) return;
  const bool by_hand = scenario.walk.along == WalkAlong::hand;
  const std::optional<Pose> X_PX = by_hand ? present_hand(player, scenario.rig, now) : X_PD;
  // Without a pose of the hand there is no direction: the walk does not start, or it stops.
  step(player.walk, scenario, *X_PD, X_PX.value_or(*X_PD), X_PX ? thumbs : 0, dt);
}

void forget(Player& player, Time now) {
  const auto later = std::ranges::find_if(
      player.buttons, [&](const devices::MouseSample& button) { return button.device_time > now; });
  player.buttons.erase(player.buttons.begin(), later);
  player.head.forget_before(now - kMemory);
  player.hand.forget_before(now - kMemory);
}

engine::State changed(engine::State state, const ReleaseChange& by, double board) {
  if (by == ReleaseChange{}) return state;
  constexpr double kRadian = std::numbers::pi / 180.0;
  const Vec3 up(0.0, 0.0, 1.0);
  state.v_WB = by.speed * (rotation(-(by.direction_deg * kRadian) * up) * state.v_WB);
  state.X_WB.p += Vec3(-by.boards * board, 0.0, by.height);
  state.w_WB = by.revs * (rotation(by.rotation_deg * kRadian * up) * state.w_WB);
  const Vec3 level(state.v_WB.x(), state.v_WB.y(), 0.0);
  if (level.norm() > 0.0) state.w_WB += by.spin * level.normalized();
  return state;
}

void drive(Player& player, std::span<const devices::Sample> samples, const Tick& tick) {
  const Scenario& scenario = tick.stage.scenario;
  const Time now = tick.moment.time - microseconds(scenario.rig.delay_s);
  follow(player, samples, scenario, now);
  for (const devices::MouseSample& button : player.buttons) {
    if (button.device_time > now) break;
    if (button.trigger && !player.trigger && !player.held) {
      grab(player, tick, button.device_time, now);
    }
    if (!button.trigger && player.held) release(player, tick, button.device_time, now);
    player.trigger = button.trigger;
  }
  if (player.held) carry(player, tick, now);
  place_hand(player, tick, now);
  forget(player, now);
}

}  // namespace headpin::scene
