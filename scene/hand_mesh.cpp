#include "scene/hand_mesh.h"

#include <algorithm>
#include <array>
#include <vector>

namespace headpin::scene {

namespace {

/// A piece of a finger or of the palm: a ball swept along a line, growing or shrinking.
struct Bone {
  Vec3 a, b;
  double ra, rb;  ///< radius at each end [m]
};

double distance(const Bone& bone, const Vec3& p) {
  const Vec3 along = bone.b - bone.a;
  const double share = std::clamp((p - bone.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - bone.a - share * along).norm() - (bone.ra + share * (bone.rb - bone.ra));
}

/// Smaller of two distances, with the crease between them filled (polynomial, width k).
double blend(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - 0.25 * h * h * k;
}

render::Mesh skin(const std::vector<Bone>& bones, double cell) {
  Vec3 lo = bones.front().a, hi = lo;
  for (const Bone& bone : bones) {
    const double r = std::max(bone.ra, bone.rb) + 2.0 * cell;
    for (const Vec3& p : {bone.a, bone.b}) {
      lo = lo.cwiseMin(p - Vec3::Constant(r));
      hi = hi.cwiseMax(p + Vec3::Constant(r));
    }
  }
  const auto field = [&](const Vec3& p) {
    double d = 1.0;
    for (const Bone& bone : bones) d = blend(d, distance(bone, p), 0.010);
    return d;
  };
  render::Mesh mesh = render::surface_of(field, lo, hi, cell, render::srgb(0xd9a27e));
  mesh.gloss = 0.12;
  return mesh;
}

/// A finger or a metacarpal through its joints, each thinner than the last.
void append_finger(std::vector<Bone>& bones, std::initializer_list<Vec3> joints, double radius) {
  for (const Vec3* joint = joints.begin(); joint + 1 != joints.end(); ++joint) {
    bones.push_back({joint[0], joint[1], radius, 0.92 * radius});
    radius *= 0.92;
  }
}

constexpr int kFingers = 4;                                                    // index to little
constexpr std::array<double, kFingers> kAcross{-0.030, -0.010, 0.010, 0.029};  // at the knuckles
constexpr std::array<double, kFingers> kLength{0.074, 0.082, 0.076, 0.060};    // knuckle to tip
constexpr std::array<double, kFingers> kAhead{0.042, 0.045, 0.041, 0.034};     // of the knuckles

}  // namespace

render::Mesh open_hand_mesh(double cell) {
  std::vector<Bone> bones;
  const Vec3 wrist(0.0, 0.0, 0.055);
  bones.push_back({wrist + Vec3(0.0, -0.004, 0.07), wrist, 0.030, 0.026});
  for (std::size_t i = 0; i < kFingers; ++i) {
    const double x = kAcross[i], l = kLength[i];
    const Vec3 knuckle(x, 0.004, -kAhead[i]);
    bones.push_back({wrist + Vec3(0.4 * x, 0.0, 0.0), knuckle, 0.018, 0.0125});
    // Fingers at rest fan out and bend a little.
    append_finger(
        bones,
        {knuckle, knuckle + Vec3(0.10 * x, -0.004, -0.45 * l),
         knuckle + Vec3(0.18 * x, -0.013, -0.75 * l), knuckle + Vec3(0.24 * x, -0.024, -l)},
        0.0105);
  }
  append_finger(bones,
                {Vec3(-0.018, -0.004, 0.040), Vec3(-0.048, -0.010, 0.006),
                 Vec3(-0.062, -0.014, -0.028), Vec3(-0.068, -0.018, -0.052)},
                0.0145);
  return skin(bones, cell);
}

render::Mesh gripping_hand_mesh(const Vec3& p_HB, double radius, double cell) {
  // Around the ball: `out` from its centre to the palm, `over` up its top, `right` across.
  const Vec3 out = p_HB.norm() > 1e-6 ? Vec3(-p_HB.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 side = Vec3::UnitY().cross(out);
  const Vec3 right = side.norm() > 1e-6 ? Vec3(side.normalized()) : Vec3(Vec3::UnitX());
  const Vec3 over = out.cross(right);
  // A point `up` and `across` along the ball's skin [m], `above` it.
  const auto at = [&](double up, double across, double above) -> Vec3 {
    const SinCos u = sin_cos(up / radius), a = sin_cos(across / radius);
    return p_HB + (radius + above) * (a.cos * (u.cos * out + u.sin * over) + a.sin * right);
  };
  std::vector<Bone> bones;
  const Vec3 wrist = at(-0.055, 0.0, 0.026);
  const Vec3 back = (out - 0.55 * over).normalized();
  bones.push_back({wrist + 0.07 * back, wrist, 0.030, 0.026});
  for (std::size_t i = 0; i < kFingers; ++i) {
    const double x = kAcross[i], k = kAhead[i], l = kLength[i];
    bones.push_back({at(-0.045, 0.4 * x, 0.020), at(k, x, 0.014), 0.018, 0.0125});
    append_finger(bones,
                  {at(k, x, 0.014), at(k + 0.45 * l, 1.15 * x, 0.011),
                   at(k + 0.75 * l, 1.3 * x, 0.009), at(k + l, 1.4 * x, 0.008)},
                  0.0105);
  }
  append_finger(bones,
                {at(-0.035, -0.018, 0.018), at(-0.012, -0.055, 0.013), at(0.012, -0.085, 0.011),
                 at(0.024, -0.108, 0.009)},
                0.0145);
  return skin(bones, cell);
}

}  // namespace headpin::scene
