// OSMesa and EGL are two doors to one Mesa: the same bits, in any order, in one process.

#include <thread>

#include <gtest/gtest.h>

#include "render/fingerprint.h"

namespace headpin::render {
namespace {

/// Whether both can be had here; else there is nothing to compare.
bool both_there() {
  for (const std::string_view name : context_names()) {
    try {
      open_context(name);
    } catch (const std::runtime_error&) {
      return false;
    }
  }
  return true;
}

TEST(Contexts, DrawTheSameBitsInEveryLookWhileTheyTakeTurns) {
  if (!both_there()) GTEST_SKIP() << "one of OSMesa and EGL is not there";
  for (const Look& look : looks()) {
    Renderer osmesa(open_context("osmesa"), look.quality), egl(open_context("egl"), look.quality);
    const Image first = test_picture(osmesa);
    EXPECT_EQ(test_picture(egl), first) << look.name;
    EXPECT_EQ(test_picture(osmesa), first) << look.name;
    EXPECT_EQ(test_picture(egl), first) << look.name;
    EXPECT_EQ(osmesa.description().substr(0, 7), "OSMesa,");
    EXPECT_EQ(egl.description().substr(0, 4), "EGL,");
  }
}

TEST(Contexts, OneCanGoWhileTheOtherStaysAndEachHasItsThread) {
  if (!both_there()) GTEST_SKIP() << "one of OSMesa and EGL is not there";
  Renderer egl(open_context("egl"));
  const Image first = test_picture(egl);
  { EXPECT_EQ(test_picture(*std::make_unique<Renderer>(open_context("osmesa"))), first); }
  EXPECT_EQ(test_picture(egl), first);
  Image beside;
  std::thread thread([&] {
    Renderer other(open_context("egl"));
    beside = test_picture(other);
  });
  EXPECT_EQ(test_picture(egl), first);
  thread.join();
  EXPECT_EQ(beside, first);
}

TEST(Contexts, OfAnotherNameAreRefused) {
  EXPECT_THROW(open_context("vulkan"), std::invalid_argument);
  EXPECT_TRUE(open_context()->instead_of.empty());
}

}  // namespace
}  // namespace headpin::render
