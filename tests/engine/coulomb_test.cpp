#include <random>

#include <gtest/gtest.h>

#include "engine/response.h"

// Coulomb's law of an impact beside a plain calculation, and at its limits.
namespace headpin::engine {
namespace {

double energy_given(const Encounter& e, const Vec3& F) {
  return F.dot(e.u_W) + 0.5 * F.dot(e.K_W * F);
}

/// The law without a look at the energy: it sticks, or slides at the limit of friction.
Vec3 raw_coulomb(const Encounter& e, const Coefficients& c) {
  const Vec3& N = e.n_AB_W;
  const double approach = e.u_W.dot(N);
  const Mat3 inverse = e.K_W.inverse();
  const Vec3 sticks = inverse * (-c.elasticity * approach * N - e.u_W);
  const double press = -sticks.dot(N);
  if ((sticks + press * N).norm() <= c.friction * press) return sticks;
  const Vec3 slip = e.u_W - approach * N;
  const Vec3 limit = N + c.friction * slip.normalized();
  const double seen = N.dot(e.K_W * limit), stop = (1.0 + c.elasticity) * approach;
  if (seen <= 0.0) return -stop / N.dot(e.K_W * N) * N;
  return -stop / seen * limit;
}

/// As far from F00 towards F as adds no energy, by halving.
Vec3 without_gain(const Encounter& e, const Vec3& F) {
  const Vec3& N = e.n_AB_W;
  const Vec3 F00 = -e.u_W.dot(N) / N.dot(e.K_W * N) * N;
  if (energy_given(e, F) <= 0.0) return F;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (energy_given(e, F00 + middle * (F - F00)) <= 0.0 ? low : high) = middle;
  }
  return F00 + low * (F - F00);
}

struct Drawn {
  Encounter e;
  Coefficients c;
};

/// Bodies that meet somehow, slender ones among them.
Drawn draw(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Mat3 A;
  for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform(-1.0, 1.0);
  Drawn d;
  d.e.n_AB_W = Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
  d.e.K_W = A * A.transpose() + 0.01 * Mat3::Identity();
  d.e.u_W = Vec3(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3));
  if (d.e.u_W.dot(d.e.n_AB_W) < 0.0) d.e.u_W = -d.e.u_W;
  d.c = {uniform(0.0, 1.0), uniform(0.0, 1.0)};
  return d;
}

TEST(CoulombImpulse, IsThatOfAPlainCalculationWithoutGain) {
  std::mt19937_64 random(5);
  int gains = 0;
  for (int k = 0; k < 3000; ++k) {
    const Drawn d = draw(random);
    const Vec3 raw = raw_coulomb(d.e, d.c), F = without_gain(d.e, raw);
    const Vec3 found = coulomb_impulse(d.e, d.c);
    EXPECT_LT((found - F).norm(), 1e-7 * (1.0 + F.norm())) << k;
    gains += energy_given(d.e, raw) > 0.0 ? 1 : 0;
  }
  EXPECT_GT(gains, 30);
}

// Bodies a million times as heavy get a million times the impulse; at a millionth of the speed a millionth.
TEST(CoulombImpulse, IsInProportionToMassAndSpeed) {
  const double part = 0x1p-20;
  const Vec3 N = Vec3::UnitZ();
  Mat3 K;
  K << 2.0, 0.2, 0.5, 0.2, 1.0, 0.3, 0.5, 0.3, 1.0;
  const Coefficients c{0.5, 0.2};
  for (const Vec3& u : {Vec3(0.0, 0.0, 1.0), Vec3(3.0, 0.0, 1.0)}) {
    const Vec3 F = coulomb_impulse({N, u, K}, c);
    EXPECT_GT((F - F.z() * N).norm(), 0.1 * c.friction);
    EXPECT_LT((part * coulomb_impulse({N, u, part * K}, c) - F).norm(), 1e-12);
    EXPECT_LT((coulomb_impulse({N, part * u, K}, c) / part - F).norm(), 1e-12);
  }
}

// K^-1 u is (ux, -1/2, 1): friction of 5/8 of the load, as much as sticking needs at ux = 3/8.
TEST(CoulombImpulse, SticksWhereFrictionIsJustEnough) {
  Mat3 K;
  K << 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.5, 1.25;
  const Vec3 N = Vec3::UnitZ();
  EXPECT_LT((coulomb_impulse({N, Vec3(0.375, 0.0, 1.0), K}, {0.0, 0.625}) - Vec3(-0.375, 0.5, -1.0))
                .norm(),
            1e-12);
  EXPECT_LT(
      (coulomb_impulse({N, Vec3(0.376, 0.0, 1.0), K}, {0.0, 0.625}) - Vec3(-0.5, 0.0, -0.8)).norm(),
      1e-12);
}

// The slip along x and the load push against each other: an impulse at the limit of friction stops nothing.
TEST(CoulombImpulse, IsNormalWhereFrictionWouldHoldTheBodiesTogether) {
  Mat3 K;
  K << 3.0, -1.5, -1.0, -1.5, 2.0, 1.0, -1.0, 1.0, 1.0;
  const Encounter e{Vec3::UnitZ(), Vec3(10.0, 0.0, 1.0), K};
  EXPECT_LT((coulomb_impulse(e, {0.25, 1.0}) - Vec3(0.0, 0.0, -1.25)).norm(), 1e-12);
}

TEST(CoulombImpulse, OfBodiesThatDoNotMoveIsZero) {
  const Vec3 F = coulomb_impulse({Vec3::UnitZ(), Vec3::Zero(), Mat3::Identity()}, {0.5, 0.5});
  EXPECT_TRUE(F.isZero(0.0));
}

// Without a slip there is no friction, though the load begins one that friction cannot hold.
TEST(CoulombImpulse, UnderRules7IsNormalWithoutAnySlip) {
  Mat3 K;
  K << 1.0, 0.0, 0.9, 0.0, 1.0, 0.0, 0.9, 0.0, 1.0;
  const Encounter e{Vec3::UnitZ(), Vec3(0.0, 0.0, 2.0), K};
  const Vec3 F = response_under("coulomb", 7).impulse(e, {0.5, 0.1});
  EXPECT_LT((F - Vec3(0.0, 0.0, -3.0)).norm(), 1e-12);
}

TEST(CoulombSliding, IsFreeWithoutFrictionAndElseLimitedByTheLoad) {
  EXPECT_EQ(coulomb_sliding(0.0, 0.01, 0.02).kept, 1.0);
  EXPECT_EQ(coulomb_sliding(0.0, 0.01, 0.02).limit, 0.0);
  EXPECT_EQ(coulomb_sliding(0.3, 0.01, 0.02).kept, 0.0);
  EXPECT_EQ(coulomb_sliding(0.3, 0.01, 0.02).limit, 0.3);
}

}  // namespace
}  // namespace headpin::engine
