// OSMesa and EGL are two doors to one Mesa: the same bits, in any order, in one process.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
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

/// Threads of this process that Mesa's rasteriser calls its own.
int rasterising_threads() {
  int count = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    if (name.starts_with("llvmpipe")) ++count;
  }
  return count;
}

// With its own, Mesa 22.3 frees a fence whose lock they still hold: a crash after minutes.
TEST(Contexts, DrawInTheCallersThreadUnlessTheUserWantsMesasOwn) {
  if (!both_there()) GTEST_SKIP() << "one of OSMesa and EGL is not there";
  unsetenv("LP_NUM_THREADS");
  for (const std::string_view name : context_names()) {
    Renderer renderer(open_context(name));
    test_picture(renderer);
    EXPECT_EQ(rasterising_threads(), 0) << name;
  }
  setenv("LP_NUM_THREADS", "2", 1);
  prepare_mesa();
  EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "2");
  unsetenv("LP_NUM_THREADS");
}

TEST(Contexts, OfAnotherNameAreRefused) {
  EXPECT_THROW(open_context("vulkan"), std::invalid_argument);
  EXPECT_TRUE(open_context()->instead_of.empty());
}

}  // namespace
}  // namespace headpin::render
