#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

namespace headpin::render {
namespace {

const Quality kPlain{.samples = 2, .contact = false, .shadow = false, .mirror = false};

/// Head upright at a height, looking along +y.
Pose looking_ahead(const Vec3& p_W) {
  return {rotation(Vec3(std::numbers::pi / 2, 0, 0)), p_W};
}

Mesh glowing(Mesh mesh) {
  mesh.surface = Surface::baked;
  return mesh;
}

Mesh glowing_ball(double radius, const Vec3& colour) {
  return glowing(ellipsoid(radius, radius, 48, 32, [&](double) { return colour; }));
}

Renderer plain_renderer() {
  return Renderer(osmesa_context(), kPlain);
}

Image picture(Renderer& renderer, const DrawList& list, const View& view) {
  Image image;
  renderer.draw(list, {&view, 1}, {&image, 1});
  return image;
}

int pixel(const Image& image, int x, int y, int c = 0) {
  return image.rgb[static_cast<std::size_t>(3 * (y * image.width + x) + c)];
}

double light(int code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Middle of a white thing on black, weighted by its light [pixels].
Vec2 centroid(const Image& image) {
  Vec2 sum = Vec2::Zero();
  double weight = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double w = light(pixel(image, x, y));
      sum += w * Vec2(x + 0.5, y + 0.5);
      weight += w;
    }
  }
  return sum / weight;
}

/// Middle of the ellipse that a ball is projected to: extremes of the tangents to it.
Vec2 projected_middle(const View& view, const Vec3& p_W, double r) {
  const Vec3 p = view.X_WE.inverse() * p_W;
  const auto middle = [&](double across, double depth) {
    // Tangent lines from the eye in the plane (across, depth).
    const double far = depth * depth - r * r;
    return across * depth / far;
  };
  const Frustum& f = view.frustum;
  return {view.width * (middle(p.x(), -p.z()) - f.left) / (f.right - f.left),
          view.height * (f.top - middle(p.y(), -p.z())) / (f.top - f.bottom)};
}

struct BallScene {
  Renderer renderer = plain_renderer();
  DrawList list;
  double radius = 0.05;

  BallScene() {
    DrawItem item;
    item.mesh = renderer.add(glowing_ball(radius, Vec3::Ones()));
    item.id = 7;
    list.items.push_back(item);
  }
  void put(const Vec3& p_W) { list.items[0].X_WG.p = p_W; }
};

// render.md section 5 measured 0.029 px rms, 0.072 px at most with 2 x 2 samples; 1.5 times that.
TEST(Picture, OfABallIsWhereItsProjectionIsInBothEyes) {
  BallScene scene;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0, squares = 0.0;
  int count = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose X_WD{rotation(Vec3(unit(random), unit(random), unit(random))),
                    Vec3(unit(random), unit(random), unit(random))};
    Optics optics;
    optics.outward_deg = i % 2 == 0 ? 0.0 : 3.0;
    const double depth = 0.6 + 2.0 * (1.0 + unit(random));
    const Vec3 p_DB(0.5 * depth * unit(random), 0.25 * depth * unit(random), -depth);
    scene.put(X_WD * p_DB);
    for (const View& view : eyes(X_WD, optics)) {
      const Vec2 error = centroid(picture(scene.renderer, scene.list, view)) -
                         projected_middle(view, X_WD * p_DB, scene.radius);
      worst = std::max(worst, error.norm());
      squares += error.squaredNorm();
      ++count;
    }
  }
  EXPECT_LT(worst, 0.11);
  EXPECT_LT(std::sqrt(squares / count), 0.044);
}

