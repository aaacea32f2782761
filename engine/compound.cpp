#include "engine/compound.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "engine/moments.h"
#include "engine/non_colliding.h"
#include "engine/rods.h"

namespace headpin::engine {
namespace {

constexpr double kPi = std::numbers::pi;

bool is_half_space(const Part& part) {
  return std::holds_alternative<HalfSpace>(part.shape);
}

bool on_axis(const Pose& X_BG, const Vec3& axis, double size) {
  return (X_BG.p - X_BG.p.dot(axis) * axis).norm() <= 1e-12 * size;
}

/// Whether a shape that is round about its own z is round about `axis`.
bool turned(double size, const Pose& X_BG, const Vec3& axis) {
  return on_axis(X_BG, axis, size) && std::abs((X_BG.q * Vec3::UnitZ()).dot(axis)) > 1.0 - 1e-12;
}

bool revolves(const Ellipsoid& e, const Pose& X_BG, const Vec3& axis) {
  if (!on_axis(X_BG, axis, e.radii.maxCoeff())) return false;
  const Vec3 along = (X_BG.q.conjugate() * axis).cwiseAbs();
  for (int i = 0; i < 3; ++i) {
    const double r1 = e.radii[(i + 1) % 3], r2 = e.radii[(i + 2) % 3];
    if (r1 == r2 && (along[i] > 1.0 - 1e-12 || r1 == e.radii[i])) return true;
  }
  return false;
}

bool revolves(const Cylinder& c, const Pose& X_BG, const Vec3& axis) {
  return turned(bounding_radius(c), X_BG, axis);
}

bool revolves(const Cone& c, const Pose& X_BG, const Vec3& axis) {
  return turned(bounding_radius(c), X_BG, axis);
}

bool revolves(const Polyhedron&, const Pose&, const Vec3&) {
  return false;
}

bool revolves(const HalfSpace&, const Pose&, const Vec3&) {
  return false;
}

/// Whether the part is a body of revolution about the line through the origin along unit `axis`.
bool revolves(const Part& part, const Vec3& axis) {
  return std::visit([&](const auto& s) { return revolves(s, part.X_BG, axis); }, part.shape);
}

/// Extent of a part along an axis and across it.
struct Outline {
  double low, high;          // along the axis
  double radius;             // largest distance from the axis
  double low_rim, high_rim;  // radius of the discs at both ends
  bool round;                // an ellipsoid on the axis
};

/// Sets the ends of a body of revolution: rims of its largest radius, an apex, or round ends.
void set_ends(Outline& o, const Ellipsoid&, bool) {
  o.round = true;
}

void set_ends(Outline& o, const Cone&, bool up) {
  (up ? o.low_rim : o.high_rim) = o.radius;
}

template <typename Other>
void set_ends(Outline& o, const Other&, bool) {
  o.low_rim = o.high_rim = o.radius;
}

Outline outline(const Part& part, const Vec3& axis) {
  Outline o{-top(part, -axis), top(part, axis), 0.0, 0.0, 0.0, false};
  if (revolves(part, axis)) {
    const Vec3 across = axis.unitOrthogonal();
    o.radius = top(part, across);
    const bool up = (part.X_BG.q * Vec3::UnitZ()).dot(axis) > 0.0;
    std::visit([&](const auto& shape) { set_ends(o, shape, up); }, part.shape);
    return o;
  }
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  const double x = std::max(top(part, u), top(part, -u));
  const double y = std::max(top(part, v), top(part, -v));
  o.radius =
      std::min(std::sqrt(x * x + y * y),
               (part.X_BG.p - part.X_BG.p.dot(axis) * axis).norm() + bounding_radius(part.shape));
  o.low_rim = o.high_rim = o.radius;
  return o;
}

Capsule capsule_along(const std::vector<Part>& parts, const Vec3& axis) {
  double radius = 0.0;
  for (const Part& part : parts) radius = std::max(radius, outline(part, axis).radius);
  // The ball at each end of the segment must contain the end of every part. That is the rim of a
  // disc, or the pole of an ellipsoid with at most the radius of the ball. The ball touches this
  // pole from outside.
  double low = kPi, high = -kPi;
  bool first = true;
  for (const Part& part : parts) {
    const Outline o = outline(part, axis);
    const double middle = 0.5 * (o.low + o.high);
    const auto back = [&](double rim) {
      return std::sqrt(std::max(0.0, radius * radius - rim * rim));
    };
    const double upper =
        o.round ? std::max(middle, o.high - radius) : std::max(o.high - back(o.high_rim), o.low);
    const double lower =
        o.round ? std::min(middle, o.low + radius) : std::min(o.low + back(o.low_rim), o.high);
    high = first ? upper : std::max(high, upper);
    low = first ? lower : std::min(low, lower);
    first = false;
  }
  return {low * axis, high * axis, radius};
}

double volume(const Capsule& c) {
  return kPi * c.radius * c.radius * ((c.b - c.a).norm() + 4.0 / 3.0 * c.radius);
}

bool holds(const Capsule& c, const std::vector<Part>& parts, const Vec3& axis) {
  for (const Part& part : parts) {
    const Outline o = outline(part, axis);
    const auto inside = [&](double z, double rim) {
      const double a = c.a.dot(axis), b = c.b.dot(axis);
      const double d = z < a ? a - z : z > b ? z - b : 0.0;
      return d * d + rim * rim <= c.radius * c.radius * (1.0 + 1e-12);
    };
    if (!inside(o.low, o.low_rim) || !inside(o.high, o.high_rim)) return false;
    if (o.round && !inside(0.5 * (o.low + o.high), o.radius)) return false;
  }
  return true;
}

Box box_of(const Polyhedron& polyhedron, const Pose& X_BG) {
  const double far = std::numeric_limits<double>::infinity();
  Box box{Vec3::Constant(far), Vec3::Constant(-far)};
  for (const Vec3& vertex : polyhedron.vertices()) {
    const Vec3 p_B = X_BG * vertex;
    box.low = box.low.cwiseMin(p_B);
    box.high = box.high.cwiseMax(p_B);
  }
  return box;
}

/// Sets the boxes of a compound of polyhedra.
void set_boxes(Compound& c) {
  for (const Part& part : c.parts) {
    c.part_box.push_back(box_of(std::get<Polyhedron>(part.shape), part.X_BG));
  }
  c.box = c.part_box.front();
  for (const Box& box : c.part_box) {
    c.box.low = c.box.low.cwiseMin(box.low);
    c.box.high = c.box.high.cwiseMax(box.high);
  }
}

}  // namespace

Box operator*(const Pose& X_WB, const Box& box) {
  const Vec3 middle = X_WB * Vec3(0.5 * (box.low + box.high));
  const Vec3 half = X_WB.q.toRotationMatrix().cwiseAbs() * Vec3(0.5 * (box.high - box.low));
  return {middle - half, middle + half};
}

Compound make_compound(std::vector<Part> parts) {
  if (parts.empty()) throw std::invalid_argument("compound: no parts");
  Compound c;
  c.parts = std::move(parts);
  bool unbounded = false;
  for (const Part& part : c.parts) {
    check(part.shape);
    if (!part.X_BG.p.allFinite() || !(std::abs(part.X_BG.q.norm() - 1.0) < 1e-9)) {
      throw std::invalid_argument("compound: pose of a " + kind(part.shape) +
                                  " is not finite or its quaternion not unit");
    }
    c.part_radius.push_back(bounding_radius(part.shape));
    c.part_turned.push_back(!part.X_BG.q.vec().isZero(0.0));
    c.bounding_radius = std::max(c.bounding_radius, part.X_BG.p.norm() + c.part_radius.back());
    unbounded = unbounded || is_half_space(part);
  }
  c.faceted = std::all_of(c.parts.begin(), c.parts.end(), [](const Part& part) {
    return std::holds_alternative<Polyhedron>(part.shape);
  });
  if (c.faceted) set_boxes(c);
  if (unbounded) return c;
  c.bounds = {Vec3::Zero(), Vec3::Zero(), c.bounding_radius};
  for (const Vec3& axis : {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
    const Capsule along = capsule_along(c.parts, axis);
    if (holds(along, c.parts, axis) && volume(along) < volume(c.bounds)) c.bounds = along;
  }
  return c;
}

namespace {

Moments moments(const Shape& shape) {
  return std::visit([](const auto& s) { return moments(s); }, shape);
}

bool overlap(const Part& a, const Part& b) {
  KeptNormal n;
  return !closest_points(a.shape, b.shape, a.X_BG.inverse() * b.X_BG, n, {}).separated;
}

// Radius of a body of revolution about z at a height above its middle, zero outside it.

double radius_at(const Ellipsoid&, const Part& part, double height) {
  const double c = top(part, Vec3::UnitZ()) - part.X_BG.p.z();
  const double r = top(part, Vec3::UnitX());
  return std::abs(height) < c ? r * std::sqrt(1.0 - height * height / (c * c)) : 0.0;
}

double radius_at(const Cylinder& c, const Part&, double height) {
  return std::abs(height) < c.half_height ? c.radius : 0.0;
}

double radius_at(const Cone& c, const Part& part, double height) {
  const double up = (part.X_BG.q * Vec3::UnitZ()).z() > 0.0 ? height : -height;
  return std::abs(up) < 0.5 * c.height ? c.radius * (0.5 - up / c.height) : 0.0;
}

double radius_at(const Polyhedron&, const Part&, double) {
  throw std::logic_error("radius of a polyhedron, which is no body of revolution");
}

double radius_at(const HalfSpace&, const Part&, double) {
  throw std::logic_error("radius of a half-space, which is no body of revolution");
}

double radius_at(const Part& part, double z) {
  return std::visit([&](const auto& s) { return radius_at(s, part, z - part.X_BG.p.z()); },
                    part.shape);
}

// Slices between the heights where a part begins or ends. The radius is taken at the middle of each
// slice, so that no slice is cut at such a height.
Moments stacked_discs(const std::vector<Part>& parts) {
  std::vector<double> cuts;
  for (const Part& part : parts) {
    cuts.push_back(top(part, Vec3::UnitZ()));
    cuts.push_back(-top(part, -Vec3::UnitZ()));
  }
  std::sort(cuts.begin(), cuts.end());
  const double slices = 20000.0 / (cuts.back() - cuts.front());
  Moments m;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double length = cuts[i + 1] - cuts[i];
    const int count = 1 + static_cast<int>(slices * length);
    const double dz = length / count;
    for (int k = 0; k < count; ++k) {
      const double z = cuts[i] + (k + 0.5) * dz;
      double r = 0.0;
      for (const Part& part : parts) r = std::max(r, radius_at(part, z));
      const double slice = kPi * r * r * dz;
      m.volume += slice;
      m.first.z() += slice * z;
      m.second += (slice * Vec3(r * r / 4.0, r * r / 4.0, z * z + dz * dz / 12.0)).asDiagonal();
    }
  }
  return m;
}

}  // namespace

MassProperties mass_properties(const Shape& shape, double density) {
  return weigh(moments(shape), density);
}

MassProperties mass_properties(const Compound& compound, double density, Overlaps overlaps,
                               Rods rods) {
  const std::vector<Part>& parts = compound.parts;
  if (std::any_of(parts.begin(), parts.end(), is_half_space)) moments(HalfSpace{});
  bool any = false;
  for (std::size_t i = 0; i < parts.size() && overlaps == Overlaps::maybe; ++i) {
    for (std::size_t j = i + 1; j < parts.size() && !any; ++j) any = overlap(parts[i], parts[j]);
  }
  if (any) {
    return weigh(is_revolution(compound) ? stacked_discs(parts) : bundled_rods(parts, rods),
                 density);
  }
  Moments m;
  for (const Part& part : parts) m.add(moments(part.shape), part.X_BG);
  return weigh(m, density);
}

bool is_revolution(const Compound& compound) {
  return std::all_of(compound.parts.begin(), compound.parts.end(),
                     [](const Part& part) { return revolves(part, Vec3::UnitZ()); });
}

namespace {

/// Principal axes, in the order and with the signs of the smallest rotation from the identity.
Mat3 principal_axes(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  const Mat3& v = solver.eigenvectors();
  Mat3 best = Mat3::Identity();
  double least = -4.0;
  for (const auto& order : std::array<std::array<int, 3>, 6>{
           {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}}) {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 m;
      for (int i = 0; i < 3; ++i) {
        m.col(i) = (signs >> i & 1 ? -1.0 : 1.0) * v.col(order[static_cast<std::size_t>(i)]);
      }
      if (m.determinant() > 0.0 && m.trace() > least) {
        least = m.trace();
        best = m;
      }
    }
  }
  return best;
}

}  // namespace

Centred about_centre(const Compound& compound, const MassProperties& mass) {
  Centred c;
  c.revolution = is_revolution(compound);
  c.X_BC.p = mass.centre;
  const Mat3& I = mass.inertia;
  const double off_diagonal = std::max({std::abs(I(0, 1)), std::abs(I(0, 2)), std::abs(I(1, 2))});
  if (!c.revolution && off_diagonal > 1e-9 * I.trace()) {
    c.X_BC.q = Quat(principal_axes(I)).normalized();
  }
  const Mat3 R = c.X_BC.q.toRotationMatrix();
  c.inertia = (R.transpose() * I * R).diagonal();
  if (c.revolution) {
    c.X_BC.p.x() = c.X_BC.p.y() = 0.0;
    c.inertia.x() = c.inertia.y() = 0.5 * (c.inertia.x() + c.inertia.y());
  }
  c.mass = mass.mass;
  std::vector<Part> parts = compound.parts;
  const Pose X_CB = c.X_BC.inverse();
  for (Part& part : parts) part.X_BG = X_CB * part.X_BG;
  c.compound = make_compound(std::move(parts));
  return c;
}

}  // namespace headpin::engine
