#include "engine/rods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace headpin::engine {
namespace {

struct Interval {
  double low, high;  // empty when low > high
};

void keep_below(Interval& t, double offset, double slope) {  // offset + slope t <= 0
  if (slope > 0.0) {
    t.high = std::min(t.high, -offset / slope);
  } else if (slope < 0.0) {
    t.low = std::max(t.low, -offset / slope);
  } else if (offset > 0.0) {
    t = {1.0, 0.0};
  }
}

void keep_quadratic(Interval& t, double a, double b, double c) {  // a t^2 + 2 b t + c <= 0, a >= 0
  if (a < 1e-15) return keep_below(t, c, 2.0 * b);
  const double root = b * b - a * c;
  if (root < 0.0) {
    t = {1.0, 0.0};
    return;
  }
  t.low = std::max(t.low, (-b - std::sqrt(root)) / a);
  t.high = std::min(t.high, (-b + std::sqrt(root)) / a);
}

// The part of an interval t of the line p + t d that lies inside a shape.

Interval inside(const Ellipsoid& e, const Vec3& p, const Vec3& d, Interval t) {
  const Vec3 u = d.cwiseQuotient(e.radii), v = p.cwiseQuotient(e.radii);
  keep_quadratic(t, u.dot(u), u.dot(v), v.dot(v) - 1.0);
  return t;
}

Interval inside(const Cylinder& c, const Vec3& p, const Vec3& d, Interval t) {
  keep_quadratic(t, d.x() * d.x() + d.y() * d.y(), d.x() * p.x() + d.y() * p.y(),
                 p.x() * p.x() + p.y() * p.y() - c.radius * c.radius);
  keep_below(t, p.z() - c.half_height, d.z());
  keep_below(t, -p.z() - c.half_height, -d.z());
  return t;
}

Interval inside(const Polyhedron& h, const Vec3& p, const Vec3& d, Interval t) {
  for (const Polyhedron::Face& f : h.faces()) {
    keep_below(t, f.normal.dot(p) - f.offset, f.normal.dot(d));
  }
  return t;
}

/// Inside: rho <= (h/2 - z) r / h. Both sides are squared; the limits of z exclude the other nappe.
Interval inside(const Cone& k, const Vec3& p, const Vec3& d, Interval t) {
  const double slope = k.radius / k.height, z = p.z() - 0.5 * k.height;
  const double a = d.x() * d.x() + d.y() * d.y() - slope * slope * d.z() * d.z();
  const double b = d.x() * p.x() + d.y() * p.y() - slope * slope * d.z() * z;
  const double c = p.x() * p.x() + p.y() * p.y() - slope * slope * z * z;
  keep_below(t, z, d.z());
  keep_below(t, -z - k.height, -d.z());
  if (a >= 1e-15) {
    keep_quadratic(t, a, b, c);
  } else if (a > -1e-15) {
    keep_below(t, c, 2.0 * b);
  } else {  // steep line: outside the roots it is inside the double cone; take the lower nappe
    const double root = std::sqrt(std::max(0.0, b * b - a * c));
    const double t1 = (-b + root) / a, t2 = (-b - root) / a;  // t1 <= t2
    if (d.z() > 0.0) {
      t.high = std::min(t.high, t1);
    } else {
      t.low = std::max(t.low, t2);
    }
  }
  return t;
}

Interval inside(const HalfSpace&, const Vec3& p, const Vec3& d, Interval t) {
  keep_below(t, p.z(), d.z());
  return t;
}

Interval inside(const Shape& shape, const Vec3& p, const Vec3& d, Interval t) {
  return std::visit([&](const auto& s) { return inside(s, p, d, t); }, shape);
}

/// A part of some of the lines of a grid.
struct Placed {
  const Part* part = nullptr;
  Pose X_GB;
  double low = 0.0, high = 0.0;  // of all of it along x, or of its section along y
};

/// A line of the grid, at a coordinate, stands for this width. `spread` is 12 times the mean square distance of
/// what it stands for.
struct Line {
  double at, width, spread;
};

/// Adds the rod at x, y: its pieces inside the union of the parts.
void add_rod(Moments& m, const Line& x, const Line& y, std::span<const Placed> parts,
             const Interval& z, std::vector<Interval>& pieces) {
  const Vec3 p(x.at, y.at, 0.0);
  pieces.clear();
  for (const Placed& placed : parts) {
    const Pose& X_GB = placed.X_GB;
    const Interval t = inside(placed.part->shape, X_GB * p, X_GB.q * Vec3::UnitZ(), z);
    if (t.low < t.high) pieces.push_back(t);
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const Interval& a, const Interval& b) { return a.low < b.low; });
  double done = z.low;
  for (const Interval& t : pieces) {
    const double a = std::max(t.low, done), b = t.high;
    if (b <= a) continue;
    done = b;
    const double volume = x.width * y.width * (b - a);
    const Vec3 middle(p.x(), p.y(), 0.5 * (a + b));
    m.volume += volume;
    m.first += volume * middle;
    m.second += volume * middle * middle.transpose();
    m.second.diagonal() += volume / 12.0 * Vec3(x.spread, y.spread, (b - a) * (b - a));
  }
}

