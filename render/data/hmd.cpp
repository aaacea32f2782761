#include "render/data/hmd.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace headpin::render {
namespace {

// To add another display, add a line.
constexpr std::array<HmdProfile, 7> kProfiles = {{
    {"flight-helmet",
     "Uno & Slater 1997, section 3: Virtual Research Flight Helmet",
     {.width = 360, .height = 240, .horizontal_fov_deg = 75.0, .vertical_fov_deg = 40.0}},
    {"flight-helmet-square",
     "as flight-helmet, with square elements at the same width",
     {.width = 360, .height = 240, .horizontal_fov_deg = 75.0, .vertical_fov_deg = 54.18}},
    {"flight-helmet-leep",
     "Watson, Walker, Hodges, VRST 1997, after Robinett and Rolland 1992: 208 x 139 triads",
     {.width = 208, .height = 139, .horizontal_fov_deg = 75.3, .vertical_fov_deg = 58.4}},
    {"flight-helmet-elements",
     "the same optics, its single-colour elements as brochures count them",
     {.width = 360, .height = 240, .horizontal_fov_deg = 75.3, .vertical_fov_deg = 58.4}},
    // With square pixels and 40 degrees vertically, an eye sees 57.3 degrees horizontally: 37.5
    // outward and 19.8 inward. 39.6 degrees are seen by both eyes.
    {"flight-helmet-total",
     "as flight-helmet, its 75 degrees being those of both eyes together, which overlap in part",
     {.width = 360,
      .height = 240,
      .horizontal_fov_deg = 57.3,
      .vertical_fov_deg = 40.0,
      .outer_deg = 37.5,
      .inner_deg = 19.8}},
    {"flight-helmet-relayed",
     "as flight-helmet, drawn in 704 x 480 and relayed to its 360 x 240 (the paper, section 3)",
     {.width = 360,
      .height = 240,
      .horizontal_fov_deg = 75.0,
      .vertical_fov_deg = 40.0,
      .relay_width = 704,
      .relay_height = 480}},
    {"flight-helmet-lens",
     "as flight-helmet-leep, drawn against a lens's distortion; its coefficient from memory of "
     "Robinett and Rolland 1992, not checked",
     {.width = 208,
      .height = 139,
      .horizontal_fov_deg = 75.3,
      .vertical_fov_deg = 58.4,
      .lens_k1 = 0.32}},
}};

}  // namespace

std::span<const HmdProfile> hmd_profiles() {
  return kProfiles;
}

std::string hmd_profile_names() {
  std::string names;
  for (const HmdProfile& profile : kProfiles) {
    names.append(names.empty() ? "" : ", ").append(profile.name);
  }
  return names;
}

const HmdProfile& hmd_profile(std::string_view name) {
  const auto found = std::ranges::find(kProfiles, name, &HmdProfile::name);
  if (found != kProfiles.end()) return *found;
  throw std::invalid_argument(std::string("display '").append(name).append("': expected one of ") +
                              hmd_profile_names());
}

}  // namespace headpin::render
