#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace headpin::render {

/// Where the light of the lamps is computed.
enum class LightPer : std::uint8_t { pixel, vertex };

/// The rendering quality of pictures. Participants see its effects, so trials store it.
struct Quality {
  int samples = 2;      ///< n; each pixel has n^2 + 1 samples for n of 2..8, one for 1
  bool contact = true;  ///< floors darken beneath and beside bodies
  bool shadow = true;   ///< bodies cast shadows on floors and bodies
  bool mirror = true;   ///< polished floors mirror what stands on them
  LightPer light = LightPer::pixel;

  bool operator==(const Quality&) const = default;
};

/// A named quality.
struct Look {
  std::string_view name, meaning;
  Quality quality;
};

/// "standard" first.
std::span<const Look> looks();

}  // namespace headpin::render
