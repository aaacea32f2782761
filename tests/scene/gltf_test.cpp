// glTF as its specification (2.0) has it: nodes that mirror, surfaces with two sides, colours that are
// multiplied; and what is not read is refused or said. The files are made here, number by number.

#include <array>
#include <fstream>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/osmesa_context.h"
#include "scene/looks/eyes.h"
#include "scene/stage/mesh_file.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/seen_mesh.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

/// What a file is made of, beside its triangles.
struct Wanted {
  std::string node = "";                             ///< more of its node: a scale, a matrix
  std::string more = "";                             ///< more of the file
  std::string material = "";                         ///< more of its material
  std::array<float, 3> colour = {1.0F, 1.0F, 1.0F};  ///< of every point
  std::array<float, 3> factor = {1.0F, 1.0F, 1.0F};  ///< the material's
  int type = 5126;                                   ///< that its positions are said to be of
};

template <typename T>
void append_number(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Points as floats, three a triangle, and their colours behind them.
std::string glb_of(const std::vector<Vec3>& points, const Wanted& wanted) {
  std::string buffer;
  for (const Vec3& p : points) {
    for (const double x : {p.x(), p.y(), p.z()}) append_number(buffer, static_cast<float>(x));
  }
  const std::size_t half = buffer.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const float c : wanted.colour) append_number(buffer, c);
  }
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},{8}"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{{0}"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1}},)"
      R"("material":0}}]}}],"materials":[{{{1}"pbrMetallicRoughness":{{"baseColorFactor":[{2},{3},{4},1]}}}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":{7},"count":{5},"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5126,"count":{5},"type":"VEC3"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{6}}},{{"buffer":0,"byteOffset":{6},"byteLength":{6}}}],)"
      R"("buffers":[{{"byteLength":{9}}}]}})",
      wanted.node, wanted.material, wanted.factor[0], wanted.factor[1], wanted.factor[2],
      points.size(), half, wanted.type, wanted.more, buffer.size());
  while (json.size() % 4 != 0) json += ' ';
  std::string glb = "glTF";
  append_number(glb, 2U);
  append_number(glb, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  append_number(glb, static_cast<std::uint32_t>(json.size()));
  glb += "JSON" + json;
  append_number(glb, static_cast<std::uint32_t>(buffer.size()));
  return glb + std::string("BIN\0", 4) + buffer;
}

/// A ball about the origin, its triangles counterclockwise from outside.
std::vector<Vec3> ball_points(double r) {
  std::vector<Vec3> points;
  constexpr int kAround = 24, kUp = 12;
  const auto at = [&](int i, int k) {
    const double a = 2.0 * std::numbers::pi * i / kAround, b = std::numbers::pi * k / kUp;
    return Vec3(r * std::sin(b) * std::cos(a), r * std::sin(b) * std::sin(a), -r * std::cos(b));
  };
  for (int k = 0; k < kUp; ++k) {
    for (int i = 0; i < kAround; ++i) {
      const Vec3 a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
      if (k > 0) points.insert(points.end(), {a, b, c});
      if (k + 1 < kUp) points.insert(points.end(), {a, c, d});
    }
  }
  return points;
}

std::vector<Vec3> inside_out(std::vector<Vec3> points) {
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) std::swap(points[i + 1], points[i + 2]);
  return points;
}

std::filesystem::path written(const TemporaryFolder& folder, const char* name,
                              const std::string& bytes) {
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return folder / name;
}

MeshData read(const std::filesystem::path& path) {
  return mesh_of(read_mesh_file(path), path, {});
}

/// Half a turn, and a mirror: column by column.
constexpr const char* kMirrored = R"("matrix":[0,1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1],)";

TEST(Gltf, OfANodeThatMirrorsLooksOutward) {
  const TemporaryFolder folder;
  for (const char* node : {"", R"("scale":[-1,1,1],)", R"("scale":[1,-2,0.5],)",
                           R"("scale":[-1,-1,-1],)", kMirrored}) {
    const MeshData mesh =
        read(written(folder, "ball.glb", glb_of(ball_points(0.1), {.node = node})));
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
      const auto point = [&](std::size_t k) { return mesh.points[mesh.triangles[i + k]]; };
      const Vec3 n = (point(1) - point(0)).cross(point(2) - point(0));
      const Vec3 middle = (point(0) + point(1) + point(2)) / 3.0;
      ASSERT_GT(n.dot(middle), 0.0) << node;
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_GT(mesh.normals[mesh.triangles[i + k]].dot(n.normalized()), 0.85) << node;
      }
    }
  }
}

