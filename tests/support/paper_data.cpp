#include "tests/support/paper_data.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/support/random_shapes.h"

namespace headpin::engine::test {
namespace {

constexpr double kPi = std::numbers::pi;

using Faces = std::vector<std::vector<std::uint32_t>>;

std::uint32_t index(int i) {
  return static_cast<std::uint32_t>(i);
}

/// Part of an object: a primitive and where it sits.
struct Piece {
  Shape shape;
  Vec3 at;
};

std::vector<std::vector<Piece>> objects() {
  const std::vector<Piece> skittle = {
      {Cylinder{0.04, 0.05}, {0.0, 0.0, -0.10}},
      {Ellipsoid{{0.06, 0.06, 0.11}}, {0.0, 0.0, 0.0}},
      {Cone{0.04, 0.16}, {0.0, 0.0, 0.14}},
  };
  const std::vector<Piece> hand = {
      {Ellipsoid{{0.05, 0.09, 0.03}}, {0.0, 0.0, 0.0}},
      {Cylinder{0.012, 0.05}, {0.03, 0.08, 0.0}},
      {Cylinder{0.012, 0.05}, {-0.03, 0.08, 0.0}},
      {Cone{0.02, 0.09}, {0.06, 0.0, 0.02}},
  };
  std::vector<std::vector<Piece>> all(6, skittle);
  all.push_back(hand);
  return all;
}

}  // namespace

Polyhedron prism(const Cylinder& s, int sides) {
  std::vector<Vec3> v;
  Faces faces(2);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    v.emplace_back(s.radius * std::cos(angle), s.radius * std::sin(angle), -s.half_height);
    v.emplace_back(s.radius * std::cos(angle), s.radius * std::sin(angle), s.half_height);
  }
  for (int i = 0; i < sides; ++i) {
    const int j = (i + 1) % sides;
    faces.push_back({index(2 * i), index(2 * j), index(2 * j + 1), index(2 * i + 1)});
    faces[0].push_back(index(2 * (sides - 1 - i)));
    faces[1].push_back(index(2 * i + 1));
  }
  return Polyhedron(v, faces);
}

Polyhedron pyramid(const Cone& s, int sides) {
  std::vector<Vec3> v;
  Faces faces(1);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * kPi * i / sides;
    v.emplace_back(s.radius * std::cos(angle), s.radius * std::sin(angle), -0.5 * s.height);
  }
  v.emplace_back(0.0, 0.0, 0.5 * s.height);
  for (int i = 0; i < sides; ++i) {
    faces.push_back({index(i), index((i + 1) % sides), index(sides)});
    faces[0].push_back(index(sides - 1 - i));
  }
  return Polyhedron(v, faces);
}

Polyhedron globe(const Ellipsoid& s, int sides, int bands) {
  std::vector<Vec3> v;
  for (int b = 1; b < bands; ++b) {
    const double polar = kPi * b / bands;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * kPi * i / sides;
      v.push_back(s.radii.cwiseProduct(Vec3(std::sin(polar) * std::cos(angle),
                                            std::sin(polar) * std::sin(angle), std::cos(polar))));
    }
  }
  const std::uint32_t top = index((bands - 1) * sides), bottom = top + 1;
  v.emplace_back(0.0, 0.0, s.radii.z());
  v.emplace_back(0.0, 0.0, -s.radii.z());
  Faces faces;
  for (int i = 0; i < sides; ++i) {
    const int j = (i + 1) % sides, last = (bands - 2) * sides;
    faces.push_back({top, index(i), index(j)});
    faces.push_back({bottom, index(last + j), index(last + i)});
    for (int b = 0; b + 2 < bands; ++b) {
      const int upper = b * sides, lower = upper + sides;
      faces.push_back({index(upper + i), index(lower + i), index(lower + j), index(upper + j)});
    }
  }
  return Polyhedron(v, faces);
}

PaperData paper_data(int polygons) {
  constexpr int kPrimitives = 22;
  if (polygons < 120) {
    throw std::invalid_argument("paper_data: " + std::to_string(polygons) +
                                " polygons, expected 120 or more");
  }
  PaperData data;
  int left = polygons, primitives = kPrimitives;
  for (const std::vector<Piece>& pieces : objects()) {
    std::vector<Part> parametric, polyhedral;
    for (const Piece& piece : pieces) {
      // An even share of what is left; ellipsoids round theirs down to whole bands.
      const int share = left / primitives--;
      const Pose X{Quat::Identity(), piece.at};
      parametric.push_back({piece.shape, X});
      const Polyhedron hull = [&] {
        if (const auto* c = std::get_if<Cylinder>(&piece.shape)) return prism(*c, share - 2);
        if (const auto* c = std::get_if<Cone>(&piece.shape)) return pyramid(*c, share - 1);
        const int bands = std::max(2, static_cast<int>(std::sqrt(share / 1.6)));
        return globe(std::get<Ellipsoid>(piece.shape), std::max(3, share / bands), bands);
      }();
      left -= static_cast<int>(hull.faces().size());
      data.polygons += static_cast<int>(hull.faces().size());
      polyhedral.push_back({hull, X});
    }
    data.parametric.push_back(make_compound(parametric));
    data.polyhedral.push_back(make_compound(polyhedral));
  }
  return data;
}

std::vector<std::vector<Pose>> paper_frames(std::uint64_t seed, int frames, double side) {
  Random random(seed);
  std::vector<std::vector<Pose>> all;
  for (int f = 0; f < frames; ++f) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < objects().size(); ++i) {
      const double r = 0.5 * side;
      const Vec3 p{random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r)};
      poses.push_back({any_rotation(random), p});
    }
    all.push_back(poses);
  }
  return all;
}

}  // namespace headpin::engine::test
