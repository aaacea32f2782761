#include "engine/response.h"

#include <random>

#include <gtest/gtest.h>

#include "engine/free_motion.h"

namespace headpin::engine {
namespace {

#ifdef HEADPIN_SANITIZED
constexpr int kMany = 20'000;
#else
constexpr int kMany = 1'000'000;
#endif

struct Half {
  double mass;
  Mat3 inertia_W;
  Vec3 r_W, v_W, w_W;

  double inv_mass() const { return 1.0 / mass; }
  Vec3 point_velocity() const { return v_W + w_W.cross(r_W); }
  double energy() const { return 0.5 * mass * v_W.squaredNorm() + 0.5 * w_W.dot(inertia_W * w_W); }
  void push(const Vec3& F) {  // eqs. (3) to (6)
    v_W += F / mass;
    w_W += inertia_W.llt().solve(r_W.cross(F));
  }
};

struct Couple {
  Half a, b;
  Vec3 n_W;
  Encounter encounter() const {
    const Mat3 one = Mat3::Identity();
    return {n_W, a.point_velocity() - b.point_velocity(),
            inverse_mass_at(a.inv_mass(), a.inertia_W.llt().solve(one), a.r_W) +
                inverse_mass_at(b.inv_mass(), b.inertia_W.llt().solve(one), b.r_W)};
  }
  void push(const Vec3& F) {
    a.push(F);
    b.push(-F);
  }
  double energy() const { return a.energy() + b.energy(); }
};

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  Vec3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Quat turn() { return rotation(vector(3.0)); }
  /// A body of size about 1; its moments obey the triangle inequality, slender ones among them.
  Half half(double mass) {
    const double slender = power(10.0, uniform(-3.0, 0.0));
    const Vec3 squares(uniform(0.1, 1.0), uniform(0.1, 1.0) * slender, uniform(0.1, 1.0) * slender);
    const Vec3 moments(squares.y() + squares.z(), squares.x() + squares.z(),
                       squares.x() + squares.y());
    const Mat3 R = turn().toRotationMatrix();
    return {mass, mass * R * moments.asDiagonal() * R.transpose(), vector(1.0), vector(5.0),
            vector(5.0)};
  }
  /// Two bodies that approach, masses up to `ratio` apart.
  Couple pair(double ratio) {
    const double spread = logarithm(ratio);
    Couple p{half(1.0), half(exponential(uniform(-spread, spread))), turn() * Vec3::UnitX()};
    if (p.encounter().u_W.dot(p.n_W) < 0.0) p.n_W = -p.n_W;
    return p;
  }