/// What an eye half a metre away sees of a ball mesh in the dark room of no lamps but the sky.
struct Looked {
  double nearest = 1e9;  ///< [m]
  double light = 0.0;    ///< mean code of its pixels
  int pixels = 0;
};

Looked looked_at(const std::filesystem::path& path) {
  Scenario scenario;
  set(scenario, "ball.mesh.file='" + path.string() + "'");
  render::Renderer renderer{render::osmesa_context()};
  const Looks looks{renderer, make_stage(scenario)};
  const Glimpse glimpse{.X_WB_balls = {Pose{Quat::Identity(), Vec3(0.0, 3.0, 1.0)}}};
  const render::DrawList list = draw_list(looks, glimpse);
  const render::View view{{rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0)), Vec3(0.0, 2.5, 1.0)},
                          {-0.5, 0.5, -0.5, 0.5},
                          100,
                          100};
  const render::Labels labels = renderer.labels(list, view);
  render::Image image;
  renderer.draw(list, {&view, 1}, {&image, 1});
  Looked found;
  for (std::size_t i = 0; i < labels.id.size(); ++i) {
    if (labels.id[i] != kFirstBallId) continue;
    ++found.pixels;
    found.nearest = std::min<double>(found.nearest, labels.depth[i]);
    found.light += image.rgb[3 * i];
  }
  found.light /= found.pixels;
  return found;
}

// A surface of two sides may be wound either way; it is seen, and lit, from both.
TEST(Gltf, IsSeenFromOutsideInColourDepthAndIds) {
  const TemporaryFolder folder;
  const std::vector<Vec3> ball = ball_points(0.1);
  const Looked plain = looked_at(written(folder, "plain.glb", glb_of(ball, {})));
  EXPECT_NEAR(plain.nearest, 0.4, 0.002);
  EXPECT_GT(plain.pixels, 500);
  const std::string two_sides = R"("doubleSided":true,)";
  for (const auto& [name, bytes] :
       {std::pair{"mirrored.glb", glb_of(ball, {.node = R"("scale":[-1,1,1],)"})},
        {"two_sides.glb", glb_of(ball, {.material = two_sides})},
        {"wound_inwards.glb", glb_of(inside_out(ball), {.material = two_sides})},
        {"both.glb", glb_of(ball, {.node = kMirrored, .material = two_sides})}}) {
    const Looked seen = looked_at(written(folder, name, bytes));
    EXPECT_NEAR(seen.nearest, 0.4, 0.002) << name;
    EXPECT_NEAR(seen.pixels, plain.pixels, 2) << name;
    EXPECT_NEAR(seen.light, plain.light, 1.0) << name;
  }
}

TEST(Gltf, OfTwoSidesCollidesAsOneBody) {
  const TemporaryFolder folder;
  const auto volume = [&](const Wanted& wanted) {
    const auto path = written(folder, "hull.glb", glb_of(ball_points(0.1), wanted));
    return polyhedra_of(read_mesh_file(path), path, {}, 1).at(0).centre().norm();
  };
  EXPECT_LT(volume({.material = R"("doubleSided":true,)"}), 1e-6);
  EXPECT_LT(volume({.node = R"("scale":[1,-1,1],)"}), 1e-6);
}

TEST(Gltf, HasTheColourOfItsPointsTimesItsMaterials) {
  const TemporaryFolder folder;
  const auto path = written(
      folder, "colour.glb",
      glb_of(ball_points(0.1), {.colour = {0.5F, 0.25F, 1.0F}, .factor = {1.0F, 0.5F, 0.125F}}));
  const MeshData mesh = read(path);
  ASSERT_EQ(mesh.colours.size(), mesh.points.size());
  for (const Vec3& c : mesh.colours) EXPECT_LT((c - Vec3(0.5, 0.125, 0.125)).norm(), 1e-6);
}

TEST(Gltf, ThatRequiresWhatIsNotReadIsRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const Wanted& wanted) {
    const auto path = written(folder, "x.glb", glb_of(ball_points(0.1), wanted));
    return complaint([&] { read(path); });
  };
  EXPECT_THAT(refusal({.more = R"("extensionsRequired":["KHR_mesh_quantization"],)"}),
              HasSubstr("x.glb: it requires KHR_mesh_quantization, which headpin does not read"));
  EXPECT_THAT(refusal({.type = 5122}), HasSubstr("x.glb: POSITION of component type 5122"));
  EXPECT_EQ(refusal({.more = R"("extensionsUsed":["KHR_materials_unlit"],)"
                             R"("extensionsRequired":["KHR_materials_unlit"],)"}),
            "");
}

