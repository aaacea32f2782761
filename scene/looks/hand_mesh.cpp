#include "scene/looks/hand_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace headpin::scene {

namespace {

/// The mirror image in the plane x = 0.
Vec3 in_mirror(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}

/// The same of a mesh; its triangles are seen from outside again.
render::Mesh in_mirror(render::Mesh mesh) {
  for (render::Vertex& v : mesh.vertices) {
    v.p.x() = -v.p.x();
    v.n.x() = -v.n.x();
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  }
  return mesh;
}

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

constexpr std::size_t kFingers = 4;  // index to little; the thumb comes after them
constexpr std::array<double, kFingers> kAcross{-0.030, -0.010, 0.010, 0.029};  // at the knuckles
constexpr std::array<double, kFingers> kLength{0.074, 0.082, 0.076, 0.060};    // knuckle to tip
constexpr std::array<double, kFingers> kAhead{0.042, 0.045, 0.041, 0.034};     // of the knuckles
constexpr double kFingerRadius = 0.0105, kThumbRadius = 0.0145, kWristRadius = 0.026;
constexpr double kThinner = 0.92;  // ratio of radii: a piece of a finger to the piece before

/// Positions of the joints.
struct Joints {
  Vec3 elbow, wrist;                           ///< ends of the visible part of the forearm
  std::array<Vec3, kFingers> palm;             ///< where the metacarpals begin
  std::array<std::array<Vec3, 4>, 5> fingers;  ///< knuckle to tip, the thumb's last
};

Joints open_joints() {
  Joints hand;
  hand.wrist = Vec3(0.0, 0.0, 0.055);
  hand.elbow = hand.wrist + Vec3(0.0, -0.05, 0.28);
  for (std::size_t i = 0; i < kFingers; ++i) {
    const double x = kAcross[i], l = kLength[i];
    const Vec3 knuckle(x, 0.004, -kAhead[i]);
    hand.palm[i] = hand.wrist + Vec3(0.4 * x, 0.0, 0.0);
    // Fingers at rest fan out and bend a little.
    hand.fingers[i] = {knuckle, knuckle + Vec3(0.10 * x, -0.004, -0.45 * l),
                       knuckle + Vec3(0.18 * x, -0.013, -0.75 * l),
                       knuckle + Vec3(0.24 * x, -0.024, -l)};
  }
  hand.fingers[kFingers] = {Vec3(-0.018, -0.004, 0.040), Vec3(-0.048, -0.010, 0.006),
                            Vec3(-0.062, -0.014, -0.028), Vec3(-0.068, -0.018, -0.052)};
  return hand;
}

/// Around a ball: palm behind it, fingers over its top, thumb on its left.
struct AroundBall {
  Vec3 p_HB;
  double radius;
  Vec3 out, over, right;  ///< from the centre to the palm, up its top, across

