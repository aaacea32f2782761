#include "scene/stage/mesh_file.h"

#include <algorithm>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "scene/looks/hand_mesh.h"
#include "scene/looks/skittle_mesh.h"
#include "scene/stage/apart.h"
#include "scene/stage/bodies.h"
#include "scene/stage/convex_hull.h"
#include "scene/stage/mesh_text.h"
#include "scene/stage/outline.h"
#include "tests/support/box_object.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

constexpr const char* kCube =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::filesystem::path file(const std::string& name, const std::string& text) {
  static const std::filesystem::path folder = fresh_folder("mesh");
  const std::filesystem::path path = folder / name;
  std::ofstream(path) << text;
  return path;
}

engine::Polyhedron only_polyhedron(const std::filesystem::path& path,
                                   const MeshMeasure& measure = {}) {
  std::vector<engine::Polyhedron> all = polyhedra_of(read_mesh_file(path), path, measure, 16);
  EXPECT_EQ(all.size(), 1u);
  return all.at(0);
}

template <typename Exception>
std::string mesh_refusal(const std::filesystem::path& path) {
  try {
    only_polyhedron(path);
  } catch (const Exception& e) {
    return e.what();
  }
  return "";
}

TEST(MeshFile, OfACubeIsAPolyhedronOfItsFaces) {
  const engine::Polyhedron cube = only_polyhedron(file("headpin_cube.obj", kCube), {.unit = 0.5});
  EXPECT_EQ(cube.vertices().size(), 8u);
  EXPECT_EQ(cube.faces().size(), 6u);
  EXPECT_EQ(cube.edges().size(), 12u);
  EXPECT_LT((cube.centre() - Vec3(0.5, 0.5, 0.5)).norm(), 1e-6);
}

// Three of the dented cube's faces are not flat, and no plane has all of it on one side.
TEST(MeshFile, OfADentedCubeIsSeveralPolyhedra) {
  std::string dented = kCube;
  dented.replace(dented.find("v 2 2 2"), 7, "v 0.5 0.5 0.5");
  const std::filesystem::path path = file("headpin_dented.obj", dented);
  const auto pieces = polyhedra_of(read_mesh_file(path), path, {}, 16);
  EXPECT_GT(pieces.size(), 1u);
  const auto hull = polyhedra_of(read_mesh_file(path), path, {}, 1);
  EXPECT_EQ(hull.size(), 1u);
  const double by_pieces = added_by(pieces, read_mesh_file(path), path, {}),
               by_hull = added_by(hull, read_mesh_file(path), path, {});
  EXPECT_GE(by_pieces, 0.0);
  EXPECT_LT(by_pieces, by_hull);
}

// What is in two shells, or in two pieces, counts once.
TEST(MeshFile, TellsHowMuchPiecesAddToShellsThatOverlap) {
  const std::filesystem::path path =
      file("headpin_overlapping.obj",
           box_object({0, 0, 0}, {2, 2, 2}) + box_object({1, 0, 0}, {3, 2, 2}, 9));
  const auto box_to = [](double x) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
      corners.emplace_back((i & 1) != 0 ? x : 0.0, (i & 2) != 0 ? 2.0 : 0.0,
                           (i & 4) != 0 ? 2.0 : 0.0);
    }
    return convex_hull(corners);
  };
  const std::string bytes = read_mesh_file(path);
  EXPECT_NEAR(added_by(std::vector{box_to(3.0)}, bytes, path, {}), 0.0, 1e-3);
  EXPECT_NEAR(added_by(std::vector{box_to(3.3)}, bytes, path, {}), 0.1, 1e-3);
  EXPECT_NEAR(added_by(std::vector{box_to(3.3), box_to(3.0)}, bytes, path, {}), 0.1, 1e-3);
  EXPECT_NEAR(added_by(std::vector{box_to(2.0)}, bytes, path, {}), -1.0 / 3.0, 1e-3);
  EXPECT_NEAR(added_by(polyhedra_of(bytes, path, {}, 16), bytes, path, {}), 0.0, 1e-12);
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
  EXPECT_EQ(only_polyhedron(file("headpin_tetrahedron.stl", stl)).vertices().size(), 4u);
}

