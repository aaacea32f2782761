#include "scene/people/participant_body.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "devices/base/sources.h"
#include "devices/fastrak/geometry.h"
#include "scene/people/arm_model.h"

namespace headpin::scene {

namespace {

// Purposes of random numbers. Each has its own sequence, independent of how many others were drawn.
constexpr std::uint64_t kTremblesDrawn = 2, kNoiseDrawn = 3;

constexpr double kTurnMost = 6.0;    ///< a fast head [rad/s]
constexpr double kFollowRate = 9.0;  ///< of the head after the eyes [1/s]

Random trembles_of(const Person& person) {
  return {person.seed, kTremblesDrawn, 0};
}

/// The shortest way from one direction to another.
double way_round(double from, double to) {
  constexpr double kRound = 2.0 * std::numbers::pi;
  double way = to - from;
  while (way > std::numbers::pi) way -= kRound;
  while (way < -std::numbers::pi) way += kRound;
  return way;
}

}  // namespace

void Following::step(double target, double dt) {
  const double gain =
      kFollowRate * kFollowRate * way_round(angle, target) - 2.0 * kFollowRate * speed;
  speed = std::clamp(speed + gain * dt, -kTurnMost, kTurnMost);
  angle += speed * dt;
}

Trembles::Trembles(Random& random, double amplitude, double low_hz, double high_hz) {
  for (std::size_t k = 0; k < amplitude_.size(); ++k) {
    amplitude_[k] = amplitude * random.uniform3(0.5, 1.0);
    rate_[k] = 2.0 * std::numbers::pi * random.uniform3(low_hz, high_hz);
    phase_[k] = random.uniform3(0.0, 2.0 * std::numbers::pi);
  }
}

Vec3 Trembles::at(double time) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < amplitude_.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      sum[axis] += amplitude_[k][axis] * sin_cos(rate_[k][axis] * time + phase_[k][axis]).sin;
    }
  }
  return sum;
}

ParticipantBody::ParticipantBody(const Person& person, const Rig& rig, const Posture& posture)
    : build{person.height, person.left_handed},
      figure(posture),
      rig_(rig),
      sway_([&] {
        Random random = trembles_of(person);
        return Trembles(random, person.sway, 0.2, 0.6);
      }()),
      hand_shift_([&] {
        Random random(person.seed, kTremblesDrawn, 1);
        return Trembles(random, person.tremor, 7.0, 11.0);
      }()),
      hand_turn_([&] {
        Random random(person.seed, kTremblesDrawn, 2);
        return Trembles(random, 6.0 * person.tremor, 7.0, 11.0);
      }()),
      noise_(person.seed, kNoiseDrawn, 0) {}

void ParticipantBody::look_at(const Vec3& p_PQ, double now, double dt) {
  const Vec3 way = p_PQ - head(now).p;
  const double ahead = std::sqrt(way.x() * way.x() + way.y() * way.y());
  constexpr double kSteep = 1.2;
  if (ahead > 0.05) turn_.step(direction(way.y(), -way.x()), dt);
  pitch_.step(std::clamp(direction(ahead, way.z()), -kSteep, kSteep), dt);
  looked_ = now;
}

Pose ParticipantBody::head(double time) const {
  const double ago = time - looked_;
  Pose X_PD = eyes(build, figure.at(time), turn_.angle + ago * turn_.speed,
                   pitch_.angle + ago * pitch_.speed);
  X_PD.p += sway_.at(time);
  return X_PD;
}

Pose ParticipantBody::hand(double time) const {
  const Pose X_PH = palm(build, figure.at(time));
  return {(X_PH.q * rotation(hand_turn_.at(time))).normalized(),
          X_PH.p + sway_.at(time) + hand_shift_.at(time)};
}

void ParticipantBody::thumbs(Time time, int forward) {
  mouse_.device_time = time;
  mouse_.left_thumb = forward > 0;
  mouse_.right_thumb = forward < 0;
  waiting_.emplace_back(mouse_);
}

void ParticipantBody::trigger(Time time, bool down) {
  mouse_.device_time = time;
  mouse_.trigger = down;
  waiting_.emplace_back(mouse_);
}

void ParticipantBody::measure(std::int64_t cycle, Time time) {
  const bool of_head = cycle % 2 == 0;
  devices::TrackerSample sample;
  sample.device_time = time;
  sample.host_time = time + TrackerNoise{}.latency;
  sample.sequence = cycle / 2;
  sample.station = static_cast<std::int32_t>(of_head ? rig_.head_station : rig_.hand_station);
  const double t = seconds(time);
  const Pose X_PS = of_head ? head(t) * rig_.X_SD.inverse() : hand(t) * rig_.X_SH.inverse();
  sample.X_TS = rig_.X_WT.inverse() * X_PS;
  const devices::FastrakNoise noise = devices::noise_at(sample.X_TS.p.norm());
  sample.X_TS.p += noise.position * noise_.normal3();
  sample.X_TS.q = sample.X_TS.q * rotation(noise.rotation * noise_.normal3());
  sample.X_TS = devices::as_received(sample.X_TS);
  waiting_.emplace_back(sample);
}

void ParticipantBody::sense(Time now, std::vector<devices::Sample>& out) {
  constexpr std::int64_t kMeasurementsHz = 120;
  for (; tick_time(cycle_, kMeasurementsHz) <= now; ++cycle_) {
    measure(cycle_, tick_time(cycle_, kMeasurementsHz));
  }
  std::ranges::stable_sort(waiting_, {}, devices::available);
  const auto later = std::ranges::upper_bound(waiting_, now, {}, devices::available);
  std::move(waiting_.begin(), later, std::back_inserter(out));
  waiting_.erase(waiting_.begin(), later);
}

}  // namespace headpin::scene
