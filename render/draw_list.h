#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/math.h"

/// The input of a renderer. Colours and light are linear RGB; 1 is white at full light.
namespace headpin::render {

struct DrawItem {
  int mesh = 0;  ///< number from Renderer::add
  // Of the same surface, with fewer triangles:
  std::optional<int> far_mesh;    ///< drawn if it is small in the picture
  std::optional<int> faint_mesh;  ///< drawn in reflections and shadows; default: far_mesh
  Pose X_WG;                      ///< mesh in the world
  Vec3 scale = Vec3::Ones();      ///< along the mesh's own axes
  Vec3 tint = Vec3::Ones();       ///< factor of the mesh's colours
  std::uint32_t id = 0;           ///< its number in labels()
  bool casts_shadow = false;
  bool mirrored = false;  ///< visible in reflections
};

/// A small lamp: at distance d it lights a surface that faces it with power / d^2.
struct Lamp {
  Vec3 p_W = Vec3::Zero();
  Vec3 power = Vec3::Ones();
};

/// A ball that keeps light from the floor near it. A few of these stand for a body.
struct Occluder {
  Vec3 p_W = Vec3::Zero();
  double radius = 0.0;  ///< [m]
};

/// A rectangle that occluders darken: one corner and two sides; u x v points out of the floor.
struct Patch {
  Vec3 p_W = Vec3::Zero();
  Vec3 u_W = Vec3::UnitX();
  Vec3 v_W = Vec3::UnitY();
};

/// The shadow of items on floors and lit bodies, by parallel light.
struct Shadow {
  Vec3 n_W = Vec3::UnitZ();  ///< unit, to the light
  Vec3 lo_W = Vec3::Zero();  ///< corners of the box that holds casters and floor
  Vec3 hi_W = Vec3::Zero();
  double depth = 0.0;  ///< share of the light that is lost in shadow; 0 is no shadow
};

struct DrawList {
  std::vector<DrawItem> items;
  std::vector<Lamp> lamps;            ///< at most kLamps
  Vec3 sky = Vec3::Constant(0.3);     ///< light from above, all around
  Vec3 ground = Vec3::Constant(0.1);  ///< light from below
  Vec3 background = Vec3::Zero();     ///< colour without any object, also in reflections
  std::vector<Occluder> occluders;
  std::vector<Patch> patches;
  Shadow shadow;
  double mirror_z = 0.0;  ///< height of the polished floor [m]

  static constexpr std::size_t kLamps = 8;
};

}  // namespace headpin::render
