#include "scene/mesh_file.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headpin::scene {
namespace {

using testing::HasSubstr;

constexpr const char* kCube =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::filesystem::path file(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path;
}

template <typename Exception>
std::string mesh_refusal(const std::filesystem::path& path) {
  try {
    load_polyhedron(path);
  } catch (const Exception& e) {
    return e.what();
  }
  return "";
}

TEST(MeshFile, OfACubeIsAPolyhedronOfItsFaces) {
  const engine::Polyhedron cube = load_polyhedron(file("headpin_cube.obj", kCube), 0.5);
  EXPECT_EQ(cube.vertices().size(), 8u);
  EXPECT_EQ(cube.faces().size(), 6u);
  EXPECT_EQ(cube.edges().size(), 12u);
  EXPECT_LT((cube.centre() - Vec3(0.5, 0.5, 0.5)).norm(), 1e-6);
}

// STL repeats every corner in every triangle.
TEST(MeshFile, WithoutSharedCornersIsWelded) {
  std::string stl = "solid t\n";
  const char* corner[] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  for (const auto& f : faces) {
    stl += "facet normal 0 0 0\n outer loop\n";
    for (const int i : f) stl += std::string("  vertex ") + corner[i] + "\n";
    stl += " endloop\nendfacet\n";
  }
  stl += "endsolid t\n";
  EXPECT_EQ(load_polyhedron(file("headpin_tetrahedron.stl", stl)).vertices().size(), 4u);
}

TEST(MeshFile, IsRefusedWithItsNameAndTheReason) {
  std::string open = kCube;
  open.resize(open.rfind("f 4 1 5 8"));
  const auto path = file("headpin_open.obj", open);
  EXPECT_THAT(mesh_refusal<std::invalid_argument>(path), HasSubstr("headpin_open.obj"));
  EXPECT_THAT(mesh_refusal<std::invalid_argument>(path), HasSubstr("not closed"));
  std::string dented = kCube;
  dented.replace(dented.find("v 2 2 2"), 7, "v 0.5 0.5 0.5");
  EXPECT_NE(mesh_refusal<std::invalid_argument>(file("headpin_dented.obj", dented)), "");
  EXPECT_THAT(mesh_refusal<std::runtime_error>(file("headpin_broken.obj", "not a mesh at all")),
              HasSubstr("headpin_broken.obj"));
  EXPECT_THAT(mesh_refusal<std::runtime_error>(file("headpin.ply", "ply\n")),
              HasSubstr("expected .obj"));
  EXPECT_THAT(mesh_refusal<std::runtime_error>("/nowhere/headpin.obj"), HasSubstr("/nowhere"));
  EXPECT_THROW(load_polyhedron(file("headpin_cube2.obj", kCube), 0.0), std::invalid_argument);
}

// Cut off anywhere, a file is refused or is still a closed convex body; it never hangs or crashes.
TEST(MeshFile, CutOffAnywhereIsRefused) {
  const std::string whole = kCube;
  for (std::size_t length = 0; length + 2 < whole.size(); length += 3) {
    EXPECT_ANY_THROW(load_polyhedron(file("headpin_cut.obj", whole.substr(0, length)))) << length;
  }
}

}  // namespace
}  // namespace headpin::scene