// Disparity fx b / Z with fx = 234.58 px, b = 64 mm; the left eye sees things farther right. The
// ball always has the 6 px for which render.md measured errors up to 0.074 px; 1.5 times that.
TEST(Picture, OfABallIsDisplacedBetweenTheEyesByFocalLengthTimesEyeDistanceOverDepth) {
  BallScene scene;
  for (const double depth : {0.6, 1.0, 2.0, 4.0, 8.0}) {
    scene.put({0.1, depth, 1.55});
    scene.list.items[0].scale = Vec3::Constant(0.5 * depth);
    std::array<Image, 2> images;
    scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), {}), images);
    const Vec2 left = centroid(images[0]), right = centroid(images[1]);
    const double r = 0.5 * depth * scene.radius;
    const double expected = 234.58 * 0.064 * depth / (depth * depth - r * r);
    EXPECT_NEAR(left.x() - right.x(), expected, 0.11) << depth;
    EXPECT_NEAR(left.y(), right.y(), 0.11) << depth;
  }
}

/// Where rays through the middle of a ball in both pictures come nearest to each other, given what
/// the eyes are taken to be; the middle of its picture is a little outside that of the ball.
Vec3 triangulated(const std::array<View, 2>& views, const std::array<Image, 2>& images, double r) {
  std::array<Vec3, 2> p, d;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const View& v = views[eye];
    const Vec2 at = centroid(images[eye]);
    p[eye] = v.X_WE.p;
    d[eye] = v.X_WE.q * Vec3(v.frustum.left + (v.frustum.right - v.frustum.left) * at.x() / v.width,
                             v.frustum.top - (v.frustum.top - v.frustum.bottom) * at.y() / v.height,
                             -1.0);
  }
  const Vec3 between = p[1] - p[0];
  const double a = d[0].dot(d[0]), b = d[0].dot(d[1]), c = d[1].dot(d[1]);
  const double s = (c * d[0].dot(between) - b * d[1].dot(between)) / (a * c - b * b);
  return p[0] + (s + r * r / s) * d[0];  // s is the depth
}

/// How far off the triangulated depth of a ball of 0.1085 m is on its way from 1 to 5 m, as shares.
struct DepthError {
  double rms = 0.0, most = 0.0;
};
template <typename Change>
DepthError depth_error(const Change& change) {
  BallScene scene;
  scene.list.items[0].scale = Vec3::Constant(0.1085 / scene.radius);
  const Pose X_WD{rotation(Vec3(0.0, 0.0, 0.05)) * looking_ahead({0, 0, 1.6}).q, Vec3(0, 0, 1.6)};
  DepthError error;
  constexpr int kPlaces = 41;
  for (int i = 0; i < kPlaces; ++i) {
    const double depth = 1.0 + 0.1 * i;
    const Vec3 p_DB(0.15 - 0.02 * depth, -0.1 * depth, -depth);
    scene.put(X_WD * p_DB);
    std::array<View, 2> views = eyes(X_WD, {});
    std::array<Image, 2> images;
    scene.renderer.draw(scene.list, views, images);
    change(views, images);
    const double off = -(X_WD.inverse() * triangulated(views, images, 0.1085)).z() / depth - 1.0;
    error.rms += off * off / kPlaces;
    error.most = std::max(error.most, std::abs(off));
  }
  error.rms = std::sqrt(error.rms);
  return error;
}

// 1 % rms, 2 % at most; what is wrong with the eyes is found out.
TEST(Picture, OfABallTellsWhereItIsFrom1To5Metres) {
  const DepthError error = depth_error([](auto&, auto&) {});
  EXPECT_LT(error.rms, 0.01);
  EXPECT_LT(error.most, 0.02);
  EXPECT_GT(depth_error([](auto&, auto& images) { std::swap(images[0], images[1]); }).rms, 0.5);
  EXPECT_GT(depth_error([](auto& views, auto&) {  // half the eye distance
              const Vec3 middle = 0.5 * (views[0].X_WE.p + views[1].X_WE.p);
              for (View& v : views) v.X_WE.p = 0.5 * (v.X_WE.p + middle);
            })
                .rms,
            0.3);
  EXPECT_GT(depth_error([](auto& views, auto&) {  // one eye rolled: a head that is not
              views[1].X_WE.q = views[1].X_WE.q * rotation(Vec3(0.0, 0.0, 0.1));
            })
                .rms,
            0.02);
}

