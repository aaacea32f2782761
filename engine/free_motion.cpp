#include "engine/free_motion.h"

#include <array>
#include <stdexcept>

namespace headpin::engine {
namespace {

/// Three steps of second order, with these parts of the time, make one of fourth (Yoshida 1990).
constexpr double kOuter = 1.3512071919596578;  // 1 / (2 - 2^(1/3))
constexpr double kSmallTurn = 0.1;             // a larger turn is cut into parts [rad]

bool nearly_equal(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(a, b);
}

Quat principal_frame(const Inertia& inertia, const Quat& q_WB) {
  return inertia.aligned ? q_WB : Quat(q_WB * inertia.q_BP);
}

/// q * rotation(0, 0, angle).
Quat turned_about_z(const Quat& q, double angle) {
  const HalfAngle half = half_angle(angle * angle);
  const double c = half.cosine, s = half.sine_by_angle * angle;
  return {q.w() * c - q.z() * s, q.x() * c + q.y() * s, q.y() * c - q.x() * s,
          q.w() * s + q.z() * c};
}

/// Restores the length 1 after a few products, with one Newton step for the inverse root.
void renormalize(Quat& q) {
  q.coeffs() *= 1.5 - 0.5 * q.squaredNorm();
}

/// Free rotation of a body of revolution, in closed form.
void turn_about_axis(Quat& q_WP, Vec3& w_W, const Inertia& inertia, double dt) {
  const double I1 = inertia.moments[0], I3 = inertia.moments[2], inv_I1 = inertia.inverse[0];
  const double more = inertia.inverse[2] - inv_I1;
  const Vec3 e3 = z_axis(q_WP);
  const double w3 = e3.dot(w_W), L3 = I3 * w3;
  const Vec3 L_W = I1 * w_W + ((I3 - I1) * w3) * e3;
  q_WP = turned_about_z(rotation(L_W * (inv_I1 * dt)) * q_WP, more * L3 * dt);
  renormalize(q_WP);
  w_W = inv_I1 * L_W + (more * L3) * z_axis(q_WP);
}

}  // namespace

Inertia principal_inertia(const Mat3& inertia_B) {
  if (!inertia_B.allFinite() ||
      (inertia_B - inertia_B.transpose()).norm() > 1e-9 * inertia_B.norm()) {
    throw std::invalid_argument("inertia: expected a finite symmetric tensor");
  }
  Mat3 axes = Mat3::Identity();
  Vec3 moments = inertia_B.diagonal();
  if ((inertia_B - Mat3(moments.asDiagonal())).norm() > 1e-12 * inertia_B.norm()) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia_B);
    moments = solver.eigenvalues();
    axes = solver.eigenvectors();
  }
  if (!(moments.minCoeff() > 0.0)) {
    throw std::invalid_argument("inertia: expected positive principal moments, found " +
                                std::to_string(moments.minCoeff()));
  }
  // The axis whose moment differs most: the moments of the two others are closest to each other.
  int alone = 2;
  double closest = std::abs(moments[0] - moments[1]);
  for (int i = 1; i >= 0; --i) {
    const double gap = std::abs(moments[(i + 1) % 3] - moments[(i + 2) % 3]);
    if (gap < closest * (1.0 - 1e-9)) {
      closest = gap;
      alone = i;
    }
  }
  const std::array<int, 3> order{(alone + 1) % 3, (alone + 2) % 3, alone};
  Inertia result;
  Mat3 R_BP;
  for (int k = 0; k < 3; ++k) {
    result.moments[k] = moments[order[static_cast<std::size_t>(k)]];
    R_BP.col(k) = axes.col(order[static_cast<std::size_t>(k)]);
  }
  if (R_BP.determinant() < 0.0) R_BP.col(1) *= -1.0;
  result.q_BP = Quat(R_BP).normalized();
  double& i1 = result.moments[0];
  double& i2 = result.moments[1];
  if (nearly_equal(i1, i2)) i1 = i2 = 0.5 * (i1 + i2);
  if (nearly_equal(i1, result.moments[2])) result.moments[2] = i1;
  result.inverse = result.moments.cwiseInverse();
  result.aligned = result.q_BP.vec().isZero(0.0);
  return result;
}