std::vector<Line> even_lines(double low, double high) {
  constexpr int kLines = 600;
  const double d = (high - low) / kLines;
  std::vector<Line> lines;
  for (int i = 0; i < kLines; ++i) lines.push_back({low + (i + 0.5) * d, d, d * d});
  return lines;
}

/// Two lines in each of the cells between cuts, where they integrate cubics exactly (Gauss, Legendre).
///
/// @param size  of the whole compound [m]
std::vector<Line> lines_between(std::vector<double>& cuts, double size) {
  constexpr double kCells = 400.0;  // of the whole, and as many again that all gaps share
  constexpr int kFinest = 60;       // of such a share
  std::sort(cuts.begin(), cuts.end());
  const auto same = [&](double a, double b) { return b - a < 1e-9 * size; };
  cuts.erase(std::unique(cuts.begin(), cuts.end(), same), cuts.end());
  if (cuts.size() < 2) return {};
  const int least =
      std::clamp(static_cast<int>(kCells / static_cast<double>(cuts.size())), 1, kFinest);
  std::vector<Line> lines;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double length = cuts[i + 1] - cuts[i];
    // Rounding must not part the counts of gaps that mirror each other, which may be round numbers.
    const int count = std::max(least, static_cast<int>(kCells * length / size + 0.6180339887));
    const double d = length / count, aside = 0.5 * d / std::numbers::sqrt3;
    for (int k = 0; k < count; ++k) {
      const double middle = cuts[i] + (k + 0.5) * d;
      lines.push_back({middle - aside, 0.5 * d, 0.0});
      lines.push_back({middle + aside, 0.5 * d, 0.0});
    }
  }
  return lines;
}

/// The edge of a flat end: all points centre + along cos(t) + across sin(t); across.x() is 0.
struct Rim {
  Vec3 centre = Vec3::Zero(), along = Vec3::Zero(), across = Vec3::Zero();
};

Rim rim(const Pose& X_BG, double height, double radius) {
  const Vec3 axis = X_BG.q * Vec3::UnitZ();
  const Vec3 across = axis.cross(Vec3::UnitX());
  Rim r{X_BG * Vec3(0.0, 0.0, height)};
  if (across.norm() < 1e-9) return r;  // the end is at one x, where a cut is
  r.across = radius * across.normalized();
  r.along = axis.cross(r.across);
  return r;
}

std::vector<Rim> rims(const Part& part) {
  if (const auto* c = std::get_if<Cylinder>(&part.shape)) {
    return {rim(part.X_BG, -c->half_height, c->radius), rim(part.X_BG, c->half_height, c->radius)};
  }
  if (const auto* c = std::get_if<Cone>(&part.shape)) {
    return {rim(part.X_BG, -0.5 * c->height, c->radius)};
  }
  return {};
}

