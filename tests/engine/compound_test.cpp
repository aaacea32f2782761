#include "engine/compound.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

constexpr double kInch = 0.0254;

// Height above the base and diameter of a ten pin, inches (reference page "bowling").
constexpr double kProfile[][2] = {{0, 2.031},      {0.75, 2.828},  {2.25, 3.906},   {3.375, 4.510},
                                  {4.5, 4.766},    {5.875, 4.563}, {7.25, 3.703},   {8.625, 2.472},
                                  {9.375, 1.965},  {10, 1.797},    {10.875, 1.870}, {11.75, 2.094},
                                  {12.625, 2.406}, {13.5, 2.547}};

double profile_radius(double z) {
  const double h = z / kInch;
  if (h >= 13.5) {  // the dome: a ball of radius 1.273 in whose top is at 15 in
    const double d = h - (15.0 - 1.273);
    return kInch * std::sqrt(std::max(0.0, 1.273 * 1.273 - d * d));
  }
  // A smooth curve through the table: cubics whose slope at a row is that of its two neighbours.
  std::size_t i = 0;
  while (kProfile[i + 1][0] < h) ++i;
  const auto slope = [](std::size_t k) {
    const std::size_t low = k == 0 ? 0 : k - 1, high = std::min(k + 1, std::size(kProfile) - 1);
    return (kProfile[high][1] - kProfile[low][1]) / (kProfile[high][0] - kProfile[low][0]);
  };
  const double dh = kProfile[i + 1][0] - kProfile[i][0], s = (h - kProfile[i][0]) / dh;
  const double d = (1 + 2 * s) * (1 - s) * (1 - s) * kProfile[i][1] +
                   s * s * (3 - 2 * s) * kProfile[i + 1][1] +
                   s * (1 - s) * (1 - s) * dh * slope(i) - s * s * (1 - s) * dh * slope(i + 1);
  return 0.5 * kInch * d;
}

// A pin as a pile of discs that overlap their neighbours, with a core that is all overlap.
Compound pin() {
  std::vector<Part> parts;
  constexpr int kDiscs = 300;
  const double height = 15.0 * kInch, step = height / kDiscs;
  for (int i = 0; i < kDiscs; ++i) {
    const double z = (i + 0.5) * step;
    parts.push_back({Cylinder{profile_radius(z), 0.5 * step}, {Quat::Identity(), {0, 0, z}}});
  }
  parts.push_back({Cylinder{0.02, 0.15}, {Quat::Identity(), {0, 0, 0.19}}});
  parts.push_back({Ellipsoid{{0.04, 0.04, 0.08}}, {Quat::Identity(), {0, 0, 0.115}}});
  parts.push_back({Cone{0.03, 0.2}, {Quat::Identity(), {0, 0, 0.15}}});
  return make_compound(parts);
}

TEST(Pin, WeighsWhatTheTableOfMeasuresSays) {
  const Compound c = pin();
  ASSERT_TRUE(is_revolution(c));
  const double volume = mass_properties(c, 1.0).mass;
  EXPECT_NEAR(volume, 2.105e-3, 0.01 * 2.105e-3);
  const MassProperties m = mass_properties(c, 1.588 / volume);
  EXPECT_NEAR(m.mass, 1.588, 1e-9);
  EXPECT_NEAR(m.centre.z(), 0.1474, 0.01 * 0.1474);
  EXPECT_NEAR(m.inertia(2, 2), 1.97e-3, 0.01 * 1.97e-3);
  EXPECT_NEAR(m.inertia(0, 0), 1.344e-2, 0.01 * 1.344e-2);
}

