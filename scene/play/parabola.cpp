#include "scene/play/parabola.h"

#include <cstddef>

namespace headpin::scene {

Parabola fit_parabola(std::span<const double> x, std::span<const Vec3> y, int terms) {
  Mat3 normal = Mat3::Identity();  // of 1, x, x^2; the identity where a term is left out
  normal.topLeftCorner(terms, terms).setZero();
  Mat3 right = Mat3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3 powers(1.0, x[i], x[i] * x[i]);
    powers.tail(3 - terms).setZero();
    normal.topLeftCorner(terms, terms) += (powers * powers.transpose()).topLeftCorner(terms, terms);
    right += powers * y[i].transpose();
  }
  const Mat3 inverse = normal.inverse();
  return {inverse * right, inverse};
}

}  // namespace headpin::scene