/// Appends where the area of the part's section across x begins, bends or ends.
void cut_x(const Part& part, std::vector<double>& cuts) {
  cuts.push_back(top(part, Vec3::UnitX()));
  cuts.push_back(-top(part, -Vec3::UnitX()));
  for (const Rim& r : rims(part)) {
    cuts.push_back(r.centre.x() - r.along.x());
    cuts.push_back(r.centre.x() + r.along.x());
  }
  if (const auto* h = std::get_if<Polyhedron>(&part.shape)) {
    for (const Vec3& vertex : h->vertices()) cuts.push_back((part.X_BG * vertex).x());
  }
}

/// How far the part's section at x reaches along y, times `sign`: the least height of a tangent plane along z
/// there. By golden sections over the turn of the plane.
double section_top(const Part& part, double x, double sign) {
  const auto height = [&](double turn) {
    const double c = std::cos(turn), s = std::sin(turn);
    return (top(part, Vec3(s, sign * c, 0.0)) - s * x) / c;
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = -0.5 * std::numbers::pi, high = -low;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = height(a), at_b = height(b);
  for (int i = 0; i < 60; ++i) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = height(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = height(b);
    }
  }
  return std::min(at_a, at_b);
}

/// Appends where the part's section at x begins, bends or ends along y.
void cut_y(const Part& part, double x, std::vector<double>& cuts) {
  if (const auto* h = std::get_if<Polyhedron>(&part.shape)) {
    for (const Polyhedron::Edge& edge : h->edges()) {
      const Vec3 a = part.X_BG * h->vertices()[edge.from], b = part.X_BG * h->vertices()[edge.to];
      if ((a.x() < x) == (b.x() < x)) continue;
      cuts.push_back(a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
    }
    return;
  }
  cuts.push_back(section_top(part, x, 1.0));
  cuts.push_back(-section_top(part, x, -1.0));
  for (const Rim& r : rims(part)) {
    const double c = (x - r.centre.x()) / r.along.x();
    if (!(std::abs(c) < 1.0)) continue;
    const double s = std::sqrt(1.0 - c * c);
    for (const double sine : {-s, s}) {
      cuts.push_back(r.centre.y() + c * r.along.y() + sine * r.across.y());
    }
  }
}

/// Adds the section at x, cut into rods anew: the outlines of its parts are others at each x.
void add_section(Moments& m, const Line& x, const std::vector<Placed>& parts, double size,
                 const Interval& z) {
  std::vector<Placed> met, along;
  std::vector<double> cuts, own;
  for (const Placed& placed : parts) {
    if (x.at <= placed.low || x.at >= placed.high) continue;
    own.clear();
    cut_y(*placed.part, x.at, own);
    if (own.empty()) continue;
    const auto ends = std::minmax_element(own.begin(), own.end());
    met.push_back({placed.part, placed.X_GB, *ends.first, *ends.second});
    cuts.insert(cuts.end(), own.begin(), own.end());
  }
  std::vector<Interval> pieces;
  for (const Line& y : lines_between(cuts, size)) {
    along.clear();
    for (const Placed& placed : met) {
      if (y.at > placed.low && y.at < placed.high) along.push_back(placed);
    }
    add_rod(m, x, y, along, z, pieces);
  }
}

}  // namespace

Moments bundled_rods(const std::vector<Part>& parts, Rods rods) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  std::vector<Placed> placed;
  std::vector<double> cuts;
  for (const Part& part : parts) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], -top(part, -Vec3::Unit(i)));
      high[i] = std::max(high[i], top(part, Vec3::Unit(i)));
    }
    placed.push_back(
        {&part, part.X_BG.inverse(), -top(part, -Vec3::UnitX()), top(part, Vec3::UnitX())});
    cut_x(part, cuts);
  }
  const Interval z{low.z(), high.z()};
  Moments m;
  if (rods == Rods::even) {
    std::vector<Interval> pieces;
    const std::vector<Line> along_y = even_lines(low.y(), high.y());
    for (const Line& x : even_lines(low.x(), high.x())) {
      for (const Line& y : along_y) add_rod(m, x, y, placed, z, pieces);
    }
    return m;
  }
  const double size = (high - low).head<2>().maxCoeff();
  for (const Line& x : lines_between(cuts, high.x() - low.x())) {
    add_section(m, x, placed, size, z);
  }
  return m;
}

}  // namespace headpin::engine
