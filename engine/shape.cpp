#include "engine/shape.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace headpin::engine {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("polyhedron: " + what);
}

std::string name(const char* what, std::size_t index) {
  return std::string(what) + " " + std::to_string(index);
}

// Twice the vector area: for a flat polygon twice its area times its unit normal.
Vec3 area_vector(std::span<const Vec3> vertices, std::span<const std::uint32_t> corners) {
  Vec3 sum = Vec3::Zero();
  const Vec3& p0 = vertices[corners[0]];
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    sum += (vertices[corners[k]] - p0).cross(vertices[corners[k + 1]] - p0);
  }
  return sum;
}

void check_vertices(const std::vector<Vec3>& vertices, double size) {
  const double apart = 1e-7 * size;
  std::vector<std::uint32_t> by_x(vertices.size());
  for (std::uint32_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t i, std::uint32_t j) {
    return vertices[i].x() != vertices[j].x() ? vertices[i].x() < vertices[j].x() : i < j;
  });
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    for (std::size_t j = i + 1; j < by_x.size(); ++j) {
      if (vertices[by_x[j]].x() - vertices[by_x[i]].x() > apart) break;
      if ((vertices[by_x[j]] - vertices[by_x[i]]).norm() <= apart) {
        refuse("vertices " + std::to_string(by_x[i]) + " and " + std::to_string(by_x[j]) +
               " are in one place");
      }
    }
  }
}

struct HalfEdge {
  std::uint32_t from, to, face;
};

/// Adds the edges of a face, which must be flat and turn to one side.
void add_half_edges(const std::vector<Vec3>& vertices, const Polyhedron::Face& face,
                    const std::vector<std::uint32_t>& c, std::uint32_t f, double slack,
                    std::vector<HalfEdge>& halves) {
  for (std::size_t k = 0; k < c.size(); ++k) {
    const std::uint32_t i = c[k], j = c[(k + 1) % c.size()];
    const Vec3& next = vertices[c[(k + 2) % c.size()]];
    if (i == j) refuse(name("face", f) + " names vertex " + std::to_string(i) + " twice");
    if (std::abs(face.normal.dot(vertices[i]) - face.offset) > slack) {
      refuse(name("face", f) + " is not flat: " + name("vertex", i) + " is " +
             std::to_string(face.normal.dot(vertices[i]) - face.offset) + " off its plane");
    }
    const Vec3 along = (vertices[j] - vertices[i]).normalized();
    if (along.cross(next - vertices[j]).dot(face.normal) < -slack) {
      refuse("not convex: " + name("face", f) + " turns inwards at " + name("vertex", j));
    }
    halves.push_back({i, j, f});
  }
}

// Every edge twice, once each way; returns each once, from < to.
std::vector<Polyhedron::Edge> pair_edges(std::vector<HalfEdge> halves) {
  const auto ends = [](const HalfEdge& e) { return std::minmax(e.from, e.to); };
  std::sort(halves.begin(), halves.end(), [&](const HalfEdge& a, const HalfEdge& b) {
    return ends(a) != ends(b) ? ends(a) < ends(b) : a.face < b.face;
  });
  std::vector<Polyhedron::Edge> edges;
  for (std::size_t i = 0; i < halves.size();) {
    std::size_t j = i;
    while (j < halves.size() && ends(halves[j]) == ends(halves[i])) ++j;
    const auto [from, to] = ends(halves[i]);
    const std::string edge = "edge " + std::to_string(from) + "-" + std::to_string(to);
    if (j - i != 2) {
      refuse("not closed: " + edge + " belongs to " + std::to_string(j - i) +
             " faces (first: " + std::to_string(halves[i].face) + "), expected 2");
    }
    if (halves[i].from == halves[i + 1].from) {
      refuse(edge + " runs the same way in faces " + std::to_string(halves[i].face) + " and " +
             std::to_string(halves[i + 1].face) + ": one of them is turned over");
    }
    edges.push_back({from, to});
    i = j;
  }
  return edges;
}

}  // namespace

