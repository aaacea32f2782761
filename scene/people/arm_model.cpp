#include "scene/people/arm_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/random.h"

namespace headpin::scene {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

double minimum_jerk(double s) {
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

Quat about_x(double angle) {
  return rotation(Vec3(angle, 0.0, 0.0));
}
Quat about_z(double angle) {
  return rotation(Vec3(0.0, 0.0, angle));
}

// A person of 1.75 m, in metres, seconds and radians.
constexpr double kShoulderHeight = 1.40, kShoulderAside = 0.20, kEyeHeight = 1.64;
constexpr double kGrabTime = 1.2, kBackSwingEnd = 3.6;
constexpr double kReleaseAngle = 12.0 * kDegree, kFollowThrough = 125.0 * kDegree;

}  // namespace

double MinimumJerk::at(double time) const {
  if (time <= keys_.front().time) return keys_.front().value;
  for (std::size_t i = 1; i < keys_.size(); ++i) {
    const Key &a = keys_[i - 1], &b = keys_[i];
    if (time < b.time) {
      return a.value + (b.value - a.value) * minimum_jerk((time - a.time) / (b.time - a.time));
    }
  }
  return keys_.back().value;
}

Vec3 ThrowMotion::Trembling::at(double time) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < amplitude.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      sum[axis] += amplitude[k][axis] * sin_cos(rate[k][axis] * time + phase[k][axis]).sin;
    }
  }
  return sum;
}

ThrowMotion::Joints ThrowMotion::joints(double forward_swing_s, double back_swing, double stoop) {
  const double end = kBackSwingEnd + forward_swing_s;
  return {
      .raise = {{0.2, 60.0 * kDegree},
                {1.0, 28.0 * kDegree},
                {1.4, 28.0 * kDegree},
                {2.1, 70.0 * kDegree},
                {2.5, 70.0 * kDegree},
                {kBackSwingEnd, back_swing},
                {end, kFollowThrough},
                {end + 1.4, 15.0 * kDegree}},
      .reach = {{0.2, 0.36},
                {1.0, 0.60},
                {1.4, 0.60},
                {2.1, 0.45},
                {2.5, 0.45},
                {3.4, 0.64},
                {end + 0.1, 0.64},
                {end + 1.2, 0.55}},
      .aside = {{0.2, 0.0}, {1.0, 40.0 * kDegree}, {1.4, 40.0 * kDegree}, {2.1, 0.0}},
      .lean = {{0.2, 0.1},
               {1.0, 0.4},
               {1.4, 0.4},
               {2.2, 0.1},
               {3.0, 0.1},
               {end - 0.1, 1.0},
               {end + 1.6, 0.1}},
      .to_ball = {{0.3, 0.0}, {0.7, 1.0}, {1.2, 1.0}, {1.4, 0.0}},
      .to_lane = {{2.7, 0.0}, {3.2, 1.0}},
      .to_skittles = {{end - 0.3, 0.0}, {end + 0.4, 1.0}},
      .stoop = {{2.5, 0.0}, {kBackSwingEnd, stoop}, {end + 0.2, stoop}, {end + 1.6, 0.0}},
  };
}