TEST(MeshFile, IsRefusedWithItsNameAndTheReason) {
  std::string open = kCube;
  open.resize(open.rfind("f 4 1 5 8"));
  const auto path = file("headpin_open.obj", open);
  EXPECT_THAT(mesh_refusal<std::runtime_error>(path),
              HasSubstr("headpin_open.obj: mesh: not closed"));
  EXPECT_THAT(mesh_refusal<std::runtime_error>(file("headpin_broken.obj", "not a mesh at all")),
              HasSubstr("headpin_broken.obj"));
  EXPECT_THAT(mesh_refusal<std::runtime_error>(file("headpin.dae", "x")),
              HasSubstr("expected .gltf, .glb, .obj"));
  EXPECT_THAT(mesh_refusal<std::runtime_error>("/nowhere/headpin.obj"), HasSubstr("/nowhere"));
  EXPECT_THROW(only_polyhedron(file("headpin_cube2.obj", kCube), {.unit = 0.0}),
               std::invalid_argument);
}

// Cut off anywhere, a file is refused or is still a closed convex body; it never hangs or crashes.
TEST(MeshFile, CutOffAnywhereIsRefused) {
  const std::string whole = kCube;
  for (std::size_t length = 0; length + 2 < whole.size(); length += 3) {
    EXPECT_ANY_THROW(only_polyhedron(file("headpin_cut.obj", whole.substr(0, length)))) << length;
  }
}

/// kCube's corners and faces, counted from 0.
constexpr int kCorners[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0},
                                {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
constexpr int kFaces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::string lines_of_cube(const char* before_face) {
  std::string text;
  for (const auto& c : kCorners) text += fmt::format("{} {} {}\n", c[0], c[1], c[2]);
  for (const auto& f : kFaces) text += fmt::format("{}{}\n", before_face, fmt::join(f, " "));
  return text;
}

std::string ply_of_cube() {
  return "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
         "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n" +
         lines_of_cube("4 ");
}

std::string off_of_cube() {
  return "OFF\n8 6 0\n" + lines_of_cube("4 ");
}

std::string stl_of_cube() {
  std::string text = "solid cube\n";
  for (const auto& f : kFaces) {
    for (const int third : {2, 3}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int corner : {f[0], f[third - 1], f[third]}) {
        text += fmt::format("vertex {}\n", fmt::join(kCorners[corner], " "));
      }
      text += "endloop\nendfacet\n";
    }
  }
  return text + "endsolid cube\n";
}

template <typename T>
void append_bytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The binary form of glTF 2.0: a head of 12 bytes, then JSON, then buffer.
///
/// @param uri  of the buffer, where it is another file
std::string glb_of_cube(const std::string& uri = "", unsigned count = 36) {
  std::string buffer;
  for (const auto& f : kFaces) {
    for (const int corner : {0, 1, 2, 0, 2, 3}) {
      for (const int x : kCorners[f[corner]]) append_bytes(buffer, static_cast<float>(x));
    }
  }
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],)"
      R"("materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.25,0,1]}}}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":432}}],"buffers":[{{{}"byteLength":432}}]}})",
      count, uri.empty() ? "" : fmt::format(R"("uri":"{}",)", uri));
  while (json.size() % 4 != 0) json += ' ';
  std::string glb = "glTF";
  append_bytes(glb, 2U);
  append_bytes(glb, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append_bytes(glb, static_cast<std::uint32_t>(json.size()));
  glb += "JSON" + json;
  append_bytes(glb, static_cast<std::uint32_t>(buffer.size()));
  return glb + std::string("BIN\0", 4) + buffer;
}

/// kCube as other programs write it.
std::string with_lines(const std::string& before, const std::string& end) {
  std::string text;
  std::istringstream lines(kCube);
  for (std::string line; std::getline(lines, line);) text += before + line + end;
  return text;
}

TEST(MeshFile, ThatIsIndentedStillTellsItsMaterialsAndItsLines) {
  EXPECT_EQ(unseen_of_mesh(".obj", "v 0 0 0\r  mtllib a.mtl\r"), "materials");
  EXPECT_EQ(unseen_of_mesh(".obj", "\xef\xbb\xbfmtllib a.mtl\n"), "materials");
  EXPECT_EQ(complaint([] { plain_obj("v 0 0 0\r\n  v 1 one 0\r\n"); }),
            "line 2: a vertex is not a number");
  EXPECT_EQ(complaint([] { plain_obj("v 0 0 0\r v 1 one 0\r"); }),
            "line 2: a vertex is not a number");
  EXPECT_EQ(plain_obj("f 1 2\\\n 3\n"), "f 1 2\\\n 3\n");  // one line, whose blank counts
}

