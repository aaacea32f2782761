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

/// The longest way of a sound in a room [samples].
double longest_way(const RoomMeasures& room) {
  const double diagonal = Vec3(room.width, room.behind + room.ahead, room.height).norm();
  return 1.1 * diagonal / kSpeedOfSound * static_cast<double>(kSoundRate);
}

SoundingBody sounding(const Stage& stage, engine::BodyId body) {
  const Scenario& scenario = stage.scenario;
  const bool is_ball = stage.roles[body] == Role::ball;
  SoundingBody source{
      .body = body,
      .surface = is_ball ? surface_of_ball(scenario.ball) : surface_of_skittle(scenario.skittle),
      .modes = is_ball ? modes_of_ball(scenario.ball) : modes_of_skittle(scenario.skittle),
      .line = DelayLine(longest_way(stage.room))};
  source.own = source.modes.size();
  for (const Mode& mode : modes_of_lane(stage.room)) source.modes.push_back(mode);
  std::erase_if(source.modes, [](const Mode& m) { return m.frequency > 0.4 * kSoundRate; });
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

Way between(const Way& a, const Way& b, double s) {
  return {a.delay + s * (b.delay - a.delay), a.gain + s * (b.gain - a.gain),
          a.bright + s * (b.bright - a.bright)};
}

}  // namespace

std::int16_t limited(double pressure) {
  constexpr double kKnee = 0.5, kLargest = 32767.0;
  const double part = std::abs(pressure) / kFullScale;
  const double over = (part - kKnee) / (1.0 - kKnee);
  const double sample = part <= kKnee ? part : kKnee + (1.0 - kKnee) * over / (1.0 + over);
  return static_cast<std::int16_t>(std::lround(std::copysign(kLargest * sample, pressure)));
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
  for (std::size_t i = 0; i < mix_.size(); ++i) {
    double pressure = 0.0;
    for (Resonator* const resonator : ringing_) pressure += resonator->next();
    source.line.add(pressure);
    if (speed > 0.0) {
      const double impulse = source.rolling->after(speed * kSampleTime) * kSampleTime;
      for (std::size_t k = 0; k < source.modes.size(); ++k) {
        source.resonators[k].strike(source.modes[k].pressure * impulse);
      }
    }
    const double s = static_cast<double>(i + 1) / static_cast<double>(mix_.size());
    for (std::size_t ear = 0; ear < 2; ++ear) {
      const Way way = between(ways_before[ear], ways[ear], s);
      mix_[i][ear] += source.shadows[ear].filter(way.gain * source.line.at(way.delay), way.bright);
    }
  }
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
