#include "scene/player.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/sources.h"
#include "scene/events.h"
#include "scene/hand.h"

namespace headpin::scene {

namespace {

constexpr Time kMemory{1'000'000};  ///< how long poses are remembered

/// What one call of `drive` works on.
struct Scene {
  const Stage& stage;
  engine::World& world;
  const Moment& moment;
  std::vector<devices::Event>& out;
};

void note(const Scene& scene, std::string_view kind, engine::BodyId body, double value = 0.0) {
  devices::Event e = event(scene.moment, kind, scene.world, {body});
  e.p_W = scene.world.states[body].X_WB.p;
  e.value = value;
  scene.out.push_back(std::move(e));
}

/// Puts a sample where it belongs: to the world's frame, and on what its sensor is worn on.
void take(Player& player, const Rig& rig, const devices::TrackerSample& sample) {
  const bool on_head = sample.station == rig.head_station;
  if (!sample.good() || (!on_head && sample.station != rig.hand_station)) return;
  const Pose X_WS = sensor_in_world(sample, rig);
  if (on_head) {
    player.head.push(sample.device_time, X_WS * rig.X_SD);
    player.head_arrival = devices::arrival(sample);
  } else {
    player.hand.push(sample.device_time, X_WS * rig.X_SH);
  }
}

void take(Player& player, const Rig&, const devices::MouseSample& sample) {
  player.buttons.push_back(sample);
}

/// Pose and velocity of what the hand carries at `time`.
///
/// The velocity is that of the hand over the last samples; a hand that has not been seen to move
/// stands still.
engine::State carried(const Player& player, const Hand& hand, Time time) {
  const Pose X_WH = *player.hand.at(time);
  const std::vector<Stamped<Pose>>& track = player.hand.samples();
  const auto last = std::upper_bound(track.begin(), track.end(), time,
                                     [](Time t, const auto& sample) { return t < sample.time; });
  const std::span<const Stamped<Pose>> seen(track.begin(), last);
  const ReleaseWindow window = release_window(hand);
  Twist V_WB;
  if (seen.size() >= 2 && seen[seen.size() - 2].time >= seen.back().time - window.longest()) {
    V_WB = release_velocity(seen, hand.grip, window);
  }
  return {{X_WH.q * player.held->q_HB, X_WH * hand.grip}, V_WB.v, V_WB.w};
}

/// Takes the nearest ball, if it is within reach.
void grab(Player& player, const Scene& scene, Time time) {
  const std::optional<Pose> X_WH = player.hand.at(time);
  if (!X_WH) return;
  std::optional<engine::BodyId> nearest;
  double least = std::numeric_limits<double>::max();
  for (const engine::BodyId ball : scene.stage.balls) {
    const double radius = scene.world.bodies[ball].shape->bounding_radius;
    const double gap = (scene.world.states[ball].X_WB.p - X_WH->p).norm() - radius;
    if (gap > least) continue;
    nearest = ball;
    least = gap;
  }
  if (!nearest) return;
  if (least > scene.stage.scenario.hand.reach) {
    return note(scene, kind::missed_grab, *nearest, least);
  }
  const engine::State& ball = scene.world.states[*nearest];
  player.held = {*nearest, X_WH->q.conjugate() * ball.X_WB.q};
  engine::set_kind(scene.world, *nearest, engine::Kind::driven);
  note(scene, kind::grab, *nearest);
}

/// Lets go at `time`, and lets the ball fly until `now`, which is later by less than a tick.
void release(Player& player, const Scene& scene, Time time, Time now) {
  const engine::BodyId body = player.held->body;
  engine::State state = carried(player, scene.stage.scenario.hand, time);
  state.X_WB.p += seconds(now - time) * state.v_WB;
  state = engine::outside_fixed(scene.world, body, state);
  player.held.reset();
  engine::set_kind(scene.world, body, engine::Kind::free);
  engine::set_state(scene.world, body, state);
  note(scene, kind::release, body, state.v_WB.norm());
}

}  // namespace

Pose sensor_in_world(const devices::TrackerSample& sample, const Rig& rig) {
  if (sample.frame == "T") return rig.X_WT * sample.X_TS;
  if (sample.frame == "W") return sample.X_TS;
  throw std::runtime_error(
      fmt::format("a sample of station {} at {:.6f} s is in frame '{}'; expected T (the "
                  "transmitter's) or W (the world's)",
                  sample.station, seconds(sample.device_time), sample.frame));
}

void drive(Player& player, std::span<const devices::Sample> samples, const Stage& stage,
           engine::World& world, const Moment& moment, std::vector<devices::Event>& out) {
  const Scene scene{stage, world, moment, out};
  const Rig& rig = stage.scenario.rig;
  for (const devices::Sample& sample : samples) {
    std::visit([&](const auto& one) { take(player, rig, one); }, sample);
  }
  const Time now = moment.time - microseconds(rig.delay_s);
  std::size_t done = 0;
  for (; done < player.buttons.size() && player.buttons[done].device_time <= now; ++done) {
    const devices::MouseSample& button = player.buttons[done];
    if (button.trigger && !player.trigger && !player.held) grab(player, scene, button.device_time);
    if (!button.trigger && player.held) release(player, scene, button.device_time, now);
    player.trigger = button.trigger;
    player.left_thumb = button.left_thumb;
    player.right_thumb = button.right_thumb;
  }
  player.buttons.erase(player.buttons.begin(),
                       player.buttons.begin() + static_cast<std::ptrdiff_t>(done));
  if (player.held) {
    const engine::BodyId body = player.held->body;
    const engine::State wanted = carried(player, stage.scenario.hand, now);
    engine::set_state(world, body, engine::outside_fixed(world, body, wanted));
  }
  player.head.forget_before(now - kMemory);
  player.hand.forget_before(now - kMemory);
}

}  // namespace headpin::scene