TEST(MeshFile, IsTheSameCubeInEveryFormat) {
  for (const auto& [name, text] :
       {std::pair{"cube.obj", std::string(kCube)},
        {"commented.obj", "# by hand\nv 0 0 0 # first\n" + std::string(kCube).substr(8)},
        {"indented.obj", with_lines(" \t", "\n")},
        {"mark.obj", "\xef\xbb\xbf" + std::string(kCube)},
        {"old_mac.obj", with_lines("", "\r")},
        {"windows.obj", with_lines("  ", "\r\n")},
        {"cube.off", off_of_cube()},
        {"cube.ply", ply_of_cube()},
        {"cube.stl", stl_of_cube()},
        {"cube.glb", glb_of_cube()}}) {
    const std::filesystem::path path = file(std::string("headpin_") + name, text);
    const engine::Polyhedron cube = only_polyhedron(path, {.unit = 0.1});
    EXPECT_EQ(cube.vertices().size(), 8u) << name;
    EXPECT_LT((cube.centre() - Vec3::Constant(0.1)).norm(), 1e-7) << name;
    const MeshData seen = mesh_of(read_mesh_file(path), path, {.unit = 0.1});
    double six_volumes = 0.0;
    for (std::size_t i = 0; i < seen.triangles.size(); i += 3) {
      const auto corner = [&](std::size_t k) { return seen.points[seen.triangles[i + k]]; };
      six_volumes += corner(0).dot(corner(1).cross(corner(2)));
      const Vec3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
      for (std::size_t k = 0; k < 3; ++k) {  // a sharp edge stays one: normals are those of faces
        EXPECT_LT((seen.normals[seen.triangles[i + k]] - n).norm(), 1e-6) << name;
      }
    }
    EXPECT_EQ(seen.triangles.size(), 36u) << name;
    EXPECT_NEAR(six_volumes, 6.0 * 0.008, 1e-7) << name;
  }
}

TEST(MeshFile, SaysWhereItsAxesPoint) {
  const std::filesystem::path path = file("headpin_box.obj", kCube);
  const auto centre = [&](const char* axes) {
    return only_polyhedron(path, {.unit = 1.0, .axes = axes}).centre();
  };
  EXPECT_LT((centre("RSP") - Vec3(1.0, -1.0, 1.0)).norm(), 1e-6);  // y up, as glTF has it
  EXPECT_LT((centre("LPS") - Vec3(-1.0, -1.0, 1.0)).norm(), 1e-6);
  EXPECT_THROW(centre("RRS"), std::invalid_argument);
  EXPECT_THROW(centre("LAS"), std::invalid_argument);  // a mirror
  EXPECT_THROW(centre("north"), std::invalid_argument);
}

TEST(MeshFile, HasTheColoursItSays) {
  const std::filesystem::path gltf = file("headpin_colour.glb", glb_of_cube());
  const MeshData material = mesh_of(read_mesh_file(gltf), gltf, {});
  ASSERT_EQ(material.colours.size(), material.points.size());
  EXPECT_LT((material.colours[3] - Vec3(0.5, 0.25, 0.0)).norm(), 1e-6);
  const std::filesystem::path obj = file(
      "headpin_colour.obj",
      "mtllib none.mtl\nv 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 0 1 0 1 0.5 0\nusemtl x\nf 1 2 3\n");
  const MeshData points = mesh_of(read_mesh_file(obj), obj, {});
  ASSERT_EQ(points.colours.size(), 3u);
  EXPECT_LT((points.colours[0] - render::srgb(0xff8000)).norm(), 3e-3);
}

// What has no colours beside what has some is white. It was black, or had the colours of the others.
TEST(MeshFile, KeepsTheColoursOfSomeOfItsMeshes) {
  const std::string red = "o a\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\n";
  const std::string plain = "o b\nv 0 0 2\nv 1 0 2\nv 0 1 2\n";
  for (const bool plain_first : {false, true}) {
    const std::filesystem::path path =
        file("headpin_some_colours.obj",
             (plain_first ? plain + "f 1 2 3\n" + red : red + "f 1 2 3\n" + plain) + "f 4 5 6\n");
    const MeshData mesh = mesh_of(read_mesh_file(path), path, {.unit = 1.0, .axes = "RAS"});
    ASSERT_EQ(mesh.points.size(), 6u);
    ASSERT_EQ(mesh.colours.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
      const Vec3 colour = mesh.points[i].z() == 2.0 ? Vec3(1.0, 1.0, 1.0) : Vec3(1.0, 0.0, 0.0);
      EXPECT_LT((mesh.colours[i] - colour).norm(), 1e-6) << i;
    }
  }
}

/// Under AddressSanitizer an allocation that fails ends the process that asks.
#ifdef HEADPIN_SANITIZED
constexpr const char* kTooMuch = "crashes";
#else
constexpr const char* kTooMuch = "256 MB of memory";
#endif

