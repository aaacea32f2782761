#pragma once

#include <limits>

#include <Eigen/Geometry>

#include "render/draw_list.h"
#include "render/eyes.h"

/// Poses, frusta, mirrors and lights as OpenGL's matrices.
namespace headpin::render {

using Mat4 = Eigen::Matrix4d;

/// World (or any frame) from a frame that is moved and scaled.
inline Mat4 matrix(const Pose& X, const Vec3& scale = Vec3::Ones()) {
  Mat4 m = Mat4::Identity();
  m.topLeftCorner<3, 3>() = X.q.toRotationMatrix() * scale.asDiagonal();
  m.topRightCorner<3, 1>() = X.p;
  return m;
}

/// Eye to clip space (OpenGL 3.3 compatibility specification, glFrustum, with tangents).
inline Mat4 projection(const Frustum& f) {
  Mat4 m = Mat4::Zero();
  m(0, 0) = 2.0 / (f.right - f.left);
  m(0, 2) = (f.right + f.left) / (f.right - f.left);
  m(1, 1) = 2.0 / (f.top - f.bottom);
  m(1, 2) = (f.top + f.bottom) / (f.top - f.bottom);
  m(2, 2) = -(f.far + f.near) / (f.far - f.near);
  m(2, 3) = -2.0 * f.far * f.near / (f.far - f.near);
  m(3, 2) = -1.0;
  return m;
}

inline Mat4 world_to_clip(const View& view) {
  return projection(view.frustum) * matrix(view.X_WE.inverse());
}

/// The world seen in a horizontal mirror at height z.
inline Mat4 mirrored_at(double z) {
  Mat4 m = Mat4::Identity();
  m(2, 2) = -1.0;
  m(2, 3) = 2.0 * z;
  return m;
}

/// The box of a shadow as the light sees it.
struct LightView {
  Mat4 to_clip = Mat4::Identity();  ///< from the world: along the light, the box just inside
  Vec2 size = Vec2::Ones();         ///< of what is seen, across and along it [m]
};

inline LightView light_view(const Shadow& shadow) {
  Mat3 R_LW;  // light frame: x as near to W's as can be, z to the light
  R_LW.row(2) = shadow.n_W.normalized();
  R_LW.row(1) = shadow.n_W.cross(Vec3::UnitX()).normalized();
  R_LW.row(0) = R_LW.row(1).cross(R_LW.row(2));
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 hi = -lo;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p_W((corner & 1) != 0 ? shadow.hi_W.x() : shadow.lo_W.x(),
                   (corner & 2) != 0 ? shadow.hi_W.y() : shadow.lo_W.y(),
                   (corner & 4) != 0 ? shadow.hi_W.z() : shadow.lo_W.z());
    const Vec3 p_L = R_LW * p_W;
    lo = lo.cwiseMin(p_L);
    hi = hi.cwiseMax(p_L);
  }
  const Vec3 to_unit = 2.0 * (hi - lo).cwiseMax(1e-6).cwiseInverse();
  Mat4 m = Mat4::Identity();
  m.topLeftCorner<3, 3>() = Vec3(to_unit.x(), to_unit.y(), -to_unit.z()).asDiagonal() * R_LW;
  m.topRightCorner<3, 1>() = -to_unit.cwiseProduct(0.5 * (hi + lo));
  m(2, 3) = -m(2, 3);
  return {m, (hi - lo).head<2>()};
}

/// The area that a box covers in a parallel projection: range of x and y of its corners.
inline Eigen::AlignedBox2d across(const Eigen::AlignedBox3d& box, const Mat4& view) {
  Eigen::AlignedBox2d seen;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    seen.extend((view * p.homogeneous()).head<2>().eval());
  }
  return seen;
}

}  // namespace headpin::render