  AroundBall(const Vec3& p, double r) : p_HB(p), radius(r) {
    out = p.norm() > 1e-6 ? Vec3(-p.normalized()) : Vec3(Vec3::UnitZ());
    const Vec3 side = Vec3::UnitY().cross(out);
    right = side.norm() > 1e-6 ? Vec3(side.normalized()) : Vec3(Vec3::UnitX());
    over = out.cross(right);
  }
  /// A point `up` and `across` along the ball's skin [m], `above` it.
  Vec3 at(double up, double across, double above) const {
    const SinCos u = sin_cos(up / radius), a = sin_cos(across / radius);
    return p_HB + (radius + above) * (a.cos * (u.cos * out + u.sin * over) + a.sin * right);
  }
};

/// Where the last but one joint of a finger bends into its hole: middle finger, ring finger, thumb.
struct Hole {
  std::size_t finger;
  double up, across;
};
constexpr std::array<Hole, 3> kHoles{{{1, 0.088, -0.0135}, {2, 0.085, 0.0145}, {4, 0.010, -0.070}}};
constexpr double kDeep = -0.030;

Joints gripping_joints(const AroundBall& ball) {
  Joints hand;
  hand.wrist = ball.at(-0.055, 0.0, 0.026);
  hand.elbow = hand.wrist + 0.285 * (ball.out - 0.55 * ball.over).normalized();
  for (std::size_t i = 0; i < kFingers; ++i) {
    const double x = kAcross[i], k = kAhead[i], l = kLength[i];
    hand.palm[i] = ball.at(-0.045, 0.4 * x, 0.020);
    hand.fingers[i] = {ball.at(k, x, 0.014), ball.at(k + 0.45 * l, 1.15 * x, 0.011),
                       ball.at(k + 0.75 * l, 1.3 * x, 0.009), ball.at(k + l, 1.4 * x, 0.008)};
  }
  hand.fingers[kFingers] = {ball.at(-0.035, -0.018, 0.018),
                            ball.at(-0.012, -0.050, 0.014),
                            ball.at(0.010, -0.070, 0.006),
                            {}};
  for (const Hole& hole : kHoles) {
    auto& joints = hand.fingers.at(hole.finger);
    joints[1] = ball.at(hole.finger < kFingers ? hole.up - 0.026 : -0.012,
                        hole.finger < kFingers ? 0.95 * hole.across : -0.048, 0.017);
    joints[2] = ball.at(hole.up, hole.across, 0.006);
    joints[3] = ball.at(hole.up, hole.across, kDeep);
  }
  return hand;
}

/// Joints between an open and a gripping hand. No joint is deeper in the ball than in the grip.
Joints between(const Joints& open, const Joints& grip, const Vec3& p_HB, double closed) {
  const auto mix = [&](const Vec3& a, const Vec3& b) -> Vec3 {
    const Vec3 from = a + closed * (b - a) - p_HB;
    const double least = (b - p_HB).norm();
    if (closed == 0.0 || from.norm() >= least || from.norm() < 1e-6) return p_HB + from;
    return p_HB + least * from.normalized();
  };
  Joints hand;
  hand.elbow = open.elbow + closed * (grip.elbow - open.elbow);
  hand.wrist = mix(open.wrist, grip.wrist);
  for (std::size_t i = 0; i < kFingers; ++i) hand.palm[i] = mix(open.palm[i], grip.palm[i]);
  for (std::size_t i = 0; i < hand.fingers.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      hand.fingers[i][k] = mix(open.fingers[i][k], grip.fingers[i][k]);
    }
  }
  return hand;
}

double radius_of(std::size_t finger) {
  return finger < kFingers ? kFingerRadius : kThumbRadius;
}

std::vector<Bone> bones_of(const Joints& hand) {
  std::vector<Bone> bones;
  const Vec3 up_the_arm = (hand.elbow - hand.wrist).normalized();
  bones.push_back({hand.wrist + 0.08 * up_the_arm, hand.wrist, 0.028, kWristRadius});
  for (std::size_t i = 0; i < hand.fingers.size(); ++i) {
    const auto& joints = hand.fingers[i];
    if (i < kFingers) bones.push_back({hand.palm[i], joints[0], 0.018, 0.0125});
    double radius = radius_of(i);
    for (std::size_t k = 0; k < 3; ++k, radius *= kThinner) {
      bones.push_back({joints[k], joints[k + 1], radius, kThinner * radius});
    }
  }
  return bones;
}

/// Distance to the skin over all bones.
double to_skin(const std::vector<Bone>& bones, const Vec3& p) {
  double d = 1.0;
  for (const Bone& bone : bones) d = blend(d, distance(bone, p), 0.010);
  return d;
}

Vec3 slope(const std::vector<Bone>& bones, const Vec3& p) {
  constexpr double h = 1e-4;
  Vec3 g;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = h * Vec3::Unit(i);
    g[i] = to_skin(bones, p + step) - to_skin(bones, p - step);
  }
  return g.normalized();
}

/// A cross-section of a tube: its centre and half axes.
struct Section {
  Vec3 p, across, up;
};

