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

/// A tensor with these principal moments along turned axes.
Mat3 turned_tensor(const Vec3& moments) {
  const Mat3 R = rotation(Vec3(0.5, -0.2, 0.9)).toRotationMatrix();
  return R * moments.asDiagonal() * R.transpose();
}

// Marbles and houses: of a small tensor as of a large one, 1e-9 of it is the limit.
TEST(PrincipalInertia, CountsMomentsWithinABillionthAsEqualInAnySize) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const auto found = [&](double more) {
      return principal_inertia((size * Vec3(1.0, 1.0 + more, 0.2)).asDiagonal()).moments;
    };
    EXPECT_EQ(found(1e-10)[0], found(1e-10)[1]);
    EXPECT_NE(found(1e-8)[0], found(1e-8)[1]);
    const auto ball = [&](double more) {
      return is_ball(principal_inertia((size * Vec3(1.0, 1.0, 1.0 + more)).asDiagonal()));
    };
    EXPECT_TRUE(ball(1e-10));
    EXPECT_FALSE(ball(1e-8));
  }
}

TEST(PrincipalInertia, AllowsRoundingOfASymmetricTensorAndNoMoreInAnySize) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    Mat3 tensor = size * turned_tensor(Vec3(1.0, 1.5, 2.2));
    tensor(0, 1) += 1e-10 * size;
    EXPECT_NO_THROW(principal_inertia(tensor));
    tensor(0, 1) += 1e-7 * size;
    EXPECT_THROW(principal_inertia(tensor), std::invalid_argument);
  }
}

// Off its diagonal a tensor may have little: it counts all the same.
TEST(PrincipalInertia, TurnsTheAxesOfATensorThatIsAlmostDiagonalInAnySize) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    Mat3 tensor = (size * Vec3(1.0, 1.5, 2.2)).asDiagonal();
    tensor(0, 1) = tensor(1, 0) = 1e-8 * size;
    const Inertia found = principal_inertia(tensor);
    EXPECT_FALSE(found.aligned);
    const Mat3 inverse = inverse_inertia(found, Quat::Identity());
    EXPECT_NEAR((inverse * tensor - Mat3::Identity()).norm(), 0.0, 1e-13);
  }
}

TEST(PrincipalInertia, OfNoMomentIsRefusedForItsMoments) {
  try {
    principal_inertia(Mat3::Zero());
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("positive principal moments"), std::string::npos);
  }
}

// No axis differs more than the last one does: of a ball, and of moments at equal distances.
TEST(PrincipalInertia, LeavesTheFrameOfABodyWhoseLastAxisDiffersAsMuchAsAnyOther) {
  for (const Vec3& moments :
       {Vec3(0.3, 0.3, 0.3), Vec3(1.0, 2.0, 3.0), Vec3(3.0, 2.0, 1.0), Vec3(0.01, 0.02, 0.03)}) {
    const Inertia found = principal_inertia(moments.asDiagonal());
    EXPECT_TRUE(found.aligned) << moments.transpose();
    EXPECT_EQ(found.moments, moments);
  }
}

TEST(InverseInertia, IsTheInverseOfTheTensorOfAnyBodyTurned) {
  const Quat q_WB = rotation(Vec3(-1.0, 0.4, 0.7));
  const Mat3 R_WB = q_WB.toRotationMatrix();
  for (const Vec3& moments : {Vec3(1.0, 1.5, 2.2), Vec3(2.2, 1.0, 1.5), Vec3(1.0, 1.0, 0.2),
                              Vec3(0.2, 1.0, 1.0), Vec3(0.7, 0.7, 0.7)}) {
    for (const Mat3& tensor_B : {turned_tensor(moments), Mat3(moments.asDiagonal())}) {
      const Mat3 inverse_W = inverse_inertia(principal_inertia(tensor_B), q_WB);
      const Mat3 tensor_W = R_WB * tensor_B * R_WB.transpose();
      EXPECT_NEAR((inverse_W * tensor_W - Mat3::Identity()).norm(), 0.0, 1e-13);
    }
  }
}

// Rounding changes the length of a quaternion in each product; in a million steps it would add up.
TEST(TurnFreely, RestoresTheLengthOfTheQuaternion) {
  for (const Vec3& moments : {Vec3(0.7, 0.7, 0.7), Vec3(1.0, 1.0, 0.2), Vec3(1.0, 1.5, 2.2)}) {
    for (const Mat3& tensor : {turned_tensor(moments), Mat3(moments.asDiagonal())}) {
      Turning t = kTumble;
      t.q.coeffs() *= 1.0 + 1e-9;
      turn_freely(t.q, t.w, principal_inertia(tensor), 1.0 / 240);
      EXPECT_NEAR(t.q.norm(), 1.0, 1e-14) << moments.transpose();
    }
  }
}

}  // namespace
}  // namespace headpin::engine
