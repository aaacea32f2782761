#include "engine/gjk.h"

#include <limits>

namespace headpin::engine {
namespace {

/// The point of a simplex nearest to the origin: its corners and their barycentric weights.
struct Nearest {
  int corner[4] = {0, 0, 0, 0};
  double weight[4] = {0.0, 0.0, 0.0, 0.0};
  int count = 0;
  double distance2 = std::numeric_limits<double>::infinity();
};

Nearest of_point(const Vec3* w, int i) {
  return {{i}, {1.0}, 1, w[i].squaredNorm()};
}

Nearest of_segment(const Vec3* w, int i, int j) {
  const Vec3 d = w[j] - w[i];
  const double t = -w[i].dot(d), length2 = d.squaredNorm();
  if (!(t > 0.0)) return of_point(w, i);
  if (t >= length2) return of_point(w, j);
  const double s = t / length2;
  return {{i, j}, {1.0 - s, s}, 2, (w[i] + s * d).squaredNorm()};
}

Nearest nearer(const Nearest& a, const Nearest& b) {
  return b.distance2 < a.distance2 ? b : a;
}

Nearest of_triangle(const Vec3* w, int i, int j, int k) {
  const Vec3 n = (w[j] - w[i]).cross(w[k] - w[i]);
  const double n2 = n.squaredNorm();
  // Twice the areas that the projected origin spans with the edges, times |n|.
  const double wi = n.dot(w[j].cross(w[k]));
  const double wj = n.dot(w[k].cross(w[i]));
  const double wk = n.dot(w[i].cross(w[j]));
  if (n2 > 0.0 && wi > 0.0 && wj > 0.0 && wk > 0.0) {
    const double sum = wi + wj + wk;
    const double li = wi / sum, lj = wj / sum, lk = wk / sum;
    return {{i, j, k}, {li, lj, lk}, 3, (li * w[i] + lj * w[j] + lk * w[k]).squaredNorm()};
  }
  return nearer(nearer(of_segment(w, i, j), of_segment(w, j, k)), of_segment(w, i, k));
}

double volume(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot(b.cross(c));
}

Nearest of_tetrahedron(const Vec3* w) {
  // Barycentric weights of the origin: volumes it spans with the faces.
  const double v0 = volume(w[1], w[2], w[3]), v1 = -volume(w[0], w[2], w[3]);
  const double v2 = volume(w[0], w[1], w[3]), v3 = -volume(w[0], w[1], w[2]);
  const double sum = v0 + v1 + v2 + v3;
  // For four points of one face of A - B, rounding decides the signs of the volumes. Then all faces
  // are examined.
  const double edges =
      (w[1] - w[0]).squaredNorm() * (w[2] - w[0]).squaredNorm() * (w[3] - w[0]).squaredNorm();
  const bool flat = sum * sum <= 1e-20 * edges;
  const double sign = sum < 0.0 ? -1.0 : 1.0;
  if (!flat && sign * v0 > 0.0 && sign * v1 > 0.0 && sign * v2 > 0.0 && sign * v3 > 0.0) {
    return {{0, 1, 2, 3}, {v0 / sum, v1 / sum, v2 / sum, v3 / sum}, 4, 0.0};
  }
  // The nearest point lies on a face that has the origin on its outer side.
  Nearest best;
  if (flat || sign * v0 <= 0.0) best = of_triangle(w, 1, 2, 3);
  if (flat || sign * v1 <= 0.0) best = nearer(best, of_triangle(w, 0, 2, 3));
  if (flat || sign * v2 <= 0.0) best = nearer(best, of_triangle(w, 0, 1, 3));
  if (flat || sign * v3 <= 0.0) best = nearer(best, of_triangle(w, 0, 1, 2));
  return best;
}

}  // namespace

Vec3 Simplex::reduce(const Vec3& from) {
  Vec3 x[4];
  for (int i = 0; i < count; ++i) x[i] = w[i] - from;
  const Nearest nearest = count == 1   ? of_point(x, 0)
                          : count == 2 ? of_segment(x, 0, 1)
                          : count == 3 ? of_triangle(x, 0, 1, 2)
                                       : of_tetrahedron(x);
  count = nearest.count;
  Vec3 v = Vec3::Zero();
  for (int i = 0; i < count; ++i) {  // corners ascend, so nothing is overwritten before it is read
    const int k = nearest.corner[i];
    w[i] = w[k];
    a[i] = a[k];
    b[i] = b[k];
    weight[i] = nearest.weight[i];
    v += weight[i] * x[k];
  }
  return v;
}

}  // namespace headpin::engine