Polyhedron::Polyhedron(std::vector<Vec3> vertices,
                       const std::vector<std::vector<std::uint32_t>>& faces)
    : vertices_(std::move(vertices)) {
  if (vertices_.size() < 4) {
    refuse(std::to_string(vertices_.size()) + " vertices, expected at least 4");
  }
  if (faces.size() < 4) refuse(std::to_string(faces.size()) + " faces, expected at least 4");
  Vec3 low = vertices_[0], high = vertices_[0];
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (!vertices_[i].allFinite()) refuse(name("vertex", i) + " is not finite");
    low = low.cwiseMin(vertices_[i]);
    high = high.cwiseMax(vertices_[i]);
  }
  const double size = (high - low).norm();
  const double slack = kTolerance * size;
  check_vertices(vertices_, size);
  std::vector<HalfEdge> halves;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    add_face(faces[f], size);
    add_half_edges(vertices_, faces_[f], faces[f], f, slack, halves);
  }
  edges_ = pair_edges(std::move(halves));
  check_convex(slack);
  find_neighbours();
  // One piece: V - E + F = 2 for each closed convex piece.
  if (vertices_.size() + faces_.size() != edges_.size() + 2) {
    refuse("not one closed surface: " + std::to_string(vertices_.size()) + " vertices - " +
           std::to_string(edges_.size()) + " edges + " + std::to_string(faces_.size()) +
           " faces, expected 2");
  }
  centre_ = centre_of_volume(size);
  find_starts();
}

void Polyhedron::add_face(const std::vector<std::uint32_t>& c, double size) {
  const std::size_t f = faces_.size();
  if (c.size() < 3) {
    refuse(name("face", f) + " has " + std::to_string(c.size()) + " corners, expected 3 or more");
  }
  for (const std::uint32_t i : c) {
    if (i >= vertices_.size()) {
      refuse(name("face", f) + " names vertex " + std::to_string(i) + " of " +
             std::to_string(vertices_.size()));
    }
  }
  const Vec3 area = area_vector(vertices_, c);
  if (!(area.norm() > 1e-12 * size * size)) refuse(name("face", f) + " has no area");
  Face face{static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(c.size()),
            area.normalized(), 0.0};
  for (const std::uint32_t i : c) {
    face.offset += face.normal.dot(vertices_[i]) / static_cast<double>(c.size());
  }
  face.along = (vertices_[c[1]] - vertices_[c[0]]).normalized();
  corners_.insert(corners_.end(), c.begin(), c.end());
  faces_.push_back(face);
}

void Polyhedron::check_convex(double slack) const {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const double outside = faces_[f].normal.dot(vertices_[i]) - faces_[f].offset;
      if (outside > slack) {
        refuse("not convex, or turned inside out: " + name("vertex", i) + " is " +
               std::to_string(outside) + " outside " + name("face", f));
      }
    }
  }
}

void Polyhedron::find_neighbours() {
  first_neighbour_.assign(vertices_.size() + 1, 0);
  for (const Edge& e : edges_) {
    ++first_neighbour_[e.from + 1];
    ++first_neighbour_[e.to + 1];
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (first_neighbour_[i + 1] < 3) {
      refuse(name("vertex", i) + " has " + std::to_string(first_neighbour_[i + 1]) +
             " edges, expected at least 3");
    }
    first_neighbour_[i + 1] += first_neighbour_[i];
  }
  neighbours_.resize(2 * edges_.size());
  std::vector<std::uint32_t> fill(first_neighbour_.begin(), first_neighbour_.end() - 1);
  for (const Edge& e : edges_) {
    neighbours_[fill[e.from]++] = e.to;
    neighbours_[fill[e.to]++] = e.from;
  }
  faces_at_.resize(neighbours_.size());
  fill.assign(first_neighbour_.begin(), first_neighbour_.end() - 1);
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    for (const std::uint32_t i : corners(faces_[f])) {
      if (fill[i] == first_neighbour_[i + 1]) {
        refuse(name("vertex", i) + " has more faces than edges");
      }
      faces_at_[fill[i]++] = f;
    }
  }
}

