#include "scene/sound/modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/sound/ears.h"
#include "scene/stage/outline.h"

namespace headpin::scene {

namespace {

using std::numbers::pi;

constexpr double kAirImpedance = 413;  // density times speed of sound at 20 degrees [Pa s/m]

// Sugar maple with 12 % moisture (Forest Products Laboratory, Wood handbook, 2010, tables 5-1, 5-2,
// 5-3): along the grain; shear modulus and modulus across the grain as parts of that.
constexpr double kMaple = 12.6e9, kMapleShear = 0.111, kMapleAcross = 0.132;
constexpr double kMapleDensity = 705.0;

// Cast polyester: handbooks give 2 to 4.4 GPa.
constexpr double kPolyester = 3.3e9, kPolyesterPoisson = 0.35;

// Loss factors. Maple has 0.01; the plastic coat is a guess. Thermosets have 0.02 to 0.1, built-up
// wooden floors 0.05 to 0.15.
constexpr double kSkittleLoss = 0.02, kBallLoss = 0.05, kLaneLoss = 0.1;

constexpr double kLaneThick = 0.065, kSleepers = 0.6;  // m

/// Of what radiates a mode.
struct Radiator {
  double mass;    ///< [kg]
  double area;    ///< [m^2]
  double radius;  ///< half of its smallest width: a smaller part of the wave length radiates less
  double loss;    ///< loss factor
};

/// The mode of a body that moves with impulse / mass everywhere, in the mean of the squares. Its sound
/// power is that of a surface of the same velocity, times the efficiency of an oscillating sphere
/// (Cremer, Heckl, Structure-borne sound).
Mode radiated(double frequency, const Radiator& body) {
  const double ka = 2.0 * pi * frequency / kSpeedOfSound * body.radius;
  const double efficiency = ka * ka * ka * ka / (4.0 + ka * ka * ka * ka);
  return {frequency, pi * frequency * body.loss,
          kAirImpedance / body.mass * std::sqrt(efficiency * body.area / (4.0 * pi))};
}

/// Of a cylinder that is as high and has the same volume.
double mean_radius(const Skittle& skittle) {
  const Outline outline = smooth_outline(skittle.profile);
  double cubic = 0.0;  // volume / pi
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const double a = outline[i - 1].y(), b = outline[i].y();
    cubic += (outline[i].x() - outline[i - 1].x()) * (a * a + a * b + b * b) / 3.0;
  }
  return std::sqrt(cubic / skittle.height);
}

}  // namespace

std::vector<Mode> modes_of_skittle(const Skittle& skittle) {
  // cosh x cos x = 1
  constexpr std::array kRoots = {4.73004, 7.85320, 10.99561, 14.13717};
  constexpr double kShearFactor = 0.9;  // of a round section
  const double radius = mean_radius(skittle), length = skittle.height;
  const double gyration = 0.5 * radius;  // of the section
  const Radiator body{skittle.mass, 2.0 * pi * radius * length, radius, kSkittleLoss};
  std::vector<Mode> modes;
  for (const double root : kRoots) {
    const double wave = root / length;
    const double thin = wave * wave * gyration * std::sqrt(kMaple / kMapleDensity) / (2.0 * pi);
    const double thick = wave * gyration * wave * gyration;
    modes.push_back(
        radiated(thin / std::sqrt(1.0 + thick * (1.0 + 1.0 / (kMapleShear * kShearFactor))), body));
  }
  return modes;
}

std::vector<Mode> modes_of_ball(const Ball& ball) {
  // Roots of Lamb's equation for l = 2, 3, 4 at Poisson's ratio 0.35: angular frequency times radius
  // over the speed of shear waves.
  constexpr std::array kRoots = {2.651, 3.957, 5.079};
  const double r = ball.radius;
  const double density = ball.mass / (4.0 / 3.0 * pi * r * r * r);
  const double shear = std::sqrt(kPolyester / (2.0 * (1.0 + kPolyesterPoisson)) / density);
  std::vector<Mode> modes;
  for (const double root : kRoots) {
    modes.push_back(
        radiated(root * shear / (2.0 * pi * r), {ball.mass, 4.0 * pi * r * r, r, kBallLoss}));
  }
  return modes;
}

std::vector<Mode> modes_of_lane(const RoomMeasures& room) {
  const double width = room.lane_width;
  const Radiator plate{kMapleDensity * kLaneThick * width * kSleepers, width * kSleepers,
                       0.5 * kSleepers, kLaneLoss};
  const double bending = kLaneThick * std::sqrt(kMaple / (12.0 * kMapleDensity));
  std::vector<Mode> modes;
  for (const int along : {1, 2}) {
    for (const int across : {1, 2, 3, 4}) {
      const double a = along / kSleepers, b = across / width;
      const double stiff = a * a * a * a + kMapleAcross * b * b * b * b;
      modes.push_back(radiated(0.5 * pi * bending * std::sqrt(stiff), plate));
    }
  }
  return modes;
}

ContactSurface surface_of_skittle(const Skittle& skittle) {
  double widest = 0.0;
  for (const Vec2& point : skittle.profile) widest = std::max(widest, point.y());
  return {1.0 / widest, kMapleAcross * kMaple, 0.4};
}

ContactSurface surface_of_ball(const Ball& ball) {
  return {1.0 / ball.radius, kPolyester, kPolyesterPoisson};
}

ContactSurface surface_of_room() {
  return {0.0, kMapleAcross * kMaple, 0.4};
}

ContactSurface surface_of_hand() {
  return {0.0, 1e5, 0.5};  // soft tissue has 10 to 200 kPa
}

double contact_time(const ContactSurface& a, const ContactSurface& b, double mass, double speed) {
  const double compliance =
      (1.0 - a.poisson * a.poisson) / a.modulus + (1.0 - b.poisson * b.poisson) / b.modulus;
  const double curvature = a.curvature + b.curvature;
  return 2.87 * power(mass * mass * curvature * compliance * compliance / speed, 0.2);
}

double part_of_impulse(double frequency, double touching) {
  const double half_waves = 2.0 * frequency * touching;
  const double square = half_waves * half_waves;
  return 1.0 / std::sqrt(1.0 + square * square);
}

}  // namespace headpin::scene
