#include "base/math.h"

namespace headpin {

SinCos sin_cos(double angle) {
  // Reduce to [-pi/4, pi/4] by a multiple of pi/2 in three parts (Cody and Waite), then Taylor.
  constexpr double kTwoOverPi = 0.63661977236758134308;
  constexpr double kPio2a = 1.57079632673412561417e+00;  // 33 bits of pi/2
  constexpr double kPio2b = 6.07710050630396597660e-11;  // the next 33
  constexpr double kPio2c = 2.02226624879595063154e-21;
  const double n = std::floor(angle * kTwoOverPi + 0.5);
  const double x = ((angle - n * kPio2a) - n * kPio2b) - n * kPio2c;
  const double z = x * x;
  const double s =
      x +
      x * z *
          (-1.0 / 6 +
           z * (1.0 / 120 +
                z * (-1.0 / 5040 + z * (1.0 / 362880 + z * (-1.0 / 39916800 +
                                                            z * (1.0 / 6227020800.0 +
                                                                 z * (-1.0 / 1307674368000.0)))))));
  const double c =
      1.0 +
      z * (-0.5 + z * (1.0 / 24 +
                       z * (-1.0 / 720 +
                            z * (1.0 / 40320 + z * (-1.0 / 3628800 +
                                                    z * (1.0 / 479001600.0 +
                                                         z * (-1.0 / 87178291200.0 +
                                                              z * (1.0 / 20922789888000.0))))))));
  const bool counts = std::abs(n) < 0x1p62;  // else n is not usable, and s and c are meaningless
  switch (counts ? static_cast<std::int64_t>(n) & 3 : 0) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double exponential(double x) {
  // x = n ln 2 + r with |r| <= ln 2 / 2, then Taylor by Horner.
  constexpr double kLn2a = 6.93147180369123816490e-01;  // 33 bits of ln 2
  constexpr double kLn2b = 1.90821492927058770002e-10;
  if (x > 709.0) return HUGE_VAL;
  if (x < -745.0) return 0.0;
  const double n = std::floor(x / (kLn2a + kLn2b) + 0.5);
  const double r = (x - n * kLn2a) - n * kLn2b;
  double sum = 1.0;
  for (int k = 14; k > 0; --k) sum = 1.0 + sum * r / k;
  return std::ldexp(sum, static_cast<int>(n));
}

double logarithm(double x) {
  // x = m 2^n with m around 1, then log m = 2 atanh((m - 1) / (m + 1)) by its series.
  constexpr double kLn2a = 6.93147180369123816490e-01;
  constexpr double kLn2b = 1.90821492927058770002e-10;
  int n = 0;
  double m = std::frexp(x, &n);
  if (m < 0.70710678118654752440) {
    m *= 2.0;
    --n;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double sum = 0.0;
  for (int k = 23; k > 1; k -= 2) sum = (sum + 1.0 / k) * z;
  return n * kLn2a + (2.0 * s * (1.0 + sum) + n * kLn2b);
}

double power(double base, double exponent) {
  if (exponent == 0.0) return 1.0;
  if (base == 0.0) return 0.0;
  return exponential(exponent * logarithm(base));
}

HalfAngle half_of_large_angle(double square) {
  const double angle = std::sqrt(square);
  const SinCos half = sin_cos(0.5 * angle);
  return {half.cos, half.sin / angle};
}

Vec3 rotation_vector(const Quat& q_AB) {
  const double sign = q_AB.w() < 0.0 ? -1.0 : 1.0;
  const Vec3 v = sign * q_AB.vec();
  const double sine = v.norm(), cosine = sign * q_AB.w();  // of half the angle
  if (sine < 1e-12) return 2.0 * v;
  // Three halvings bring the tangent below 0.2; then the series of the arc tangent.
  double t = sine / (1.0 + cosine);
  t = t / (1.0 + std::sqrt(1.0 + t * t));
  t = t / (1.0 + std::sqrt(1.0 + t * t));
  const double z = t * t;
  double arc = 0.0;
  for (int k = 23; k >= 1; k -= 2) arc = 1.0 / k - z * arc;
  return 16.0 * t * arc / sine * v;
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
  const double sign = a.q.dot(b.q) < 0.0 ? -1.0 : 1.0;
  Quat q;
  q.coeffs() = (1.0 - s) * a.q.coeffs() + s * sign * b.q.coeffs();
  q.normalize();
  return {q, (1.0 - s) * a.p + s * b.p};
}

}  // namespace headpin