ThrowMotion::ThrowMotion(const ThrowPlan& plan, const Hand& hand)
    : joints_(joints(0.75, -75.0 * kDegree, 0.0)), p_HB_(hand.grip) {
  if (!(plan.speed >= kSlowestPlan && plan.speed <= kFastestPlan)) {
    throw std::invalid_argument(
        fmt::format("speed of the throw: expected {} to {} m/s, found {} m/s", kSlowestPlan,
                    kFastestPlan, plan.speed));
  }
  if (!(std::abs(plan.aim) <= kWidestAim_deg * kDegree)) {
    throw std::invalid_argument(
        fmt::format("aim: expected at most {} degrees to each side, found {:.3g}", kWidestAim_deg,
                    plan.aim / kDegree));
  }
  if (plan.height && !(*plan.height >= kLowestRelease && *plan.height <= kHighestRelease)) {
    throw std::invalid_argument(
        fmt::format("height of the release: expected {} to {} m, found {} m", kLowestRelease,
                    kHighestRelease, *plan.height));
  }
  Random random(plan.seed);
  const auto trembling = [&](double amplitude, double low_hz, double high_hz) {
    Trembling t;
    for (std::size_t k = 0; k < t.amplitude.size(); ++k) {
      t.amplitude[k] = amplitude * random.uniform3(0.5, 1.0);
      t.rate[k] = 2.0 * kPi * random.uniform3(low_hz, high_hz);
      t.phase[k] = random.uniform3(0.0, 2.0 * kPi);
    }
    return t;
  };
  sway_ = trembling(0.003, 0.2, 0.6);
  hand_shift_ = trembling(0.00015, 7.0, 11.0);
  hand_turn_ = trembling(0.1 * kDegree, 7.0, 11.0);
  head_turn_ = trembling(0.3 * kDegree, 0.3, 1.5);

  // The duration of the swing follows from the speed: a slower swing takes longer.
  const double speed = plan.speed * (1.0 + plan.errors.speed * random.normal());
  const double aim = plan.aim + plan.errors.aim * random.normal();
  const double back_swing = -75.0 * kDegree + 3.0 * kDegree * random.normal();
  grab_ = microseconds(kGrabTime);
  WantedRelease wanted{speed, back_swing, kReleaseAngle, 0.0};
  double swing_s = fit_joints(wanted, hand);
  if (plan.height) {
    const double height = *plan.height + plan.errors.height * random.normal();
    for (int i = 0; i < 8; ++i) {
      const Vec3 v = ball_at_release(hand);
      wanted.released -= v.z() / v.norm();
      wanted.stoop += (this->hand(release_) * hand.grip).z() - height;
      swing_s = fit_joints(wanted, hand);
    }
  }
  duration_ = microseconds(plan.duration_s);
  const double shortest = kBackSwingEnd + swing_s + 0.5;
  if (!(plan.duration_s >= shortest && plan.duration_s <= 600.0)) {
    throw std::invalid_argument(fmt::format(
        "a duration of {} s; expected {:.1f} s (the throw) to 600 s", plan.duration_s, shortest));
  }

  // Place the model so that the ball leaves where it should, in the aimed direction.
  const Vec3 v_MB = ball_at_release(hand);
  speed_ = v_MB.norm();
  const Vec3 ahead = Vec3(v_MB.x(), v_MB.y(), 0.0).normalized();
  Mat3 R_MA;  // A: y where the ball goes
  R_MA << ahead.cross(Vec3::UnitZ()), ahead, Vec3::UnitZ();
  p_MB_release_ = this->hand(release_) * hand.grip;  // X_WM_ is still the identity
  X_WM_.q = (about_z(-aim) * Quat(R_MA.transpose())).normalized();
  const Vec3 p = X_WM_.q * (this->hand(release_) * hand.grip);
  X_WM_.p = Vec3(-p.x(), -p.y(), 0.0);
  if (plan.p_WB) X_WM_.p.head<2>() = *plan.p_WB - (X_WM_.q * p_MB_release_).head<2>();
}

/// Sets the joints for a swing that releases the ball at the wanted speed.
/// @return  duration of the swing [s]
double ThrowMotion::fit_joints(const WantedRelease& wanted, const Hand& hand) {
  const double released =
      (wanted.released - wanted.back_swing) / (kFollowThrough - wanted.back_swing);
  double low = 0.0, high = 1.0;  // part of the swing's time by which the arm is at that angle
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (minimum_jerk(middle) < released ? low : high) = middle;
  }
  double swing_s = 0.75;
  for (int i = 0; i < 8; ++i) {
    joints_ = joints(swing_s, wanted.back_swing, wanted.stoop);
    release_ = microseconds(kBackSwingEnd + low * swing_s);
    swing_s *= ball_at_release(hand).norm() / wanted.speed;
  }
  return swing_s;
}

Vec3 ThrowMotion::ball_at_release(const Hand& hand) const {
  constexpr Time kStep{1000};
  const Vec3 p_before = this->hand(release_ - kStep) * hand.grip;
  const Vec3 p_after = this->hand(release_ + kStep) * hand.grip;
  return (p_after - p_before) / seconds(2 * kStep);
}

