#include "scene/skittle_mesh.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <string>

namespace headpin::scene {

namespace {

using render::Mesh;
using render::Ring;
using render::srgb;

const Vec3 kWhite = srgb(0xf4f1e6);
const Vec3 kRed = srgb(0xc3161c);

/// Stripes, as shares of the height. Real ones are narrower; these are still seen from 6 m.
constexpr std::array<double, 4> kStripes{0.580, 0.632, 0.672, 0.724};

Vec3 colour_at(double share) {
  const bool red =
      (share > kStripes[0] && share < kStripes[1]) || (share > kStripes[2] && share < kStripes[3]);
  return red ? kRed : kWhite;
}

/// A point of the outline and the outward normal there, at a distance along it.
struct OnOutline {
  Vec2 p, n;
};

OnOutline along(const Outline& outline, const std::vector<double>& length, double s) {
  const auto after = std::upper_bound(length.begin() + 1, length.end() - 1, s);
  const auto i = static_cast<std::size_t>(after - length.begin());
  const double step = length[i] - length[i - 1];
  const double share = step > 0.0 ? std::clamp((s - length[i - 1]) / step, 0.0, 1.0) : 0.0;
  const Vec2 p = outline[i - 1] + share * (outline[i] - outline[i - 1]);
  // The direction of a few points around, so that the straight pieces do not show.
  const std::size_t a = i >= 2 ? i - 2 : 0, b = std::min(i + 1, outline.size() - 1);
  const Vec2 t = (outline[b] - outline[a]).normalized();
  return {p, {t.x(), -t.y()}};
}

}  // namespace

Outline smooth_outline(std::span<const Vec2> profile) {
  if (profile.size() < 3) throw std::invalid_argument("skittle profile: fewer than three points");
  for (std::size_t i = 1; i < profile.size(); ++i) {
    if (!(profile[i].x() > profile[i - 1].x()) || profile[i].y() < 0.0) {
      throw std::invalid_argument("skittle profile: point " + std::to_string(i + 1) +
                                  " does not rise");
    }
  }
  const bool round = profile.back().y() == 0.0;  // the rest is a spline up to the point before
  std::vector<Vec2> p(profile.begin(), profile.end() - (round ? 1 : 0));
  const Vec2 first = p[0], second = p[1], last = p.back(), before = p[p.size() - 2];
  p.insert(p.begin(), 2.0 * first - second);
  p.emplace_back(2.0 * last.x() - before.x(), before.y());  // upright at its end

  constexpr int kSteps = 16;
  Outline outline;
  for (std::size_t i = 1; i + 2 < p.size(); ++i) {
    // Barry and Goldman's pyramid with knots at the square roots of the distances.
    std::array<double, 4> t{};
    for (std::size_t k = 1; k < 4; ++k) {
      t[k] = t[k - 1] + std::sqrt((p[i + k - 1] - p[i + k - 2]).norm());
    }
    const auto mix = [](const Vec2& a, const Vec2& b, double ta, double tb, double at) -> Vec2 {
      return ((tb - at) * a + (at - ta) * b) / (tb - ta);
    };
    for (int step = 0; step < kSteps; ++step) {
      const double at = t[1] + (t[2] - t[1]) * step / kSteps;
      const Vec2 a1 = mix(p[i - 1], p[i], t[0], t[1], at);
      const Vec2 a2 = mix(p[i], p[i + 1], t[1], t[2], at);
      const Vec2 a3 = mix(p[i + 1], p[i + 2], t[2], t[3], at);
      const Vec2 b1 = mix(a1, a2, t[0], t[2], at);
      const Vec2 b2 = mix(a2, a3, t[1], t[3], at);
      outline.push_back(mix(b1, b2, t[1], t[2], at));
    }
  }
  const double rise = profile.back().x() - last.x();
  for (int step = 0; step < kSteps; ++step) {  // a quarter of an ellipse, or a flat top
    const SinCos turn = sin_cos(0.5 * std::numbers::pi * step / kSteps);
    outline.emplace_back(last.x() + rise * turn.sin, last.y() * turn.cos);
  }
  outline.emplace_back(profile.back().x(), 0.0);
  return outline;
}

Outline ellipsoid_outline(double height, double radius) {
  constexpr int kSteps = 128;
  Outline outline;
  for (int i = 0; i <= kSteps; ++i) {
    const SinCos turn = sin_cos(std::numbers::pi * i / kSteps);
    const bool end = i == 0 || i == kSteps;
    outline.emplace_back(0.5 * height * (1.0 - turn.cos), end ? 0.0 : radius * turn.sin);
  }
  return outline;
}

Mesh skittle_mesh(const Outline& outline, double origin, int rings, int sides) {
  std::vector<double> length{0.0};
  for (std::size_t i = 1; i < outline.size(); ++i) {
    length.push_back(length.back() + (outline[i] - outline[i - 1]).norm());
  }
  const double height = outline.back().x();
  std::vector<double> at;  // distances along the outline that get a ring
  for (int i = 0; i <= rings; ++i) at.push_back(length.back() * i / rings);
  for (const double share : kStripes) {
    std::size_t i = 1;
    while (outline[i].x() < share * height) ++i;
    const double part =
        (share * height - outline[i - 1].x()) / (outline[i].x() - outline[i - 1].x());
    const double edge = length[i - 1] + part * (length[i] - length[i - 1]);
    // A plain ring next to an edge would only make a sliver.
    std::erase_if(at, [&](double s) {
      return std::abs(s - edge) < 0.4 * length.back() / rings && s > 0.0 && s < length.back();
    });
    at.push_back(edge);
  }
  std::sort(at.begin(), at.end());

  std::vector<Ring> list;
  if (outline.front().y() > 0.0) {  // a flat base
    list.push_back({-origin, 0.0, {0.0, -1.0}, kWhite});
    list.push_back({-origin, outline.front().y(), {0.0, -1.0}, kWhite});
  }
  for (const double s : at) {
    const OnOutline point = along(outline, length, s);
    const double share = point.p.x() / height;
    const bool top = s >= length.back();
    const Vec2 n = top ? Vec2(0.0, 1.0) : point.n;
    const double r = top ? 0.0 : point.p.y();
    const Vec3 below = colour_at(share - 1e-6), above = colour_at(share + 1e-6);
    list.push_back({point.p.x() - origin, r, n, below});
    if (below != above) list.push_back({point.p.x() - origin, r, n, above});
  }
  Mesh mesh = render::turned(list, sides);
  mesh.gloss = 0.5;
  return mesh;
}

Mesh ball_mesh(double radius, const Vec3& holes_towards) {
  Mesh mesh = render::ellipsoid(radius, radius, 32, 20, [](double) { return Vec3::Zero(); });
  const Vec3 dark = srgb(0x123a8c), light = srgb(0x4d8fe0);
  for (render::Vertex& v : mesh.vertices) {
    const Vec3 n = v.n.cast<double>();
    // Two waves that bend each other give bands like poured resin.
    const double wave = std::sin(3.0 * n.x() + 2.5 * std::sin(2.0 * n.y() + 1.0) + 2.0 * n.z());
    const double share = std::clamp(0.5 + 0.9 * wave, 0.0, 1.0);
    v.colour = Vec3(dark + share * share * (light - dark)).cast<float>();
  }
  // Holes are caps a little above the ball: two for fingers, one for the thumb.
  const double hole = 0.115 * radius;
  const Vec3 side = holes_towards.unitOrthogonal(), ahead = holes_towards.cross(side);
  for (const Vec2& at : {Vec2(0.16, 0.22), Vec2(-0.16, 0.22), Vec2(0.0, -0.38)}) {
    const Vec3 out = (holes_towards + at.x() * side + at.y() * ahead).normalized();
    std::vector<Ring> cap;
    for (const double r : {hole, 0.6 * hole, 0.0}) {
      const double up = 1.004 * std::sqrt(radius * radius - r * r);
      cap.push_back({up, r, {r, up}, srgb(0x05070d)});
    }
    append(mesh, render::turned(cap, 12), {Quat::FromTwoVectors(Vec3::UnitZ(), out), Vec3::Zero()});
  }
  mesh.gloss = 0.9;
  return mesh;
}

}  // namespace headpin::scene
