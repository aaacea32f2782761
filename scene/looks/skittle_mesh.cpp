#include "scene/looks/skittle_mesh.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace headpin::scene {

namespace {

using render::Mesh;
using render::Ring;
using render::srgb;

const Vec3 kWhite = srgb(0xf4f1e6);
const Vec3 kRed = srgb(0xc3161c);

/// Edges of the stripes, as parts of the height. Real stripes are narrower; these are visible from
/// 6 m.
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
  // The direction is that between points a little apart, so that straight pieces are not visible.
  const std::size_t a = i >= 2 ? i - 2 : 0, b = std::min(i + 1, outline.size() - 1);
  const Vec2 t = (outline[b] - outline[a]).normalized();
  return {p, {t.x(), -t.y()}};
}

std::vector<double> lengths_along(const Outline& outline) {
  std::vector<double> length{0.0};
  for (std::size_t i = 1; i < outline.size(); ++i) {
    length.push_back(length.back() + (outline[i] - outline[i - 1]).norm());
  }
  return length;
}

/// Appends the points after `first`, up to `last`, that a polyline needs to stay within `off` of an
/// outline (Ramer 1972, Douglas and Peucker 1973).
void append_bends(const Outline& outline, std::size_t first, std::size_t last, double off,
                  std::vector<std::size_t>& bends) {
  const Vec2 along = (outline[last] - outline[first]).normalized();
  double farthest = off;
  std::size_t at = last;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vec2 d = outline[i] - outline[first];
    const double beside = std::abs(along.x() * d.y() - along.y() * d.x());
    if (beside <= farthest) continue;
    farthest = beside;
    at = i;
  }
  if (at != last) append_bends(outline, first, at, off, bends);
  if (at != last) return append_bends(outline, at, last, off, bends);
  bends.push_back(last);
}

/// @param at    distances along the outline that get a ring
/// @param near  a plain ring that is nearer to a stripe's edge is left out: it would make slivers
Mesh striped(const Outline& outline, const std::vector<double>& length, std::vector<double> at,
             double near, double origin, int sides) {
  const double height = outline.back().x();
  for (const double share : kStripes) {
    std::size_t i = 1;
    while (outline[i].x() < share * height) ++i;
    const double part =
        (share * height - outline[i - 1].x()) / (outline[i].x() - outline[i - 1].x());
    const double edge = length[i - 1] + part * (length[i] - length[i - 1]);
    std::erase_if(
        at, [&](double s) { return std::abs(s - edge) < near && s > 0.0 && s < length.back(); });
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

}  // namespace

Mesh skittle_mesh(const Outline& outline, double origin, int rings, int sides) {
  const std::vector<double> length = lengths_along(outline);
  std::vector<double> at;
  for (int i = 0; i <= rings; ++i) at.push_back(length.back() * i / rings);
  return striped(outline, length, at, 0.4 * length.back() / rings, origin, sides);
}

Mesh edged_skittle_mesh(const Outline& outline, double origin, double off, int sides) {
  const std::vector<double> length = lengths_along(outline);
  std::vector<std::size_t> bends{0};
  append_bends(outline, 0, outline.size() - 1, off, bends);
  std::vector<double> at;
  for (const std::size_t i : bends) at.push_back(length[i]);
  return striped(outline, length, at, 0.0, origin, sides);
}

Mesh ball_mesh(double radius, std::span<const Vec3> holes, int sides, int rings) {
  Mesh mesh = render::ellipsoid(radius, radius, sides, rings, [](double) { return Vec3::Zero(); });
  const Vec3 dark = srgb(0x123a8c), light = srgb(0x4d8fe0);
  for (render::Vertex& v : mesh.vertices) {
    const Vec3 n = v.n.cast<double>();
    // Two waves that bend each other give bands like poured resin.
    const double wave = std::sin(3.0 * n.x() + 2.5 * std::sin(2.0 * n.y() + 1.0) + 2.0 * n.z());
    const double share = std::clamp(0.5 + 0.9 * wave, 0.0, 1.0);
    v.colour = Vec3(dark + share * share * (light - dark)).cast<float>();
  }
  // Holes are caps a little above the ball.
  const double hole = 0.115 * radius;
  for (const Vec3& out : holes) {
    std::vector<Ring> cap;
    for (const double r : {hole, 0.6 * hole, 0.0}) {
      const double up = 1.004 * std::sqrt(radius * radius - r * r);
      cap.push_back({up, r, {r, up}, srgb(0x05070d)});
    }
    append(mesh, render::turned(cap, 3 * sides / 8),
           {Quat::FromTwoVectors(Vec3::UnitZ(), out), Vec3::Zero()});
  }
  mesh.gloss = 0.9;
  return mesh;
}

Mesh oil_ring_mesh() {
  constexpr double kThick = 0.012, kHalfHeight = 0.0015;  // of the radius; [m]
  constexpr int kAround = 6, kSides = 64;
  const Vec3 oil = srgb(0xe8e2c4);
  std::vector<Ring> tube;
  for (int i = 0; i <= kAround; ++i) {
    const double t = (2.0 * i / kAround - 1.0) * std::numbers::pi;
    tube.push_back({kHalfHeight * std::sin(t),
                    1.0 + kThick * std::cos(t),
                    {kHalfHeight * std::cos(t), kThick * std::sin(t)},
                    oil});
  }
  Mesh mesh = render::turned(tube, kSides);
  mesh.gloss = 0.5;
  return mesh;
}

}  // namespace headpin::scene