Twist ThrowMotion::ball_and_hand(const Hand& hand) const {
  constexpr Time kStep{1000};
  const Quat q_before = this->hand(release_ - kStep).q, q_after = this->hand(release_ + kStep).q;
  return {ball_at_release(hand),
          rotation_vector(q_after * q_before.conjugate()) / seconds(2 * kStep)};
}

Vec3 ThrowMotion::trunk(double t) const {
  const double lean = joints_.lean.at(t);
  return Vec3(0.0, 0.25 * lean, -0.10 * lean - joints_.stoop.at(t)) + sway_.at(t);
}

Vec3 ThrowMotion::looked_at(double t) const {
  const auto mix = [](const Vec3& a, const Vec3& b, double share) -> Vec3 {
    return a + share * (b - a);
  };
  const Vec3 foul_line(0.0, p_MB_release_.y(), 0.0);
  const Vec3 on_lane = foul_line + Vec3(0.5 * p_MB_release_.x(), 1.0, 0.0);
  const Vec3 skittles = foul_line + Vec3(p_MB_release_.x(), 6.3, 0.2);
  Vec3 p = mix(hand_in_model(t).p, hand_in_model(kGrabTime) * p_HB_, joints_.to_ball.at(t));
  if (t > kGrabTime) p = hand_in_model(t) * p_HB_;
  return mix(mix(p, on_lane, joints_.to_lane.at(t)), skittles, joints_.to_skittles.at(t));
}

Pose ThrowMotion::head(Time time) const {
  const double t = seconds(time);
  const Vec3 p_MD = Vec3(0.0, 0.10, kEyeHeight) + trunk(t);
  Mat3 R_MD;  // x right, y up, looking along -z
  // The head bends down by 44 degrees at most; below that, only the eyes turn.
  constexpr double kSteepest = 0.69;
  Vec3 back = (p_MD - looked_at(t)).normalized();
  if (back.z() > kSteepest) {
    const double level = std::sqrt(1.0 - kSteepest * kSteepest);
    back << level * back.head<2>().normalized(), kSteepest;
  }
  R_MD.col(2) = back;
  R_MD.col(0) = Vec3::UnitZ().cross(R_MD.col(2)).normalized();
  R_MD.col(1) = R_MD.col(2).cross(R_MD.col(0));
  const Quat q_MD = Quat(R_MD) * rotation(head_turn_.at(t));
  return X_WM_ * Pose{q_MD.normalized(), p_MD};
}

Pose ThrowMotion::hand(Time time) const {
  return X_WM_ * hand_in_model(seconds(time));
}

Pose ThrowMotion::hand_in_model(double t) const {
  // When the arm hangs, the palm faces ahead: fingers (-z) down, back of the hand (y) to the rear.
  const Quat q_MH = about_z(-joints_.aside.at(t)) * about_x(joints_.raise.at(t)) * about_z(kPi) *
                    rotation(hand_turn_.at(t));
  const Vec3 p_MH = Vec3(kShoulderAside, 0.0, kShoulderHeight) + trunk(t) +
                    q_MH * Vec3(0.0, 0.0, -joints_.reach.at(t)) + hand_shift_.at(t);
  return {q_MH.normalized(), p_MH};
}

Pose ThrowMotion::left_hand(Time time) const {
  const double t = seconds(time);
  constexpr double kRaise = 25.0 * kDegree, kAside = 20.0 * kDegree, kReach = 0.5;
  const Quat q_MH = about_z(kAside) * about_x(kRaise) * about_z(kPi);
  const Vec3 p_MH =
      Vec3(-kShoulderAside, 0.0, kShoulderHeight) + trunk(t) + q_MH * Vec3(0.0, 0.0, -kReach);
  return X_WM_ * Pose{q_MH.normalized(), p_MH};
}

Rig synthetic_rig() {
  const double h = std::sqrt(0.5);
  // Columns of each rotation: where the second frame's x, y, z point in the first.
  const Quat q_WT(0.0, h, h, 0.0);        // ahead, right, down
  const Quat q_SD(0.5, -0.5, -0.5, 0.5);  // a receiver's axes are the transmitter's
  Rig rig;
  rig.X_WT = {q_WT, Vec3(0.4, -2.2, 1.1)};
  rig.X_SD = {q_SD, Vec3(0.10, 0.0, 0.12)};  // eyes ahead of and below the top of the helmet
  rig.X_SH = {q_SD, Vec3(0.04, 0.0, 0.03)};
  rig.delay_s = 0.025;  // a receiver's interval and the latency
  return rig;
}