// Halves of a box that touch are summed in closed form where they are known not to overlap.
TEST(MassProperties, OfPartsThatTouchAreExact) {
  const auto block = [](double low, double high) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
      corners.emplace_back(i & 1 ? 0.05 : -0.05, i & 2 ? 0.05 : -0.05, i & 4 ? high : low);
    }
    return Part{
        Polyhedron(
            corners,
            {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}),
        {}};
  };
  const Compound two = make_compound({block(0.0, 0.1), block(0.1, 0.3)});
  const MassProperties m = mass_properties(two, 500.0, Overlaps::none);
  EXPECT_NEAR(m.mass, 1.5, 1e-12);
  EXPECT_LT((m.centre - Vec3(0, 0, 0.15)).norm(), 1e-12);
  EXPECT_NEAR(m.inertia(2, 2), 1.5 * (0.01 + 0.01) / 12.0, 1e-12);
  EXPECT_NEAR(m.inertia(0, 0), 1.5 * (0.01 + 0.09) / 12.0, 1e-12);
}

// A cylinder cut in two overlapping lengths weighs what the whole one does, however it is posed.
TEST(Overlap, CountsOnce) {
  const double density = 700.0;
  const MassProperties whole = mass_properties(Cylinder{0.1, 0.3}, density);
  const Part low{Cylinder{0.1, 0.2}, {Quat::Identity(), {0, 0, -0.1}}};
  const Part high{Cylinder{0.1, 0.2}, {Quat::Identity(), {0, 0, 0.1}}};
  const MassProperties two = mass_properties(make_compound({low, high}), density);
  EXPECT_NEAR(two.mass, whole.mass, 1e-9 * whole.mass);
  EXPECT_LT((two.inertia - whole.inertia).norm(), 1e-6 * whole.inertia.norm());
  EXPECT_LT((two.centre - whole.centre).norm(), 1e-12);

  const Pose X{Quat(0.6, 0.2, -0.3, 0.7).normalized(), {0.3, -0.2, 0.1}};
  const MassProperties tilted = mass_properties(
      make_compound({{low.shape, X * low.X_BG}, {high.shape, X * high.X_BG}}), density);
  const Mat3 R = X.q.toRotationMatrix();
  EXPECT_NEAR(tilted.mass, whole.mass, 1e-3 * whole.mass);
  EXPECT_LT((tilted.centre - X * whole.centre).norm(), 1e-3 * 0.3);
  EXPECT_LT((tilted.inertia - R * whole.inertia * R.transpose()).norm(),
            1e-3 * whole.inertia.norm());
}

// Counting random points of a box is slow and certain.
TEST(MassProperties, AgreeWithCountedPoints) {
  Random random(5);
  std::vector<Compound> compounds;
  for (const test::ShapeKind k : test::kShapeKinds) {
    compounds.push_back(
        make_compound({{random_shape(random, k), {any_rotation(random), {0.1, 0, 0.2}}}}));
  }
  compounds.push_back(
      make_compound({{Cone{0.4, 0.9}, {any_rotation(random), {0.2, 0.1, 0}}},
                     {Ellipsoid{{0.3, 0.5, 0.2}}, {any_rotation(random), {0, 0, 0.3}}},
                     {test::box({0.4, 0.2, 0.1}), {any_rotation(random), {0, 0.2, 0}}}}));
  for (const Compound& c : compounds) {
    const MassProperties m = mass_properties(c, 1.0);
    const int n = 400000;
    const double r = c.bounding_radius;
    double hits = 0.0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    for (int i = 0; i < n; ++i) {
      const Vec3 p{random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r)};
      bool in = false;
      for (const Part& part : c.parts) in = in || contains(part.shape, part.X_BG.inverse() * p);
      if (!in) continue;
      hits += 1.0;
      first += p;
      second += (p - m.centre) * (p - m.centre).transpose();
    }
    const double each = 8.0 * r * r * r / n;
    const Mat3 inertia = each * (second.trace() * Mat3::Identity() - second);
    // Four standard errors of a count of some 1e5 are 1.3 percent.
    EXPECT_NEAR(m.mass, each * hits, 0.013 * m.mass) << kind(c.parts[0].shape);
    EXPECT_LT((m.centre - first / hits).norm(), 0.01 * r) << kind(c.parts[0].shape);
    EXPECT_LT((m.inertia - inertia).norm(), 0.03 * m.inertia.norm()) << kind(c.parts[0].shape);
  }
}

