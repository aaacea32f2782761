#include "devices/recordings/table_rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "devices/recordings/reading.h"

namespace headpin::devices {
namespace {

/// Rotations about three axes in an order: capitals about the axes that turn with the body, small
/// letters about fixed ones, as SciPy has them.
Quat of_angles(const Vec3& angles, std::string_view order) {
  Quat q = Quat::Identity();
  for (const char letter : order) {
    const bool fixed = letter >= 'x';
    const auto axis = static_cast<Eigen::Index>(letter - (fixed ? 'x' : 'X'));
    const Quat turn = rotation(angles[axis] * Vec3::Unit(axis));
    q = fixed ? turn * q : q * turn;
  }
  return q.normalized();
}

}  // namespace

template <std::size_t N>
std::optional<std::array<double, N>> RotationReader::numbers(
    const AnyTable::Row& row, const std::array<std::optional<std::size_t>, N>& columns) const {
  std::array<double, N> all{};
  for (std::size_t i = 0; i < N; ++i) {
    const std::optional<double> number = table_.number(row.cells[*columns[i]]);
    if (!number) return std::nullopt;
    all[i] = *number;
  }
  return all;
}

std::optional<Quat> RotationReader::operator()(const AnyTable::Row& row,
                                               std::string_view quaternion) const {
  constexpr double kDegree = std::numbers::pi / 180.0;
  switch (part_.rotation) {
    case RotationKind::none:
      return Quat::Identity();
    case RotationKind::quaternion:
      return of_quaternion(row, quaternion);
    case RotationKind::matrix:
      return of_matrix(row);
    case RotationKind::angles:
    case RotationKind::vector:
      break;
  }
  const auto angles = numbers<3>(row, part_.angles);
  if (!angles) return std::nullopt;
  const Vec3 a = (degrees_ ? kDegree : 1.0) * Vec3((*angles)[0], (*angles)[1], (*angles)[2]);
  if (!(a.norm() < 1e4)) return std::nullopt;
  return part_.rotation == RotationKind::vector ? rotation(a) : of_angles(a, order_);
}

std::optional<Quat> RotationReader::of_quaternion(const AnyTable::Row& row,
                                                  std::string_view letters) const {
  std::array<std::optional<std::size_t>, 4> columns = part_.quaternion;
  std::ranges::sort(columns);  // as they stand in the file
  const auto four = numbers<4>(row, columns);
  if (!four) return std::nullopt;
  const Quat q = quaternion_of(*four, letters);
  if (!(std::abs(q.norm() - 1.0) < 1e-3)) return std::nullopt;
  return q;
}

std::optional<Quat> RotationReader::of_matrix(const AnyTable::Row& row) const {
  const auto nine = numbers<9>(row, part_.matrix);
  if (!nine) return std::nullopt;
  Mat3 R;
  for (std::size_t i = 0; i < 9; ++i)
    R(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = (*nine)[i];
  if (!((R * R.transpose() - Mat3::Identity()).norm() < 1e-2) || R.determinant() < 0.0)
    return std::nullopt;
  return Quat(R).normalized();
}

/// The letters of a quaternion's columns in the order in which they stand in the file.
std::string order_of(const PartColumns& part) {
  std::array<std::pair<std::size_t, char>, 4> letters{};
  for (std::size_t i = 0; i < 4; ++i) letters[i] = {*part.quaternion[i], "wxyz"[i]};
  std::ranges::sort(letters);
  return {letters[0].second, letters[1].second, letters[2].second, letters[3].second};
}

}  // namespace headpin::devices