TEST(Picture, IsTheSameForBothEyesWithoutEyeDistance) {
  BallScene scene;
  scene.put({0.1, 1.0, 1.6});
  Optics optics;
  optics.eye_distance = 0.0;
  std::array<Image, 2> images;
  scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), optics), images);
  EXPECT_EQ(images[0], images[1]);
  optics.eye_distance = 0.064;
  scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), optics), images);
  EXPECT_NE(images[0], images[1]);
}

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

/// A lamp-lit ball over a polished floor: every pass has something to do.
struct LitScene {
  Renderer renderer;
  DrawList list;

  /// @param faces  of the floor, along and across; of one it is one part (mesh_parts.h)
  explicit LitScene(Quality quality = {}, double gloss = 0.2, int faces = 1)
      : renderer(osmesa_context(), quality) {
    Mesh floor;
    floor.surface = Surface::floor;
    floor.gloss = gloss;
    for (int i = 0; i < faces; ++i) {
      for (int j = 0; j < faces; ++j) {
        const auto corner = [&](int across, int along) {
          return Vec3(-2.0 + 4.0 * across / faces, -1.0 + 7.0 * along / faces, 0.0);
        };
        append_face(floor, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1),
                    Vec3::Constant(0.4));
      }
    }
    DrawItem item;
    item.mesh = renderer.add(floor);
    item.id = 1;
    list.items.push_back(item);
    item.mesh = renderer.add(ellipsoid(0.1, 0.1, 32, 20, [](double) { return Vec3::Ones(); }));
    item.id = 2;
    item.casts_shadow = true;
    item.mirrored = true;
    list.items.push_back(item);
    list.lamps = {{{0, 2, 2.5}, Vec3::Constant(2.0)}};
    list.patches = {{{-2, -1, 0}, {4, 0, 0}, {0, 7, 0}}};
    list.shadow = {Vec3(0.5, 0.0, 1.0).normalized(), {-2, -1, 0}, {2, 6, 1}, 0.5};
    put({0.0, 2.0, 0.1});
  }
  void put(const Vec3& p_W) {
    list.items[1].X_WG.p = p_W;
    list.occluders = {{p_W, 0.1}};
  }
  std::array<Image, 2> pair() {
    std::array<Image, 2> images;
    const Pose X_WD{rotation(Vec3(std::numbers::pi / 2 - 0.5, 0, 0)), Vec3(0, 0, 1.2)};
    renderer.draw(list, eyes(X_WD, {}), images);
    return images;
  }
};

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

TEST(Picture, OfALookThatMirrorsIsTheSameWhereNothingIsPolished) {
  LitScene without({.samples = 1, .mirror = false}, 0.0), with({.samples = 1}, 0.0);
  EXPECT_EQ(without.pair(), with.pair());
}

TEST(Picture, LitAtVerticesShowsTheSameBallAlikeBright) {
  const Quality pixel{.samples = 1, .contact = false, .shadow = false, .mirror = false};
  Quality vertex = pixel;
  vertex.light = "vertex";
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

TEST(Look, IsKnownByNameAndAnUnknownLightIsRefused) {
  EXPECT_EQ(looks()[0].name, "standard");
  for (const Look& look : looks()) EXPECT_NO_THROW(LitScene(look.quality).pair()) << look.name;
  EXPECT_THROW(LitScene({.light = "candle"}), std::invalid_argument);
}

TEST(ContactShadow, IsDarkUnderABallOnTheFloorAndGoneUnderAHighOne) {
  const Quality contact{.samples = 2, .contact = true, .shadow = false, .mirror = false};
  LitScene with(contact), without(kPlain);
  const auto darkest = [&](double height) {
    double least = 1.0;
    with.put({0.0, 2.0, height});
    without.put({0.0, 2.0, height});
    const Image a = with.pair()[0], b = without.pair()[0];
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 360; ++x) {
        if (pixel(b, x, y) > 0) {
          least = std::min(least, light(pixel(a, x, y)) / light(pixel(b, x, y)));
        }
      }
    }
    return least;
  };
  EXPECT_LT(darkest(0.1), 0.6);
  EXPECT_GT(darkest(0.3), darkest(0.1) + 0.2);
  EXPECT_GT(darkest(1.0), 0.98);  // (0.1 / 1.0)^2 is below what is drawn
}