TEST(Gltf, SaysWhatOfItIsNotDrawn) {
  const TemporaryFolder folder;
  const std::string textures = R"("textures":[{},{}],)", blend = R"("alphaMode":"BLEND",)";
  const auto unseen = [&](const Wanted& wanted) {
    return read(written(folder, "x.glb", glb_of(ball_points(0.1), wanted))).unseen;
  };
  EXPECT_EQ(unseen({}), "");
  EXPECT_EQ(unseen({.material = R"("alphaMode":"OPAQUE",)"}), "");
  EXPECT_EQ(unseen({.more = textures}), "2 textures");
  EXPECT_EQ(unseen({.more = textures, .material = blend}), "2 textures, alpha");
  Scenario scenario;
  EXPECT_TRUE(not_drawn(scenario).empty());
  set(scenario,
      "ball.mesh.file='" +
          written(folder, "x.glb", glb_of(ball_points(0.1), {.material = blend})).string() + "'");
  EXPECT_THAT(not_drawn(scenario), testing::ElementsAre(HasSubstr("x.glb: not drawn: alpha")));
  const auto obj =
      written(folder, "x.obj", "mtllib x.mtl\nv 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  EXPECT_EQ(read(obj).unseen, "materials");
}

// Many programs leave the normals of an STL at 0.
TEST(StlFile, WithoutNormalsIsLitAsItsFacesLie) {
  const TemporaryFolder folder;
  std::string ascii = "solid ball\n", binary(80, ' ');
  const std::vector<Vec3> points = ball_points(0.1);
  append_number(binary, static_cast<std::uint32_t>(points.size() / 3));
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    ascii += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) append_number(binary, 0.0F);
    for (std::size_t k = i; k < i + 3; ++k) {
      ascii += fmt::format("vertex {} {} {}\n", points[k].x(), points[k].y(), points[k].z());
      for (int a = 0; a < 3; ++a) append_number(binary, static_cast<float>(points[k][a]));
    }
    ascii += "endloop\nendfacet\n";
    append_number(binary, std::uint16_t{0});
  }
  ascii += "endsolid ball\n";
  for (const auto& [name, bytes] : {std::pair{"ascii.stl", ascii}, {"binary.stl", binary}}) {
    const MeshData mesh = read(written(folder, name, bytes));
    ASSERT_EQ(mesh.triangles.size(), points.size()) << name;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      ASSERT_GT(mesh.normals[i].dot(mesh.points[i].normalized()), 0.95) << name;
    }
  }
}

TEST(SeenMesh, OfAnotherSizeThanWhatItStandsForOrOfNoAreaIsRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& bytes, const char* what, const char* name = "x.glb") {
    const auto path = written(folder, name, bytes);
    return complaint([&] {
      parse_scenario(fmt::format("[{}.mesh]\nfile = '{}'\n", what, path.string()), "x.toml");
    });
  };
  EXPECT_EQ(refusal(glb_of(ball_points(0.1085), {}), "ball"), "");
  EXPECT_THAT(
      refusal(glb_of(ball_points(108.5), {}), "ball"),
      HasSubstr("farthest point is 108.5 m from its origin, expected 0.05425 to 0.217; with "
                "unit = 0.001 it would be 0.109"));
  EXPECT_THAT(refusal(glb_of(ball_points(0.001), {}), "ball"),
              HasSubstr("set `unit` if the file has other units"));
  EXPECT_THAT(refusal(glb_of(ball_points(108.5), {}), "skittle"), HasSubstr("0.1905 to 0.762"));
  EXPECT_THAT(refusal(glb_of(ball_points(30.0), {}), "hand"), HasSubstr("0.05 to 1.5"));
  EXPECT_THAT(refusal(glb_of(ball_points(0.004), {}), "room"), HasSubstr("0.5 to 1000"));
  EXPECT_THAT(refusal("v 0 0 -0.1\nv 0 0 0\nv 0 0 0.1\nf 1 2 3\n", "ball", "x.obj"),
              HasSubstr("of no area"));
}

}  // namespace
}  // namespace headpin::scene