/// Everything that says no, with words of why.
std::string refusal_of(const std::filesystem::path& path) {
  return complaint([&] { mesh_of(read_mesh_file(path), path, {}); });
}

// Each was met in the wild or by a fuzzer: it is refused in one sentence that names it and says why,
// and takes neither the time nor the memory that it asks for.
TEST(MeshFile, ThatIsBrokenHugeOrHostileIsRefusedWithItsReason) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  constexpr int kTeeth = 32'000;
  std::string comb, face = "f";  // every ear of a face is held against all its corners
  for (int i = 0; i < kTeeth; ++i) {
    const bool back = i >= kTeeth / 2;
    comb += fmt::format("v {} {} 0\n", back ? kTeeth - i : i, (back ? 3 : 0) + i % 2);
    face += fmt::format(" {}", i + 1);
  }
  for (int i = 0; i < 60; ++i) comb += face + "\n";
  const std::string cube = kCube;
  std::string other = glb_of_cube("/etc/passwd");
  other = other.substr(20, other.find("BIN") - 24);  // its JSON
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {"empty.obj", "", "empty"},
      {"text.obj", "hello", "expected a whole .obj file; its reader, assimp, says: "},
      {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"},
      {"beyond.obj", replaced(cube, "4 1 5 8", "4 1 5 9"), "out of range"},
      {"before.obj", replaced(cube, "4 1 5 8", "4 1 5 -99"), "out of range"},
      {"none.obj", replaced(cube, "4 1 5 8", "4 1 5 0"), "index"},
      {"nan.obj", replaced(cube, "v 2 2 2", "v nan 2 2"), "line 7"},
      {"far.obj", replaced(cube, "v 2 2 2", "v 1e30 2 2"), "within 1000 m"},
      {"slow.obj", comb, "1 s of processor time"},
      {"long.obj", std::string(17'000'000, '#'), "16000000"},
      {"beyond.off", replaced(off_of_cube(), "4 3 0 4 7", "4 3 0 4 8"), "out of range"},
      {"huge.off", "OFF\n2000000000 2000000000 0\n0 0 0\n", kTooMuch},
      {"cut.off", off_of_cube().substr(0, 50), ""},
      {"beyond.ply", replaced(ply_of_cube(), "4 3 0 4 7", "4 3 0 4 8"), "out of range"},
      {"huge.ply", replaced(ply_of_cube(), "face 6", "face 2000000000"), "as in the header"},
      {"cut.ply", ply_of_cube().substr(0, 230), "as in the header"},
      {"head.ply", "ply\n", "format"},
      {"huge.stl", std::string(80, 'x') + std::string(4, '\xff') + std::string(100, '\0'), "STL"},
      {"none.stl", "solid t\nendsolid t\n", "no vertices"},
      {"other.gltf", other, "referenced file \"/etc/passwd\""},
      {"count.glb", glb_of_cube("", 300'000'000), "out of range"},
      {"junk.glb", "glTF" + std::string(40, '\xff'), ""},
      {"cycle.gltf",
       R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
       R"("nodes":[{"children":[0]}]})",
       "recursive"},
      {"junk.gltf", "{}", ""}};
  for (const auto& [name, text, why] : cases) {
    const std::string said = refusal_of(file("headpin_" + name, text));
    EXPECT_THAT(said, HasSubstr("headpin_" + name + ": ")) << name;
    EXPECT_THAT(said, HasSubstr(why)) << name;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_LT(said.size(), 400u) << said;
  }
}

TEST(MeshFile, HasFacesOfTheCornersAndPointsThatAreThere) {
  const std::vector<std::uint32_t> sizes = {3, 4}, corners = {0, 1, 2, 0, 2, 3, 4};
  const auto wrong = [&](const std::vector<std::uint32_t>& s, std::size_t points) {
    return complaint([&] { require_faces(s, corners, points); });
  };
  EXPECT_EQ(wrong(sizes, 5), "");
  EXPECT_THAT(wrong(sizes, 4), HasSubstr("point 4"));  // one past the end
  EXPECT_THAT(wrong({3, 3}, 5), HasSubstr("6 corners"));
  EXPECT_THAT(wrong({3, 5}, 5), HasSubstr("8 corners"));
  EXPECT_THAT(complaint([] { require_faces({}, {}, 5); }), HasSubstr("no faces"));
}

