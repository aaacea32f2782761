#include "render/data/hmd.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace headpin::render {
namespace {

TEST(Hmd, TheDefaultIsThePapers) {
  const Optics& optics = hmd_profiles().front().optics;
  EXPECT_EQ(optics.width, 360);
  EXPECT_EQ(optics.height, 240);
  EXPECT_EQ(optics.horizontal_fov_deg, 75.0);
  EXPECT_EQ(optics.vertical_fov_deg, 40.0);
  // tan(37.5) / 360 over tan(20) / 240: its picture elements are wide.
  EXPECT_NEAR(optics.pixel_aspect(), 1.405, 0.001);
}

TEST(Hmd, ProfilesAreFoundByNameAndOthersRefused) {
  for (const HmdProfile& profile : hmd_profiles()) {
    EXPECT_EQ(hmd_profile(profile.name).name, profile.name);
    EXPECT_FALSE(profile.source.empty());
  }
  EXPECT_NEAR(hmd_profile("flight-helmet-square").optics.pixel_aspect(), 1.0, 0.001);
  EXPECT_EQ(hmd_profile("flight-helmet-leep").optics.vertical_fov_deg, 58.4);
  EXPECT_THROW(hmd_profile("dvisor"), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::render
