#include "scene/people/figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace headpin::scene {

namespace {

// Of a standing person, as shares of the height (Drillis and Contini 1966): hips, from there to the
// shoulders and to the eyes.
constexpr double kHips = 0.530, kTrunk = 0.288, kToEyes = 0.406;
// From the joint of head and neck to between the eyes.
constexpr double kEyesAhead = 0.057, kEyesAbove = 0.046;

constexpr std::array<double Posture::*, 8> kPostureJoints = {
    &Posture::x,    &Posture::y,     &Posture::facing, &Posture::crouch,
    &Posture::lean, &Posture::raise, &Posture::aside,  &Posture::reach};

Quat turn_about(const Vec3& axis, double angle) {
  return rotation(angle * axis);
}

/// A point relative to the hips, in the tracked space.
Vec3 from_hips(const Build& build, const Posture& posture, const Vec3& p) {
  const Vec3 p_PHips(posture.x, posture.y, kHips * build.height - posture.crouch);
  return p_PHips +
         turn_about(Vec3::UnitZ(), posture.facing) * (turn_about(Vec3::UnitX(), -posture.lean) * p);
}

}  // namespace

double direction(double along, double across) {
  const double length = std::sqrt(along * along + across * across);
  if (length == 0.0) return 0.0;
  if (along < 0.0 && across == 0.0) return std::numbers::pi;
  // Half of the angle is the direction of the vector plus its length ahead. If it points backward,
  // the angle is measured from behind.
  if (along < 0.0) {
    const double beyond = direction(-along, -across);
    return across > 0.0 ? beyond + std::numbers::pi : beyond - std::numbers::pi;
  }
  return rotation_vector(Quat(along + length, 0.0, 0.0, across).normalized()).z();
}

double Glide::at(double time) const {
  const double s = std::clamp((time - begin_) / duration_, 0.0, 1.0);
  const auto& c = coefficients_;
  return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
}

double Glide::goal() const {
  double sum = 0.0;
  for (const double c : coefficients_) sum += c;
  return sum;
}

void Glide::to(double value, double now, double duration) {
  const auto& c = coefficients_;
  const double s = std::clamp((now - begin_) / duration_, 0.0, 1.0);
  const bool rests = now < begin_ || s >= 1.0;
  const double place = at(now), share = duration / duration_;
  const double speed =
      rests ? 0.0
            : share *
                  (c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5]))));
  const double gain =
      rests ? 0.0
            : share * share * (2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5])));
  const double way = value - place;
  coefficients_ = {place,
                   speed,
                   0.5 * gain,
                   10.0 * way - 6.0 * speed - 1.5 * gain,
                   -15.0 * way + 8.0 * speed + 1.5 * gain,
                   6.0 * way - 3.0 * speed - 0.5 * gain};
  begin_ = now;
  duration_ = duration;
}

Figure::Figure(const Posture& posture) {
  for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i] = Glide(posture.*kPostureJoints[i]);
}

Posture Figure::at(double time) const {
  Posture posture;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    posture.*kPostureJoints[i] = joints_[i].at(time);
  }
  return posture;
}

Posture Figure::goal() const {
  Posture posture;
  for (std::size_t i = 0; i < joints_.size(); ++i) posture.*kPostureJoints[i] = joints_[i].goal();
  return posture;
}

void Figure::to(const Posture& posture, double now, double duration) {
  for (const auto joint : kPostureJoints) to(joint, posture.*joint, now, duration);
}

void Figure::to(double Posture::*joint, double value, double now, double duration) {
  const auto i = std::ranges::find(kPostureJoints, joint) - kPostureJoints.begin();
  joints_[static_cast<std::size_t>(i)].to(value, now, duration);
}

Vec3 shoulder(const Build& build, const Posture& posture) {
  return from_hips(build, posture, {build.shoulder_aside(), 0.0, kTrunk * build.height});
}

Pose palm(const Build& build, const Posture& posture) {
  const double aside = build.left_handed ? -posture.aside : posture.aside;
  const Quat q_PH = turn_about(Vec3::UnitZ(), posture.facing - aside) *
                    turn_about(Vec3::UnitX(), posture.raise) *
                    turn_about(Vec3::UnitZ(), std::numbers::pi);
  return {q_PH.normalized(), shoulder(build, posture) + q_PH * Vec3(0.0, 0.0, -posture.reach)};
}

Pose eyes(const Build& build, const Posture& posture, double turn, double pitch) {
  const double h = build.height;
  const Vec3 p_PJoint = from_hips(build, posture, {0.0, 0.0, (kToEyes - kEyesAbove) * h});
  const Quat q_PD =
      (turn_about(Vec3::UnitZ(), turn) * turn_about(Vec3::UnitX(), 0.5 * std::numbers::pi + pitch))
          .normalized();
  return {q_PD, p_PJoint + q_PD * Vec3(0.0, kEyesAbove * h, -kEyesAhead * h)};
}

void point_at(const Build& build, Posture& posture, const Vec3& p_PQ, double before) {
  const Vec3 d = turn_about(Vec3::UnitZ(), -posture.facing) * (p_PQ - shoulder(build, posture));
  const double ahead = std::sqrt(d.x() * d.x() + d.y() * d.y());
  const double side = direction(d.y(), d.x());
  posture.raise = direction(-d.z(), ahead);
  posture.aside = build.left_handed ? -side : side;
  posture.reach = std::clamp(d.norm() - before, 0.4 * build.arm(), build.arm());
}

}  // namespace headpin::scene