 private:
  std::mt19937_64 random_;
};

TEST(FourCorners, DoWhatTheirNamesSay) {
  Draw draw(1);
  for (int i = 0; i < kMany / 100; ++i) {
    const Couple before = draw.pair(100.0);
    const Encounter e = before.encounter();
    const double speed = e.u_W.norm(), energy = before.energy();
    const auto u_after = [&](const Vec3& F) { return Vec3(e.u_W + e.K_W * F); };
    const auto energy_after = [&](const Vec3& F) {
      Couple after = before;
      after.push(F);
      return after.energy();
    };
    const double tiny = 1e-10 * speed;  // K is as bad as 1e5 here: eleven digits stay
    EXPECT_NEAR(u_after(impulse_inelastic_smooth(e)).dot(e.n_AB_W), 0.0, tiny);
    EXPECT_NEAR(u_after(impulse_inelastic_rough(e)).norm(), 0.0, tiny);
    EXPECT_NEAR(u_after(impulse_elastic_rough(e)).cross(e.n_AB_W).norm(), 0.0, tiny);
    EXPECT_LT(u_after(impulse_elastic_rough(e)).dot(e.n_AB_W), 0.0);
    EXPECT_NEAR(u_after(impulse_elastic_smooth(e)).dot(e.n_AB_W), -e.u_W.dot(e.n_AB_W), tiny);
    EXPECT_NEAR(energy_after(impulse_elastic_smooth(e)), energy, 1e-12 * energy);
    EXPECT_NEAR(energy_after(impulse_elastic_rough(e)), energy, 1e-11 * energy);
    EXPECT_LE(energy_after(impulse_inelastic_smooth(e)), energy);
    EXPECT_LE(energy_after(impulse_inelastic_rough(e)), energy);
    EXPECT_NEAR(impulse_elastic_smooth(e).cross(e.n_AB_W).norm(), 0.0,
                1e-12 * impulse_elastic_smooth(e).norm());
  }
}

TEST(EveryResponse, KeepsLinearAndAngularMomentum) {
  Draw draw(2);
  for (int i = 0; i < kMany / 100; ++i) {
    const Vec3 p_WA = draw.vector(3.0), p_WQ = draw.vector(3.0);  // A's centre; any other point
    for (const Response& response : responses()) {
      Couple pair = draw.pair(1e4);
      const Vec3 p_WB = p_WA + pair.a.r_W - pair.b.r_W;  // both arms end in the same point
      const auto linear = [&] { return Vec3(pair.a.mass * pair.a.v_W + pair.b.mass * pair.b.v_W); };
      const auto angular = [&] {
        return Vec3(pair.a.inertia_W * pair.a.w_W + pair.b.inertia_W * pair.b.w_W +
                    (p_WA - p_WQ).cross(pair.a.mass * pair.a.v_W) +
                    (p_WB - p_WQ).cross(pair.b.mass * pair.b.v_W));
      };
      const Vec3 p = linear(), L = angular();
      const double size = pair.a.mass * pair.a.v_W.norm() + pair.b.mass * pair.b.v_W.norm();
      pair.push(response.impulse(pair.encounter(), {draw.uniform(0, 1), draw.uniform(0, 1)}));
      EXPECT_NEAR((linear() - p).norm(), 0.0, 1e-12 * size);
      EXPECT_NEAR((angular() - L).norm(), 0.0, 1e-12 * 10.0 * size);  // arms up to ten metres
    }
  }
}

// The blend is a convex mix of four impulses that add no energy, and energy is convex in F.
TEST(EveryResponse, NeverAddsEnergyAndNeverLeavesThePairApproaching) {
  for (const Response& response : responses()) {
    Draw draw(3);
    double worst = 0.0, worst_approach = 0.0;
    for (int i = 0; i < kMany; ++i) {
      Couple pair = draw.pair(1e4);
      const Encounter e = pair.encounter();
      const Vec3 F = response.impulse(e, {draw.uniform(0, 1), draw.uniform(0, 1)});
      const double before = pair.energy();
      worst_approach = std::max(worst_approach, (e.u_W + e.K_W * F).dot(e.n_AB_W) / e.u_W.norm());
      pair.push(F);
      worst = std::max(worst, (pair.energy() - before) / before);
    }
    EXPECT_LE(worst, 1e-12) << response.name;
    EXPECT_LE(worst_approach, 1e-9) << response.name;  // rounding of K with ratios of 1e4
  }
}

TEST(PaperImpulse, IsBilinearInBothCoefficientsAndMeetsTheCorners) {
  Draw draw(4);
  for (int i = 0; i < 1000; ++i) {
    const Encounter e = draw.pair(10.0).encounter();
    const double size = impulse_elastic_rough(e).norm();
    const auto F = [&](double elasticity, double friction) {
      return paper_impulse(e, {elasticity, friction});
    };
    EXPECT_NEAR((F(0, 0) - impulse_inelastic_smooth(e)).norm(), 0.0, 1e-14 * size);
    EXPECT_NEAR((F(1, 0) - impulse_elastic_smooth(e)).norm(), 0.0, 1e-14 * size);
    EXPECT_NEAR((F(0, 1) - impulse_inelastic_rough(e)).norm(), 0.0, 1e-14 * size);
    EXPECT_NEAR((F(1, 1) - impulse_elastic_rough(e)).norm(), 0.0, 1e-14 * size);
    const double a = draw.uniform(0, 0.5), b = draw.uniform(0, 1), h = draw.uniform(0, 0.25);
    EXPECT_NEAR((F(a, b) - 2 * F(a + h, b) + F(a + 2 * h, b)).norm(), 0.0, 1e-13 * size);
    EXPECT_NEAR((F(b, a) - 2 * F(b, a + h) + F(b, a + 2 * h)).norm(), 0.0, 1e-13 * size);
  }
}

TEST(EveryResponse, DoesNotCareWhichBodyIsCalledA) {
  Draw draw(5);
  for (const Response& response : responses()) {
    for (int i = 0; i < 1000; ++i) {
      const Coefficients c{draw.uniform(0, 1), draw.uniform(0, 1)};
      const Couple pair = draw.pair(10.0);
      const Vec3 F = response.impulse(pair.encounter(), c);
      const Vec3 G = response.impulse(Couple{pair.b, pair.a, -pair.n_W}.encounter(), c);
      EXPECT_NEAR((F + G).norm(), 0.0, 1e-12 * F.norm());
    }
  }
}

TEST(EveryResponse, TurnsWithTheFrame) {
  Draw draw(6);
  for (const Response& response : responses()) {
    for (int i = 0; i < 1000; ++i) {
      const Coefficients c{draw.uniform(0, 1), draw.uniform(0, 1)};
      const Encounter e = draw.pair(10.0).encounter();
      const Mat3 R = draw.turn().toRotationMatrix();
      const Encounter turned{R * e.n_AB_W, R * e.u_W, R * e.K_W * R.transpose()};
      const Vec3 F = response.impulse(e, c);
      EXPECT_NEAR((R * F - response.impulse(turned, c)).norm(), 0.0, 1e-10 * F.norm());
    }
  }
}

TEST(EveryResponse, TreatsAFixedBodyAsTheLimitOfAHeavyOne) {
  Draw draw(7);
  for (const Response& response : responses()) {
    for (int i = 0; i < 1000; ++i) {
      const Coefficients c{draw.uniform(0, 1), draw.uniform(0, 1)};
      Couple pair = draw.pair(1.0);
      Encounter fixed = pair.encounter();
      fixed.K_W = inverse_mass_at(1.0, pair.a.inertia_W.inverse(), pair.a.r_W);
      pair.b.mass *= 1e9;
      pair.b.inertia_W *= 1e9;
      const Vec3 F = response.impulse(fixed, c);
      EXPECT_NEAR((F - response.impulse(pair.encounter(), c)).norm(), 0.0, 1e-4 * F.norm());
    }
  }
}

TEST(HeadOn, EqualElasticBallsSwapVelocities) {
  const Mat3 I = 0.4 * Mat3::Identity();
  Couple pair{{1.0, I, Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3::Zero()},
              {1.0, I, Vec3(-1, 0, 0), Vec3(-2, 0, 0), Vec3::Zero()},
              Vec3::UnitX()};
  pair.push(paper_impulse(pair.encounter(), {1.0, 0.0}));
  EXPECT_EQ(pair.a.v_W, Vec3(-2, 0, 0));
  EXPECT_EQ(pair.b.v_W, Vec3(3, 0, 0));
}

// A ball of radius r, sphere inertia 2/5 m r^2, comes down on a rough floor with slip s and speed
// v. K is 1/m along N and 7/2 1/m across: stopping the slip takes 2/7 of m s.
TEST(BallOnAFloor, FollowsTheClosedSolutionForSpinAndSlope) {
  const double m = 2.0, r = 0.5, v = 3.0, s = 1.5, w = -4.0;
  const Vec3 N = -Vec3::UnitZ(), arm(0, 0, -r);
  const Mat3 inv_I = Mat3::Identity() / (0.4 * m * r * r);
  const Vec3 v_W(s, 0, -v), w_W(0, w, 0);
  const Encounter e{N, v_W + w_W.cross(arm), inverse_mass_at(1.0 / m, inv_I, arm)};
  const double slip = s - w * r;  // of the lowest point
  ASSERT_NEAR(e.u_W.x(), slip, 1e-15);
  const Vec3 F01 = impulse_inelastic_rough(e);
  EXPECT_NEAR((F01 - Vec3(-m * slip * 2.0 / 7.0, 0, m * v)).norm(), 0.0, 1e-14);
  // eq. (7): the energy of the slip goes into the rebound, v'^2 = v^2 + 2/7 slip^2.
  const double rebound = std::sqrt(v * v + 2.0 / 7.0 * slip * slip);
  const Vec3 F11 = impulse_elastic_rough(e);
  EXPECT_NEAR((F11 - Vec3(-m * slip * 2.0 / 7.0, 0, m * (v + rebound))).norm(), 0.0, 1e-13);
  // Coulomb, sliding: the tangential impulse is friction times the normal one.
  const Vec3 F = coulomb_impulse(e, {0.5, 0.1});
  EXPECT_NEAR((F - m * v * 1.5 * Vec3(-0.1, 0, 1)).norm(), 0.0, 1e-14);
}

// Pitfall of the paper's law (engine.md 4.3): a ball sliding at 6 m/s that touches down at .2 m/s
// hops, because F11 turns slip into rebound. A law that does not hop is not the paper's.
TEST(PaperImpulse, HopsWhenASlidingBallTouchesDown) {
  const double m = 7.0, r = 0.108;
  const Vec3 arm(0, 0, -r);
  const Encounter e{-Vec3::UnitZ(), Vec3(6.0, 0, -0.2),
                    inverse_mass_at(1 / m, Mat3::Identity() / (0.4 * m * r * r), arm)};
  const auto hop = [&](double elasticity, double friction) {
    return (e.u_W + e.K_W * paper_impulse(e, {elasticity, friction})).z();
  };
  const double k = std::sqrt(0.04 + 36.0 * 2.0 / 7.0);  // the rebound of F11
  EXPECT_NEAR(hop(1.0, 1.0), k, 0.01 * k);
  EXPECT_NEAR(hop(1.0, 1.0) * hop(1.0, 1.0) / 2 / 9.81, 0.529, 0.01 * 0.529);
  EXPECT_NEAR(hop(0.49, 0.49), 0.82, 0.01 * 0.82);
  EXPECT_NEAR(hop(1.0, 0.25), 0.75 * 0.2 + 0.25 * k, 0.001);
  EXPECT_NEAR(hop(0.5, 0.0), 0.1, 1e-15);
}

TEST(PaperImpulse, LeavesATangentialVelocityAloneWithoutFriction) {
  const Encounter e{Vec3::UnitX(), Vec3(2.0, 0.3, -0.7), 3.0 * Mat3::Identity()};
  const Vec3 after = e.u_W + e.K_W * paper_impulse(e, {0.49, 0.0});
  EXPECT_EQ(after.y(), 0.3);
  EXPECT_EQ(after.z(), -0.7);
}

// Two bodies that meet along the normal, whose masses lie beside it: the normal impulse begins a slip.
TEST(CoulombImpulse, OpposesTheSlipThatBeginsWhereThereIsNone) {
  Draw draw(11);
  int limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const Coefficients c{draw.uniform(0.0, 1.0), draw.uniform(0.01, 0.5)};
    Encounter e = draw.pair(10.0).encounter();
    const Vec3& N = e.n_AB_W;
    e.u_W = 2.5 * N;
    const Vec3 F = coulomb_impulse(e, c);
    const double Fn = -F.dot(N);
    const Vec3 Ft = F + Fn * N;
    const Vec3 begins = -(e.K_W * N - N.dot(e.K_W * N) * N);  // by an impulse against N on A
    ASSERT_GT(Fn, 0.0);
    EXPECT_LE(Ft.norm(), c.friction * Fn * (1.0 + 1e-9));
    EXPECT_LE((e.u_W + e.K_W * F).dot(N), 1e-9);
    if (Ft.norm() > (1.0 - 1e-12) * c.friction * Fn) {
      ++limited;
      EXPECT_NEAR(Ft.normalized().dot(begins.normalized()), -1.0, 1e-9);
    }
    // Neither a turn of the frame nor a slip that is rounding changes it.
    const Mat3 R = draw.turn().toRotationMatrix();
    const Encounter turned{R * N, R * e.u_W, R * e.K_W * R.transpose()};
    EXPECT_NEAR((R * F - coulomb_impulse(turned, c)).norm(), 0.0, 1e-9 * F.norm());
    Encounter rounded = e;
    rounded.u_W += 1e-15 * N.unitOrthogonal();
    EXPECT_NEAR((F - coulomb_impulse(rounded, c)).norm(), 0.0, 1e-9 * F.norm());
  }
  EXPECT_GT(limited, 500);
}