/// A tube through its sections, closed by a point beyond the last, seen from outside.
render::Mesh tube(const std::vector<Section>& sections, const Vec3& end, std::uint32_t sides,
                  const Vec3& colour) {
  render::Mesh mesh;
  const auto add = [&](const Vec3& p, const Vec3& n) {
    mesh.vertices.push_back({p.cast<float>(), n.cast<float>(), colour.cast<float>()});
  };
  for (const Section& s : sections) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const SinCos turn = sin_cos(2.0 * std::numbers::pi * k / sides);
      const Vec3 from = turn.cos * s.across + turn.sin * s.up;
      add(s.p + from, from.normalized());
    }
  }
  add(end, (end - sections.back().p).normalized());
  const auto rings = static_cast<std::uint32_t>(sections.size());
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t next = (k + 1) % sides;
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      const std::uint32_t a = r * sides, b = a + sides;
      for (const std::uint32_t i : {a + k, a + next, b + next, a + k, b + next, b + k}) {
        mesh.indices.push_back(i);
      }
    }
    const std::uint32_t last = (rings - 1) * sides;
    for (const std::uint32_t i : {last + k, last + next, rings * sides}) mesh.indices.push_back(i);
  }
  return mesh;
}

/// Moves a tube's vertices onto the skin, so that tubes that meet form one surface.
void wrap(render::Mesh& mesh, const std::vector<Bone>& bones) {
  for (render::Vertex& v : mesh.vertices) {
    Vec3 p = v.p.cast<double>();
    for (int i = 0; i < 4; ++i) p -= to_skin(bones, p) * slope(bones, p);
    v.p = p.cast<float>();
    v.n = slope(bones, p).cast<float>();
  }
}

/// Cross-sections along a line of joints: at both ends of each piece, in the middle of the first
/// piece, and beyond the tip. They are as parallel to `across` as possible.
std::vector<Section> sections_along(const std::array<Vec3, 4>& joints, double radius,
                                    const Vec3& across) {
  std::vector<Section> sections;
  const auto add = [&](const Vec3& p, const Vec3& along, double r) {
    const Vec3 up = across.cross(along).normalized();
    sections.push_back({p, r * up.cross(along), r * up});
  };
  for (std::size_t k = 0; k < 3; ++k, radius *= kThinner) {
    const Vec3 piece = joints[k + 1] - joints[k];
    if (k == 0) add(joints[0], piece.normalized(), 1.2 * radius);
    if (k == 0) add(joints[0] + 0.5 * piece, piece.normalized(), 1.1 * radius);
    const Vec3 next = k < 2 ? Vec3(joints[k + 2] - joints[k + 1]) : piece;
    add(joints[k + 1], (piece.normalized() + next.normalized()).normalized(), 1.1 * radius);
    if (k < 2) continue;
    add(joints[3] + 0.7 * radius * piece.normalized(), piece.normalized(), 0.7 * radius);
  }
  return sections;
}

void append_finger(render::Mesh& mesh, const Joints& hand, std::size_t i, const Vec3& across,
                   const std::vector<Bone>& bones, const Vec3& skin) {
  const auto& joints = hand.fingers[i];
  const double radius = radius_of(i);
  const Vec3 tip = joints[3] + radius * (joints[3] - joints[2]).normalized();
  render::Mesh finger = tube(sections_along(joints, radius, across), tip, 8, skin);
  wrap(finger, bones);
  append(mesh, finger);
}