TEST(MassProperties, OfPartsThatDoNotOverlapAreExact) {
  const double r = 0.1, apart = 0.3, density = 700.0;
  const Compound c =
      make_compound({{Ellipsoid{Vec3::Constant(r)}, {Quat::Identity(), {-apart, 0, 0}}},
                     {Ellipsoid{Vec3::Constant(r)}, {Quat::Identity(), {apart, 0, 0}}}});
  const MassProperties m = mass_properties(c, density);
  const double ball = density * 4.0 / 3.0 * std::numbers::pi * r * r * r;
  EXPECT_NEAR(m.mass, 2.0 * ball, 1e-12 * ball);
  EXPECT_NEAR(m.inertia(0, 0), 2.0 * 0.4 * ball * r * r, 1e-12 * ball);
  EXPECT_NEAR(m.inertia(1, 1), 2.0 * ball * (0.4 * r * r + apart * apart), 1e-12 * ball);
}

// The same cone twice is one cone. It lies beside the axis, so that it is cut into rods along its own.
TEST(MassProperties, OfACutIntoRodsAreThoseOfTheWhole) {
  for (const Quat& q : {Quat::Identity(), Quat(0.0, 1.0, 0.0, 0.0)}) {
    const Part cone{Cone{0.2, 0.5}, {q, {0.3, 0, 0}}};
    const MassProperties one = mass_properties(make_compound({cone}), 1.0);
    const MassProperties twice = mass_properties(make_compound({cone, cone}), 1.0);
    EXPECT_NEAR(one.mass, std::numbers::pi * 0.04 * 0.5 / 3.0, 1e-12);
    EXPECT_NEAR(twice.mass, one.mass, 1e-3 * one.mass);
    EXPECT_LT((twice.centre - one.centre).norm(), 1e-3);
  }
}

