#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/finer_part.h"
#include "render/osmesa_context.h"
#include "tests/render/drawn_scenes.h"

namespace headpin::render {
namespace {

using test::BallScene;
using test::centroid;
using test::glowing;
using test::LitScene;
using test::looking_ahead;
using test::picture;
using test::pixel;
using test::plain_renderer;

TEST(Picture, ShowsColoursAsTheyAreGivenAndTheBackgroundWhereNothingIs) {
  Renderer renderer = plain_renderer();
  DrawList list;
  DrawItem item;
  item.mesh = renderer.add(glowing(box({1.0, 0.1, 0.1}, srgb(0x4080c0))));
  item.X_WG.p = {0.0, 2.0, 1.6};
  list.items.push_back(item);
  list.background = srgb(0x203040);
  const View view = eyes(looking_ahead({0, 0, 1.6}), {})[0];
  const Image image = picture(renderer, list, view);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(pixel(image, 180, 120, c), 0x40 * (c + 1), 1);
    EXPECT_NEAR(pixel(image, 5, 5, c), 0x10 * (c + 2), 1);
  }
}

TEST(Picture, HasTheUpperHalfOfTheWorldInItsUpperHalf) {
  BallScene scene;
  scene.put({0.0, 2.0, 2.0});
  const Image image = picture(scene.renderer, scene.list, eyes(looking_ahead({0, 0, 1.6}), {})[0]);
  EXPECT_LT(centroid(image).y(), 100.0);
}

// A wall that hides the left half of a pixel column: three of its five samples, one on the edge.
TEST(Picture, AveragesLightNotCodesAtAnEdge) {
  Renderer renderer = plain_renderer();
  DrawList list;
  DrawItem item;
  item.mesh = renderer.add(glowing(box({2.0, 0.01, 4.0}, Vec3::Ones())));
  View view = eyes(looking_ahead({0, 0, 0}), {})[0];
  view.X_WE.p = Vec3::Zero();
  const double depth = 1.0;
  // Its left edge goes through the middle of the pixel column that begins at the centre.
  const double pixel_width = (view.frustum.right - view.frustum.left) / view.width;
  item.X_WG.p = {1.0 + 0.5 * pixel_width * depth, depth + 0.005, 0.0};
  list.items.push_back(item);
  const Image image = picture(renderer, list, view);
  EXPECT_EQ(pixel(image, 179, 120), 0);
  EXPECT_EQ(pixel(image, 180, 120), 203);  // code of 0.6 of the light, of which 0.5 is 188
  EXPECT_EQ(pixel(image, 181, 120), 255);
}

/// How many different codes a white thing's edge has where it crosses a column (or a row) of pixels
/// as slowly as a fortieth of a pixel each.
int levels_along(bool level) {
  Renderer renderer = plain_renderer();
  DrawList list;
  DrawItem item;
  item.mesh = renderer.add(glowing(box({8.0, 0.01, 8.0}, Vec3::Ones())));
  View view = eyes(looking_ahead({0, 0, 0}), {})[0];
  view.X_WE.p = Vec3::Zero();
  const Frustum& f = view.frustum;
  const double pixel_x = (f.right - f.left) / view.width;
  const double pixel_y = (f.top - f.bottom) / view.height;
  const double slope = level ? pixel_y / pixel_x / 40.0 : pixel_x / pixel_y / 40.0;
  const Quat turned = rotation(Vec3(0.0, level ? -slope : slope, 0.0));
  const Vec3 outward = level ? Vec3(turned * Vec3::UnitZ()) : Vec3(turned * Vec3::UnitX());
  item.X_WG = {turned, Vec3(0.0, 1.0, 0.0) - 4.0 * outward};
  list.items.push_back(item);
  const Image image = picture(renderer, list, view);
  std::vector<bool> seen(256);
  for (int i = 40; i < 200; ++i) {
    for (int across = 110; across < 131; ++across) {
      seen[static_cast<std::size_t>(level ? pixel(image, i + 80, across)
                                          : pixel(image, across + 60, i))] = true;
    }
  }
  return static_cast<int>(std::ranges::count(seen, true));
}

// Black, white, and eight shades between them, as five samples in the pixel and four beside it are
// passed one after another; of a grid along the pixels there is one.
TEST(Picture, HasEightShadesOnEdgesThatAreNearlyLevelOrUpright) {
  EXPECT_EQ(levels_along(true), 10);
  EXPECT_EQ(levels_along(false), 10);
}

TEST(Picture, HidesWhatLiesBehindInWhateverOrderItIsListed) {
  BallScene scene;
  DrawItem wall;
  wall.mesh = scene.renderer.add(glowing(box({4.0, 0.1, 4.0}, srgb(0x808080))));
  wall.X_WG.p = {0, 1.5, 1.6};
  scene.put({0.0, 2.0, 1.6});
  scene.list.items.push_back(wall);
  const View view = eyes(looking_ahead({0, 0, 1.6}), {})[0];
  const Image after = picture(scene.renderer, scene.list, view);
  std::swap(scene.list.items[0], scene.list.items[1]);
  const Image before = picture(scene.renderer, scene.list, view);
  EXPECT_EQ(before, after);
  EXPECT_NEAR(pixel(before, 180, 120), 0x80, 1);
}

TEST(Picture, DrawnAloneIsTheOneDrawnInASequenceByAnyContextAndInAnyThread) {
  const auto position = [](int i) { return Vec3(0.05 * i - 0.3, 1.5 + 0.1 * i, 0.1); };
  LitScene scene;
  std::vector<std::array<Image, 2>> sequence;
  for (int i = 0; i < 8; ++i) {
    scene.put(position(i));
    sequence.push_back(scene.pair());
    scene.renderer.labels(scene.list, {});  // must leave no trace
  }
  EXPECT_NE(sequence[4], sequence[5]);
  LitScene alone;
  alone.put(position(5));
  EXPECT_EQ(alone.pair(), sequence[5]);
  std::array<Image, 2> elsewhere;
  std::thread([&] {
    LitScene other;
    other.put(position(5));
    elsewhere = other.pair();
  }).join();
  EXPECT_EQ(elsewhere, sequence[5]);
  EXPECT_EQ(alone.pair(), sequence[5]);
}

// The part that is drawn again lies where it belongs, polish, shadows and all: it is that of a picture
// of 65 samples, which the rest is not.
TEST(Picture, OfSomethingSmallIsDrawnFinerThereAndOnlyThere) {
  const auto small_ball = [](int samples) {
    LitScene scene({.samples = samples}, 0.3);
    scene.list.items[1].X_WG.p = Vec3(0.3, 5.6, 0.1);
    scene.list.items[1].scale = Vec3::Constant(0.6);
    return scene;
  };
  LitScene five = small_ball(2), sixty_five = small_ball(8);
  const auto shown = five.pair(), best = sixty_five.pair();
  const auto eye_views =
      eyes({rotation(Vec3(std::numbers::pi / 2 - 0.5, 0, 0)), Vec3(0, 0, 1.2)}, {});
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Labels labels = five.renderer.labels(five.list, eye_views[eye]);
    int of_ball = 0, there = 0, elsewhere = 0;
    for (std::size_t i = 0; i < shown[eye].rgb.size(); ++i) {
      const bool is_ball = labels.id[i / 3] == 2;
      const int off = std::abs(int{shown[eye].rgb[i]} - int{best[eye].rgb[i]});
      of_ball += is_ball ? 1 : 0;
      (is_ball ? there : elsewhere) = std::max(is_ball ? there : elsewhere, off);
    }
    EXPECT_GT(of_ball, 3 * 20);
    EXPECT_LE(there, 2);
    EXPECT_GT(elsewhere, 10);
  }
}

