#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/gl_functions.h"
#include "render/matrices.h"

/// What the passes of a picture pass on.
namespace headpin::render {

/// What the light sees: where a shadow map is, and which areas of it items cover.
struct CastShadow {
  Mat4 view;                                ///< world to the shadow map, 0..1
  std::vector<Eigen::AlignedBox2d> shades;  ///< areas that items cover, 0..1
};

/// A draw list as one eye sees it.
struct EyeScene {
  const DrawList* list;
  const std::vector<double>* sizes;  ///< of the items in the picture [pixels]
  const CastShadow* shadow;
  Mat4 world_to_clip = Mat4::Identity();
  Vec3 eye_W = Vec3::Zero();
  Vec3 grid_x = Vec3::UnitX(), grid_y = Vec3::UnitY();  ///< clip space to that of the samples
  Vec3 edge = Vec3::Ones();  ///< x and y up to which they are drawn, in clip space
  Vec3 picture_u = Vec3::Zero(),
       picture_v = Vec3::Zero();  ///< (i, j, 1) of a sample to the picture
  bool in_mirror = false;
};

/// Fills the bound target.
inline void clear(const Gl& gl, const Vec3& colour) {
  const Eigen::Vector3f c = colour.cast<float>();
  gl.ClearColor(c.x(), c.y(), c.z(), 1.0F);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

/// Whether samples outside of the picture are left out.
inline void cut_picture(const Gl& gl, bool on) {
  for (GLenum plane = GL_CLIP_DISTANCE1; plane <= GL_CLIP_DISTANCE4; ++plane) {
    on ? gl.Enable(plane) : gl.Disable(plane);
  }
}

}  // namespace headpin::render