TEST(MakeCompound, RefusesAPartThatCannotBe) {
  const auto refused = [](const Shape& shape) {
    try {
      make_compound({{Ellipsoid{Vec3::Ones()}, {}}, {shape, {}}});
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(Cylinder{0.1, 0.2}));
  EXPECT_TRUE(refused(Cylinder{-0.1, 0.2}));
  EXPECT_TRUE(refused(Ellipsoid{{0.1, 0.0, 0.1}}));
}

// A box whose edges are along the axes needs no other axes.
TEST(AboutCentre, LeavesAxesAloneThatArePrincipalOnes) {
  for (const Vec3& half : {Vec3(0.1, 0.2, 0.3), Vec3(0.3, 0.2, 0.1), Vec3(0.2, 0.3, 0.1)}) {
    const Compound c = make_compound({{test::box(half), {}}});
    EXPECT_EQ(about_centre(c, mass_properties(c, 500.0)).X_BC.q.coeffs(),
              Quat::Identity().coeffs());
  }
}

TEST(AboutCentre, HasItsCentreOfMassAtTheOriginAndAxesAlongThePrincipalOnes) {
  Random random(6);
  const Pose X{any_rotation(random), {0.3, -0.4, 0.5}};
  const Compound c = make_compound({{test::box({0.1, 0.3, 0.2}), X}});
  const Centred centred = about_centre(c, mass_properties(c, 500.0));
  const MassProperties m = mass_properties(centred.compound, 500.0);
  EXPECT_LT(m.centre.norm(), 1e-12);
  EXPECT_NEAR(m.mass, 500.0 * 8 * 0.1 * 0.3 * 0.2, 1e-9);
  EXPECT_LT((m.inertia - Mat3(centred.inertia.asDiagonal())).norm(), 1e-9 * m.inertia.norm());
  EXPECT_FALSE(centred.revolution);
}

TEST(AboutCentre, LeavesTheAxisOfABodyOfRevolutionAlone) {
  const Compound c = pin();
  const Centred centred = about_centre(c, mass_properties(c, 754.0));
  EXPECT_TRUE(centred.revolution);
  EXPECT_EQ(centred.X_BC.q.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(centred.inertia.x(), centred.inertia.y());
  EXPECT_NEAR(centred.inertia.x(), mass_properties(centred.compound, 754.0).inertia(0, 0), 1e-9);
  EXPECT_LT(std::abs(mass_properties(centred.compound, 754.0).centre.z()), 1e-9);
}

TEST(Bounds, HoldEveryPart) {
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    std::vector<Part> parts;
    const bool coaxial = i % 2 == 0;
    for (int k = 0; k < 3; ++k) {
      Shape shape =
          random_shape(random, static_cast<test::ShapeKind>(index_below(random, coaxial ? 3 : 4)));
      if (auto* e = std::get_if<Ellipsoid>(&shape); e && coaxial) e->radii.y() = e->radii.x();
      const Vec3 p(0.0, 0.0, random.uniform(-1.0, 1.0));
      const Pose upside_down{Quat(0.0, 1.0, 0.0, 0.0), p};
      parts.push_back({shape, coaxial ? (k == 1 ? upside_down : Pose{Quat::Identity(), p})
                                      : Pose{any_rotation(random), p + 0.3 * direction(random)}});
    }
    const Compound c = make_compound(parts);
    const Vec3 axis = c.bounds.b - c.bounds.a;
    for (int j = 0; j < 500; ++j) {
      const Vec3 n = direction(random);
      for (const Part& part : c.parts) {
        const Vec3 p = part.X_BG * support(part.shape, part.X_BG.q.conjugate() * n);
        EXPECT_LE(p.norm(), c.bounding_radius * (1.0 + 1e-12));
        const double t = axis.squaredNorm() > 0.0
                             ? std::clamp((p - c.bounds.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0)
                             : 0.0;
        EXPECT_LE((p - c.bounds.a - t * axis).norm(), c.bounds.radius * (1.0 + 1e-9));
      }
    }
  }
}

/// Two crossed bars of one length and a square section.
Compound plus(double length, double width, const Quat& q = Quat::Identity()) {
  const double a = 0.5 * length, b = 0.5 * width;
  return make_compound(
      {{test::box({a, b, b}), {q, Vec3::Zero()}}, {test::box({b, a, b}), {q, Vec3::Zero()}}});
}

double plus_volume(double length, double width) {
  return width * width * (2.0 * length - width);
}

/// About z, of density 1: two bars less what they share.
double plus_moment(double length, double width) {
  const double w2 = width * width;
  return w2 * (2.0 * length * (length * length + w2) - width * 2.0 * w2) / 12.0;
}

TEST(MassProperties, OfThinBarsAreExact) {
  for (const double width : {0.011, 0.012, 0.05}) {
    const MassProperties m = mass_properties(plus(2.0, width), 1.0);
    const double volume = plus_volume(2.0, width), moment = plus_moment(2.0, width);
    EXPECT_NEAR(m.mass, volume, 1e-9 * volume);
    EXPECT_NEAR(m.inertia(2, 2), moment, 1e-9 * moment);
    EXPECT_LT(m.centre.norm(), 1e-9);
  }
}

TEST(MassProperties, OfThinBarsThatAreTurnedAreGood) {
  for (const double turn : {1e-4, 0.01, 0.3, 0.25 * std::numbers::pi}) {
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, 3)}) {
      const Quat q(Eigen::AngleAxisd(turn, axis.normalized()));
      const MassProperties m = mass_properties(plus(2.0, 0.011, q), 1.0);
      const Mat3 turned_back = q.toRotationMatrix().transpose() * m.inertia * q.toRotationMatrix();
      const double volume = plus_volume(2.0, 0.011), moment = plus_moment(2.0, 0.011);
      EXPECT_NEAR(m.mass, volume, 1e-3 * volume) << turn;
      EXPECT_NEAR(turned_back(2, 2), moment, 1e-3 * moment) << turn;
      EXPECT_LT(m.centre.norm(), 1e-9) << turn;
    }
  }
}

TEST(MassProperties, OfAFrameOfThinBarsAreExact) {
  for (const double width : {0.002, 0.004, 0.008}) {
    const double a = 0.25, b = 0.5 * width, hole = 2.0 * (a - width);
    std::vector<Part> parts;
    for (const double side : {b - a, a - b}) {
      parts.push_back({test::box({a, b, b}), {Quat::Identity(), {0, side, 0}}});
      parts.push_back({test::box({b, a, b}), {Quat::Identity(), {side, 0, 0}}});
    }
    const double volume = (4.0 * a * a - hole * hole) * width;
    EXPECT_NEAR(mass_properties(make_compound(parts), 1.0).mass, volume, 1e-9 * volume);
  }
}