// Small things at both ends of a wide picture: a grid of 65 samples a pixel would be 40000 wide.
TEST(Picture, OfSmallThingsFarApartIsDrawnAsFineAsOpenGlCan) {
  BallScene scene;
  scene.list.items[0].casts_shadow = true;
  scene.list.items[0].scale = Vec3::Constant(0.1);
  scene.list.items.push_back(scene.list.items[0]);
  View view = eyes(looking_ahead({0, 0, 0}), {})[0];
  view.X_WE.p = Vec3::Zero();
  view.width = 5400;
  const double aside = 0.7, ahead = 4.0, pixel_width = 2.0 * view.frustum.right / view.width;
  scene.list.items[0].X_WG.p = {-aside * ahead, ahead, 0.0};
  scene.list.items[1].X_WG.p = {aside * ahead, ahead, 0.0};
  const Image image = picture(scene.renderer, scene.list, view);
  const int off = static_cast<int>(aside / pixel_width);
  EXPECT_GT(pixel(image, 2700 - off, 119) + pixel(image, 2700 - off, 120), 100);
  EXPECT_GT(pixel(image, 2700 + off, 119) + pixel(image, 2700 + off, 120), 100);
}

TEST(FinerGrid, IsTheFinestOfAQuarterOfTheSamplesWhoseSidesFit) {
  const View view{.X_WE = {}, .frustum = {-1, 1, -1, 1}, .width = 5450, .height = 240};
  const PixelRect part{0, 0, 5000, 8};
  const auto n = [&](int largest) {
    const auto finer = finer_grid(SampleGrid{2}, view, part, largest);
    return finer ? finer->n : 0;
  };
  EXPECT_EQ(n(1 << 20), 6);  // 37 samples of 40000 pixels; a quarter of the view's is 1635000
  EXPECT_EQ(n(30008), 6);    // 6 * 5000 + 8
  EXPECT_EQ(n(30007), 5);
  EXPECT_EQ(n(16384), 3);
  EXPECT_EQ(n(15000), 0);
}

