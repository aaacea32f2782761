#include "render/display.h"

#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace headpin::render {
namespace {

Image noise(int width, int height) {
  std::mt19937 random(3);
  Image image{width, height,
              std::vector<std::uint8_t>(std::size_t{3} * static_cast<std::size_t>(width) *
                                        static_cast<std::size_t>(height))};
  for (std::uint8_t& byte : image.rgb) byte = static_cast<std::uint8_t>(random() % 256);
  return image;
}

/// Mean light of a picture's red, 0..1.
double mean_light(const Image& image) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) sum += light_of_codes()[image.rgb[i]];
  return sum / kFullLight / (static_cast<double>(image.rgb.size()) / 3.0);
}

// The law of an area filter: no light is lost, whatever the ratio. A code is half a step off at most,
// which noise averages out.
TEST(AreaFilter, KeepsTheLight) {
  const Image from = noise(704, 480);
  for (const auto& [width, height] :
       {std::pair{360, 240}, std::pair{352, 240}, std::pair{100, 99}}) {
    EXPECT_NEAR(mean_light(area_filtered(from, width, height)), mean_light(from), 2e-4) << width;
  }
}

TEST(AreaFilter, GivesEachPixelTheLightOfTheAreaItCovers) {
  Image from{5, 1, std::vector<std::uint8_t>(15, 0)};
  from.rgb[3 * 2] = 255;  // the middle one, half in each of two
  const Image two = area_filtered(from, 2, 1);
  EXPECT_EQ(two.rgb[0], two.rgb[3]);
  EXPECT_NEAR(light_of_codes()[two.rgb[0]], 0.2 * kFullLight, 0.01 * kFullLight);
  // A whole ratio is the mean of whole pixels; the picture's own size is the picture.
  const Image image = noise(8, 4);
  const Image half = area_filtered(image, 4, 2);
  const auto light = [&](std::size_t i) { return double{1} * light_of_codes()[image.rgb[i]]; };
  const double mean = (light(0) + light(3) + light(24) + light(27)) / 4.0;
  EXPECT_EQ(half.rgb[0], codes_of_light()[static_cast<std::size_t>(std::lround(mean))]);
  EXPECT_EQ(area_filtered(image, 8, 4), image);
}

Optics with_lens() {
  Optics optics;
  optics.horizontal_fov_deg = 75.3;
  optics.vertical_fov_deg = 58.4;
  optics.lens_k1 = 0.32;
  optics.lens_k2 = 0.05;
  return optics;
}

/// A drawn picture with one bright pixel in a direction (tangents), else black.
Image point_at(const View& drawn, const Vec2& t) {
  const Frustum& f = drawn.frustum;
  Image image{drawn.width, drawn.height,
              std::vector<std::uint8_t>(std::size_t{3} * static_cast<std::size_t>(drawn.width) *
                                        static_cast<std::size_t>(drawn.height))};
  const int x = static_cast<int>(drawn.width * (t.x() - f.left) / (f.right - f.left));
  const int y = static_cast<int>(drawn.height * (f.top - t.y()) / (f.top - f.bottom));
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const int at = (y + j) * drawn.width + x + i;
      for (int c = 0; c < 3; ++c) image.rgb[static_cast<std::size_t>(3 * at + c)] = 255;
    }
  }
  return image;
}

Vec2 middle_of_light(const Image& image) {
  Vec2 sum = Vec2::Zero();
  double all = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double light =
          light_of_codes()[image.rgb[static_cast<std::size_t>(3 * (y * image.width + x))]];
      sum += light * Vec2(x + 0.5, y + 0.5);
      all += light;
    }
  }
  return sum / all;
}

// What is drawn in a direction comes to the place on the display that the lens shows there.
TEST(Lens, PutsEveryDirectionWhereItIsSeen) {
  const Optics optics = with_lens();
  const View shown = eyes({}, optics)[0], drawn = drawn_view(shown, optics);
  const double T = shown.frustum.right, k1 = optics.lens_k1, k2 = optics.lens_k2;
  for (const Vec2& s : {Vec2(0.0, 0.0), Vec2(0.5, 0.2), Vec2(-0.7, 0.4), Vec2(0.85, -0.5)}) {
    const double r2 = s.squaredNorm();
    const Vec2 t = T * (1.0 + k1 * r2 + k2 * r2 * r2) / (1.0 + k1 + k2) * s;
    const Vec2 at = middle_of_light(on_display(point_at(drawn, t), shown, optics));
    // s runs from -1 to 1 across, with as much a pixel down as the upper edge has.
    EXPECT_NEAR(at.x(), 0.5 * shown.width * (1.0 + s.x()), 1.0) << s.transpose();
    double top = 0.0;  // s of the upper edge, by fixed point
    for (int i = 0; i < 200; ++i) {
      top = shown.frustum.top / T * (1.0 + k1 + k2) /
            (1.0 + k1 * top * top + k2 * top * top * top * top);
    }
    EXPECT_NEAR(at.y(), 0.5 * shown.height * (1.0 - s.y() / top), 1.0) << s.transpose();
  }
}