// The same part twice is one.
TEST(MassProperties, OfThinRoundPartsAreGood) {
  const double r = 0.002, h = 0.5;
  for (const double turn : {0.0, 0.02, 0.7, 0.5 * std::numbers::pi}) {
    for (const Vec3& axis : {Vec3(0, 1, 0), Vec3(1, 0, 0)}) {
      const Pose X{Quat(Eigen::AngleAxisd(turn, axis)), {0.1, 0, 0}};
      const Part rod{Cylinder{r, h}, X}, coin{Cylinder{h, r}, X};
      for (const Part& part : {rod, coin}) {
        const double volume = mass_properties(part.shape, 1.0).mass;
        const MassProperties twice = mass_properties(make_compound({part, part}), 1.0);
        EXPECT_NEAR(twice.mass, volume, 1e-3 * volume) << turn;
        EXPECT_LT((twice.centre - X.p).norm(), 1e-9) << turn;
      }
    }
  }
}

// What trials under rules 1 to 13 weigh: the numbers of that time, which were wrong.
TEST(MassProperties, ByEvenRodsAreThoseOfOlderTrials) {
  const MassProperties thin = mass_properties(plus(2.0, 0.011), 1.0, Overlaps::maybe, Rods::even);
  EXPECT_DOUBLE_EQ(thin.mass, 0.0005847111111111036);
  EXPECT_DOUBLE_EQ(thin.inertia(2, 2), 0.00019556418897119821);
  const MassProperties thick = mass_properties(plus(2.0, 0.05), 1.0, Overlaps::maybe, Rods::even);
  EXPECT_DOUBLE_EQ(thick.mass, 0.009875000000002306);
  EXPECT_DOUBLE_EQ(thick.inertia(2, 2), 0.0033353782964124874);
  EXPECT_DOUBLE_EQ(thick.centre.x(), -0.0008227848101215922);
}

// Upright on the axis z, up to 1e-12 of their size.
TEST(IsRevolution, HoldsForRoundPartsUprightOnTheAxis) {
  const auto is = [](const Shape& shape, const Pose& X_BG = {}) {
    return is_revolution(make_compound({{shape, X_BG}}));
  };
  const auto turned = [](double angle, const Vec3& axis) {
    return Pose{Quat(Eigen::AngleAxisd(angle, axis)), {0, 0, 0.5}};
  };
  for (const double r : {0x1p-10, 1.0, 0x1p10}) {
    for (const Shape& shape :
         {Shape(Cylinder{r, r}), Shape(Cone{r, 2.0 * r}), Shape(Ellipsoid{{r, r, 2.0 * r}})}) {
      const double size = bounding_radius(shape);
      EXPECT_TRUE(is(shape, {Quat::Identity(), {0, 0.9e-12 * size, 3.0}})) << r;
      EXPECT_FALSE(is(shape, {Quat::Identity(), {1.1e-12 * size, 0, 3.0}})) << r;
      EXPECT_FALSE(is(shape, {Quat::Identity(), {0.1 * r, 0, 0}})) << r;
      EXPECT_TRUE(is(shape, turned(std::numbers::pi, Vec3::UnitX())));
      EXPECT_TRUE(is(shape, turned(1.0, Vec3::UnitZ())));
      EXPECT_FALSE(is(shape, turned(0.01, Vec3::UnitX())));
    }
  }
  const Pose z_along_x = turned(0.5 * std::numbers::pi, Vec3::UnitY());
  const Pose z_along_y = turned(0.5 * std::numbers::pi, Vec3::UnitX());
  EXPECT_TRUE(is(Ellipsoid{{2, 2, 2}}, turned(1.0, Vec3(1, 2, 3).normalized())));
  for (const Pose& X : {Pose{}, z_along_x, z_along_y}) EXPECT_FALSE(is(Ellipsoid{{1, 2, 3}}, X));
  EXPECT_FALSE(is(Ellipsoid{{3, 1, 1}}));
  EXPECT_TRUE(is(Ellipsoid{{3, 1, 1}}, z_along_x));
  EXPECT_FALSE(is(Ellipsoid{{1, 3, 1}}));
  EXPECT_TRUE(is(Ellipsoid{{1, 3, 1}}, z_along_y));
  EXPECT_FALSE(is(test::box({1, 1, 2})));
  EXPECT_FALSE(is(HalfSpace{}));
}