// Light from 26.6 degrees (tan = 0.5) beside the zenith: the shadow of a ball at height h lies
// h / 2 farther from the light.
TEST(CastShadow, LiesWhereTheLightThrowsIt) {
  LitScene with({.samples = 2, .contact = false, .shadow = true, .mirror = false});
  LitScene without(kPlain);
  const View above{{Quat::Identity(), Vec3(0.0, 2.0, 3.0)}, {-0.5, 0.5, -0.5, 0.5}, 200, 200};
  for (const double height : {0.3, 0.8}) {
    with.put({0.3, 2.0, height});
    without.put({0.3, 2.0, height});
    const Image a = picture(with.renderer, with.list, above);
    const Image b = picture(without.renderer, without.list, above);
    double sum = 0.0, count = 0.0;
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        if (pixel(a, x, y) + 20 < pixel(b, x, y)) {
          sum += x + 0.5;
          count += 1.0;
        }
      }
    }
    ASSERT_GT(count, 50.0);
    // 3 m below the eye a pixel is 15 mm. The ball hides part of its shadow: a pixel or two.
    const double x_W = (sum / count - 100.0) * 0.015;
    EXPECT_NEAR(x_W, 0.3 - 0.5 * height, 0.035) << height;
  }
}

// Shadows are looked up only in those parts of a floor on which one may fall.
TEST(CastShadow, IsWholeHoweverTheFloorIsParted) {
  const View above{{Quat::Identity(), Vec3(0.0, 2.0, 3.0)}, {-0.5, 0.5, -0.5, 0.5}, 200, 200};
  for (const Look& look : looks()) {
    LitScene whole(look.quality), parted(look.quality, 0.2, 14);
    // Parts end at whole metres: shadows that lie in one, and that reach two centimetres into others.
    for (const Vec3& p : {Vec3(0.3, 2.4, 0.1), Vec3(0.28, 2.08, 0.4), Vec3(0.32, 1.92, 0.8)}) {
      whole.put(p);
      parted.put(p);
      const Image a = picture(whole.renderer, whole.list, above);
      const Image b = picture(parted.renderer, parted.list, above);
      int most = 0;
      for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        most = std::max(most, std::abs(int{a.rgb[i]} - int{b.rgb[i]}));
      }
      EXPECT_LE(most, 1) << look.name << ", ball at " << p.transpose();
    }
  }
}

// Light from 26.6 degrees beside the zenith: a ball 0.4 m above another and 0.2 m to the light's side
// is between it and the light. Taken away, or put to the other side, it shades nothing.
TEST(CastShadow, FallsOnABodyBehindAnother) {
  const View above{
      {rotation(Vec3(0.9, 0.0, 0.0)), Vec3(0.0, 0.8, 1.5)}, {-0.5, 0.5, -0.5, 0.5}, 200, 200};
  const auto light_of = [&](const Quality& quality, std::optional<Vec3> other) {
    LitScene scene(quality);
    scene.put({0.0, 2.0, 0.1});
    if (other) {
      DrawItem item = scene.list.items[1];
      item.X_WG.p = *other;
      item.id = 3;
      scene.list.items.push_back(item);
    }
    const Image image = picture(scene.renderer, scene.list, above);
    const Labels labels = scene.renderer.labels(scene.list, above);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < labels.id.size(); ++i) {
      if (labels.id[i] != 2) continue;
      sum += light(image.rgb[3 * i]);
      count += 1.0;
    }
    EXPECT_GT(count, 100.0);
    return sum / count;
  };
  const Vec3 between(0.2, 2.0, 0.5), beside(-0.2, 2.0, 0.5);
  for (const Look& look : looks()) {
    const double alone = light_of(look.quality, {});
    EXPECT_NEAR(light_of(look.quality, beside) / alone, 1.0, 0.03) << look.name;
    const double shaded = light_of(look.quality, between) / alone;
    if (look.quality.shadow) {
      EXPECT_LT(shaded, 0.75) << look.name;  // the light's share is a half
      EXPECT_GT(shaded, 0.45) << look.name;
    } else {
      EXPECT_NEAR(shaded, 1.0, 0.03) << look.name;
    }
  }
}