TEST(Picture, OfALookThatMirrorsIsTheSameWhereNothingIsPolished) {
  LitScene without({.samples = 1, .mirror = false}, 0.0), with({.samples = 1}, 0.0);
  EXPECT_EQ(without.pair(), with.pair());
}

TEST(Picture, LitAtVerticesShowsTheSameBallAlikeBright) {
  const Quality pixel{.samples = 1, .contact = false, .shadow = false, .mirror = false};
  Quality vertex = pixel;
  vertex.light = LightPer::vertex;
  LitScene a(pixel), b(vertex);
  const Image by_pixel = a.pair()[0], by_vertex = b.pair()[0];
  EXPECT_NE(by_pixel, by_vertex);
  const Labels labels = a.renderer.labels(
      a.list, eyes({rotation(Vec3(std::numbers::pi / 2 - 0.5, 0, 0)), Vec3(0, 0, 1.2)}, {})[0]);
  double of_pixel = 0.0, of_vertex = 0.0;
  for (std::size_t i = 0; i < labels.id.size(); ++i) {
    if (labels.id[i] != 2) continue;
    of_pixel += by_pixel.rgb[3 * i];
    of_vertex += by_vertex.rgb[3 * i];
  }
  EXPECT_GT(of_pixel, 0.0);
  EXPECT_NEAR(of_vertex / of_pixel, 1.0, 0.02);
}

TEST(Picture, OfNoViewsIsNone) {
  LitScene scene;
  EXPECT_NO_THROW(scene.renderer.draw(scene.list, {}, {}));
}

TEST(Look, IsKnownByName) {
  EXPECT_EQ(looks()[0].name, "standard");
  for (const Look& look : looks()) EXPECT_NO_THROW(LitScene(look.quality).pair()) << look.name;
}

TEST(Labels, NameTheItemAndTheDepthOfEachPixel) {
  BallScene scene;
  scene.put({0.0, 2.0, 1.6});
  View view = eyes(looking_ahead({0, 0, 1.6}), {})[0];
  view.X_WE.p = Vec3(0, 0, 1.6);
  const Labels labels = scene.renderer.labels(scene.list, view);
  ASSERT_EQ(labels.id.size(), 360u * 240u);
  const std::size_t middle = 360 * 120 + 180;
  EXPECT_EQ(labels.id[middle], 7u);
  EXPECT_NEAR(labels.depth[middle], 1.95, 0.001);  // nearest point of the ball
  EXPECT_EQ(labels.id[0], 0u);
  EXPECT_EQ(labels.depth[0], std::numeric_limits<float>::infinity());
  // The pixels it covers: an ellipse of half axes f r / sqrt(Z^2 - r^2) each way.
  const double expected =
      std::numbers::pi * 234.58 * 329.70 * 0.05 * 0.05 / (2.0 * 2.0 - 0.05 * 0.05);
  const auto count = std::count(labels.id.begin(), labels.id.end(), 7u);
  EXPECT_NEAR(static_cast<double>(count), expected, 0.05 * expected);
}

