#include "render/data/mesh.h"

#include <map>
#include <numbers>

#include <gtest/gtest.h>

namespace headpin::render {
namespace {

Vec3 corner(const Mesh& mesh, std::size_t i) {
  return mesh.vertices[mesh.indices[i]].p.cast<double>();
}

/// Volume by the divergence theorem: positive where triangles turn outward.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    sum += corner(mesh, i).dot(corner(mesh, i + 1).cross(corner(mesh, i + 2))) / 6.0;
  }
  return sum;
}

/// Every edge is walked once in each direction, corners at one place being one corner.
bool closed(const Mesh& mesh) {
  const auto place = [&](std::size_t i) {
    const Eigen::Vector3f p = mesh.vertices[mesh.indices[i]].p;
    return std::array<float, 3>{p.x() + 0.0F, p.y() + 0.0F, p.z() + 0.0F};
  };
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{place(i + k), place(i + (k + 1) % 3)}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end()) return false;
  }
  return !edges.empty();
}

/// Least cosine between a triangle and the normals at its corners.
double worst_normal(const Mesh& mesh) {
  double worst = 1.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3 n = (corner(mesh, i + 1) - corner(mesh, i))
                       .cross(corner(mesh, i + 2) - corner(mesh, i))
                       .normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      worst = std::min(worst, n.dot(mesh.vertices[mesh.indices[i + k]].n.cast<double>()));
    }
  }
  return worst;
}

const Vec3 kGrey = Vec3::Constant(0.5);

TEST(Box, IsClosedFacesOutwardAndHasItsVolume) {
  const Mesh mesh = box({0.2, 0.3, 0.5}, kGrey);
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), 0.03, 1e-8);  // float corners
  EXPECT_NEAR(worst_normal(mesh), 1.0, 1e-6);
}

// An n-sided prism inscribed in a cylinder has sin(2 pi / n) / (2 pi / n) of its volume.
TEST(Turned, CylinderIsClosedAndHasItsVolume) {
  const int sides = 24;
  const std::vector<Ring> rings{{0.0, 0.0, {0, -1}, kGrey}, {0.0, 0.1, {0, -1}, kGrey},
                                {0.0, 0.1, {1, 0}, kGrey},  {0.5, 0.1, {1, 0}, kGrey},
                                {0.5, 0.1, {0, 1}, kGrey},  {0.5, 0.0, {0, 1}, kGrey}};
  const Mesh mesh = turned(rings, sides);
  const double turn = 2.0 * std::numbers::pi / sides;
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), std::numbers::pi * 0.01 * 0.5 * std::sin(turn) / turn, 1e-8);
  EXPECT_GT(worst_normal(mesh), std::cos(0.5 * turn) - 1e-6);  // a corner leans half a side
}

TEST(EllipsoidMesh, IsClosedAndComesNearItsVolume) {
  const Mesh mesh = ellipsoid(0.1, 0.2, 48, 48, [](double) { return kGrey; });
  EXPECT_TRUE(closed(mesh));
  const double exact = 4.0 / 3.0 * std::numbers::pi * 0.1 * 0.1 * 0.2;
  EXPECT_LT(volume(mesh), exact);  // inscribed
  EXPECT_NEAR(volume(mesh), exact, 0.01 * exact);
  EXPECT_GT(worst_normal(mesh), std::cos(0.2));
}

TEST(Append, MovesPointsAndTurnsNormals) {
  Mesh mesh;
  append(mesh, box({0.1, 0.1, 0.1}, kGrey), {rotation(Vec3(0.3, 0.4, 0.5)), Vec3(1, 2, 3)});
  append(mesh, box({0.1, 0.2, 0.1}, kGrey), {Quat::Identity(), Vec3(-1, 0, 0)});
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), 0.003, 1e-6);
  EXPECT_NEAR(worst_normal(mesh), 1.0, 1e-5);
}

TEST(SurfaceOf, ABallIsClosedRoundAndFacesOutward) {
  const double radius = 0.1;
  const auto field = [&](const Vec3& p) {
    return (p - Vec3(0.0113, 0.0227, 0.0341)).norm() - radius;
  };
  const Mesh mesh = surface_of(field, Vec3::Constant(-0.15), Vec3::Constant(0.15), 0.01, kGrey);
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3), 1e-4);
  for (const Vertex& v : mesh.vertices) EXPECT_NEAR(field(v.p.cast<double>()), 0.0, 0.001);
  EXPECT_GT(worst_normal(mesh), std::cos(3.0 * std::sqrt(3.0) * 0.01 / radius));  // three cells
}

// IEC 61966-2-1 at its ends and at the code of half the light.
TEST(Srgb, IsLinearLight) {
  EXPECT_EQ(srgb(0x000000), Vec3::Zero());
  EXPECT_NEAR((srgb(0xffffff) - Vec3::Ones()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(srgb(0xbc0000).x(), 0.5, 0.003);  // half a code step
  EXPECT_EQ(srgb(0x00ff00), Vec3(0, 1, 0));
}

}  // namespace
}  // namespace headpin::render