// A ball does not shade its own lit side.
TEST(CastShadow, LeavesALoneBodyAsItWas) {
  LitScene with({.samples = 2, .contact = false, .shadow = true, .mirror = false});
  LitScene without(kPlain);
  for (LitScene* scene : {&with, &without}) {  // texels of 6 mm, as in the paper's room
    scene->list.shadow.lo_W = Vec3(-0.75, -1.0, 0.0);
    scene->list.shadow.hi_W = Vec3(0.75, 6.0, 1.0);
  }
  const View above{{Quat::Identity(), Vec3(0.0, 2.0, 2.0)}, {-0.2, 0.2, -0.2, 0.2}, 200, 200};
  const Image a = picture(with.renderer, with.list, above);
  const Image b = picture(without.renderer, without.list, above);
  const Labels labels = with.renderer.labels(with.list, above);
  int compared = 0;
  for (std::size_t i = 0; i < labels.id.size(); ++i) {
    if (labels.id[i] != 2 || labels.depth[i] > 1.86F) continue;  // not its rim
    EXPECT_NEAR(int{a.rgb[3 * i]}, int{b.rgb[3 * i]}, 6);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

// The image of a ball at height h in a floor at 0 is a ball at height -h.
TEST(MirrorImage, IsAsFarBelowTheFloorAsTheBallIsAboveIt) {
  LitScene with({.samples = 2, .contact = false, .shadow = false, .mirror = true});
  LitScene without({.samples = 2, .contact = false, .shadow = false, .mirror = false});
  for (LitScene* scene : {&with, &without}) {
    scene->list.items[1].tint = Vec3(1.0, 0.0, 0.0);
    scene->list.lamps.clear();
    scene->list.sky = scene->list.ground = Vec3::Ones();  // evenly lit
  }
  const View view = eyes(looking_ahead({0, 0, 0.5}), {})[0];
  for (const double height : {0.2, 0.35}) {
    const Vec3 p_W(0.05, 3.5, height);
    with.put(p_W);
    without.put(p_W);
    const Image a = picture(with.renderer, with.list, view);
    const Image b = picture(without.renderer, without.list, view);
    Vec2 sum = Vec2::Zero();
    double weight = 0.0;
    for (int y = 120; y < 240; ++y) {
      for (int x = 0; x < 360; ++x) {
        // Red that is there only with the mirror.
        const double red = light(pixel(a, x, y, 0)) - light(pixel(a, x, y, 1)) -
                           (light(pixel(b, x, y, 0)) - light(pixel(b, x, y, 1)));
        if (red < 0.02) continue;
        sum += red * Vec2(x + 0.5, y + 0.5);
        weight += red;
      }
    }
    ASSERT_GT(weight, 1.0) << height;
    const Vec2 expected = projected_middle(view, {p_W.x(), p_W.y(), -height}, 0.1);
    // The floor mirrors more at a flatter angle, so the far edge weighs a little more.
    EXPECT_LT((sum / weight - expected).norm(), 0.6) << height;
  }
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
