#pragma once

#include <span>
#include <string>
#include <string_view>

#include "render/data/optics.h"

/// Head-mounted displays by name.
namespace headpin::render {

/// A display with its optics, the same for both eyes but mirrored.
struct HmdProfile {
  std::string_view name;
  std::string_view source;  ///< where its numbers come from
  Optics optics;
};

/// All profiles known; the first is the default.
std::span<const HmdProfile> hmd_profiles();

/// Their names, separated by commas.
std::string hmd_profile_names();

/// @throws std::invalid_argument  naming the profiles
const HmdProfile& hmd_profile(std::string_view name);

}  // namespace headpin::render
