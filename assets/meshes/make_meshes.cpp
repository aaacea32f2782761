// Writes the meshes of this folder: what the program draws by itself, as files to start from, and a
// convex hull to collide with. The skittle is turned from the measured profile of
// scene/scenario/scenario.cpp; its measures and their sources are in assets/scenarios. `./dev meshes` runs this.

#include <fstream>
#include <iostream>
#include <numbers>

#include <fmt/ostream.h>

#include "scene/looks/hand_mesh.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/stage/bodies.h"

namespace {

using namespace headpin;

constexpr const char* kProfile =
    "turned from the profile of USBC's specification manual (heights and diameters in inches in "
    "scene/scenario/scenario.cpp)";

std::ofstream open_obj(const std::string& folder, const std::string& name,
                       const std::string& what) {
  std::ofstream out(folder + "/" + name + ".obj");
  out.exceptions(std::ios::failbit | std::ios::badbit);
  fmt::print(out, "# {}\n# Metres; x right, y ahead, z up. Made by ./dev meshes.\n", what);
  return out;
}

/// Colours as they are usual in an OBJ: sRGB, after the point.
void write_seen(const std::string& folder, const std::string& name, const std::string& what,
                const render::Mesh& mesh, const Quat& q_FG = Quat::Identity()) {
  std::ofstream out = open_obj(folder, name, what);
  for (const render::Vertex& v : mesh.vertices) {
    const Vec3 p = q_FG * v.p.cast<double>(), c = render::srgb_of(v.colour.cast<double>());
    fmt::print(out, "v {:.6f} {:.6f} {:.6f} {:.3f} {:.3f} {:.3f}\n", p.x(), p.y(), p.z(), c.x(),
               c.y(), c.z());
  }
  for (const render::Vertex& v : mesh.vertices) {
    const Vec3 n = q_FG * v.n.cast<double>();
    fmt::print(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x(), n.y(), n.z());
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    out << "f";
    for (std::size_t k = i; k < i + 3; ++k) fmt::print(out, " {0}//{0}", mesh.indices[k] + 1);
    out << "\n";
  }
}

/// The points of a profile that its convex hull has, upwards.
std::vector<Vec2> hull_of(const std::vector<Vec2>& profile) {
  std::vector<Vec2> hull;
  for (const Vec2& p : profile) {
    const auto dents = [&](const Vec2& a, const Vec2& b) {  // b lies inside the line from a to p
      const Vec2 u = b - a, v = p - a;
      return u.x() * v.y() - u.y() * v.x() >= 0.0;
    };
    while (hull.size() > 1 && dents(hull[hull.size() - 2], hull.back())) hull.pop_back();
    hull.push_back(p);
  }
  return hull;
}

/// Flat faces: a polygon below, rings of four-sided ones, triangles that meet at the top.
void write_hull(const std::string& folder, const std::vector<Vec2>& profile) {
  constexpr int kSides = 16;
  std::ofstream out =
      open_obj(folder, "skittle_hull",
               fmt::format("Convex hull of the skittle, {} sides, {}", kSides, kProfile));
  const std::vector<Vec2> hull = hull_of(profile);
  const auto rings = static_cast<int>(hull.size()) - 1;  // the last is the top
  for (int ring = 0; ring < rings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const SinCos a = sin_cos(2.0 * std::numbers::pi * side / kSides);
      const Vec2& p = hull[static_cast<std::size_t>(ring)];
      fmt::print(out, "v {:.8f} {:.8f} {:.8f}\n", p.y() * a.cos, p.y() * a.sin, p.x());
    }
  }
  fmt::print(out, "v 0 0 {:.8f}\nf", hull.back().x());
  const auto at = [&](int ring, int side) { return 1 + ring * kSides + (side + kSides) % kSides; };
  for (int side = 0; side < kSides; ++side) fmt::print(out, " {}", at(0, -side));
  out << "\n";
  for (int ring = 0; ring + 1 < rings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      fmt::print(out, "f {} {} {} {}\n", at(ring, side), at(ring, side + 1), at(ring + 1, side + 1),
                 at(ring + 1, side));
    }
  }
  for (int side = 0; side < kSides; ++side) {
    fmt::print(out, "f {} {} {}\n", at(rings - 1, side), at(rings - 1, side + 1),
               1 + rings * kSides);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_meshes FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  const scene::Scenario scenario;
  const scene::Outline outline = scene::smooth_outline(scenario.skittle.profile);
  write_seen(folder, "skittle", std::string("A ten-pin, ") + kProfile,
             scene::skittle_mesh(outline, 0.0, 26, 18));
  write_seen(folder, "ball", "A ball 8.54 in across (USBC allows 8.500 to 8.595), about its centre",
             scene::ball_mesh(scenario.ball.radius,
                              scene::ball_holes(scenario.hand.grip, scenario.ball.radius)));
  const Quat upright = rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0));
  write_seen(folder, "hand",
             "An open right hand in a sleeve, about the middle of its palm, fingers ahead",
             scene::hand_mesh(scenario.hand.grip, scenario.ball.radius, 0.0), upright);
  write_hull(folder, scenario.skittle.profile);
}
