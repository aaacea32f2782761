#pragma once

#include "render/eyes.h"

/// Views as computer vision writes them.
namespace headpin::render {

/// A pinhole camera in OpenCV's convention: x right, y down, z ahead. The centre of the first pixel
/// is at (0, 0).
struct Camera {
  double fx, fy, cx, cy;  ///< [pixels]
  Pose X_CW;              ///< takes points of the world into the camera

  explicit Camera(const View& view);

  /// Where a point is in the picture; its depth must be positive.
  Vec2 pixel(const Vec3& p_CQ) const {
    return {fx * p_CQ.x() / p_CQ.z() + cx, fy * p_CQ.y() / p_CQ.z() + cy};
  }
  /// The point of a depth that is seen at a place in the picture.
  Vec3 point(double x, double y, double depth) const {
    return {(x - cx) / fx * depth, (y - cy) / fy * depth, depth};
  }
};

}  // namespace headpin::render
