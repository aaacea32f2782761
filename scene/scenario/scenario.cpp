#include "scene/scenario/scenario.h"

#include <cmath>
#include <utility>

#include "render/data/hmd.h"

namespace headpin::scene {
namespace {

/// Rounds a length, so that the text of a scenario does not show rounding errors of products.
double ten_micrometres(double length) {
  return std::round(length * 1e5) / 1e5;
}

}  // namespace

Hmd hmd_of_profile(std::string_view name) {
  const render::HmdProfile& profile = render::hmd_profile(name);
  return {std::string(profile.name), profile.optics};
}

Scenario::Scenario() : hmd(hmd_of_profile(render::hmd_profiles().front().name)) {
  // Ten pins: pins 12 in = 0.3048 m apart, so rows 10.392 in = 0.26396 m apart (USBC).
  for (int r = 0; r < 4; ++r) {
    for (int i = 0; i <= r; ++i) {
      rack.spots.emplace_back(ten_micrometres((i - 0.5 * r) * 0.3048),
                              ten_micrometres(r * 0.26396));
    }
  }
  // Fitted to within 1.9 mm of the profile, with given radius of the base and given height.
  skittle.parts = {
      {PartShape::cylinder, 0.0258, 0.0, 0.02},     {PartShape::cylinder, 0.0287, 0.003, 0.02},
      {PartShape::ellipsoid, 0.0384, 0.0002, 0.05}, {PartShape::ellipsoid, 0.0605, 0.004, 0.229},
      {PartShape::cone, 0.0605, 0.1335, 0.3131},    {PartShape::cylinder, 0.0246, 0.2, 0.33},
      {PartShape::ellipsoid, 0.0318, 0.272, 0.38},  {PartShape::ellipsoid, 0.0323, 0.3164, 0.381}};
  const double inch = 0.0254;
  for (const auto& [h, d] : {std::pair{0.0, 2.031},
                             {0.75, 2.828},
                             {2.25, 3.906},
                             {3.375, 4.510},
                             {4.5, 4.766},
                             {5.875, 4.563},
                             {7.25, 3.703},
                             {8.625, 2.472},
                             {9.375, 1.965},
                             {10.0, 1.797},
                             {10.875, 1.870},
                             {11.75, 2.094},
                             {12.625, 2.406},
                             {13.5, 2.547},
                             {13.727, 2.546},  // from here a half of a sphere, r = 1.273 in
                             {15.0, 0.0}}) {
    skittle.profile.emplace_back(ten_micrometres(h * inch), ten_micrometres(0.5 * d * inch));
  }
}

void set_elasticity(Materials& materials, double elasticity) {
  for (Coefficients* m : {&materials.skittle, &materials.ball, &materials.lane, &materials.wall}) {
    m->elasticity = elasticity;
  }
}

void set_friction(Materials& materials, double friction) {
  for (Coefficients* m : {&materials.skittle, &materials.ball, &materials.lane, &materials.wall}) {
    m->friction = friction;
  }
}

void set_elasticity(Scenario& scenario, double elasticity) {
  set_elasticity(scenario.material, elasticity);
  if (!scenario.version.buttons) return;
  scenario.version.red.elasticity = scenario.version.blue.elasticity = elasticity;
}

void set_friction(Scenario& scenario, double friction) {
  set_friction(scenario.material, friction);
  if (!scenario.version.buttons) return;
  scenario.version.red.friction = scenario.version.blue.friction = friction;
}

void set_shape(Scenario& scenario, SkittleShape shape) {
  scenario.collision.shape = shape;
  if (!scenario.version.buttons) return;
  scenario.version.red.shape = scenario.version.blue.shape = shape;
}

Scenario under(Scenario scenario, const Version& version) {
  set_elasticity(scenario.material, version.elasticity);
  set_friction(scenario.material, version.friction);
  scenario.collision.shape = version.shape;
  if (version.detection) scenario.collision.detection = *version.detection;
  if (version.iterations != 0) scenario.collision.iterations = version.iterations;
  return scenario;
}

}  // namespace headpin::scene