Vec3 Polyhedron::centre_of_volume(double size) const {
  double volume6 = 0.0;
  const Vec3 p0 = vertices_[0];
  Vec3 moment = Vec3::Zero();
  for (const Face& face : faces_) {
    const auto c = corners(face);
    const Vec3 a = vertices_[c[0]] - p0;
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      const Vec3 u = vertices_[c[k]] - p0, v = vertices_[c[k + 1]] - p0;
      const double six = a.dot(u.cross(v));
      volume6 += six;
      moment += six * 0.25 * (a + u + v);
    }
  }
  if (!(volume6 > 1e-9 * size * size * size)) refuse("has no volume");
  return p0 + moment / volume6;
}

void Polyhedron::find_starts() {
  start_.assign(64, 0);
  const std::array<double, 3> weight = {0.22, 0.5, 0.84};
  for (std::uint32_t k = 0; k < 8; ++k) {
    for (const auto& order : std::array<std::array<std::size_t, 3>, 6>{
             {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}}) {
      const Vec3 n((k & 1 ? -1.0 : 1.0) * weight[order[0]], (k & 2 ? -1.0 : 1.0) * weight[order[1]],
                   (k & 4 ? -1.0 : 1.0) * weight[order[2]]);
      std::uint32_t best = 0;
      for (std::uint32_t i = 1; i < vertices_.size(); ++i) {
        if (n.dot(vertices_[i]) > n.dot(vertices_[best])) best = i;
      }
      start_[cell(n)] = best;
    }
  }
}

Vec3 support(const Shape& shape, const Vec3& n) {
  return std::visit(
      [&](const auto& s) -> Vec3 {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, HalfSpace>) {
          throw std::invalid_argument("support: a half-space has no furthest point");
        } else {
          return support(s, n);
        }
      },
      shape);
}

double bounding_radius(const Ellipsoid& s) {
  return s.radii.maxCoeff();
}

double bounding_radius(const Cylinder& s) {
  return std::sqrt(s.radius * s.radius + s.half_height * s.half_height);
}

double bounding_radius(const Cone& s) {
  return std::sqrt(s.radius * s.radius + 0.25 * s.height * s.height);
}

double bounding_radius(const Polyhedron& s) {
  double r2 = 0.0;
  for (const Vec3& v : s.vertices()) r2 = std::max(r2, v.squaredNorm());
  return std::sqrt(r2);
}

double bounding_radius(const HalfSpace&) {
  return std::numeric_limits<double>::infinity();
}

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& s) { return bounding_radius(s); }, shape);
}

bool contains(const Polyhedron& s, const Vec3& p, double tolerance) {
  return std::all_of(s.faces().begin(), s.faces().end(), [&](const Polyhedron::Face& f) {
    return f.normal.dot(p) - f.offset <= tolerance;
  });
}

double clearance(const Polyhedron& s, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polyhedron::Face& f : s.faces()) least = std::min(least, f.offset - f.normal.dot(p));
  return least;
}

bool contains(const HalfSpace&, const Vec3& p, double tolerance) {
  return p.z() <= tolerance;
}

bool contains(const Shape& shape, const Vec3& p, double tolerance) {
  return std::visit([&](const auto& s) { return contains(s, p, tolerance); }, shape);
}

namespace {

void check_length(const char* what, double value) {
  if (!(std::isfinite(value) && value > 0.0)) {
    throw std::invalid_argument(std::string(what) + ": " + std::to_string(value) +
                                " m, expected finite and above 0");
  }
}

}  // namespace

void check(const Ellipsoid& s) {
  for (int i = 0; i < 3; ++i) check_length("ellipsoid radius", s.radii[i]);
}

void check(const Cylinder& s) {
  check_length("cylinder radius", s.radius);
  check_length("cylinder half height", s.half_height);
}

void check(const Cone& s) {
  check_length("cone radius", s.radius);
  check_length("cone height", s.height);
}

void check(const Shape& shape) {
  std::visit([](const auto& s) { check(s); }, shape);
}

std::string kind(const Shape& shape) {
  return std::visit([](const auto& s) { return kind(s); }, shape);
}

}  // namespace headpin::engine
