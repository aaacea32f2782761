#include "scene/sound/hearing.h"

#include <algorithm>
#include <cmath>

namespace headpin::scene {

namespace {

constexpr double kSampleTime = 1.0 / static_cast<double>(kSoundRate);

/// Samples until a tick.
std::int64_t samples_until(const Session& session, std::int64_t tick) {
  return tick * kSoundRate / session.scenario().rates.physics_hz;
}

/// The longest way of a sound in a room, and a tick more [samples].
double longest_delay(const RoomMeasures& room, std::int64_t ticks_hz) {
  const double diagonal = Vec3(room.width, room.behind + room.ahead, room.height).norm();
  return (1.1 * diagonal / kSpeedOfSound + 1.0 / static_cast<double>(ticks_hz)) *
         static_cast<double>(kSoundRate);
}

SoundingBody sounding(const Stage& stage, engine::BodyId body) {
  const Scenario& scenario = stage.scenario;
  const bool is_ball = stage.roles[body] == Role::ball;
  SoundingBody source{
      .body = body,
      .surface = is_ball ? surface_of_ball(scenario.ball) : surface_of_skittle(scenario.skittle),
      .modes = is_ball ? modes_of_ball(scenario.ball) : modes_of_skittle(scenario.skittle),
      .line = DelayLine(longest_delay(stage.room, scenario.rates.physics_hz))};
  const auto too_high = [](const Mode& m) { return m.frequency > 0.4 * kSoundRate; };
  std::erase_if(source.modes, too_high);
  source.own = source.modes.size();
  for (const Mode& mode : modes_of_lane(stage.room)) {
    if (!too_high(mode)) source.modes.push_back(mode);
  }
  for (const Mode& mode : source.modes) source.resonators.emplace_back(mode);
  if (is_ball) {
    const double weight = scenario.ball.mass * scenario.collision.gravity;
    source.rolling.emplace(source.surface, surface_of_room(), weight);
  }
  return source;
}

/// Those of a body's resonators that sound: all of a ball that rolls.
void find_ringing(SoundingBody& source, bool rolls, std::vector<Resonator*>& ringing) {
  ringing.clear();
  for (Resonator& resonator : source.resonators) {
    if (!resonator.fade() || rolls) ringing.push_back(&resonator);
  }
}

/// Speed of a ball that rolls on the lane; 0 of any other body.
double rolling_speed(const SoundingBody& source, const engine::World& world) {
  const bool rolls = source.rolling && world.bodies[source.body].kind == engine::Kind::free &&
                     world.memory.bodies[source.body].supported &&
                     !engine::is_asleep(world, source.body);
  return rolls ? world.states[source.body].v_WB.head<2>().norm() : 0.0;
}

/// Reciprocal of the mass that a collision moves.
double mobility(const engine::Body& body) {
  return body.kind == engine::Kind::free ? 1.0 / body.mass : 0.0;
}

}  // namespace

std::int16_t limited(double pressure) {
  constexpr double kKnee = 0.5, kLargest = 32767.0;
  const double part = std::abs(pressure) / kFullScale;
  double sample = part;
  if (part > kKnee) {
    const double over = (part - kKnee) / (1.0 - kKnee);
    sample = kKnee + (1.0 - kKnee) * over / (1.0 + over);
  }
  const auto rounded = static_cast<std::int16_t>(kLargest * sample + 0.5);
  return pressure < 0.0 ? static_cast<std::int16_t>(-rounded) : rounded;
}

Hearing::Hearing(const Session& session, std::optional<Pose> X_WD)
    : X_WD_(X_WD), samples_(samples_until(session, session.tick)) {
  take_bodies(session);
}

void Hearing::take_bodies(const Session& session) {
  stage_ = session.stage;
  sources_.clear();
  for (engine::BodyId body = 0; body < stage_->roles.size(); ++body) {
    const Role role = stage_->roles[body];
    if (role == Role::ball || role == Role::skittle) sources_.push_back(sounding(*stage_, body));
  }
}

SoundingBody* Hearing::source_of(engine::BodyId body) {
  const auto found = std::ranges::find(sources_, body, &SoundingBody::body);
  return found == sources_.end() ? nullptr : &*found;
}

void Hearing::tick(const Session& session, std::vector<StereoSample>& out) {
  if (session.stage != stage_) take_bodies(session);  // another version of the game
  if (const std::optional<Pose> X_WD = head_pose(session)) X_WD_ = X_WD;
  const std::int64_t until = samples_until(session, session.tick);
  mix_.assign(static_cast<std::size_t>(until - samples_), {0.0, 0.0});
  samples_ = until;
  if (X_WD_) {
    for (SoundingBody& source : sources_) sound(source, session, *X_WD_);
    strike(session);
  }
  for (const std::array<double, 2>& ears : mix_) {
    out.push_back({limited(ears[0]), limited(ears[1])});
  }
}

/// Adds what the ears hear of a body between the last tick and this one.
void Hearing::sound(SoundingBody& source, const Session& session, const Pose& X_WD) {
  const double speed = rolling_speed(source, session.world);
  find_ringing(source, speed > 0.0, ringing_);
  if (!ringing_.empty()) {
    source.heard_for = static_cast<std::int64_t>(source.line.size() + mix_.size());
  }
  const Vec3 p_W = session.world.states[source.body].X_WB.p;
  const std::array<Way, 2> ways = ways_to_ears(X_WD, p_W);
  const double tick = 1.0 / static_cast<double>(session.scenario().rates.physics_hz);
  const bool jumped = (p_W - source.p_W).norm() > kSpeedOfSound * tick;
  const std::array<Way, 2> ways_before = jumped ? ways : source.ways;
  source.ways = ways;
  source.p_W = p_W;
  if (source.heard_for <= 0) return;
  source.heard_for -= static_cast<std::int64_t>(mix_.size());
  ring(source, speed);
  source.line.add(pressures_);
  for (std::size_t ear = 0; ear < 2; ++ear) hear(source, ways_before[ear], ear);
}

/// Adds what an ear hears of a body, while the way to it changes to that of now.
void Hearing::hear(SoundingBody& source, Way way, std::size_t ear) {
  const double samples = static_cast<double>(mix_.size());
  const Way& to = source.ways[ear];
  // Each sample is heard later, and nearer to the newest one.
  const double later = (to.delay - way.delay) / samples - 1.0;
  const double louder = (to.gain - way.gain) / samples;
  const double brighter = (to.bright - way.bright) / samples;
  way.delay += samples - 1.0;
  HeadShadow shadow = source.shadows[ear];
  for (std::array<double, 2>& ears : mix_) {
    ears[ear] += shadow.filter(way.gain * source.line.at(way.delay), way.bright);
    way.delay += later;
    way.gain += louder;
    way.bright += brighter;
  }
  source.shadows[ear] = shadow;
}

/// Makes the pressures of a body between the last tick and this one.
/// @param speed  that it rolls with [m/s], 0 if it does not
void Hearing::ring(SoundingBody& source, double speed) {
  pressures_.assign(mix_.size(), 0.0);
  if (speed <= 0.0) return scene::ring(ringing_, pressures_);
  impulses_.resize(mix_.size());
  for (double& impulse : impulses_) {
    impulse = source.rolling->after(speed * kSampleTime) * kSampleTime;
  }
  scene::ring(ringing_, impulses_, pressures_);
}

/// The impacts of this tick.
void Hearing::strike(const Session& session) {
  const engine::World& world = session.world;
  const auto surface_of = [&](const SoundingBody* source, engine::BodyId body) {
    if (source) return source->surface;
    return stage_->roles[body] == Role::hand ? surface_of_hand() : surface_of_room();
  };
  for (const engine::ContactEvent& e : world.events) {
    const double moved = mobility(world.bodies[e.a]) + mobility(world.bodies[e.b]);
    if (moved <= 0.0) continue;
    const double impulse = std::abs(e.impulse_W.dot(e.n_AB_W));
    SoundingBody* const a = source_of(e.a);
    SoundingBody* const b = source_of(e.b);
    const auto by = [&](SoundingBody* source, engine::BodyId other, const ContactSurface& surface) {
      if (!source) return;
      const bool on_lane = stage_->roles[other] == Role::lane;
      strike(*source, surface, on_lane, impulse, 1.0 / moved, e.approach_speed);
    };
    by(a, e.b, surface_of(b, e.b));
    by(b, e.a, surface_of(a, e.a));
  }
}

void Hearing::strike(SoundingBody& source, const ContactSurface& other, bool on_lane,
                     double impulse, double mass, double speed) {
  constexpr double kSlowest = 0.01;  // m/s: a first touch has no speed of its own
  const double touching = contact_time(source.surface, other, mass, std::max(kSlowest, speed));
  const std::size_t count = on_lane ? source.modes.size() : source.own;
  for (std::size_t k = 0; k < count; ++k) {
    const Mode& mode = source.modes[k];
    source.resonators[k].strike(mode.pressure * impulse *
                                part_of_impulse(mode.frequency, touching));
  }
}

}  // namespace headpin::scene
