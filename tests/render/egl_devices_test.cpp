#include "render/egl_devices.h"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/fingerprint.h"
#include "render/gl_functions.h"
#include "tests/support/folder.h"

namespace headpin::render {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(EglDevices, AreNamedByANumberOrAuto) {
  for (const char* name : {"egl:auto", "egl:0", "egl:12"}) {
    EXPECT_TRUE(is_egl_device(name) && is_context_name(name)) << name;
  }
  for (const char* name : {"egl", "egl:", "egl:-1", "egl:1x", "egl:autos", "osmesa:0", ""}) {
    EXPECT_FALSE(is_egl_device(name)) << name;
  }
}

/// Two cards of CUDA's, in the other order; one that does not work; another maker's; the processor.
std::vector<EglDevice> machine() {
  return {{0, false, false, {}, "Permission denied"},
          {1, true, true, 1, "card"},
          {2, true, true, 0, "card"},
          {3, true, true, {}, "another maker's"},
          {4, true, false, {}, "llvmpipe"}};
}

TEST(EglDevices, AutoTakesTheFirstCardThatWorksAndThatCudaShows) {
  EXPECT_EQ(chosen_device(machine(), std::nullopt), 1);
  EXPECT_EQ(chosen_device(machine(), "0"), 2);
  EXPECT_EQ(chosen_device(machine(), "0,1"), 2);
  EXPECT_EQ(chosen_device(machine(), "7,1"), 1);
  EXPECT_EQ(chosen_device(machine(), ""), 4);    // all hidden
  EXPECT_EQ(chosen_device(machine(), "-1"), 4);  // likewise
  EXPECT_EQ(chosen_device({}, std::nullopt), std::nullopt);
  EXPECT_THROW(chosen_device(machine(), "GPU-8f3a"), std::invalid_argument);
}

/// Whether Mesa's software is among the devices here; else there is nothing to draw with.
std::optional<int> processor() {
  try {
    for (const EglDevice& device : egl_devices()) {
      if (device.works && !device.card) return device.number;
    }
  } catch (const std::runtime_error&) {
  }
  return std::nullopt;
}

// So a picture by a card is told from one by the processor, by whichever door that was asked.
TEST(EglDevices, TheProcessorDrawsTheBitsThatItDrawsOtherwiseAndSaysThatItIsADevice) {
  const std::optional<int> number = processor();
  if (!number) GTEST_SKIP() << "EGL does not list the processor here";
  Renderer device(open_context("egl:" + std::to_string(*number)));
  const Fingerprint by_device = fingerprint(device);
  EXPECT_THAT(by_device.renderer, StartsWith("EGL device " + std::to_string(*number) + ", "));
  Renderer plain(open_context("egl"));
  const Fingerprint by_egl = fingerprint(plain);
  EXPECT_EQ(by_device.picture, by_egl.picture);
  EXPECT_THAT(difference(by_device, by_egl), HasSubstr("drawn by EGL device "));
}

TEST(EglDevices, OneThatIsNotListedIsRefused) {
  if (!processor()) GTEST_SKIP() << "EGL does not list the processor here";
  try {
    open_context("egl:99");
    FAIL() << "device 99 draws";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("egl:99: cannot be drawn with: EGL lists "));
  }
}

// Whatever driver the environment or the machine would have answer.
TEST(Egl, DrawsOnTheProcessorWhateverElseIsAskedFor) {
  if (!processor()) GTEST_SKIP() << "no EGL here";
  setenv("LIBGL_ALWAYS_SOFTWARE", "0", 1);
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere/10_card.json", 1);
  const std::unique_ptr<GlContext> context = open_context("egl");
  const std::string renderer = renderer_name(load_functions(*context));
  EXPECT_TRUE(draws_on_the_processor(renderer)) << renderer;
}

TEST(EglDevices, ADriverThatCrashesCostsAChildAndIsTold) {
  if (!processor()) GTEST_SKIP() << "no EGL here";
  const std::filesystem::path vendor = fresh_folder("vendor") / "10_card.json";
  std::ofstream(vendor) << R"({"file_format_version": "1.0.0", "ICD": {"library_path": ")"
                        << HEADPIN_CRASHING_DRIVER << "\"}}";
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", vendor.c_str(), 1);
  try {
    egl_devices();
    FAIL() << "the driver did not crash";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("its driver ended the process: Aborted"));
  }
}

}  // namespace
}  // namespace headpin::render
