#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/math.h"

/// All a renderer needs to be told. Colours and light are linear RGB, 1 is white at full light.
namespace headpin::render {

struct DrawItem {
  int mesh = 0;  ///< what Renderer::add returned
  // Of the same surface, with fewer triangles:
  std::optional<int> far_mesh;    ///< drawn where it is small
  std::optional<int> faint_mesh;  ///< mirrored, and as a shadow; without, the far one
  Pose X_WG;                      ///< mesh in the world
  Vec3 scale = Vec3::Ones();      ///< along the mesh's own axes
  Vec3 tint = Vec3::Ones();       ///< times the mesh's colours
  std::uint32_t id = 0;           ///< what labels() calls it
  bool casts_shadow = false;
  bool mirrored = false;  ///< seen again in polished floors
};

/// A small lamp: at distance d it lights a surface that faces it with power / d^2.
struct Lamp {
  Vec3 p_W = Vec3::Zero();
  Vec3 power = Vec3::Ones();
};

/// A ball that keeps light from the floor near it. Bodies are told as a few of these.
struct Occluder {
  Vec3 p_W = Vec3::Zero();
  double radius = 0.0;  ///< [m]
};

/// A rectangle that occluders darken: one corner and two sides, u x v pointing out of the floor.
struct Patch {
  Vec3 p_W = Vec3::Zero();
  Vec3 u_W = Vec3::UnitX();
  Vec3 v_W = Vec3::UnitY();
};

/// Where floors and lit bodies take the shadow of items, cast by parallel light.
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
  Vec3 background = Vec3::Zero();     ///< where nothing is, and what a polished floor mirrors there
  std::vector<Occluder> occluders;
  std::vector<Patch> patches;
  Shadow shadow;
  double mirror_z = 0.0;  ///< height of the polished floor [m]

  static constexpr std::size_t kLamps = 8;
};

}  // namespace headpin::render
