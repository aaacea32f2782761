#include "scene/stage/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace headpin::scene {

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
  p.emplace_back(2.0 * last.x() - before.x(), before.y());  // vertical at its end

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

Outline outline_of_parts(std::span<const TurnedPart> parts) {
  constexpr double kStep = 0.001;  // [m]
  std::vector<double> heights;
  for (const TurnedPart& part : parts) {
    const int steps = std::max(1, static_cast<int>(std::ceil((part.high - part.low) / kStep)));
    for (int i = 0; i <= steps; ++i) {
      heights.push_back(part.low + (part.high - part.low) * i / steps);
    }
  }
  std::ranges::sort(heights);
  // The largest radius of the parts directly below, or above, a height.
  const auto widest = [&](double height, bool below) {
    double radius = 0.0;
    for (const TurnedPart& part : parts) {
      const bool there = below ? part.low < height && height <= part.high
                               : part.low <= height && height < part.high;
      if (there) radius = std::max(radius, part.radius(height));
    }
    return radius;
  };
  Outline outline;
  for (const double height : heights) {
    for (const bool below : {true, false}) {
      const Vec2 point(height, widest(height, below));
      if (outline.empty() ? !below : point != outline.back()) outline.push_back(point);
    }
  }
  return outline;
}

engine::MassProperties turned_mass(const Outline& outline, double mass) {
  // Integrals over the height h of the discs. Between two points they are polynomials, at most h^2
  // r^2 and r^4, which three-point Gauss quadrature integrates exactly.
  const double off = std::sqrt(0.6);
  const std::array<Vec2, 3> gauss{Vec2(-off, 5.0 / 18.0), Vec2(0.0, 8.0 / 18.0),
                                  Vec2(off, 5.0 / 18.0)};
  double volume = 0.0, first = 0.0, second = 0.0, fourth = 0.0;  // of r^2, h r^2, h^2 r^2, r^4
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Vec2 step = outline[i] - outline[i - 1];
    for (const Vec2& g : gauss) {
      const Vec2 p = outline[i - 1] + 0.5 * (1.0 + g.x()) * step;
      const double h = p.x(), r2 = p.y() * p.y(), part = g.y() * step.x();
      volume += part * r2;
      first += part * h * r2;
      second += part * h * h * r2;
      fourth += part * r2 * r2;
    }
  }
  const double centre = first / volume, per = mass / volume;
  const double about_axis = 0.5 * fourth * per;
  const double across = (0.25 * fourth + second) * per - mass * centre * centre;
  engine::MassProperties found;
  found.mass = mass;
  found.centre = Vec3(0.0, 0.0, centre);
  found.inertia = Vec3(across, across, about_axis).asDiagonal();
  return found;
}

namespace {

/// Largest distance from the axis of a convex polyhedron's section at a height.
double radius_of_section(const SkittlePart& part, double height) {
  double radius = 0.0;
  for (const std::vector<std::uint32_t>& face : part.faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Vec3 &a = part.corners[face[i]], &b = part.corners[face[(i + 1) % face.size()]];
      const double from = height - a.z(), to = height - b.z();
      if (from * to > 0.0) continue;  // the edge is above or below
      const double share = a.z() == b.z() ? 0.0 : from / (b.z() - a.z());
      const Vec3 p = a + share * (b - a);
      radius = std::max(
          {radius, std::hypot(p.x(), p.y()), a.z() == b.z() ? std::hypot(b.x(), b.y()) : 0.0});
    }
  }
  return radius;
}

double radius_of_part(const SkittlePart& part, double height) {
  if (height < part.low || height > part.high) return 0.0;
  if (part.shape == PartShape::polyhedron) return radius_of_section(part, height);
  if (part.shape == PartShape::cylinder) return part.radius;
  const double share = (height - part.low) / (part.high - part.low);
  if (part.shape == PartShape::cone) return part.radius * (1.0 - share);
  const double across = 2.0 * share - 1.0;
  return part.radius * std::sqrt(std::max(0.0, 1.0 - across * across));
}

}  // namespace

std::vector<Vec2> profile_of_parts(std::span<const SkittlePart> parts, double height) {
  constexpr int kSteps = 24;
  std::vector<Vec2> profile;
  for (int i = 0; i <= kSteps; ++i) {
    const double at = i == kSteps ? height : height * i / kSteps;
    double radius = 0.0;
    for (const SkittlePart& part : parts) radius = std::max(radius, radius_of_part(part, at));
    profile.emplace_back(at, radius);
  }
  return profile;
}

}  // namespace headpin::scene
