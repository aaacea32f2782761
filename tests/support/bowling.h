#pragma once

#include <optional>
#include <vector>

#include "engine/workspace.h"
#include "engine/world.h"

/// A ten-pin lane for tests and benchmarks, with the measures of engine.md section 0.
namespace headpin::engine {

/// Base cylinder, belly ellipsoid, neck cylinder, head sphere; B at the centre of mass.
Compound skittle_shape();
/// Half-space below z = 0.
Compound floor_shape();
Compound sphere_shape(double radius);

inline constexpr double kSkittleHeight = 0.147;  ///< of the centre of mass above the base [m]
inline constexpr double kBaseRadius = 0.0258;    ///< [m]
inline constexpr double kBallRadius = 0.108;     ///< [m]
inline constexpr double kSpacing = 0.3048;       ///< of the skittles [m]

Body skittle_body(const Material& material);  ///< 1.5 kg
Body ball_body(const Material& material, double radius = kBallRadius, double mass = 7.0);
Body floor_body(const Material& material);
/// A body of one shape, of a density of 1000 kg/m^3 or of a given mass [kg].
Body solid(const Shape& shape, const Material& material, std::optional<double> mass = {});

/// The state of a body at a place, with its velocities.
State at(const Pose& X_WB, const Vec3& v_WB = Vec3::Zero(), const Vec3& w_WB = Vec3::Zero());
State at(const Vec3& p_WB, const Vec3& v_WB = Vec3::Zero(), const Vec3& w_WB = Vec3::Zero());

struct RackOptions {
  Parameters parameters;
  Material material{0.7, 0.7};  ///< of every body: products .49; skittles also roll heavily
  bool ball = true;
  double ball_offset = 0.04;   ///< to the right of the head pin [m]
  double ball_speed = 6.0;     ///< rolling [m/s]
  double ball_distance = 1.5;  ///< before the head pin [m]
  int racks = 1;               ///< side by side and behind each other, each with its ball
};

/// A lane with racks of ten, head pin of the first at the origin; what is in it.
struct Bowling {
  World world;
  BodyId lane = 0;
  std::vector<BodyId> skittles;  ///< rack by rack
  std::vector<BodyId> balls;
};

Bowling bowling(const RackOptions& options);

/// Skittles of one rack that lean by more than 30 degrees or have left the lane.
int skittles_down(const Bowling& b, int rack = 0);

void run(World& world, double seconds);
void run(World& world, Workspace& workspace, double seconds);

/// Cosine of the angle between a body's z axis and the vertical.
double upright(const State& state);

}  // namespace headpin::engine
