#include "engine/free_motion.h"

#include <gtest/gtest.h>

namespace headpin::engine {
namespace {

struct Turning {
  Quat q;
  Vec3 w;
};

Turning after(const Inertia& inertia, Turning t, double seconds, double dt) {
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int i = 0; i < steps; ++i) turn_freely(t.q, t.w, inertia, dt);
  return t;
}

const Turning kTumble{rotation(Vec3(0.3, -1.0, 0.4)), Vec3(5.0, 3.0, -8.0)};

TEST(TumblingSkittle, KeepsAngularMomentumAndEnergyOverFiveSeconds) {
  const Inertia skittle = principal_inertia(Vec3(0.0145, 0.0145, 0.0021).asDiagonal());
  const Turning end = after(skittle, kTumble, 5.0, 1.0 / 240);
  const Vec3 L = angular_momentum(skittle, kTumble.q, kTumble.w);
  EXPECT_NEAR((angular_momentum(skittle, end.q, end.w) - L).norm(), 0.0, 1e-12 * L.norm());
  const double energy = turning_energy(skittle, kTumble.q, kTumble.w);
  EXPECT_NEAR(turning_energy(skittle, end.q, end.w), energy, 1e-12 * energy);
}

// For a body of revolution one long step and many short ones are the same closed solution.
TEST(BodyOfRevolution, TurnsTheSameInOneStepAndInMany) {
  const Inertia skittle = principal_inertia(Vec3(0.0145, 0.0145, 0.0021).asDiagonal());
  const Turning one = after(skittle, kTumble, 1.0, 1.0);
  const Turning many = after(skittle, kTumble, 1.0, 1.0 / 1024);
  EXPECT_NEAR(rotation_vector(one.q.conjugate() * many.q).norm(), 0.0, 1e-11);
  EXPECT_NEAR((one.w - many.w).norm(), 0.0, 1e-10);
}

// Three different moments: the splitting is composed to fourth order, so a step a quarter as long
// is 256 times nearer; as long as the steps are no shorter than the parts they are taken in.
TEST(BodyWithoutSymmetry, ConvergesWithTheFourthPowerOfTheStep) {
  const Inertia brick = principal_inertia(Vec3(0.010, 0.014, 0.006).asDiagonal());
  const Turning fine = after(brick, kTumble, 1.0, 1.0 / 16384);
  const auto error = [&](double dt) {
    return rotation_vector(fine.q.conjugate() * after(brick, kTumble, 1.0, dt).q).norm();
  };
  EXPECT_NEAR(error(1.0 / 256) / error(1.0 / 1024), 256.0, 64.0);
  const Turning end = after(brick, kTumble, 5.0, 1.0 / 1024);
  const Vec3 L = angular_momentum(brick, kTumble.q, kTumble.w);
  EXPECT_NEAR((angular_momentum(brick, end.q, end.w) - L).norm(), 0.0, 1e-11 * L.norm());
}

TEST(PrincipalInertia, FindsTheAxesOfATurnedTensor) {
  const Quat q_BP = rotation(Vec3(0.5, -0.2, 0.9));
  const Mat3 R = q_BP.toRotationMatrix();
  const Mat3 tensor = R * Vec3(0.0145, 0.0145, 0.0021).asDiagonal() * R.transpose();
  const Inertia found = principal_inertia(tensor);
  EXPECT_NEAR((found.moments - Vec3(0.0145, 0.0145, 0.0021)).norm(), 0.0, 1e-15);
  EXPECT_EQ(found.moments[0], found.moments[1]);
  EXPECT_NEAR((inverse_inertia(found, Quat::Identity()) * tensor - Mat3::Identity()).norm(), 0.0,
              1e-13);
}

TEST(PrincipalInertia, PutsTheAxisOfRevolutionLast) {
  EXPECT_EQ(principal_inertia(Vec3(0.2, 1.0, 1.0).asDiagonal()).moments, Vec3(1.0, 1.0, 0.2));
  EXPECT_EQ(principal_inertia(Vec3(1.0, 0.2, 1.0).asDiagonal()).moments, Vec3(1.0, 1.0, 0.2));
}

TEST(PrincipalInertia, RefusesWhatNoBodyHas) {
  EXPECT_THROW(principal_inertia(Mat3::Zero()), std::invalid_argument);
  EXPECT_THROW(principal_inertia(Vec3(1, 1, -1).asDiagonal()), std::invalid_argument);
  EXPECT_THROW(principal_inertia(Mat3::Constant(NAN)), std::invalid_argument);
  Mat3 crooked = Mat3::Identity();
  crooked(0, 1) = 0.5;
  EXPECT_THROW(principal_inertia(crooked), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::engine
