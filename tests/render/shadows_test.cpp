// Shadows and mirror images: where they lie, and what they leave as it was.

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "render/renderer.h"
#include "tests/render/drawn_scenes.h"

namespace headpin::render {
namespace {

using test::kPlain;
using test::light;
using test::LitScene;
using test::looking_ahead;
using test::picture;
using test::pixel;
using test::projected_middle;

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

}  // namespace
}  // namespace headpin::render
