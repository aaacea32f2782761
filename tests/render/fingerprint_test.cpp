#include "render/fingerprint.h"

#include <algorithm>
#include <cstdlib>
#include <set>

#include <gtest/gtest.h>

#include "render/osmesa_context.h"

namespace headpin::render {
namespace {

TEST(TestPicture, IsTheSameFromEveryRendererOfItsQualityAndWhateverWasDrawnBefore) {
  Renderer one(osmesa_context()), other(osmesa_context());
  const Image picture = test_picture(one);
  EXPECT_EQ(picture, test_picture(other));
  EXPECT_EQ(picture, test_picture(one));
}

// It says something of whatever a look leaves out: each changes it.
TEST(TestPicture, ShowsEveryEffect) {
  std::set<std::uint64_t> hashes;
  for (const Quality& quality :
       {Quality{}, Quality{.samples = 1}, Quality{.contact = false}, Quality{.shadow = false},
        Quality{.mirror = false}, Quality{.light = LightPer::vertex}}) {
    Renderer renderer(osmesa_context(), quality);
    hashes.insert(pixel_hash(test_picture(renderer)));
  }
  EXPECT_EQ(hashes.size(), 6u);
}

TEST(Fingerprint, TellsMesasEnvironment) {
  setenv("LP_HEADPIN_TEST", "7", 1);
  Renderer renderer(osmesa_context());
  const Fingerprint with = fingerprint(renderer);
  unsetenv("LP_HEADPIN_TEST");
  const Fingerprint without = fingerprint(renderer);
  EXPECT_EQ(std::ranges::count(with.environment, "LP_HEADPIN_TEST=7"), 1);
  EXPECT_EQ(std::ranges::count(without.environment, "LP_HEADPIN_TEST=7"), 0);
  EXPECT_FALSE(with.processor.empty());
  EXPECT_EQ(with.picture, without.picture);
  EXPECT_NE(difference(with, without).find("LP_HEADPIN_TEST=7"), std::string::npos);
}

TEST(Fingerprint, WithoutATellingDifferenceSaysThatThePictureDiffers) {
  Fingerprint a{"OSMesa", {"sse2"}, {}, 1}, b = a;
  EXPECT_EQ(difference(a, b), "");
  b.picture = 2;
  EXPECT_EQ(difference(a, b), "nothing that is told of it differs, its test picture does");
}

}  // namespace
}  // namespace headpin::render