// Both eyes see the near mesh, here upright, or both the far one, here lying: labels are of the same
// one, though an item beside the head is nearer to one eye. It changes between 0.63 and 0.65 m.
TEST(Labels, AreOfTheMeshThatThePicturesShow) {
  Renderer renderer = plain_renderer();
  DrawItem item;
  item.mesh = renderer.add(glowing(box(Vec3(0.02, 0.02, 0.1), Vec3::Ones())));
  item.far_mesh = renderer.add(glowing(box(Vec3(0.1, 0.02, 0.02), Vec3::Ones())));
  item.id = 7;
  DrawList list;
  int near = 0, far = 0;
  const auto both = eyes(looking_ahead({0, 0, 1.6}), {});
  for (double away = 0.6; away < 0.68; away += 0.004) {
    item.X_WG.p = Vec3(0.5 * away, away, 1.6);
    list.items = {item};
    std::array<Image, 2> images;
    renderer.draw(list, both, images);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Labels labels = renderer.labels(list, both[eye], both);
      int differ = 0;  // pixels, but for those at an edge
      for (int i = 0; i < 360 * 240; ++i) {
        const int code = pixel(images[eye], i % 360, i / 360);
        const bool is_seen = labels.id[static_cast<std::size_t>(i)] == 7;
        if (is_seen ? code < 5 : code > 250) ++differ;
      }
      EXPECT_LT(differ, 20) << away << ", eye " << eye;
    }
    bool upright = false;
    for (int x = 0; x < 360; ++x) upright |= pixel(images[0], x, 105) > 250;
    ++(upright ? near : far);
  }
  EXPECT_GT(near, 3);
  EXPECT_GT(far, 3);
}

TEST(Labels, HaveRowsFromTheTop) {
  BallScene scene;
  scene.put({0.0, 2.0, 2.0});
  const Labels labels = scene.renderer.labels(scene.list, eyes(looking_ahead({0, 0, 1.6}), {})[0]);
  const auto first = std::find(labels.id.begin(), labels.id.end(), 7u);
  ASSERT_NE(first, labels.id.end());
  EXPECT_LT((first - labels.id.begin()) / 360, 120);
}

TEST(Renderer, RefusesWhatItCannotDraw) {
  BallScene scene;
  const View good = eyes(looking_ahead({0, 0, 1.6}), {})[0];
  View view = good;
  view.width = 0;
  EXPECT_THROW(picture(scene.renderer, scene.list, view), std::invalid_argument);
  view.width = 1 << 20;
  EXPECT_THROW(picture(scene.renderer, scene.list, view), std::invalid_argument);
  std::array<Image, 1> one;
  EXPECT_THROW(scene.renderer.draw(scene.list, eyes({}, {}), one), std::invalid_argument);
  scene.list.items[0].mesh = 1;
  EXPECT_THROW(picture(scene.renderer, scene.list, good), std::invalid_argument);
  scene.list.items[0].mesh = 0;
  scene.list.lamps.resize(9);
  EXPECT_THROW(picture(scene.renderer, scene.list, good), std::invalid_argument);
  scene.list.lamps.clear();
  EXPECT_NO_THROW(picture(scene.renderer, scene.list, good));
  Mesh broken;
  broken.indices = {0, 1, 2};
  EXPECT_THROW(scene.renderer.add(broken), std::invalid_argument);
  EXPECT_THROW(Renderer(osmesa_context(), {.samples = 0}), std::invalid_argument);
}

TEST(Renderer, SaysHowManySamplesLimitASize) {
  const auto said = [](int samples) -> std::string {
    Renderer renderer(osmesa_context(), {.samples = samples});
    View view = eyes({}, {})[0];
    view.width = 1 << 20;
    try {
      picture(renderer, {}, view);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(said(1),
              testing::StartsWith("view: 1048576x240 pixels with 1 sample each, expected"));
  EXPECT_THAT(said(2), testing::HasSubstr(" with 5 samples each, expected 1 to "));
  EXPECT_THAT(said(2), testing::HasSubstr("hmd.width, hmd.height"));
  EXPECT_THAT(said(2), testing::HasSubstr("look.samples"));
}

TEST(OsMesa, TellsWhoDraws) {
  Renderer renderer = plain_renderer();
  EXPECT_NE(renderer.description().find("OSMesa, "), std::string::npos);
  EXPECT_NE(renderer.description().find("OpenGL "), std::string::npos);
}

TEST(OsMesa, RefusesAnEnvironmentThatWouldCrashIt) {
  setenv("GALLIUM_DRIVER", "swrast", 1);
  EXPECT_THROW(osmesa_context(), std::runtime_error);
  unsetenv("GALLIUM_DRIVER");
  setenv("LP_NATIVE_VECTOR_WIDTH", "512", 1);
  EXPECT_THROW(osmesa_context(), std::runtime_error);
  setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);
  EXPECT_NO_THROW(osmesa_context());
}

TEST(OsMesa, MakesAndDropsManyContexts) {
  const auto first = LitScene().pair();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(LitScene().pair(), first);
}

}  // namespace
}  // namespace headpin::render