// What a reader may take is bounded by itself, not by what the machine has.
TEST(MeshFile, IsReadInTheMemoryThatIsAllowed) {
  const auto filled_with = [](std::size_t bytes) {
    return apart([=] { return std::string(bytes, 'x').substr(bytes - 3); },
                 {.cpu_s = 60, .memory = 64'000'000});
  };
  EXPECT_EQ(filled_with(32'000'000), "xxx");
#ifndef HEADPIN_SANITIZED  // where an allocation that fails ends the process
  EXPECT_THAT(complaint([&] { filled_with(96'000'000); }), HasSubstr("64 MB of memory"));
#endif
}

TEST(MeshFile, ThatIsNoRegularFileIsRefusedAtOnce) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.obj").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "zeros.ply");
  std::filesystem::create_directory(folder / "folder.stl");
  std::filesystem::create_symlink("itself.off", folder / "itself.off");
  for (const char* name : {"pipe.obj", "zeros.ply", "folder.stl"}) {
    EXPECT_THAT(refusal_of(folder / name), HasSubstr("expected a file, found a")) << name;
  }
  EXPECT_THAT(refusal_of(folder / "itself.off"), HasSubstr("cannot open"));
  EXPECT_THAT(refusal_of(folder / "gone.glb"), HasSubstr("No such file"));
}

// What comes along is what is drawn without it.
TEST(MeshFile, ThatComesAlongIsWhatTheProgramDraws) {
  const std::filesystem::path folder = HEADPIN_SOURCE_DIR "/assets/meshes";
  const Scenario scenario;
  const Quat upright = rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0));
  const Outline outline = smooth_outline(scenario.skittle.profile);
  const auto holes = ball_holes(scenario.hand.grip, scenario.ball.radius);
  for (const auto& [name, drawn, q] :
       {std::tuple{"skittle.obj", skittle_mesh(outline, 0.0, 26, 18), Quat::Identity()},
        {"ball.obj", ball_mesh(scenario.ball.radius, holes), Quat::Identity()},
        {"hand.obj", hand_mesh(scenario.hand.grip, scenario.ball.radius, 0.0), upright}}) {
    const MeshData mesh = mesh_of(read_mesh_file(folder / name), folder / name, {});
    ASSERT_EQ(mesh.triangles.size(), drawn.indices.size()) << name;
    for (std::size_t i = 0; i < drawn.indices.size(); i += 7) {
      const render::Vertex& v = drawn.vertices[drawn.indices[i]];
      const std::uint32_t k = mesh.triangles[i];
      ASSERT_LT((mesh.points[k] - q * v.p.cast<double>()).norm(), 2e-6) << name << i;
      ASSERT_LT((mesh.normals[k] - q * v.n.cast<double>()).norm(), 1e-3) << name << i;
      ASSERT_LT((mesh.colours[k] - v.colour.cast<double>()).norm(), 5e-3) << name << i;
    }
  }
}

// With a tab, and with the fourth number of a point in homogeneous coordinates.
TEST(MeshFile, KeepsItsColoursBesideVerticesOfOtherForms) {
  const std::string red = "v 0 0 0 1 0 0\nv\t1 0 0\t1 0 0\nv 0 1 0 1 0 0\n";
  for (const std::string plain :
       {"v\t0 0 2\nv\t1\t0\t2\nv\t0 1 2\n", "v 0 0 2 1\nv 2 0 4 2\nv 0 0.5 1 0.5\r\n"}) {
    const std::filesystem::path path =
        file("headpin_forms.obj", std::string(plain) + red + "f 1 2 3\nf 4 5 6\n");
    const MeshData mesh = mesh_of(read_mesh_file(path), path, {.unit = 1.0, .axes = "RAS"});
    ASSERT_EQ(mesh.points.size(), 6u);
    ASSERT_EQ(mesh.colours.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
      const bool white = mesh.points[i].z() > 1.0;
      EXPECT_LT((mesh.colours[i] - (white ? Vec3(1.0, 1.0, 1.0) : Vec3(1.0, 0.0, 0.0))).norm(),
                1e-6)
          << i;
    }
    const auto above = [](const Vec3& p) { return (p - Vec3(1.0, 0.0, 2.0)).norm() < 1e-6; };
    EXPECT_EQ(std::ranges::count_if(mesh.points, above), 1);
  }
  EXPECT_EQ(plain_obj("v 0 0 2 1\nv\t1 0 2\n"), "v 0 0 2 1\nv\t1 0 2\n");  // without colours
  EXPECT_EQ(plain_obj("v 0 0 0 1 0 0\nv 0 0 2 0\n"), "v 0 0 0 1 0 0\nv 0 0 2 0\n");  // at infinity
  EXPECT_THROW(plain_obj("v\t0 x 0\n"), std::runtime_error);
}

}  // namespace
}  // namespace headpin::scene