/// Adds the palm, from under the sleeve to the knuckles.
void append_palm(render::Mesh& mesh, const Joints& hand, const Vec3& across,
                 const std::vector<Bone>& bones, const Vec3& skin) {
  Vec3 knuckles = Vec3::Zero(), heel = Vec3::Zero();
  for (std::size_t i = 0; i < kFingers; ++i) {
    knuckles += hand.fingers[i][0] / kFingers;
    heel += hand.palm[i] / kFingers;
  }
  const Vec3 up_the_arm = (hand.elbow - hand.wrist).normalized();
  std::vector<Section> sections;
  const auto add = [&](const Vec3& p, const Vec3& along, double wide, double thick) {
    const Vec3 up = across.cross(along).normalized();
    sections.push_back({p, wide * up.cross(along), thick * up});
  };
  const Vec3 ahead = (knuckles - heel).normalized();
  add(hand.wrist + 0.05 * up_the_arm, -up_the_arm, 0.03, 0.03);
  add(hand.wrist + 0.02 * up_the_arm, -up_the_arm, 0.03, 0.03);
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    add(heel + share * (knuckles - heel), ahead, 0.035 + 0.012 * share, 0.024);
  }
  render::Mesh palm = tube(sections, knuckles + 0.014 * ahead, 14, skin);
  wrap(palm, bones);
  append(mesh, palm);
}

/// Adds the sleeve over the forearm, from its cuff towards the elbow.
void append_sleeve(render::Mesh& mesh, const Joints& hand, const Vec3& across) {
  const Vec3 along = hand.elbow - hand.wrist;
  const Vec3 ahead = along.normalized();
  const Vec3 up = across.cross(ahead).normalized(), side = up.cross(ahead);
  const auto part = [&](std::initializer_list<Vec2> rings, double end, const Vec3& colour) {
    std::vector<Section> sections;
    for (const Vec2& r : rings) {
      sections.push_back({hand.wrist + r.x() * ahead, r.y() * 1.1 * side, r.y() * up});
    }
    render::append(mesh, tube(sections, hand.wrist + end * ahead, 14, colour));
  };
  const double length = along.norm();
  part({{0.030, 0.030}, {0.028, 0.0355}, {0.056, 0.0365}}, 0.058, render::srgb(0xe8e4da));
  part({{0.046, 0.037}, {0.060, 0.0395}, {0.16, 0.045}, {length - 0.03, 0.052}, {length, 0.035}},
       length + 0.012, render::srgb(0x34506e));
}

}  // namespace

render::Mesh hand_mesh(const Vec3& p_HB, double radius, double closed, bool left_hand) {
  if (left_hand) return in_mirror(hand_mesh(in_mirror(p_HB), radius, closed));
  const AroundBall ball(p_HB, radius);
  const Joints hand = between(open_joints(), gripping_joints(ball), p_HB, closed);
  const std::vector<Bone> bones = bones_of(hand);
  const Vec3 skin = render::srgb(0xd9a27e);
  const Vec3 across = (hand.fingers[kFingers - 1][0] - hand.fingers[0][0]).normalized();
  render::Mesh mesh;
  mesh.gloss = 0.12;
  mesh.fine_light = false;  // matt and of small triangles
  append_palm(mesh, hand, across, bones, skin);
  for (std::size_t i = 0; i < hand.fingers.size(); ++i) {
    append_finger(mesh, hand, i, across, bones, skin);
  }
  append_sleeve(mesh, hand, across);
  return mesh;
}

std::array<Vec3, 3> ball_holes(const Vec3& p_HB, double radius, bool left_hand) {
  if (left_hand) {
    std::array<Vec3, 3> towards = ball_holes(in_mirror(p_HB), radius);
    for (Vec3& one : towards) one = in_mirror(one);
    return towards;
  }
  // The orientation when the arm model takes the ball from its stand: 28 degrees forward, 40 aside.
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Quat q_WH = rotation(Vec3(0.0, 0.0, -40.0 * kDegree)) *
                    rotation(Vec3(28.0 * kDegree, 0.0, 0.0)) *
                    rotation(Vec3(0.0, 0.0, std::numbers::pi));
  const AroundBall ball(p_HB, radius);
  std::array<Vec3, 3> towards;
  for (std::size_t i = 0; i < towards.size(); ++i) {
    towards[i] = q_WH * (ball.at(kHoles[i].up, kHoles[i].across, 0.0) - p_HB).normalized();
  }
  return towards;
}

}  // namespace headpin::scene