TEST(CoulombImpulse, UnderRules7HadNoFrictionThere) {
  Draw draw(12);
  const Response& old = response_under("coulomb", 7);
  int other = 0;
  for (int i = 0; i < 200; ++i) {
    const Coefficients c{0.5, 0.1};
    Encounter e = draw.pair(10.0).encounter();
    EXPECT_EQ(old.impulse(e, c), coulomb_impulse(e, c));  // they slip: to the bit
    e.u_W = 2.0 * Vec3::UnitZ();
    e.n_AB_W = Vec3::UnitZ();
    other += old.impulse(e, c) != coulomb_impulse(e, c) ? 1 : 0;
  }
  EXPECT_GT(other, 50);
  EXPECT_EQ(&response_under("coulomb", 8), &response_named("coulomb"));
  EXPECT_EQ(&response_under("paper", 1), &response_named("paper"));
}

TEST(PaperSliding, DecaysTheSameWhateverTheRate) {
  for (const double rate : {60.0, 240.0, 1000.0, 32000.0}) {
    const Sliding s = paper_sliding(0.49, 1.0 / rate, 1.0 / 60.0);
    EXPECT_NEAR(std::pow(s.kept, rate), std::pow(0.51, 60.0), 1e-10 * std::pow(0.51, 60.0));
  }
  EXPECT_EQ(paper_sliding(1.0, 0.004, 1.0 / 60.0).kept, 0.0);
  EXPECT_EQ(paper_sliding(0.0, 0.004, 1.0 / 60.0).kept, 1.0);
}

TEST(ResponseNamed, RefusesAnUnknownNameAndListsTheKnown) {
  EXPECT_EQ(response_named("paper").name, "paper");
  try {
    response_named("newton");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "response: expected one of paper, coulomb, found 'newton'");
  }
}

}  // namespace
}  // namespace headpin::engine
