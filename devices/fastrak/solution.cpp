#include "devices/fastrak/solution.h"

#include "devices/fastrak/geometry.h"

namespace headpin::devices {

Pose pose_reported(const FastrakStationSetup& setup, const Pose& X_TS) {
  Pose X = X_TS;
  X.p = X * setup.p_SN;
  X = frame_through(setup.p_TA[0], setup.p_TA[1], setup.p_TA[2]).value().inverse() * X;
  X = Pose{from_angles_deg(setup.mounting_deg), Vec3::Zero()} * X;
  return X;
}

FastrakRecord record_of(const FastrakStationSetup& setup, const FastrakSolution& solution,
                        const Vec3& p_last, double metre_per_unit) {
  Pose X = pose_reported(setup, solution.X_TS);
  if (setup.q_boresight) {
    X.q = X.q * setup.q_boresight->conjugate() * from_angles_deg(setup.boresight_deg);
  }
  X.q.normalize();
  if (X.q.w() < 0.0) X.q.coeffs() = -X.q.coeffs();

  FastrakRecord record;
  record.error = solution.error;
  record.position = X.p / metre_per_unit;
  record.relative = (X.p - p_last) / metre_per_unit;
  record.angles_deg = angles_deg(X.q);
  record.attitude = X.q.toRotationMatrix();
  record.quaternion = {X.q.w(), X.q.x(), X.q.y(), X.q.z()};
  record.pressed = solution.pressed;

  const auto outside = [](const Vec3& v, const std::array<Vec3, 2>& box) {
    return (v.array() > box[0].array()).any() || (v.array() < box[1].array()).any();
  };
  if (record.error == ' ') {
    if (outside(X.p, setup.position_envelope)) record.error = 'x';
    if (outside(record.angles_deg, setup.angle_envelope_deg)) record.error = 'y';
  }
  return record;
}

}  // namespace headpin::devices