void expect_bounds(const std::vector<Part>& parts, const Vec3& a, const Vec3& b, double radius) {
  const Capsule bounds = make_compound(parts).bounds;
  EXPECT_NEAR(bounds.radius, radius, 1e-12);
  EXPECT_LT((bounds.a - a).norm(), 1e-12) << bounds.a.transpose();
  EXPECT_LT((bounds.b - b).norm(), 1e-12) << bounds.b.transpose();
}

// A ball at each end that goes through the rim there, or touches the pole or the apex.
TEST(Bounds, OfALongBodyTouchBothOfItsEnds) {
  const auto upright = [](double z) { return Pose{Quat::Identity(), {0, 0, z}}; };
  const Quat upside_down(0.0, 1.0, 0.0, 0.0);
  const Quat z_along_x(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()));
  for (const double r : {0.1, 10.0}) {
    expect_bounds({{Cylinder{r, 5.0 * r}, {}}}, {0, 0, -5.0 * r}, {0, 0, 5.0 * r}, r);
  }
  expect_bounds({{Cylinder{0.1, 1.0}, upright(10)}}, {0, 0, 9}, {0, 0, 11}, 0.1);
  expect_bounds({{Cylinder{0.1, 1.0}, upright(-10)}}, {0, 0, -11}, {0, 0, -9}, 0.1);
  expect_bounds({{Cylinder{0.1, 1.0}, {z_along_x, {10, 0, 0}}}}, {9, 0, 0}, {11, 0, 0}, 0.1);
  expect_bounds({{Cone{0.1, 2.0}, upright(5)}}, {0, 0, 4}, {0, 0, 5.9}, 0.1);
  expect_bounds({{Cone{0.1, 2.0}, {upside_down, {0, 0, 5}}}}, {0, 0, 4.1}, {0, 0, 6}, 0.1);
  expect_bounds({{Ellipsoid{{0.1, 0.1, 1.0}}, upright(5)}}, {0, 0, 4.1}, {0, 0, 5.9}, 0.1);
  expect_bounds({{Ellipsoid{{0.3, 0.3, 0.1}}, upright(5)}}, {0, 0, 5}, {0, 0, 5}, 0.3);
  // A thinner length on top or below: a rim of 0.3 m in a ball of 0.5 m is 0.4 m from its middle.
  const Part thick{Cylinder{0.5, 1.0}, {}};
  expect_bounds({thick, {Cylinder{0.3, 1.0}, upright(2)}}, {0, 0, -1}, {0, 0, 2.6}, 0.5);
  expect_bounds({thick, {Cylinder{0.3, 1.0}, upright(-2)}}, {0, 0, -2.6}, {0, 0, 1}, 0.5);
}

// A capsule of length 2 q r holds pi r^3 (2 q + 4/3), the sphere around the same cylinder 4/3 pi r^3 (1 + q^2)^1.5: it
// is smaller while q < 0.84.
TEST(Bounds, OfACylinderAreTheSphereOrTheCapsuleOfLessVolume) {
  for (const double r : {0.05, 0.5, 10.0}) {
    for (const double q : {0.01, 0.1, 0.3, 0.8}) {
      expect_bounds({{Cylinder{r, q * r}, {}}}, Vec3::Zero(), Vec3::Zero(),
                    r * std::sqrt(1.0 + q * q));
    }
    for (const double q : {0.9, 1.0, 3.0, 30.0}) {
      expect_bounds({{Cylinder{r, q * r}, {}}}, {0, 0, -q * r}, {0, 0, q * r}, r);
    }
  }
}

