#include "render/camera.h"

namespace headpin::render {

namespace {

/// From an eye (y up, looking along -z) to a camera (y down, z ahead): half a turn about x.
const Quat kHalfTurn(0.0, 1.0, 0.0, 0.0);

}  // namespace

Camera::Camera(const View& view)
    : fx(view.width / (view.frustum.right - view.frustum.left)),
      fy(view.height / (view.frustum.top - view.frustum.bottom)),
      cx(-view.frustum.left * fx - 0.5),
      cy(view.frustum.top * fy - 0.5),
      X_CW(Pose{kHalfTurn, Vec3::Zero()} * view.X_WE.inverse()) {}

}  // namespace headpin::render