Vec3 axis_of_revolution(const Inertia& inertia, const Quat& q_WB) {
  return z_axis(principal_frame(inertia, q_WB));
}

Mat3 inverse_inertia(const Inertia& inertia, const Quat& q_WB) {
  const Vec3& inv = inertia.inverse;
  const Quat q_WP = principal_frame(inertia, q_WB);
  // (1/I1) 1 + (1/I2 - 1/I1) e2 e2' + (1/I3 - 1/I1) e3 e3'
  Mat3 result = inv[0] * Mat3::Identity();
  if (inv[2] != inv[0]) {
    const Vec3 e3 = z_axis(q_WP);
    result += (inv[2] - inv[0]) * e3 * e3.transpose();
  }
  if (inv[1] != inv[0]) {
    const Vec3 e2 = q_WP * Vec3::UnitY();
    result += (inv[1] - inv[0]) * e2 * e2.transpose();
  }
  return result;
}

Vec3 angular_momentum(const Inertia& inertia, const Quat& q_WB, const Vec3& w_WB) {
  const Quat q_WP = q_WB * inertia.q_BP;
  const Vec3 w_P = q_WP.conjugate() * w_WB;
  return q_WP * Vec3(inertia.moments.cwiseProduct(w_P));
}

double turning_energy(const Inertia& inertia, const Quat& q_WB, const Vec3& w_WB) {
  const Vec3 w_P = (q_WB * inertia.q_BP).conjugate() * w_WB;
  return 0.5 * w_P.dot(inertia.moments.cwiseProduct(w_P));
}

void turn_freely(Quat& q_WB, Vec3& w_WB, const Inertia& inertia, double dt) {
  const Vec3 &I = inertia.moments, &inv = inertia.inverse;
  if (is_ball(inertia)) {  // w is constant
    q_WB = rotation(w_WB * dt) * q_WB;
    renormalize(q_WB);
    return;
  }
  if (I[0] == I[1] && inertia.aligned) {
    turn_about_axis(q_WB, w_WB, inertia, dt);
    return;
  }
  Quat q_WP = principal_frame(inertia, q_WB);
  if (I[0] == I[1]) {
    turn_about_axis(q_WP, w_WB, inertia, dt);
  } else {
    const Vec3 L_W = q_WP * Vec3(I.cwiseProduct(q_WP.conjugate() * w_WB));
    const auto turn_second = [&](double h) {
      const double L2 = (q_WP.conjugate() * L_W).y();
      q_WP = q_WP * rotation(Vec3(0.0, (inv[1] - inv[0]) * L2 * (0.5 * h), 0.0));
    };
    const auto turn = [&](double h) {
      turn_second(h);
      const double L3 = (q_WP.conjugate() * L_W).z();
      q_WP = rotation(L_W * (inv[0] * h)) * q_WP *
             rotation(Vec3(0.0, 0.0, (inv[2] - inv[0]) * L3 * h));
      turn_second(h);
    };
    const double turns = L_W.norm() * inv.maxCoeff() * std::abs(dt) / kSmallTurn;
    const int parts = static_cast<int>(std::min(std::ceil(turns), 1000.0));
    for (int k = 0; k < parts; ++k) {
      for (const double weight : {kOuter, 1.0 - 2.0 * kOuter, kOuter}) turn(weight * dt / parts);
    }
    renormalize(q_WP);
    w_WB = q_WP * Vec3(inv.cwiseProduct(q_WP.conjugate() * L_W));
  }
  q_WB = (q_WP * inertia.q_BP.conjugate()).normalized();
}

}  // namespace headpin::engine