// A ball beside the origin: along x and along y the capsules have one volume.
TEST(Bounds, AreAlongTheFirstOfTwoAxesThatAreAsGood) {
  const double r = 0.125, radius = 1.0 + r;
  expect_bounds({{Ellipsoid{{r, r, r}}, {Quat::Identity(), {1, 1, 0}}}}, {1.0 - r, 0, 0},
                {radius, 0, 0}, radius);
}

TEST(MakeCompound, RefusesAPoseThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const Pose& X_BG) { return make_compound({{Cylinder{0.1, 0.2}, X_BG}}); };
  EXPECT_NO_THROW(make({Quat(0.6, 0.8, 0.0, 0.0), {1, 2, 3}}));
  EXPECT_THROW(make({Quat::Identity(), {0, nan, 0}}), std::invalid_argument);
  EXPECT_THROW(make({Quat(1.0, 1e-4, 0.0, 0.0), Vec3::Zero()}), std::invalid_argument);
  EXPECT_THROW(make({Quat(nan, 0.0, 0.0, 0.0), Vec3::Zero()}), std::invalid_argument);
}

// The same part twice is one. Discs are exact for a cylinder; the documented error is 1e-6.
TEST(MassProperties, OfPartsCutIntoDiscsAreThoseOfTheWholeAtEverySize) {
  const Quat upside_down(0.0, 1.0, 0.0, 0.0);
  for (const double s : {0.01, 1.0, 20.0}) {
    for (const Shape& shape : {Shape(Cylinder{0.2 * s, 0.7 * s}), Shape(Cone{0.2 * s, 0.5 * s}),
                               Shape(Ellipsoid{{0.2 * s, 0.2 * s, 0.7 * s}})}) {
      for (const Quat& q : {Quat::Identity(), upside_down}) {
        const Part part{shape, {q, {0, 0, 0.3 * s}}};
        const MassProperties one = mass_properties(make_compound({part}), 700.0);
        const MassProperties two = mass_properties(make_compound({part, part}), 700.0);
        const double error = std::holds_alternative<Cylinder>(shape) ? 1e-11 : 1e-6;
        EXPECT_NEAR(two.mass, one.mass, error * one.mass) << kind(shape) << s;
        EXPECT_LT((two.centre - one.centre).norm(), error * s) << kind(shape) << s;
        EXPECT_LT((two.inertia - one.inertia).norm(), error * one.inertia.norm())
            << kind(shape) << s;
      }
    }
  }
}

/// Cosine of half the angle by which a rotation turns.
double half_turn(const Mat3& R) {
  return std::abs(Quat(R).w());
}

// The axes of a box, named and signed in 24 ways that are rotations.
TEST(AboutCentre, TurnsABoxByTheLeastAngleThatMakesItsAxesPrincipal) {
  Random random(15);
  std::vector<Mat3> ways;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (const double si : {-1.0, 1.0}) {
        for (const double sj : {-1.0, 1.0}) {
          if (i == j) continue;
          const Vec3 x = si * Vec3::Unit(i), y = sj * Vec3::Unit(j);
          ways.push_back((Mat3() << x, y, x.cross(y)).finished());
        }
      }
    }
  }
  ASSERT_EQ(ways.size(), 24u);
  for (int k = 0; k < 50; ++k) {
    const Quat q = any_rotation(random);
    const Compound c = make_compound({{test::box({0.003, 0.005, 0.009}), {q, Vec3::Zero()}}});
    const Centred centred = about_centre(c, mass_properties(c, 500.0));
    const Mat3 R = centred.X_BC.q.toRotationMatrix();
    double best = 0.0;
    for (const Mat3& way : ways) best = std::max(best, half_turn(q.toRotationMatrix() * way));
    EXPECT_NEAR(half_turn(R), best, 1e-9);
    const Mat3 inertia = mass_properties(centred.compound, 500.0).inertia;
    EXPECT_LT((inertia - Mat3(centred.inertia.asDiagonal())).norm(), 1e-9 * inertia.norm());
  }
}

}  // namespace
}  // namespace headpin::engine