TEST(Lens, LeavesTheEdgesMiddlesWhereTheFieldOfViewHasThem) {
  const Optics optics = with_lens();
  const View shown = eyes({}, optics)[0], drawn = drawn_view(shown, optics);
  EXPECT_LT(drawn.frustum.left, shown.frustum.left);  // corners are farther out
  EXPECT_GT(drawn.frustum.top, shown.frustum.top);
  EXPECT_GT(drawn.width, shown.width);
  const double inside = 0.985;
  const Vec2 at = middle_of_light(
      on_display(point_at(drawn, {inside * shown.frustum.right, 0.0}), shown, optics));
  EXPECT_GT(at.x(), 0.98 * shown.width);
  EXPECT_NEAR(at.y(), 0.5 * shown.height, 1.0);
}

TEST(Lens, LabelsAreBentAsPicturesAre) {
  const Optics optics = with_lens();
  const View shown = eyes({}, optics)[1], drawn = label_view(shown, optics);
  const auto count = static_cast<std::size_t>(drawn.width) * static_cast<std::size_t>(drawn.height);
  Labels labels{drawn.width, drawn.height, std::vector<std::uint32_t>(count),
                std::vector<float>(count, 2.0F)};
  const Vec2 t(0.4, 0.3);
  const Image image = point_at(drawn_view(shown, optics), t);
  ASSERT_EQ(image.width, drawn.width);
  for (std::size_t i = 0; i < count; ++i) labels.id[i] = image.rgb[3 * i] > 0 ? 7 : 0;
  const Labels seen = on_display(labels, shown, optics);
  Vec2 sum = Vec2::Zero();
  int found = 0;
  for (int i = 0; i < shown.width * shown.height; ++i) {
    if (seen.id[static_cast<std::size_t>(i)] != 7) continue;
    sum += Vec2(i % shown.width + 0.5, i / shown.width + 0.5);
    ++found;
  }
  ASSERT_GT(found, 0);
  EXPECT_LT((sum / found - middle_of_light(on_display(image, shown, optics))).norm(), 1.0);
}

// The depth of a display's pixel is that in its own direction, not that of a pixel beside it: of a floor,
// a wall and the edge between them, 1.6 m below and 7.6 m ahead of the eye.
TEST(Lens, DepthIsThatOfThePixelsOwnDirection) {
  const Optics optics = with_lens();
  const View shown = eyes({}, optics)[1], drawn = label_view(shown, optics);
  constexpr double kDown = 1.6, kAhead = 7.6;
  const auto depth_along = [&](const Vec2& t) {
    return t.y() < 0.0 ? std::min(kAhead, kDown / -t.y()) : kAhead;
  };
  Labels labels{drawn.width, drawn.height, {}, {}};
  const Frustum& f = drawn.frustum;
  for (int y = 0; y < drawn.height; ++y) {
    for (int x = 0; x < drawn.width; ++x) {
      labels.id.push_back(1);
      labels.depth.push_back(
          static_cast<float>(depth_along({f.left + (f.right - f.left) * (x + 0.5) / drawn.width,
                                          f.top - (f.top - f.bottom) * (y + 0.5) / drawn.height})));
    }
  }
  const Labels seen = on_display(labels, shown, optics);
  const double T = std::max(-shown.frustum.left, shown.frustum.right);
  const double k1 = optics.lens_k1, k2 = optics.lens_k2;
  const auto edge = [&](double t) {  // s in direction t, by fixed point
    double s = 0.0;
    for (int i = 0; i < 500; ++i) {
      s = t / T * (1.0 + k1 + k2) / (1.0 + k1 * s * s + k2 * s * s * s * s);
    }
    return s;
  };
  const double left = edge(shown.frustum.left), right = edge(shown.frustum.right);
  const double bottom = edge(shown.frustum.bottom), top = edge(shown.frustum.top);
  for (int y = 0; y < shown.height; ++y) {
    for (int x = 0; x < shown.width; ++x) {
      const Vec2 s(left + (right - left) * (x + 0.5) / shown.width,
                   top - (top - bottom) * (y + 0.5) / shown.height);
      const double r2 = s.squaredNorm();
      const double depth = depth_along(T * (1.0 + k1 * r2 + k2 * r2 * r2) / (1.0 + k1 + k2) * s);
      const float found = seen.depth[static_cast<std::size_t>(y * shown.width + x)];
      // At the edge between floor and wall a pixel may be taken for either.
      const double allowed = depth > 0.95 * kAhead ? 0.1 : 1e-4;
      EXPECT_NEAR(found, depth, allowed) << x << " " << y;
    }
  }
}

TEST(Display, WithoutRelayAndLensIsPlain) {
  EXPECT_TRUE(is_plain({}));
  EXPECT_FALSE(is_plain({.relay_width = 704, .relay_height = 480}));
  EXPECT_FALSE(is_plain(with_lens()));
  const Optics relayed{.relay_width = 704, .relay_height = 480};
  const View shown = eyes({}, relayed)[0], drawn = drawn_view(shown, relayed);
  EXPECT_EQ(drawn.width, 704);
  EXPECT_EQ(drawn.height, 480);
  EXPECT_EQ(drawn.frustum.left, shown.frustum.left);
  const Image out = on_display(noise(704, 480), shown, relayed);
  EXPECT_EQ(out.width, 360);
  EXPECT_EQ(out.height, 240);
}

}  // namespace
}  // namespace headpin::render