void set_up(Scenario& scenario, const ThrowMotion& motion) {
  const auto equal = [](const Pose& a, const Pose& b) {
    return a.p == b.p && a.q.coeffs() == b.q.coeffs();
  };
  const Scenario usual;
  const Rig& rig = scenario.rig;
  if (equal(rig.X_WT, usual.rig.X_WT) && equal(rig.X_SD, usual.rig.X_SD) &&
      equal(rig.X_SH, usual.rig.X_SH) && rig.delay_s == usual.rig.delay_s) {
    scenario.rig = synthetic_rig();
  }
  const Pose X_WH = motion.hand(motion.grab());
  if (scenario.ball.home == usual.ball.home) scenario.ball.home = X_WH * scenario.hand.grip;
  const double gap = (scenario.ball.home - X_WH.p).norm() - scenario.ball.radius;
  if (gap > scenario.hand.reach) {
    throw std::invalid_argument(
        fmt::format("ball.home must be within the arm's reach: the hand that grabs the ball is at "
                    "[{:.3f}, {:.3f}, {:.3f}], {:.3f} m from the ball, but hand.reach is {}",
                    X_WH.p.x(), X_WH.p.y(), X_WH.p.z(), gap, scenario.hand.reach));
  }
}

std::vector<devices::Sample> sense(const ThrowMotion& motion, const Rig& rig, std::uint64_t seed,
                                   const TrackerNoise& noise) {
  Random random(~seed);  // other numbers than those of the motion
  const Pose X_TW = rig.X_WT.inverse();
  const Pose X_DS = rig.X_SD.inverse(), X_HS = rig.X_SH.inverse();
  std::vector<devices::Sample> samples;
  const auto trigger = [&](Time time, bool down) {
    devices::MouseSample mouse;
    mouse.device_time = time;
    mouse.trigger = down;
    samples.emplace_back(mouse);
  };
  Time last{-1};
  for (std::int64_t cycle = 0; tick_time(cycle, 120) <= motion.duration(); ++cycle) {
    devices::TrackerSample sample;
    sample.device_time = tick_time(cycle, 120);
    sample.host_time = sample.device_time + noise.latency;
    sample.sequence = cycle / 2;
    sample.station =
        static_cast<std::int32_t>(cycle % 2 == 0 ? rig.head_station : rig.hand_station);
    const Pose X_WS = cycle % 2 == 0 ? motion.head(sample.device_time) * X_DS
                                     : motion.hand(sample.device_time) * X_HS;
    sample.X_TS = X_TW * X_WS;
    sample.X_TS.p += noise.per_range * sample.X_TS.p.norm() * random.normal3();
    sample.X_TS.q = (sample.X_TS.q * rotation(noise.angle * random.normal3())).normalized();
    for (const auto& [time, down] :
         {std::pair{motion.grab(), true}, std::pair{motion.release(), false}}) {
      if (last < time && time <= sample.device_time) trigger(time, down);
    }
    last = sample.device_time;
    samples.emplace_back(sample);
  }
  return samples;
}

devices::MotionRecording record(const ThrowMotion& motion, std::uint64_t seed) {
  Random random(~seed);
  // Recording's frame: x right, y up, -z ahead; origin at the foul line.
  const Pose X_TW{about_x(-0.5 * kPi), Vec3::Zero()};
  devices::MotionRecording recording;
  for (std::int64_t i = 0; tick_time(i, 72) <= motion.duration(); ++i) {
    const double jitter_ms = random.uniform(-2.0, 2.0);
    const double ms = std::max(0.0, std::floor(1e3 * seconds(tick_time(i, 72)) + jitter_ms));
    const Time time = microseconds(1e-3 * ms);
    recording.times.push_back(time);
    recording.head.push_back(X_TW * motion.head(time));
    recording.left_hand.push_back(X_TW * motion.left_hand(time));
    recording.right_hand.push_back(X_TW * motion.hand(time));
  }
  return recording;
}

}  // namespace headpin::scene
